/* ---- the engine, in a thread of its own ---- */
const $ = (id) => document.getElementById(id), source = (id) => $(id).textContent;
const worker = new Worker(URL.createObjectURL(new Blob([source('worker')])));
const waits = new Map(); let calls = 0;
worker.onmessage = ({ data: [id, result, error] }) => { const w = waits.get(id); waits.delete(id); error ? w[1](Error(error)) : w[0](result); };
worker.onerror = (e) => say(`The engine stopped: ${e.message}. Reload the page.`, true);
const ask = (...call) => new Promise((good, bad) => { waits.set(++calls, [good, bad]); worker.postMessage([calls, ...call]); });
const engine = (async () => {
  const packed = Uint8Array.from(atob(source('engine').trim()), (c) => c.charCodeAt(0));
  const bytes = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  return ask('init', bytes);
})();
/* ---- experiments ---- */
const DT = 5e-5, D = 0.2; /* time step and mean diameter of all texts here, s and cm */
const distances = (f) => Float32Array.from({ length: f.n.grains }, (_, i) => Math.abs(f.picture[5 * i])).sort();
const ends = (f) => { /* of walls that have some */
  const all = [], from = 5 * (f.n.grains + f.n.links);
  for (let k = from; k < from + 6 * f.n.walls; k += 6) {
    const [x, y, nx, ny, ...at] = f.picture.subarray(k, k + 6);
    for (const s of at) if (Math.abs(s) < 1e4) all.push([x + s * ny, y - s * nx]);
  }
  return all;
};
const turned = (p) => `rotation=${p.rotation}\nrolling.mu=${p.rotation ? p.mu_roll : 0}\nnormal.k_n=${p.k_n}\nfill.radius_width=${0.1 * p.scatter}`;
const kinds = {
  box: { name: 'Box', act: 'Open the wall', body: () => 'open = "right";', surface: (p) => [1, 0, p.W], x: (p) => [0, 2 * p.W], pour: (p) => [D, p.W - D],
    start: { mu: 0.5, mu_roll: 0.1, k_n: 1e6, N: 600, W: 5, scatter: 0.2, rotation: false }, moved: 'pile.moved(0.1*d) >= 0.05*pile.marked',
    hint: 'The box is full and at rest. Open the wall.', region: 'pile',
    changes: (p) => `N=${p.N}\nW=${p.W}\nmu=${p.mu}\nmu_roll=${p.rotation ? p.mu_roll : 0}\nrotation=${p.rotation}\nk_n=${p.k_n}\nscatter=${p.scatter}\nopens=false${p.N < 10 * p.W ? '\nfill.H=0.8' : ''}` },
  cylinder: { name: 'Lifted cylinder', act: 'Lift the cylinder', body: (p) => `walls = { cylinder = { velocity = (0.0, ${p.v.toFixed(2)}); }; };`, surface: () => [2, -1e3, 1e3],
    x: (p, f) => { const far = distances(f), R = Math.max(1.8 * p.W, (far[Math.floor(0.98 * far.length)] || 0) + 4 * D); return [-R, R]; }, pour: (p) => [-0.3 * p.W, 0.3 * p.W], names: { W: 'D' }, start: { mu: 0.5, mu_roll: 0.1, k_n: 1e6, N: 600, W: 4, scatter: 0.2, v: 2, rotation: true },
    changes: (p) => `D=${p.W}\nv=${p.v}\nmu=${p.mu}\nmu_roll=${p.rotation ? p.mu_roll : 0}\naspect=${p.N * D * D / (p.W * p.W)}\n${turned(p)}` },
  hopper: { name: 'Hopper', act: 'Open the gate', body: () => 'open = "gate";', surface: () => [0, 0, 1], x: () => [0, 6], pour: () => [D, 6 - D], range: { N: [400, 3000, 10] },
    start: { mu: 0.2, mu_roll: 0.1, k_n: 1e6, N: 1200, D: 1.6, scatter: 0.2, rotation: false },
    changes: (p) => `D=${p.D}\nmu=${p.mu}\nfill.N=${p.N}\nfill.H=${p.N / 75}\n${turned(p)}` },
  drum: { name: 'Drum', act: 'Turn the drum', body: (p) => `walls = { drum = { omega = ${p.omega.toFixed(2)}; }; };`, surface: () => [0, 0, 1],
    x: (p, f) => { const R = Math.max(...ends(f).map(([x, y]) => Math.hypot(x, y))); return [-R, R, -R, R]; }, start: { mu: 0.2, mu_roll: 0.1, k_n: 1e6, N: 440, omega: 0.5, scatter: 0.2, rotation: false },
    changes: (p) => `R=${Math.sqrt(p.N / 27.5)}\nomega=${p.omega}\nmu=${p.mu}\nfill.N=${p.N}\n${turned(p)}` },
  other: { start: { mu: 0, mu_roll: 0, k_n: 1e6, rotation: false }, surface: () => [0, 0, 1], x: (p, f) => { /* a text with walls of its own */
    const q = f.picture, of = ends(f);
    for (let i = 0; i < f.n.grains; i++) of.push([q[5 * i] - q[5 * i + 2], q[5 * i + 1] - q[5 * i + 2]], [q[5 * i] + q[5 * i + 2], q[5 * i + 1]]);
    const most = (i, pick) => of.reduce((m, v) => pick(m, v[i]), of[0][i]);
    return of.length ? [most(0, Math.min), most(0, Math.max), most(1, Math.min)] : [0, 1, 0]; } },
};
/* Sliders: what is shown, range, unit; `law` is what a new phase says, without it the value waits for a start. */
const log = { to: Math.log10, from: (v) => +(10 ** v).toPrecision(2) };
const sliders = {
  mu: { name: 'friction <i class="v">μ</i>', range: [0, 1.5, 0.01], law: (v) => `tangential = { mu = ${v.toFixed(4)}; };` },
  mu_roll: { name: 'rolling resistance', range: [0, 0.5, 0.01], law: (v) => `rolling = { mu = ${v.toFixed(4)}; };`, off: (p) => !p.rotation },
  k_n: { name: 'stiffness <i class="v">k</i><sub>n</sub>', unit: 'dyn/cm<sup>3/2</sup>', range: [5, 6.3, 0.02], scale: log, law: (v) => `normal = { k_n = ${v.toExponential(3)}; };` },
  v: { name: 'speed of the lift', unit: 'cm/s', range: [0.5, 10, 0.1], law: (v, p) => begun() ? kinds.cylinder.body(p) : '' },
  omega: { name: 'rate of the drum', unit: 'rad/s', range: [0, 2, 0.05], law: (v, p) => kinds.drum.body(p) },
  N: { name: 'number of grains', range: [50, 3000, 10] },
  W: { name: 'width', unit: 'cm', range: [2, 12, 0.5] },
  D: { name: 'width of the outlet', unit: 'cm', range: [0.6, 4, 0.1] },
  scatter: { name: 'scatter of the radii', unit: 'of the mean', range: [0, 0.3, 0.01] },
};
let kind = 'box', p = { ...kinds.box.start }, was = { ...p } /* p: of the sliders; was: what the pile has */, own /* a text that was given */, chosen = kind, running = false, frame = null, busy = false, held = 0;
let queue = Promise.resolve(), version = 0, theta_t = NaN, rested = true, tilting = '', outcome = '', hand = false, seen = { rate: 1, at: 0, steps: 0, fps: 60 }, fault = false, gone = [];
/* ---- the text of what is done: phases, each with its steps ---- */
let record = { source: '', head: '', closed: [], live: [], begun: 0 };
function parts(list, at) { /* pieces of a text between separators that are in no bracket or quote */
  const found = []; let depth = 0, quote = false, from = 0;
  for (let i = 0; i < list.length; i++) {
    const c = list[i];
    if (c === '"' && list[i - 1] !== '\\') quote = !quote;
    if (quote) continue; depth += '({['.includes(c) - ')}]'.includes(c);
    if (c === at && depth === 0) { found.push(list.slice(from, i).trim()); from = i + 1; }
  }
  return [...found, list.slice(from).trim()].filter((s) => s);
}
function short(text) { return text.replace(/-?\d\.\d{17}e[+-]\d\d/g, (n) => { const s = String(Number(n)); return /[.e]/.test(s) ? s : s + '.0'; }); }
function open_record(text) {
  const line = /^phases = \((.*)\);$/m.exec(text), lines = (s) => s.replace(/ \}, \{ /g, ' },\n  { ');
  const body = (s) => parts(s.replace(/^\{|\}$/g, ''), ';').filter((m) => !/^(if|steps|time|until|least|every|most|fail|go_on|status|keep) = /.test(m)).map((m) => m + ';').join(' ');
  record = { source: lines(text), head: lines(text.replace(/^(phases|measure|result|require) = .*;\n/mg, '')), closed: [], live: line ? parts(line[1], ',').map(body) : [], begun: 0 };
}
function close_phases({ where, phases, step }) {
  const closed = [...record.closed];
  let from = record.begun;
  record.live.forEach((body, k) => {
    const phase = phases[record.closed.length + k], current = phase.name === where;
    if (!phase.passes && !current) return;
    const to = phase.passes ? phase.step : step;
    closed.push(`{ ${body} steps = ${to - from}; }`), from = to;
  });
  return closed;
}
const text_of = (head, phases) => `${head}phases = (\n  ${phases.join(',\n  ')} );\n`;
const record_text = (state) => state.phases.some((q) => q.inner) || (!hand && !state.phases.some((q) => q.name === state.where)) ? record.source : text_of(record.head, close_phases(state));
/* End the phase, begin others. A text without an end of its own ends at once, the last one never. A tilt ends, too. */
function act(bodies, set) {
  return one_by_one(async () => {
    const state = await ask('state'), all = [].concat(bodies).map((b) => b.body === undefined ? { body: b } : b);
    if (state.phases.some((q) => q.inner)) throw Error('a text with phases within phases can only be watched; start one of the experiments');
    if (tilting && !/_turn_/.test(all[0].body)) all[0].body = still_now + all[0].body;
    const closed = close_phases(state), live = all.map((b, k) => ({ name: `act${closed.length + 1 + k}`, ...b }));
    const phases = live.map((b, k) => `{ name = "${b.name}"; ${b.body} ${b.end || `steps = ${k < live.length - 1 ? 0 : 1000000000};`} }`);
    await ask('go_on', text_of(record.head, [...closed, ...phases]), live.length);
    record = { ...record, closed, live: live.map((b) => `name = "${b.name}"; ${b.body}`), begun: state.step };
    outcome = tilting ? `The tilt was ended at ${Math.abs(frame.n.tilt).toFixed(1)}°, before the pile moved.` : '';
    tilting = live[0].end ? live[0].name : ''; if (tilting) theta_t = NaN;
    hand = true, fault = false, told = tilting || live.at(-1).name, $('record').open = false;
    tell();
  }, set);
}
function one_by_one(job, set = {}) { /* true if it went well; what it was to set is set, or goes back */
  held++;
  const back = () => { for (const k of Object.keys(set)) if (p[k] === set[k]) p[k] = was[k]; sync(); };
  return queue = queue.then(job).then(() => { Object.assign(was, set); return true; }, (e) => { back(); say(advice(e.message), true); tell(true); return false; })
    .then(async (good) => { held--; if (running && frame) show(); else await once(); return good; });
}
function advice(message) {
  const what = /that turns/.test(message) ? 'Start again, and tilt gravity instead.' : /^overlap /.test(message) ? 'Choose a larger stiffness.' : /touch|no place|overlap/.test(message) ? 'Choose a free place.'
    : /dt = /.test(message) ? 'Choose a smaller stiffness or speed, or fewer grains or a wider box.' : /room/.test(message) ? 'Choose fewer grains or a wider box.' : /= inf/.test(message) ? 'Choose a rate above 0.' : 'Change it, or start again.';
  return `${message[0].toUpperCase()}${message.slice(1)}. ${what}`;
}
function say(text, bad) { $('say').textContent = text; $('say').className = bad ? 'bad' : ''; }
/* ---- start, run, read ---- */
function start(text, set, next) { /* next: an experiment that has been chosen, not another since */
  return one_by_one(async () => {
    await engine;
    if (next && next !== chosen) return;
    if (next && own !== undefined) view(next);
    version++, running = false;
    const values = { ...was, ...set };
    open_record(await ask('start', text ?? source(`${kind}.cfg`), text === undefined ? kinds[kind].changes(values) : ''));
    was = values;
    for (const line of ['head', 'source']) record[line] = short(record[line]); own = text, theta_t = NaN, tilting = outcome = '', hand = false, fault = false, top_now = 0, gone = [];
    if (own !== undefined) adopt();
    $('record').open = false; await once();
    if (own !== undefined && 'N' in p) p.N = was.N = frame.n.grains;
    follow();
    running = !still.matches; tell();
  }, set);
}
/* Which experiment a text is, by its walls, and the values of its sliders. */
function adopt() {
  const walls = (t) => (/^walls = [^]*?\} *\);/m.exec(t) || [''])[0].replace(/\s/g, '');
  kind = Object.keys(kinds).find((k) => kinds[k].act && walls(source(`${k}.cfg`)) === walls(record.head)) || 'other';
  p = { ...kinds[kind].start, rotation: false };
  for (const key of Object.keys(p)) {
    const value = new RegExp(`^ *${kinds[kind].names?.[key] || key} = (?:{ value = )?(true|false|-?\\d[\\d.e+-]*)`, 'm').exec(record.head);
    if (value) p[key] = JSON.parse(value[1]);
  }
  const width = /radius_width = ([\d.]+)/.exec(record.head);
  if (width && 'scatter' in p) p.scatter = 10 * width[1];
  was = { ...p };
  for (const tab of document.querySelectorAll('#tabs input')) tab.checked = tab.value === kind;
  make_sliders();
}
/* Laws as a text of one's own has them, and as its phases that have passed or run change them. */
const passed = () => hand ? [...record.closed, ...record.live] : record.live.filter((_, k) => { const q = frame.phases[k] || {}; return q.passes || q.name === frame.where; });
function follow() {
  if (own === undefined || hand) return;
  for (const [key, name] of [['mu', 'tangential = {[^}]*mu'], ['mu_roll', 'rolling = {[^}]*mu'], ['k_n', 'normal = {[^}]*k_n']]) {
    const last = passed().map((b) => new RegExp(`${name} = ([^;]+);`).exec(b)).filter(Boolean).at(-1);
    p[key] = was[key] = last ? +last[1] : frame.n[key];
  }
  sync();
}
async function read(seconds, most) {
  const mine = version, f = await ask('frame', seconds, frame ? frame.n.dt : DT, most, kinds[kind].surface(was));
  if (mine !== version) return; frame = f;
  const names = 'step t grains links walls done energy rest tilt gx gy mu mu_roll k_n weight dt d'.split(' '), at = names.length, n = frame.n = Object.fromEntries(names.map((k, i) => [k, f.number[i]]));
  frame.theta = f.number.slice(at, at + 3), frame.error = f.number.slice(at + 3, at + 6), frame.flanks = [f.number.slice(at + 6, at + 9), f.number.slice(at + 9, at + 12)], frame.columns = f.number[at + 12] || 0;
  frame.centre = [0, 0]; /* of mass, gravity down */
  const g = Math.atan2(n.gx, 0 - n.gy), c = Math.cos(g) / n.grains, s = Math.sin(g) / n.grains;
  for (let i = 0; i < n.grains; i++) { const [x, y] = f.picture.subarray(5 * i); frame.centre[0] += c * x + s * y, frame.centre[1] += c * y - s * x; }
  if (!begun() || (gone.length && n.grains > gone.at(-1).grains)) gone = [];
  if (begun()) gone.push({ t: n.t, grains: n.grains });
  while (gone.length > 2 && n.t - gone[1].t >= 0.5) gone.shift();
  if (tilting && f.where !== tilting && f.where.startsWith('act')) {
    theta_t = Math.abs(n.tilt), tilting = '';
    outcome = `The pile moves at a tilt of ${theta_t.toFixed(1)}°${rested ? '' : ', but it was not at rest before'}. The same button tilts on.`;
  }
  if (f.fault) {
    running = false, fault = n.done !== 1, tell(true); /* 2: the grains can't go on */
    say(!fault ? `The experiment has ended without a result: ${f.fault}. “Run” goes on.` : advice(f.fault), true);
  }
  const news = running && (frame.where !== told || n.done);
  if (frame.where !== told) follow();
  told = frame.where; if (n.done) running = false; if (news) tell();
  return f;
}
async function once() { try { await read(0, 0); draw(); show(); } catch (e) { if (frame) say(advice(e.message), true); } }
/* The engine works all the time where it is slower than wanted; the picture follows the screen. */
let last = 0, drawn = 0, fresh = false, told = '';
function turn(now) {
  requestAnimationFrame(turn);
  if (!busy) pump();
  if (!fresh || (still.matches && now - drawn < 250)) return;
  fresh = false; draw();
  seen.fps = 0.95 * seen.fps + 0.05 * 1000 / (now - drawn);
  drawn = now; if (now - seen.at > 120) { seen.at = now; show(); }
}
async function pump() {
  const now = performance.now(), elapsed = (now - last) / 1000, wanted = Math.min(0.05, elapsed) * $('speed').value;
  last = now; if (!running || held || !frame || wanted < frame.n.dt) return;
  busy = true; const before = frame.n.t;
  const f = await read(wanted, 13).catch((e) => say(advice(e.message), true));
  busy = false; if (!f) return; fresh = true;
  seen.steps += 0.05 * (f.done * f.n.grains / (performance.now() - now) * 1000 - seen.steps);
  seen.rate += 0.05 * (Math.max(0, f.n.t - before) / elapsed - seen.rate);
  if (f.done * f.n.dt < 0.9 * wanted) pump();
}
function play(on) {
  if (on && frame && frame.n.done && !fault) { act('').then((good) => good && play(true)); return; }
  running = on && !fault, $('record').open &&= !running;
  tell();
}
function do_act() { return act(kinds[kind].body(was)).then((good) => good && play(true)); }
const still_now = 'gravity_turn_deg_per_step = 0.0; box_turn_deg_per_step = 0.0; ';
function tilt(sign) {
  if (!sign) return act(still_now);
  if (!frame.n.grains) return say('There is no grain to move.', true);
  rested = !!frame.n.rest;
  const box = $('turns').value === 'box', rate = (sign * 5 * frame.n.dt).toFixed(10);
  const key = 'gravity_turn_deg_per_step box_turn_deg_per_step'.split(' '), turn = key.map((k, i) => `${k} = ${i === +box ? rate : '0.0'};`).join(' ');
  return act([{ body: turn, end: `every = 50; most = 2000000; until = "${kinds[kind].moved || 'moved(0.1*d) >= 0.05*marked'}";`, name: `tilt${record.closed.length}` }, still_now])
    .then((good) => good && play(true));
}
function pour() {
  if (!kinds[kind].pour) return say('The drum is closed: click into it to insert a grain.', true);
  const [a, b] = kinds[kind].pour(was), bodies = [];
  for (let k = 0; k < 10; k++) {
    const r = 0.1 * (1 + was.scatter * (Math.random() + Math.random() - 1)), x = a + (b - a) * (k + 0.2 + 0.6 * Math.random()) / 10;
    bodies.push(`add = { r = ${r.toFixed(4)}; x = ${x.toFixed(4)}; y = "max(touch, 0) + 2*d"; };`);
  }
  return act(bodies).then((good) => good && play(true));
}
/* ---- the picture ---- */
const canvas = $('view'), pen = canvas.getContext('2d'), still = matchMedia('(prefers-reduced-motion: reduce)'), dark = matchMedia('(prefers-color-scheme: dark)');
const CLASSES = 10; let colours = [], top_now = 0, most_now = 10, map = null;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
function read_colours() {
  const stops = [0, 1, 2, 3].map((k) => css(`--load-${k}`).match(/\w\w/g).map((h) => parseInt(h, 16)));
  colours = Array.from({ length: CLASSES }, (_, k) => { const t = 3 * k / (CLASSES - 1), i = Math.min(2, Math.floor(t)), f = t - i;
    return `rgb(${stops[i].map((c, j) => Math.round(c + f * (stops[i + 1][j] - c))).join(' ')})`; });
}
function fit(f) { /* lab to screen: gravity points down; the width of the experiment and the highest grain are in view */
  const ratio = Math.min(2, devicePixelRatio || 1), w = canvas.clientWidth, h = canvas.clientHeight, q = f.picture, turn = Math.PI / 180;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
  const [x0, x1, low = kind === 'hopper' ? -0.8 : 0] = kinds[kind].x(was, f), g = Math.atan2(f.n.gx, 0 - f.n.gy), c = Math.cos(g), s = Math.sin(g);
  const box = kinds[kind].act ? f.n.tilt * turn - g : 0, cb = Math.cos(box), sb = Math.sin(box), ct = Math.cos(g + box), st = Math.sin(g + box); /* how far it has turned */
  let high = kind === 'drum' ? x1 : kind === 'other' ? low + 0.1 * (x1 - x0) : 2;
  for (let i = 0; i < f.n.grains; i++) {
    const x = cb * q[5 * i] - sb * q[5 * i + 1], y = sb * q[5 * i] + cb * q[5 * i + 1];
    if (x > x0 - 5 * f.n.d && x < x1 + 5 * f.n.d) high = Math.max(high, y + q[5 * i + 2]);
  }
  top_now = !top_now || still.matches || high > top_now ? Math.max(high, top_now && !still.matches ? top_now : 0) : top_now + 0.03 * (high - top_now);
  const corners = [[x0, low], [x1, low], [x0, top_now], [x1, top_now]].map(([x, y]) => [ct * x + st * y, -st * x + ct * y]);
  const xs = corners.map((v) => v[0]), ys = corners.map((v) => v[1]), left = Math.min(...xs), right = Math.max(...xs), bottom = Math.min(...ys), upper = Math.max(...ys);
  const margin = 26, k = Math.min((w - 2 * margin) / (right - left), (h - 2 * margin - 30) / (upper - bottom));
  const ox = w / 2 - k * (left + right) / 2, oy = h - margin + k * bottom;
  map = { k, c, s, ox, oy, box, cb, sb, ct, st };
  pen.resetTransform(); pen.clearRect(0, 0, canvas.width, canvas.height);
  pen.setTransform(ratio * k * c, ratio * k * s, ratio * k * s, -ratio * k * c, ratio * ox, ratio * oy);
  return { x0, x1 };
}
function draw() {
  if (!frame) return;
  const f = frame, q = f.picture, n = f.n.grains, { x0, x1 } = fit(f), px = 1 / map.k, lines = $('show').value === 'lines', links = 5 * n, walls = links + 5 * f.n.links;
  let most = 0; const loads = new Float32Array(n);
  for (let i = 0; i < n; i++) loads[i] = q[5 * i + 3];
  if (n) most = loads.slice().sort()[Math.floor(0.98 * (n - 1))];
  most_now += (Math.max(4, most) - most_now) * (still.matches ? 1 : 0.1);
  const paths = Array.from({ length: CLASSES }, () => new Path2D());
  for (let i = 0; i < n; i++) {
    const x = q[5 * i], y = q[5 * i + 1], r = Math.max(q[5 * i + 2] - 0.4 * px, 0.5 * q[5 * i + 2]), path = paths[lines ? 0 : Math.max(0, Math.min(CLASSES - 1, Math.floor(CLASSES * loads[i] / most_now))) || 0];
    path.moveTo(x + r, y); path.arc(x, y, r, 0, 7);
  }
  paths.forEach((path, k) => { pen.fillStyle = colours[k]; pen.fill(path); });
  if (was.rotation && map.k * f.n.d > 2.4) { /* spokes show the rotation */
    pen.beginPath();
    for (let i = 0; i < n; i++) { const x = q[5 * i], y = q[5 * i + 1], r = 0.85 * q[5 * i + 2], a = q[5 * i + 4]; pen.moveTo(x, y); pen.lineTo(x + r * Math.cos(a), y + r * Math.sin(a)); }
    pen.lineWidth = 1.1 * px; pen.strokeStyle = css('--field'); pen.stroke();
  }
  if (lines) {
    const widths = Array.from({ length: 8 }, () => new Path2D());
    for (let k = links; k < walls; k += 5) {
      const w = Math.min(7, Math.floor(8 * Math.sqrt(q[k + 4] / most_now)));
      if (q[k + 4] > 0) { widths[w].moveTo(q[k], q[k + 1]); widths[w].lineTo(q[k + 2], q[k + 3]); }
    }
    pen.strokeStyle = css('--ink'); pen.lineCap = 'round';
    widths.forEach((path, k) => { pen.lineWidth = 0.06 * f.n.d * (k + 0.35); pen.stroke(path); });
  }
  pen.beginPath();
  for (let k = walls; k < walls + 6 * f.n.walls; k += 6) {
    const [x, y, nx, ny] = q.subarray(k), a = Math.max(q[k + 4], -1e4), b = Math.min(q[k + 5], 1e4);
    if (a < b) { pen.moveTo(x + a * ny, y - a * nx); pen.lineTo(x + b * ny, y - b * nx); }
  }
  pen.lineWidth = 2.5 * px; pen.strokeStyle = css('--wall'); pen.lineCap = 'butt'; pen.stroke();
  const outline = surface_of(q, n, x0, x1);
  pen.rotate(-map.box);
  if ($('slopes').checked) draw_slopes(f, q, n, px, outline);
  if ($('rays').checked) draw_rays(px, outline);
}
/* Highest places over columns one diameter wide, in the box's frame, as all lines here. */
function surface_of(q, n, x0, x1) {
  const columns = new Float64Array(Math.max(1, Math.ceil((x1 - x0) / D)));
  for (let i = 0; i < n; i++) {
    const x = map.cb * q[5 * i] - map.sb * q[5 * i + 1], y = map.sb * q[5 * i] + map.cb * q[5 * i + 1], k = Math.floor((x - x0) / D);
    if (k in columns) columns[k] = Math.max(columns[k], y + q[5 * i + 2]);
  }
  return { columns, x0, at: (x) => columns[Math.floor((x - x0) / D)] || 0 };
}
const dashes = [[1, 4], [8, 5], []];
function draw_slopes(f, q, n, px, outline) {
  const [type, from, to] = kinds[kind].surface(was);
  pen.strokeStyle = css('--line');
  const line = (m, x, y, slope, half) => { pen.beginPath(); pen.moveTo(x - half, y + slope * half); pen.lineTo(x + half, y - slope * half); pen.setLineDash(dashes[m].map((v) => v * px)); pen.lineWidth = (m === 2 ? 3 : 2.2) * px; pen.stroke(); };
  if (type === 1 && f.columns > 2 && begun()) {
    const h = q.subarray(q.length - f.columns), mean = h.reduce((a, b) => a + b, 0) / h.length, half = (to - from) / 2;
    for (let m = 0; m < 3; m++) { const slope = Math.tan(f.theta[m] * Math.PI / 180); line(m, from + half, (m ? mean : h[0] - slope * (half - D / 2)) + D / 2, slope, half); }
  }
  if (type === 2) {
    const { columns, x0 } = outline, high = Math.max(...columns), apex = columns.indexOf(high);
    for (const [k, flank] of f.flanks.entries()) for (let m = 0; m < 3; m++) {
      if (isNaN(flank[m])) continue;
      const way = flank[m] > 0 ? 1 : -1, of = [];
      for (let i = apex; i >= 0 && i < columns.length; i += way) if (columns[i] > 0.1 * high && columns[i] < 0.9 * high) of.push([x0 + (i + 0.5) * D, columns[i]]);
      if (of.length < 2 || k > 1) continue;
      const x = of.reduce((a, v) => a + v[0], 0) / of.length, y = of.reduce((a, v) => a + v[1], 0) / of.length;
      line(m, x, y, Math.tan(flank[m] * Math.PI / 180), of.length * D / 2 + 0.3);
    }
  }
  if (kind === 'drum' && n) { const [x, y] = f.centre; pen.save(), pen.rotate(f.n.tilt * Math.PI / 180), line(2, 0.45 * x, 0.45 * y, x / y, 0.75 * outline.columns.length * D / 2), pen.restore(); }
  pen.setLineDash([]);
}
function draw_rays(px, { columns, x0, at }) {
  const high = Math.max(...columns), sum = columns.reduce((a, h) => a + h, 0), base = columns.reduce((a, h, k) => a + h * (x0 + (k + 0.5) * D), 0) / sum;
  if (!kinds[kind].surface(was)[0] || !high) return;
  pen.strokeStyle = pen.fillStyle = css('--theory'); pen.lineWidth = 2 * px;
  for (const way of [-1, 1]) { /* fixed to gravity, as the slope of eq. (3) is */
    const dx = way * 0.5 * map.ct - 0.866 * map.st, dy = way * 0.5 * map.st + 0.866 * map.ct;
    let s = 0;
    while (s < 3 * high && s * dy < at(base + s * dx)) s += 0.02;
    pen.beginPath(); pen.moveTo(base, 0); pen.lineTo(base + s * dx, s * dy); pen.stroke();
  }
  pen.beginPath(); pen.arc(base, 0, 4 * px, 0, 7); pen.fill();
  const rise = 3 * was.mu, foot = kind === 'box' ? kinds.box.surface(was)[2] : x0 + D * (columns.length - [...columns].reverse().findIndex((h) => h > 1.5 * D));
  const back = Math.min(foot - x0, (top_now || high) / Math.max(rise, 1e-6));
  pen.setLineDash([10 * px, 4 * px, 2 * px, 4 * px]), pen.beginPath(); pen.moveTo(foot, 0); pen.lineTo(foot - back * (map.ct + rise * map.st), back * (rise * map.ct - map.st)); pen.stroke();
  pen.setLineDash([]);
}
/* Is the wall open, the cylinder lifted, the drum turned? */
const begun = () => passed().some((b) => /open = |velocity = |omega = /.test(b));
/* ---- words and numbers ---- */
const power = (v) => Number.isFinite(v) ? v ? v.toExponential(1).replace(/e\+?(.*)/, ' · 10<sup>$1</sup>').replace('-', '−') : '0' : '–';
const number = (v, digits = 1, unit = '') => Number.isFinite(v) ? v.toFixed(digits) + unit : '–';
function show() {
  if (!frame) return;
  const f = frame, heavy = f.n.gx || f.n.gy, type = kinds[kind].surface(was)[0], key = (m) => `<svg aria-hidden="true"><path d="M0 5h26" stroke="var(--line)" stroke-width="${m === 2 ? 3 : 2.2}" stroke-dasharray="${dashes[m]}"/></svg>`, rows = [];
  const row = (name, value, unit = '', rule) => rows.push(`<tr${rule ? ' class="rule"' : ''}><td>${name}</td><td>${value}</td><td>${unit}</td></tr>`);
  const angle = (m) => !Number.isFinite(f.theta[m]) || !begun() ? ['–', begun() ? 'none' : ''] : [number(f.theta[m], 1, '°'), Number.isFinite(f.error[m]) ? `± ${number(f.error[m])}°` : ''], theta = '<i class="v">θ</i>';
  if (type) ['first to last', 'straight line', 'parabola'].forEach((name, m) => row(`${key(m)}${theta}<sub>R</sub>, ${name}`, ...angle(m)));
  if (kind === 'drum') row(`${key(2)}slope, by the centre of mass`, number(Math.atan(-f.centre[0] / f.centre[1]) * 180 / Math.PI, 1, '°'));
  if (kind === 'hopper') row('outflow, over 0.5&nbsp;s', number(gone.length && f.n.t - gone[0].t > 0.1 ? (gone[0].grains - f.n.grains) / (f.n.t - gone[0].t) : NaN, 0), 'grains/s');
  row(`tilt`, number(heavy ? f.n.tilt + 0 : NaN, 1, '°'), '', true);
  if (type || theta_t > 0) row(`${theta}<sub>T</sub>, the pile moves`, number(theta_t, 1, '°'));
  if (type) row(`${theta}<sub>MS</sub> by eq. (3)`, number(Math.atan(3 * was.mu) * 180 / Math.PI, 1, '°'));
  row('grains', f.n.grains, '', true);
  row('contacts a grain', number(f.n.grains ? 2 * f.n.links / f.n.grains : NaN, 2));
  row('kinetic energy', power(f.n.energy), `<i class="v">${heavy ? 'm g d' : 'F d'}</i>`);
  row('state', f.n.rest ? 'at rest' : 'moves', '');
  $('table').innerHTML = rows.join('');
  $('time').textContent = f.n.t.toFixed(2), $('rate').textContent = running ? `${seen.rate.toFixed(seen.rate < 0.095 ? 2 : 1)} × real time` : fault ? 'stopped' : 'paused';
  $('most').textContent = most_now.toFixed(0), $('what').textContent = `${$('show').value === 'lines' ? 'contact force' : 'load'}, in mean ${heavy ? 'weights' : 'forces'}`;
  $('legend').classList.toggle('lines', $('show').value === 'lines');
  $('act').disabled = fault || begun(), $('stop').disabled = !record.live.some((b) => /turn_deg_per_step = -?0\.0*[1-9]/.test(b));
}
const waiting = { fill: 'Grains fall in; at rest the experiment goes on by itself.', lift: 'The cylinder is lifted.', settle: 'The heap comes to rest.', flow: 'The hopper empties until 300 grains are left.', start: 'The drum begins to turn.', turn: 'The drum turns once.' };
function tell(keep) { /* what there is to do; keep: not what is said */
  const k = kinds[kind], { done, rest } = frame?.n || {};
  $('act').innerHTML = `${k.act}<kbd aria-hidden="true">O</kbd>`, $('act').hidden = !k.act, $('anew').hidden = kind === 'other';
  $('play').innerHTML = `${running ? 'Pause' : 'Run'}<kbd aria-hidden="true">space</kbd>`;
  $('pour').disabled = !k.pour, $('rays').disabled = !k.surface(was)[0];
  if (keep || fault || !frame) return;
  if (done && !running) say(k.hint && !hand && !begun() && rest ? k.hint : `The experiment has ended${rest ? ', at rest' : ''}. “Run” goes on.`);
  else if (hand) say(tilting ? 'Tilted by 5° a second, until 5 % of the grains have moved by d/10.' : outcome || 'The run goes on until it is paused.');
  else if (!running) say('Paused.');
  else if (own !== undefined) say(`Phase “${frame.where}” of the text.`);
  else say(kind === 'box' ? 'Grains fall in. Open the wall now, or when they are at rest.' : waiting[frame.where] || '');
  $('play').className = $('act').disabled || !k.act ? 'main' : '';
  if (!running) show();
}
async function show_record() {
  if (!$('record').open || !frame) return;
  running = false;
  const state = await ask('state'), text = record_text(state);
  $('text').value = text; $('digest').textContent = state.digest; $('text').scrollTop = 1e6;
  $('until').textContent = `What was done up to step ${state.step}, where the run is paused. A change here and “Run this text” begin anew.`;
  tell();
}
/* ---- controls ---- */
function make_sliders() {
  for (const [place, live] of [['live', true], ['starts', false]]) {
    $(place).innerHTML = Object.entries(sliders).filter(([key, s]) => key in p && !!s.law === live).map(([key, s]) => {
      const [a, b, step] = kinds[kind].range?.[key] || s.range;
      return `<label class="slider" for="in-${key}"><span>${s.name}</span><output id="of-${key}"></output><input type="range" id="in-${key}" min="${a}" max="${b}" step="${step}"></label>`;
    }).join('');
  }
  for (const key of Object.keys(sliders)) {
    const input = $(`in-${key}`), s = sliders[key]; if (!input) continue;
    input.oninput = () => { p[key] = s.scale ? s.scale.from(+input.value) : +input.value; label(key); };
    input.onchange = () => change(key, s.law ? s.law(p[key], p) : '');
  }
  sync();
}
function sync() { /* the sliders, from the values */
  for (const [key, s] of Object.entries(sliders)) if ($(`in-${key}`)) $(`in-${key}`).value = s.scale ? s.scale.to(p[key]) : p[key], label(key);
  $('rotation').checked = p.rotation;
}
function change(key, body) { /* of the run, or with a new start */
  const set = { [key]: p[key] };
  if (key === 'v' && !body && hand) Object.assign(was, set);
  else return body ? act(body, set) : start(undefined, set);
}
function label(key) {
  const s = sliders[key], v = p[key];
  $(`of-${key}`).innerHTML = Number.isFinite(v) ? `${v >= 1e4 ? power(v) : s.range[2] >= 1 ? v : v.toFixed(s.range[2] < 0.1 ? 2 : 1)} <small>${s.unit || ''}</small>` : '–';
  $(`in-${key}`).disabled = !!(s.off && s.off(p));
}
function view(next) {
  kind = next, p = { ...kinds[kind].start }, was = { ...p };
  document.querySelector(`#tabs input[value=${kind}]`).checked = true;
  make_sliders();
}
function choose(next) { view(chosen = next); return start(undefined, { ...p }, next); }
$('tabs').innerHTML = Object.entries(kinds).filter(([, k]) => k.act).map(([key, k]) => `<label><input type="radio" name="kind" value="${key}">${k.name}</label>`).join('');
$('tabs').onchange = (e) => choose(e.target.value);
const jobs = { act: do_act, play: () => play(!running), again: () => start(own), pour, left: () => tilt(-1), right: () => tilt(1), stop: () => tilt(0), read: () => start($('text').value) };
for (const [id, job] of Object.entries(jobs)) $(id).onclick = job;
$('rotation').onchange = () => { p.rotation = $('rotation').checked; change('rotation'), sync(); };
for (const id of ['show', 'slopes', 'rays']) $(id).onchange = () => { draw(); show(); };
$('record').ontoggle = show_record;
$('copy').onclick = async () => { try { await navigator.clipboard.writeText($('text').value); } catch { $('text').select(); document.execCommand('copy'); } say('The text is copied.'); };
$('save').onclick = () => { const a = document.createElement('a'); a.href = URL.createObjectURL(new Blob([$('text').value])); a.download = 'scene.cfg'; a.click(); };
canvas.onclick = (e) => {
  if (!map) return; const u = (e.offsetX - map.ox) / map.k, v = (map.oy - e.offsetY) / map.k, x = map.c * u - map.s * v, y = map.s * u + map.c * v;
  act(`add = { r = ${+(frame.n.d / 2).toPrecision(4)}; x = ${x.toPrecision(6)}; y = ${y.toPrecision(6)}; };`).then((good) => good && play(true));
};
addEventListener('keydown', (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || /TEXTAREA|SELECT/.test(e.target.tagName) || (/range|radio/.test(e.target.type) && e.key.startsWith('Arrow'))) return;
  const id = { ' ': 'play', o: 'act', r: 'again', g: 'pour', ArrowLeft: 'left', ArrowRight: 'right', ArrowDown: 'stop' }[e.key.length === 1 ? e.key.toLowerCase() : e.key];
  if (!id || (id !== 'pour' && $(id).disabled) || $(id).hidden || (e.key === ' ' && /BUTTON|SUMMARY|INPUT/.test(e.target.tagName))) return;
  e.preventDefault();
  jobs[id]();
});
addEventListener('resize', draw); dark.onchange = () => { read_colours(); draw(); }; read_colours();
choose('box').then(() => requestAnimationFrame(turn));
