// A headless Chromium, driven over the pipe of its DevTools protocol: messages end with a zero byte.
'use strict';
const { spawn } = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');

const names = ['chromium-headless-shell', 'chromium', 'chromium-browser', 'google-chrome'];
const find = () => names.map((n) => process.env.PATH.split(':').map((d) => path.join(d, n)).find((f) => fs.existsSync(f))).find((f) => f);

module.exports = async function open(log) {
  const program = find();
  if (!program) throw Error('there is no Chromium: as root, run: apt-get install chromium-headless-shell');
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'page-'));
  const child = spawn(program, ['--headless', '--no-sandbox', '--disable-gpu', '--hide-scrollbars', '--remote-debugging-pipe', `--user-data-dir=${folder}`, 'about:blank'],
    { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const waits = new Map(), listeners = [];
  let id = 0, rest = '', session;
  child.stdio[4].on('data', (data) => {
    const parts = (rest + data).split('\0');
    rest = parts.pop();
    for (const m of parts.map((s) => JSON.parse(s))) {
      const wait = waits.get(m.id);
      waits.delete(m.id);
      if (wait) m.error ? wait[1](Error(`${wait[2]}: ${m.error.message}`)) : wait[0](m.result);
      else listeners.forEach((f) => f(m.method, m.params));
    }
  });
  const send = (method, params = {}, to = session) => new Promise((good, bad) => {
    waits.set(++id, [good, bad, method]);
    child.stdio[3].write(JSON.stringify({ id, method, params, sessionId: to }) + '\0');
  });
  const { targetInfos } = await send('Target.getTargets');
  session = (await send('Target.attachToTarget', { targetId: targetInfos.find((t) => t.type === 'page').targetId, flatten: true })).sessionId;
  listeners.push((method, e) => {
    if (method === 'Runtime.exceptionThrown') log(e.exceptionDetails.exception?.description || e.exceptionDetails.text);
    if (method === 'Runtime.consoleAPICalled') log(e.args.map((a) => a.value ?? a.description).join(' '));
    if (method === 'Log.entryAdded') log(e.entry.text);
  });
  for (const domain of ['Page', 'Runtime', 'Log']) await send(`${domain}.enable`);
  const value = async (expression) => {
    const { result, exceptionDetails } = await send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true, userGesture: true });
    if (exceptionDetails) throw Error(`${expression}: ${exceptionDetails.exception?.description || exceptionDetails.text}`);
    return result.value;
  };
  return {
    send, value,
    pause: (ms) => new Promise((done) => setTimeout(done, ms)),
    size: (width, height) => send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: width < 500 }),
    media: (features) => send('Emulation.setEmulatedMedia', { features: Object.entries(features).map(([name, v]) => ({ name, value: v })) }),
    goto: async (file) => { const loaded = new Promise((done) => listeners.push((m) => m === 'Page.loadEventFired' && done())); await send('Page.navigate', { url: `file://${path.resolve(file)}` }); await loaded; },
    shot: async (file, whole) => fs.writeFileSync(file, Buffer.from((await send('Page.captureScreenshot', { format: 'png', captureBeyondViewport: !!whole, ...(whole ? { clip: { ...(await send('Page.getLayoutMetrics')).cssContentSize, scale: 1 } } : {}) })).data, 'base64')),
    key: async (key, windowsVirtualKeyCode) => { for (const type of ['keyDown', 'keyUp']) await send('Input.dispatchKeyEvent', { type, key, text: type === 'keyDown' && key.length === 1 ? key : undefined, windowsVirtualKeyCode }); },
    click: async (x, y) => { for (const type of ['mousePressed', 'mouseReleased']) await send('Input.dispatchMouseEvent', { type, x, y, button: 'left', clickCount: 1 }); },
    tap: async (x, y) => { await send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y }] }); await send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] }); },
    close: () => { child.kill(); fs.rmSync(folder, { recursive: true, force: true, maxRetries: 5 }); },
  };
};
