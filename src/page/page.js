/* ---- the engine, in a thread of its own ---- */
const $ = (id) => document.getElementById(id), source = (id) => $(id).textContent;
const worker = new Worker(URL.createObjectURL(new Blob([source('worker')])));
const waits = new Map();
let calls = 0;
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
const turned = (p) => `rotation=${p.rotation}\nrolling.mu=${p.rotation ? p.mu_roll : 0}\nnormal.k_n=${p.k_n}\nfill.radius_width=${0.1 * p.scatter}`;
const kinds = {
  box: { name: 'Box', act: 'Open the wall', body: () => 'open = "right";', surface: (p) => [1, 0, p.W], x: (p) => [0, 2 * p.W], pour: (p) => [D, p.W - D],
    start: { mu: 0.5, mu_roll: 0.1, k_n: 1e6, N: 600, W: 5, scatter: 0.2, rotation: false }, moved: 'pile.moved(0.1*d) >= 0.05*pile.marked',
    hint: 'The box is full and at rest. Open the wall.', region: 'pile',
    changes: (p) => `N=${p.N}\nW=${p.W}\nmu=${p.mu}\nmu_roll=${p.rotation ? p.mu_roll : 0}\nrotation=${p.rotation}\nk_n=${p.k_n}\nscatter=${p.scatter}\nopens=false` },
  cylinder: { name: 'Lifted cylinder', act: 'Lift the cylinder', body: (p) => `walls = { cylinder = { velocity = (0.0, ${p.v.toFixed(2)}); }; };`, surface: () => [2, -1e3, 1e3],
    x: (p) => [-1.8 * p.W, 1.8 * p.W], pour: (p) => [-0.3 * p.W, 0.3 * p.W], start: { mu: 0.5, mu_roll: 0.1, k_n: 1e6, N: 600, W: 4, scatter: 0.2, v: 2, rotation: true },
    changes: (p) => `D=${p.W}\nv=${p.v}\nmu=${p.mu}\nmu_roll=${p.rotation ? p.mu_roll : 0}\naspect=${p.N * D * D / (p.W * p.W)}\n${turned(p)}` },
  hopper: { name: 'Hopper', act: 'Open the gate', body: () => 'open = "gate";', surface: () => [0, 0, 1], x: () => [0, 6], pour: () => [D, 6 - D],
    start: { mu: 0.2, mu_roll: 0.1, k_n: 1e6, N: 1200, D: 1.6, scatter: 0.2, rotation: false },
    changes: (p) => `D=${p.D}\nmu=${p.mu}\nfill.N=${p.N}\nfill.H=${p.N / 75}\n${turned(p)}` },
  drum: { name: 'Drum', act: 'Turn the drum', body: (p) => `walls = { drum = { omega = ${p.omega.toFixed(2)}; }; };`, surface: () => [0, 0, 1], x: (p) => { const R = Math.sqrt(p.N / 27.5); return [-R, R]; },
    pour: null, start: { mu: 0.2, mu_roll: 0.1, k_n: 1e6, N: 440, omega: 0.5, scatter: 0.2, rotation: false },
    changes: (p) => `R=${Math.sqrt(p.N / 27.5)}\nomega=${p.omega}\nmu=${p.mu}\nfill.N=${p.N}\n${turned(p)}` },
};
/* Sliders: what is shown, range, unit; `law` is what a new phase says, without it the value waits for a start. */
const log = { to: Math.log10, from: (v) => +(10 ** v).toPrecision(2) };
const sliders = {
  mu: { name: 'friction <i class="v">μ</i>', range: [0, 1.5, 0.01], law: (v) => `tangential = { mu = ${v.toFixed(4)}; };` },
  mu_roll: { name: 'rolling resistance', range: [0, 0.5, 0.01], law: (v) => `rolling = { mu = ${v.toFixed(4)}; };`, off: (p) => !p.rotation },
  k_n: { name: 'stiffness <i class="v">k</i><sub>n</sub>', unit: 'dyn/cm<sup>3/2</sup>', range: [5, 6.3, 0.02], scale: log, law: (v) => `normal = { k_n = ${v.toExponential(3)}; };` },
  v: { name: 'speed of the lift', unit: 'cm/s', range: [0.5, 10, 0.1], law: (v, p) => p.lifts ? kinds.cylinder.body(p) : '' },
  omega: { name: 'rate of the drum', unit: 'rad/s', range: [0, 2, 0.05], law: (v, p) => kinds.drum.body(p) },
  N: { name: 'number of grains', range: [50, 3000, 10] },
  W: { name: 'width', unit: 'cm', range: [2, 12, 0.5] },
  D: { name: 'width of the outlet', unit: 'cm', range: [0.6, 4, 0.1] },
  scatter: { name: 'scatter of the radii', unit: 'of the mean', range: [0, 0.3, 0.01] },
};
let kind = 'box', p = { ...kinds.box.start }, running = false, frame = null, busy = false, held = 0, queue = Promise.resolve(), version = 0;
let theta_t = NaN, rested = true, tilting = '', hand = false, seen = { rate: 1, at: 0, steps: 0, fps: 60 }, fault = false;

