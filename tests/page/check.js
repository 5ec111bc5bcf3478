// The page in headless Chromium: every control, digests against `repose run`, messages, widths, names of controls, speed.
// Pictures of three widths, light and dark, in the page's folder. usage: check.js REPOSE PAGE
'use strict';
const { execFileSync } = require('child_process');
const fs = require('fs');
const path = require('path');
const open = require('./browser.js');

const [repose, folder] = process.argv.slice(2);
const WIDTHS = [360, 800, 1400];
let bad = 0, sum = 0;
function check(good, what) {
  sum++;
  if (good) return;
  bad++;
  console.log(`check   page: wrong: ${what}`);
}
function native(file) {
  const out = execFileSync(repose, ['run', file], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  const is = (name) => +(RegExp(`^${name}\t(\\S+)`, 'm').exec(out) || [])[1];
  return { digest: /^# digest: (\w+)/m.exec(out)[1], steps: +/^# steps: (\d+)/m.exec(out)[1], is };
}

async function main() {
  const heard = [];
  const b = await open((text) => heard.push(text));
  const { value, pause } = b, say = () => value('$("say").className + ": " + $("say").textContent');
  const until = async (what, ms = 60000) => {
    for (const end = Date.now() + ms; Date.now() < end; await pause(50)) if (await value(`!!(${what})`)) return true;
    check(false, `never: ${what}; the page says "${await say()}"`);
    return false;
  };
  const idle = () => value('queue.then(() => 1)');
  const set = async (id, v) => { await value(`$('${id}').value = ${JSON.stringify(v)}; for (const e of ['input', 'change']) $('${id}').dispatchEvent(new Event(e, { bubbles: true }))`); await idle(); };
  const press = async (id) => { await value(`$('${id}').click()`); await idle(); };
  const shows = async (id) => Number.parseFloat(await value(`$('${id}').textContent`));
  // The text of what was done, run by the program.
  const repeat = async (what, file) => {
    if (!await value('$("record").open')) await value('$("record").open = true');
    await value('show_record()');
    const digest = await value('$("digest").textContent'), text = await value('$("text").value'), step = +/step (\d+)/.exec(await value('$("until").textContent'))[1];
    fs.writeFileSync(file, text);
    const n = native(file);
    check(n.digest === digest && n.steps === step, `${what}: ${digest} at step ${step} on the page, ${n.digest} at step ${n.steps} by repose run ${file}`);
    await value('$("record").open = false');
    return text;
  };

  // Loading
  await b.size(1400, 900);
  const from = Date.now();
  await b.goto(path.join(folder, 'index.html'));
  await until('frame && frame.n.step > 0');
  const loaded = (Date.now() - from) / 1000;

  // Each experiment as its file has it, and others that the page does not offer: loaded walls, a bed
  for (const kind of ['box', 'cylinder', 'hopper', 'drum', 'column', 'biaxial', 'crater_bed']) {
    const text = fs.readFileSync(`examples/${kind}.cfg`, 'utf8');
    await value(`start(${JSON.stringify(text)}, '').then(() => { running = false; })`);
    await value("ask('run', 1e9).then(once).then(() => { tell(); })");
    const { digest } = await value("ask('state')"), n = native(`examples/${kind}.cfg`);
    const [as, said, began] = await value('[kind, $("say").textContent, begun()]');
    check(as === (await value(`!!$('${kind}.cfg')`) ? kind : 'other') && /has ended/.test(said) && (began || as === 'other'), `${kind}.cfg is taken for a ${as}, begun: ${began}; ${said}`);
    if (kind === 'box') check(Math.abs(await value('frame.theta[2]') - n.is('theta_r3_deg')) < 1e-5 && await value('p.W === 4 && p.N === 400 && p.mu === 0.2'), 'theta_R and sliders of a text');
    if (kind === 'drum') check(Math.abs(await value('map.box') + await value('map.ox - canvas.clientWidth / 2')) < 1, 'a drum is in the middle');
    if (kind === 'biaxial') check(/tilt–/.test(await value('$("table").textContent')) && await value('map.c === 1 && frame.n.energy < 1'), `no gravity: ${await value('$("table").textContent')}`);
    check(n.digest === digest, `${kind}.cfg: ${digest} on the page, ${n.digest} by repose run`);
    const offered = await value(`$('${kind}.cfg')?.textContent ?? null`);
    check(offered === null || offered.trim() === text.trim(), `${kind}.cfg on the page differs from examples`);
  }

  // Small grains in m, no grains, no phases: what fails must not end the page
  await value(`start(${JSON.stringify(fs.readFileSync('examples/wedge.cfg', 'utf8'))}).then(() => { play(true); })`);
  await until('frame.n.t > 0.01 && frame.n.grains === 3000');
  check(/Phase .fill. of the text/.test(await say()) && await value('draw(), frame.n.dt > 0 && Math.abs(frame.n.d - 0.0069) < 0.001'), `wedge.cfg: ${await say()}`);
  await value("one_by_one(() => { throw Error('of a test'); })");
  await value(`start(${JSON.stringify(fs.readFileSync('examples/pile.cfg', 'utf8'))})`);
  check(/phases = \(/.test(await say()), `no phases: ${await say()}`);
  await value("start('dt = 5e-5; y_min = -1.0; fill = { N = 1; W = 1.0; H = 1.0; }; phases = ( { name = \"a\"; steps = 5000; } );').then(() => read(1, 9999)).then(() => tilt(1))");
  check(await value('frame.n.grains === 0 && !(theta_t > 0)') && /no grain/.test(await say()), `no grains: ${await say()}`);

  // Values that are refused, one right after another
  await value("choose('box')");
  await value(`for (const [id, v] of [['in-N', 3000], ['in-W', 2]]) { $(id).value = v; for (const e of ['input', 'change']) $(id).dispatchEvent(new Event(e)); }`);
  await idle();
  check(/bad: Dt = .*fewer grains/.test(await say()) && await value('frame.n.grains === 3000 && p.W === 5 && +$("in-W").value === 5 && /^Run/.test($("play").textContent)'), `a width that is refused: ${await say()}`);
  await set('in-N', 50);
  await set('in-W', 12);
  check(!(await say()).startsWith('bad'), `few grains in a wide box: ${await say()}`);
  await value("choose('drum')");
  await set('in-omega', 0);
  await set('in-N', 200);
  check(/rate above 0/.test(await say()) && await value('p.N === 440'), `a drum that stands: ${await say()}`);

  await value("Promise.all(['hopper', 'box', 'drum', 'box', 'cylinder'].map(choose))");
  check(await value('kind === "cylinder" && Object.keys(p).every((k) => p[k] === was[k]) && frame.n.grains === 600'), `experiments chosen at once: ${await say()}`);

  // Outflow, read at any pace as the program has it
  await value("choose('hopper')");
  await set('speed', '100');
  await until('frame.n.done');
  const flow = await value('Number.parseFloat([...$("table").rows].find((r) => /outflow/.test(r.textContent)).cells[1].textContent)');
  check(Math.abs(flow - native('examples/hopper.cfg').is('rate')) < 150, `an outflow of ${flow} grains/s`);

  // The box with every control
  await value("choose('box')");
  await set('speed', '100');
  await set('in-N', 400);
  await set('in-W', 4);
  await set('in-scatter', 0.1);
  check(await shows('of-N') === 400 && await shows('of-W') === 4 && await shows('of-scatter') === 0.1, 'sliders of a new start');
  await value('$("rotation").click()');
  await idle();
  check(await value('p.rotation && !$("in-mu_roll").disabled'), 'grains rotate');
  await until('frame.n.t > 0.4');
  await set('in-mu', 0.3);
  await set('in-mu_roll', 0.05);
  await set('in-k_n', 5.7);
  check(!(await say()).startsWith('bad'), `laws that change: ${await say()}`);
  await press('act');
  await until('begun() && $("act").disabled', 5000);
  await until('frame.n.t > 1.5 && frame.columns > 4 && Number.isFinite(frame.theta[2])');
  check(await value('$("table").textContent.includes("±")'), 'theta_R with its error');
  await press('pour');
  const box = await value('(() => { const r = canvas.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()');
  const spot = (x, y) => value(`[${box[0]} + map.ox + map.k * ${x}, ${box[1]} + map.oy - map.k * ${y}]`);
  let [x, y] = await spot(7.5, 3);
  await b.click(x, y);
  await until('/^name = "act[0-9]+"; add = { r = 0.1; x = [0-9]/.test(record.live.join())', 10000);
  await idle();
  await value('play(false)');
  [x, y] = await value(`[${box[0]} + map.ox + map.k * frame.picture[0], ${box[1]} + map.oy - map.k * frame.picture[1]]`);
  await b.click(x, y);
  await until('$("say").className === "bad"');
  check(/Choose a free place/.test(await say()), `a click into a grain: ${await say()}`);
  await repeat('box, changed laws, grains put in', path.join(folder, 'box.cfg'));
  await value('play(true)');
  await press('right');
  await until('theta_t > 0', 90000);
  await until('$("table").textContent.includes(theta_t.toFixed(1))', 5000);
  await set('speed', '0.1');
  await press('left');
  await set('in-k_n', 5.6);
  check(await value('Number.isNaN(theta_t) && !tilting') && /The tilt was ended at/.test(await say()), `another act ends a tilt: ${await say()}`);
  await until('$("stop").disabled', 5000);
  await pause(300);
  const tilted = await value('frame.n.tilt');
  await pause(300);
  check(await value('frame.n.tilt') === tilted, 'gravity stands after an act');
  await set('speed', '100');
  for (const [id, v] of [['show', 'lines'], ['turns', 'box']]) await set(id, v);
  for (const id of ['rays', 'slopes']) await press(id);
  await press('right');
  await pause(300);
  await press('stop');
  await set('in-mu', 0.4);
  check(/tilt gravity instead/.test(await say()) && await shows('of-mu') === 0.3 && await value('p.mu === 0.3 && +$("in-mu").value === 0.3'), `laws in a box that has turned: ${await say()}`);
  check(await value('[0, 2 * p.W].every((x) => map.oy + map.k * map.st * x < canvas.clientHeight)'), 'the floor of a turned box is in view');
  for (const id of ['rays', 'slopes']) await press(id);
  await repeat('box, tilted', path.join(folder, 'tilted.cfg'));
  await set('turns', 'gravity');
  await set('show', 'load');

  // Keys
  for (const [key, code, what] of [[' ', 32, 'running'], ['p', 80, 'running'], ['g', 71, 'record.live.length === 10'], ['ArrowRight', 39, 'tilting || theta_t > 0'], ['ArrowDown', 40, '!tilting'], ['r', 82, '!hand'], ['o', 79, 'begun()']]) {
    await value('document.activeElement.blur()');
    await b.key(key, code);
    await idle();
    await until(what, 5000);
  }
  await value('play(true)');
  await until('frame.n.t > 0.5');
  await value('play(false)');

  // The others, by hand
  for (const [kind, changes] of [['cylinder', [['in-v', 5], ['in-N', 200], ['in-mu', 0.8], ['in-v', 4]]], ['hopper', [['in-D', 2], ['in-N', 500], ['in-mu', 0.1]]], ['drum', [['in-N', 200], ['in-mu', 0.6], ['in-omega', 1.5]]]]) {
    await value(`choose('${kind}')`);
    await set('speed', '100');
    for (const [id, v] of changes.slice(0, 2)) await set(id, v);
    await value('play(true)');
    await until('frame.n.t > 0.3');
    for (const [id, v] of changes.slice(2)) await set(id, v);
    if (!await value('$("act").disabled')) await press('act');
    await until('frame.n.t > 1');
    if (kind !== 'drum') await press('pour');
    await until('frame.n.t > 1.2');
    check(!(await say()).startsWith('bad'), `${kind}: ${await say()}`);
    await repeat(`${kind}, by hand`, path.join(folder, `${kind}.cfg`));
  }
  // A text of one's own, right and wrong
  await value("choose('box').then(() => start(source('cylinder.cfg').replace('mu = 0.5', 'mu = 0.4'), ''))");
  check(await value('record.source.includes("mu = 0.4")'), 'a text of one\'s own');
  await value('$("record").open = true');
  await pause(500);
  await value('$("text").value = "dt = 1;"; $("read").click()');
  await until('$("say").className === "bad" && /phases/.test($("say").textContent)');
  await value('$("record").open = false');

  // Speed
  await value("choose('box')");
  await set('speed', '1');
  await set('in-N', 1000);
  await set('in-W', 6);
  await value('play(true); seen.fps = 60');
  await pause(4000);
  const speed = await value('[seen.fps, seen.rate, seen.steps]');
  check(speed[0] > 0, `${speed[0]} frames a second with 1000 grains`);

  // Widths and themes
  await press('act');
  await set('speed', '4');
  await pause(3000);
  await value('play(false); document.activeElement.blur()');
  for (const width of WIDTHS) {
    await b.size(width, width < 500 ? 780 : 900);
    for (const scheme of ['light', 'dark']) {
      await b.media({ 'prefers-color-scheme': scheme });
      await pause(300);
      await value('draw()');
      const wide = await value('document.documentElement.scrollWidth');
      check(wide <= width, `${wide} px wide at ${width} px`);
      await b.shot(path.join(folder, `${width}-${scheme}.png`), true);
    }
  }
  // Touch, names of controls, reduced motion
  await b.size(360, 780);
  [x, y] = await value('(() => { const r = $("play").getBoundingClientRect(); scrollTo(0, scrollY + r.top - 300); const s = $("play").getBoundingClientRect(); return [s.left + s.width / 2, s.top + s.height / 2]; })()');
  await b.send('Emulation.setTouchEmulationEnabled', { enabled: true });
  await b.tap(x, y);
  await until('running', 5000);
  const { nodes } = await b.send('Accessibility.getFullAXTree');
  for (const n of nodes.filter((n) => !n.ignored && /^(button|slider|checkbox|radio|combobox|textbox|image)$/i.test(n.role?.value)))
    check(n.name?.value, `a ${n.role.value} has no name`);
  await b.media({ 'prefers-reduced-motion': 'reduce' });
  await b.goto(path.join(folder, 'index.html'));
  await until('frame');
  await pause(500);
  check(!await value('running') && /Paused|Run/.test(await say()), 'reduced motion: paused at first');
  await press('play');
  await until('frame.n.step > 100', 10000);

  check(heard.length === 0, `the console has: ${heard.join('; ')}`);
  b.close();
  console.log(`check   page: ${sum - bad} of ${sum} right; ${loaded.toFixed(2)} s to the first frame; 1000 grains: ${speed[0].toFixed(0)} frames/s, ${speed[1].toFixed(2)} of real time, ${speed[2].toExponential(1)} particle-steps/s`);
  console.log(`see     ${WIDTHS.map((w) => `${folder}/${w}-light.png ${w}-dark.png`).join(' ')}`);
  process.exit(bad ? 1 : 0);
}
main().catch((e) => { console.error(`check-page: ${/^there is no/.test(e.message) ? e.message : e.stack}`); process.exit(1); });