/* ---- the text of what is done: phases, each with its steps ---- */
let record = { source: '', head: '', closed: [], live: [], begun: 0 };
function parts(list, at) { /* pieces of a text between separators that are in no bracket or quote */
  const found = [];
  let depth = 0, quote = false, from = 0;
  for (let i = 0; i < list.length; i++) {
    const c = list[i];
    if (c === '"' && list[i - 1] !== '\\') quote = !quote;
    if (quote) continue;
    depth += '({['.includes(c) - ')}]'.includes(c);
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
    closed.push(`{ ${body} steps = ${to - from}; }`);
    from = to;
  });
  return closed;
}
const text_of = (head, phases) => `${head}phases = (\n  ${phases.join(',\n  ')} );\n`;
const record_text = (state) => state.phases.some((q) => q.inner) || (!hand && !state.phases.some((q) => q.name === state.where)) ? record.source : text_of(record.head, close_phases(state));
/* End the phase, begin others. A text without an end of its own ends at once, the last one never. */
function act(...bodies) {
  return one_by_one(async () => {
    const state = await ask('state');
    if (state.phases.some((q) => q.inner)) throw Error('a text with phases within phases can only be watched; start one of the experiments');
    const closed = close_phases(state), live = bodies.map((b, k) => ({ name: `act${closed.length + 1 + k}`, ...(b.body === undefined ? { body: b } : b) }));
    const phases = live.map((b, k) => `{ name = "${b.name}"; ${b.body} ${b.end || `steps = ${k < live.length - 1 ? 0 : 1000000000};`} }`);
    await ask('go_on', text_of(record.head, [...closed, ...phases]), live.length);
    record = { ...record, closed, live: live.map((b) => `name = "${b.name}"; ${b.body}`), begun: state.step };
    hand = true, fault = false;
    tell();
  });
}
function one_by_one(job) { /* true if it went well */
  held++;
  return queue = queue.then(job).then(() => true, (e) => { say(advice(e.message), true); return false; }).then(async (good) => { held--; if (running) show(); else await once(); return good; });
}
function advice(message) {
  const what = /that turns/.test(message) ? 'Start again, and tilt gravity instead.' : /touch|no place|overlap/.test(message) ? 'Choose a free place.'
    : /dt = /.test(message) ? 'Choose a smaller stiffness or speed.' : /room/.test(message) ? 'Choose fewer grains or a wider box.' : 'Change it, or start again.';
  return `${message[0].toUpperCase()}${message.slice(1)}. ${what}`;
}
function say(text, bad) { $('say').textContent = text; $('say').className = bad ? 'bad' : ''; }

/* ---- start, run, read ---- */
async function start(text, changes) {
  version++, running = false;
  return one_by_one(async () => {
    await engine;
    open_record(await ask('start', text ?? source(`${kind}.cfg`), changes ?? kinds[kind].changes(p)));
    for (const line of ['head', 'source']) record[line] = short(record[line]);
    theta_t = NaN, tilting = '', hand = false, fault = false, frame = null, p.lifts = false, top_now = 0;
    $('record').open = false;
    await once();
    if (text) p.mu = frame.n.mu;
    running = !still.matches;
    tell();
  });
}
async function read(seconds, most) {
  const mine = version, f = await ask('frame', seconds, DT, most, kinds[kind].surface(p));
  if (mine !== version) return;
  frame = f;
  frame.n = Object.fromEntries('step t grains links walls done energy rest tilt gx gy mu weight'.split(' ').map((k, i) => [k, f.number[i]]));
  frame.theta = f.number.slice(13, 16), frame.error = f.number.slice(16, 19), frame.flanks = [f.number.slice(19, 22), f.number.slice(22, 25)], frame.columns = f.number[25] || 0;
  if (tilting && f.where !== tilting && f.where.startsWith('act')) { theta_t = Math.abs(frame.n.tilt); tilting = ''; }
  if (f.fault) { fault = true; running = false; say(advice(f.fault), true); }
  const news = running && (frame.where !== told || frame.n.done);
  told = frame.where;
  if (frame.n.done) running = false;
  if (news) tell();
  return f;
}
async function once() { await read(0, 0).catch(() => 0); draw(); show(); }
/* The engine works all the time where it is slower than wanted; the picture follows the screen. */
let last = 0, drawn = 0, fresh = false, told = '';
function turn(now) {
  requestAnimationFrame(turn);
  if (!busy) pump();
  if (!fresh || (still.matches && now - drawn < 250)) return;
  fresh = false;
  draw();
  seen.fps = 0.95 * seen.fps + 0.05 * 1000 / (now - drawn);
  drawn = now;
  if (now - seen.at > 120) { seen.at = now; show(); }
}
async function pump() {
  const now = performance.now(), elapsed = (now - last) / 1000, wanted = Math.min(0.05, elapsed) * $('speed').value;
  last = now;
  if (!running || held || !frame || wanted < DT) return;
  busy = true;
  const before = frame.n.t;
  const f = await read(wanted, 13).catch((e) => say(advice(e.message), true));
  busy = false;
  if (!f) return;
  fresh = true;
  seen.steps += 0.05 * (f.done * f.n.grains / (performance.now() - now) * 1000 - seen.steps);
  seen.rate += 0.05 * (Math.max(0, f.n.t - before) / elapsed - seen.rate);
  if (f.done * DT < 0.9 * wanted) pump();
}
function play(on) {
  if (on && frame && frame.n.done) { act('').then((good) => good && play(true)); return; }
  running = on && !fault;
  tell();
}
function do_act() { if (kind === 'cylinder') p.lifts = true; act(kinds[kind].body(p)).then((good) => good && play(true)); }
function tilt(sign) {
  const box = $('turns').value === 'box', key = box ? 'box_turn_deg_per_step' : 'gravity_turn_deg_per_step', rate = sign * (5 * DT);
  rested = !!frame.n.rest;
  if (!sign) { tilting = ''; return act('gravity_turn_deg_per_step = 0.0; box_turn_deg_per_step = 0.0;'); }
  return act({ body: `${key} = ${rate.toFixed(7)};`, end: `every = 50; most = 2000000; until = "${kinds[kind].moved || 'moved(0.1*d) >= 0.05*marked'}";`, name: `tilt${record.closed.length}` },
    `${key} = 0.0;`).then((good) => { if (!good) return; tilting = (record.live[0].match(/name = "(\w+)"/) || [])[1] || ''; theta_t = NaN; play(true); });
}
function pour() {
  if (!kinds[kind].pour) return say('The drum is closed: click into it to put in a grain.', true);
  const [a, b] = kinds[kind].pour(p), bodies = [];
  for (let k = 0; k < 10; k++) {
    const r = 0.1 * (1 + p.scatter * (Math.random() + Math.random() - 1)), x = a + (b - a) * (k + 0.2 + 0.6 * Math.random()) / 10;
    bodies.push(`add = { r = ${r.toFixed(4)}; x = ${x.toFixed(4)}; y = "max(touch, 0) + 2*d"; };`);
  }
  return act(...bodies).then((good) => good && play(true));
}

/* ---- the picture ---- */
const canvas = $('view'), pen = canvas.getContext('2d'), still = matchMedia('(prefers-reduced-motion: reduce)'), dark = matchMedia('(prefers-color-scheme: dark)');
const CLASSES = 10;
let colours = [], top_now = 0, most_now = 10, map = null;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
function read_colours() {
  const stops = [0, 1, 2, 3].map((k) => css(`--load-${k}`).match(/\w\w/g).map((h) => parseInt(h, 16)));
  colours = Array.from({ length: CLASSES }, (_, k) => { const t = 3 * k / (CLASSES - 1), i = Math.min(2, Math.floor(t)), f = t - i;
    return `rgb(${stops[i].map((c, j) => Math.round(c + f * (stops[i + 1][j] - c))).join(' ')})`; });
}
function fit(f) { /* lab to screen: gravity points down; the width of the experiment and the highest grain are in view */
  const ratio = Math.min(2, devicePixelRatio || 1), w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
  const [x0, x1] = kinds[kind].x(p), g = Math.atan2(f.n.gx, -f.n.gy), c = Math.cos(g), s = Math.sin(g), q = f.picture;
  let high = kind === 'drum' ? x1 : 2, low = kind === 'drum' ? x0 : kind === 'hopper' ? -0.8 : 0;
  for (let i = 0; i < f.n.grains; i++) if (q[5 * i] > x0 - 1 && q[5 * i] < x1 + 1) high = Math.max(high, q[5 * i + 1] + q[5 * i + 2]);
  top_now = !top_now || still.matches || high > top_now ? Math.max(high, top_now && !still.matches ? top_now : 0) : top_now + 0.03 * (high - top_now);
  const corners = [[x0, low], [x1, low], [x0, top_now], [x1, top_now]].map(([x, y]) => [c * x + s * y, -s * x + c * y]);
  const xs = corners.map((v) => v[0]), ys = corners.map((v) => v[1]), left = Math.min(...xs), right = Math.max(...xs), bottom = Math.min(...ys), upper = Math.max(...ys);
  const margin = 26, k = Math.min((w - 2 * margin) / (right - left), (h - 2 * margin - 30) / (upper - bottom));
  const ox = w / 2 - k * (left + right) / 2, oy = h - margin + k * bottom;
  map = { k, c, s, ox, oy, ratio };
  pen.resetTransform();
  pen.clearRect(0, 0, canvas.width, canvas.height);
  pen.setTransform(ratio * k * c, ratio * k * s, ratio * k * s, -ratio * k * c, ratio * ox, ratio * oy);
  return { x0, x1 };
}
function draw() {
  if (!frame) return;
  const f = frame, q = f.picture, n = f.n.grains, { x0, x1 } = fit(f), px = 1 / map.k, lines = $('show').value === 'lines', links = 5 * n, walls = links + 5 * f.n.links;
  let most = 0;
  const loads = new Float32Array(n);
  for (let i = 0; i < n; i++) loads[i] = q[5 * i + 3];
  if (n) most = loads.slice().sort()[Math.floor(0.98 * (n - 1))];
  most_now += (Math.max(4, most) - most_now) * (still.matches ? 1 : 0.1);
  const paths = Array.from({ length: CLASSES }, () => new Path2D());
  for (let i = 0; i < n; i++) {
    const x = q[5 * i], y = q[5 * i + 1], r = q[5 * i + 2] - 0.4 * px, path = paths[lines ? 0 : Math.max(0, Math.min(CLASSES - 1, Math.floor(CLASSES * loads[i] / most_now)))];
    path.moveTo(x + r, y);
    path.arc(x, y, r, 0, 7);
  }
  paths.forEach((path, k) => { pen.fillStyle = colours[k]; pen.fill(path); });
  if (p.rotation && map.k > 12) { /* spokes show the rotation */
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
    widths.forEach((path, k) => { pen.lineWidth = 0.012 * (k + 0.35); pen.stroke(path); });
  }
  pen.beginPath();
  for (let k = walls; k < walls + 6 * f.n.walls; k += 6) {
    const [x, y, nx, ny] = q.subarray(k), a = Math.max(q[k + 4], -1e4), b = Math.min(q[k + 5], 1e4);
    if (a < b) { pen.moveTo(x + a * ny, y - a * nx); pen.lineTo(x + b * ny, y - b * nx); }
  }
  pen.lineWidth = 2.5 * px; pen.strokeStyle = css('--wall'); pen.lineCap = 'butt'; pen.stroke();
  const outline = surface_of(q, n, x0, x1);
  if ($('slopes').checked) draw_slopes(f, q, n, px, outline);
  if ($('rays').checked) draw_rays(f, q, n, px, outline);
}
/* Highest places over columns one diameter wide, in the box's frame as long as that does not turn. */
function surface_of(q, n, x0, x1) {
  const columns = new Float64Array(Math.max(1, Math.ceil((x1 - x0) / D)));
  for (let i = 0; i < n; i++) { const k = Math.floor((q[5 * i] - x0) / D); if (k in columns) columns[k] = Math.max(columns[k], q[5 * i + 1] + q[5 * i + 2]); }
  return { columns, x0, at: (x) => columns[Math.floor((x - x0) / D)] || 0 };
}
const dashes = [[1, 4], [8, 5], []];
function draw_slopes(f, q, n, px, outline) {
  const [type, from, to] = kinds[kind].surface(p), boxed = f.n.tilt - Math.atan2(f.n.gx, -f.n.gy) * 180 / Math.PI;
  pen.save();
  pen.rotate(-boxed * Math.PI / 180);
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
  if (kind === 'drum' && n) {
    let x = 0, y = 0;
    for (let i = 0; i < n; i++) x += q[5 * i] / n, y += q[5 * i + 1] / n;
    f.drum = Math.atan(-x / y) * 180 / Math.PI;
    line(2, 0.45 * x, 0.45 * y, x / y, 0.75 * outline.columns.length * D / 2);
  }
  pen.restore();
  pen.setLineDash([]);
}
function draw_rays(f, q, n, px, { columns, x0, at }) {
  const high = Math.max(...columns), sum = columns.reduce((a, h) => a + h, 0), base = columns.reduce((a, h, k) => a + h * (x0 + (k + 0.5) * D), 0) / sum;
  if (kind === 'drum' || kind === 'hopper' || !high) return;
  pen.strokeStyle = pen.fillStyle = css('--theory'); pen.lineWidth = 2 * px;
  for (const way of [-1, 1]) { /* fixed to gravity */
    const dx = way * 0.5 * map.c - 0.866 * map.s, dy = way * 0.5 * map.s + 0.866 * map.c;
    let s = 0;
    while (s < 3 * high && s * dy < at(base + s * dx)) s += 0.02;
    pen.beginPath(); pen.moveTo(base, 0); pen.lineTo(base + s * dx, s * dy); pen.stroke();
  }
  pen.beginPath(); pen.arc(base, 0, 4 * px, 0, 7); pen.fill();
  const rise = 3 * p.mu, foot = kind === 'box' ? kinds.box.surface(p)[2] : x0 + D * (columns.length - [...columns].reverse().findIndex((h) => h > D));
  const back = Math.min(foot - x0, (top_now || high) / Math.max(rise, 1e-6));
  pen.setLineDash([10 * px, 4 * px, 2 * px, 4 * px]);
  pen.beginPath(); pen.moveTo(foot, 0); pen.lineTo(foot - back, back * rise); pen.stroke();
  pen.setLineDash([]);
}

/* Is the wall open, the cylinder lifted, the drum turned? */
const begun = () => hand ? [...record.closed, ...record.live].some((b) => /open = |velocity = |omega = /.test(b)) : kind !== 'box' && frame.where !== 'fill';

/* ---- words and numbers ---- */
const number = (v, digits = 1, unit = '') => Number.isFinite(v) ? v.toFixed(digits) + unit : '–';
function show() {
  if (!frame) return;
  const f = frame, type = kinds[kind].surface(p)[0], key = (m) => `<svg aria-hidden="true"><path d="M0 5h26" stroke="var(--line)" stroke-width="${m === 2 ? 3 : 2.2}" stroke-dasharray="${dashes[m]}"/></svg>`, rows = [];
  const row = (name, value, unit = '', rule) => rows.push(`<tr${rule ? ' class="rule"' : ''}><td>${name}</td><td>${value}</td><td>${unit}</td></tr>`);
  const angle = (m) => !begun() ? ['–', ''] : [number(f.theta[m], 1, '°'), Number.isFinite(f.error[m]) ? `± ${number(f.error[m])}°` : ''], theta = '<i class="v">θ</i>';
  if (type) ['first to last', 'straight line', 'parabola'].forEach((name, m) => row(`${key(m)}${theta}<sub>R</sub>, ${name}`, ...angle(m)));
  if (kind === 'drum') row(`${key(2)}slope, by the centre of mass`, number(f.drum, 1, '°'));
  if (kind === 'hopper') row('outflow', flow(f.n), 'grains/s');
  row(`tilt`, number(f.n.tilt + 0, 1, '°'), '', true);
  row(`${theta}<sub>T</sub>, the pile moves`, number(theta_t, 1, '°'));
  row(`${theta}<sub>MS</sub> by eq. (3)`, number(Math.atan(3 * p.mu) * 180 / Math.PI, 1, '°'));
  row('grains', f.n.grains, '', true);
  row('contacts a grain', number(f.n.grains ? 2 * f.n.links / f.n.grains : NaN, 2));
  row('kinetic energy', f.n.energy ? f.n.energy.toExponential(1) : '0', '<i class="v">m g d</i>');
  row('state', f.n.rest ? 'at rest' : 'moves', '');
  $('table').innerHTML = rows.join('');
  $('time').textContent = f.n.t.toFixed(2), $('rate').textContent = running ? `${seen.rate.toFixed(seen.rate < 0.095 ? 2 : 1)} × real time` : fault ? 'stopped' : 'paused';
  $('most').textContent = most_now.toFixed(0), $('what').textContent = $('show').value === 'lines' ? 'contact force, mean weights' : 'load, mean weights';
  $('legend').classList.toggle('lines', $('show').value === 'lines');
  $('act').disabled = fault || begun(), $('stop').disabled = !record.live.some((b) => /turn_deg_per_step = -?0\.0*[1-9]/.test(b));
}
let flow_from = null, flow_now = NaN;
function flow({ t, grains }) { /* over the last half second */
  if (!flow_from || t < flow_from.t || grains > flow_from.grains) flow_from = { t, grains }, flow_now = NaN;
  if (t - flow_from.t > 0.5) flow_now = (flow_from.grains - grains) / (t - flow_from.t), flow_from = { t, grains };
  return number(flow_now, 0);
}
const waiting = { fill: 'Grains fall in; at rest the experiment goes on by itself.', lift: 'The cylinder is lifted.', settle: 'The heap comes to rest.', flow: 'The hopper empties until 300 grains are left.', start: 'The drum begins to turn.', turn: 'The drum turns once.' };
function tell() {
  const k = kinds[kind];
  $('act').innerHTML = `${k.act}<kbd>O</kbd>`;
  $('play').innerHTML = `${running ? 'Pause' : 'Run'}<kbd>space</kbd>`;
  $('pour').disabled = !k.pour;
  if (fault || !frame) return;
  if (frame.n.done && !running) say(k.hint && !hand ? k.hint : `The experiment has ended${frame.n.rest ? ', at rest' : ''}. Run goes on.`);
  else if (hand) say(tilting ? 'Tilted by 5° a second, until 5 % of the grains have moved by d/10.' : theta_t > 0 ? `The pile moves at a tilt of ${theta_t.toFixed(1)}°${rested ? '' : ', but it was not at rest before'}. The same button tilts on.` : 'By hand now: the run goes on until it is paused.');
  else if (!running) say('Paused.');
  else say(kind === 'box' ? 'Grains fall in. Open the wall now, or when they are at rest.' : waiting[frame.where] || '');
  $('play').className = $('act').disabled ? 'main' : '';
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
      const [a, b, step] = s.range, v = s.scale ? s.scale.to(p[key]) : p[key];
      return `<label class="slider" for="in-${key}"><span>${s.name}</span><output id="of-${key}"></output><input type="range" id="in-${key}" min="${a}" max="${b}" step="${step}" value="${v}"></label>`;
    }).join('');
  }
  for (const key of Object.keys(sliders)) {
    const input = $(`in-${key}`), s = sliders[key];
    if (!input) continue;
    input.oninput = () => { p[key] = s.scale ? s.scale.from(+input.value) : +input.value; label(key); };
    input.onchange = () => { if (!s.law) return start(); const body = s.law(p[key], p); return body && act(body); };
    label(key);
  }
  $('rotation').checked = p.rotation;
}
function label(key) {
  const s = sliders[key], v = p[key];
  $(`of-${key}`).innerHTML = `${v >= 1e4 ? v.toExponential(1).replace('e+', ' · 10<sup>') + '</sup>' : s.range[2] >= 1 ? v : v.toFixed(s.range[2] < 0.1 ? 2 : 1)} <small>${s.unit || ''}</small>`;
  $(`in-${key}`).disabled = !!(s.off && s.off(p));
}
function choose(next) {
  kind = next, p = { ...kinds[kind].start };
  document.querySelector(`#tabs input[value=${kind}]`).checked = true;
  make_sliders();
  return start();
}
$('tabs').innerHTML = Object.entries(kinds).map(([key, k]) => `<label><input type="radio" name="kind" value="${key}">${k.name}</label>`).join('');
$('tabs').onchange = (e) => choose(e.target.value);
const jobs = { act: do_act, play: () => play(!running), again: () => start(), pour, left: () => tilt(-1), right: () => tilt(1), stop: () => tilt(0), read: () => start($('text').value, '') };
for (const [id, job] of Object.entries(jobs)) $(id).onclick = job;
$('rotation').onchange = () => { p.rotation = $('rotation').checked; make_sliders(); start(); };
for (const id of ['show', 'slopes', 'rays']) $(id).onchange = () => { draw(); show(); };
$('record').ontoggle = show_record;
$('copy').onclick = async () => { try { await navigator.clipboard.writeText($('text').value); } catch { $('text').select(); document.execCommand('copy'); } say('The text is copied.'); };
$('save').onclick = () => { const a = document.createElement('a'); a.href = URL.createObjectURL(new Blob([$('text').value])); a.download = 'scene.cfg'; a.click(); };
canvas.onclick = (e) => {
  if (!map) return;
  const u = (e.offsetX - map.ox) / map.k, v = (map.oy - e.offsetY) / map.k, x = map.c * u - map.s * v, y = map.s * u + map.c * v;
  act(`add = { r = 0.1; x = ${x.toFixed(4)}; y = ${y.toFixed(4)}; };`).then((good) => good && play(true));
};
addEventListener('keydown', (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || /TEXTAREA|SELECT/.test(e.target.tagName) || (e.target.type === 'range' && e.key.startsWith('Arrow'))) return;
  if (e.target.type === 'radio' && e.key.startsWith('Arrow')) return;
  const job = jobs[{ ' ': 'play', o: 'act', r: 'again', g: 'pour', ArrowLeft: 'left', ArrowRight: 'right', ArrowDown: 'stop' }[e.key.length === 1 ? e.key.toLowerCase() : e.key]];
  if (!job || (e.key === ' ' && /BUTTON|SUMMARY|INPUT/.test(e.target.tagName))) return;
  e.preventDefault();
  job();
});
addEventListener('resize', draw);
dark.onchange = () => { read_colours(); draw(); };
read_colours();
choose('box').then(() => requestAnimationFrame(turn));
