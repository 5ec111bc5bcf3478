;
"use strict";
// Tables that sort, and show the claims with one verdict; the avalanche. Without this script the page is complete, except
// for the avalanche.
(() => {
  const verdicts = ["reproduced", "not reproduced", "undecided", "can't be tested", "by eye", "no data"];
  const byId = (id) => document.getElementById(id);

  // ---- tables
  const number = (text) => /^[-+]?[0-9.]/.test(text) ? parseFloat(text) : NaN;
  const compare = (a, b) => {
    const x = number(a), y = number(b);
    if (!isNaN(x) && !isNaN(y)) return x - y;
    return isNaN(x) !== isNaN(y) ? (isNaN(x) ? 1 : -1) : a.localeCompare(b);
  };
  const sort = (table, head, column) => {
    const up = head.getAttribute("aria-sort") !== "ascending";
    const body = table.tBodies[0], text = (row) => row.cells[column].textContent.trim();
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
    body.append(...[...body.rows].sort((a, b) => (up ? 1 : -1) * compare(text(a), text(b))));
  };
  const judged = [];
  for (const table of document.querySelectorAll("main table")) {
    if (!table.tHead || !table.tBodies.length) continue;
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => sort(table, head, column));
    });
    const last = table.tHead.rows[0].cells.length - 1;
    if (table.tHead.rows[0].cells[last].textContent.trim() !== "verdict") continue;
    for (const row of table.tBodies[0].rows) {
      const cell = row.cells[last], verdict = verdicts.find((v) => cell.textContent.trim().startsWith(v));
      cell.className = verdicts.indexOf(verdict) < 3 ? verdict.replace(" ", "-") : "other";
      judged.push({ table, row, verdict });
    }
  }
  const select = byId("verdict");
  const inReport = (j) => !j.table.closest("details.page");
  for (const v of ["all", ...verdicts]) {
    const n = judged.filter((j) => inReport(j) && (v === "all" || j.verdict === v)).length;
    select.append(new Option(`${v} (${n})`, v));
  }
  select.addEventListener("change", () => {
    for (const j of judged) j.row.hidden = select.value !== "all" && j.verdict !== select.value;
    for (const table of new Set(judged.map((j) => j.table)))
      table.hidden = [...table.tBodies[0].rows].every((row) => row.hidden);
  });
  byId("controls").hidden = false;
  byId("theme").addEventListener("click", () => {
    const root = document.documentElement.style;
    const dark = root.colorScheme ? root.colorScheme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.colorScheme = dark ? "light" : "dark";
    draw();
  });

  // ---- pages that a link leads into, and paper, are unfolded
  const unfold = () => {
    const target = location.hash.length > 1 && byId(decodeURIComponent(location.hash.slice(1)));
    const page = target && target.closest("details.page");
    if (page && !page.open) { page.open = true; target.scrollIntoView(); }
  };
  addEventListener("hashchange", unfold);
  addEventListener("beforeprint", () => { for (const page of document.querySelectorAll("details.page")) page.open = true; });

  // ---- the avalanche
  const run = window.avalanche, section = byId("avalanche"), canvas = section.querySelector("canvas");
  const slider = byId("frame"), play = byId("play"), said = byId("grain");
  const wide = 9000, high = 4200, scale = canvas.width / wide; // thousandths of a cm: 9 cm x 4.2 cm
  const at = (frame, g) => [frame.xy[2 * g], frame.xy[2 * g + 1]];
  const px = (x) => (x + 150) * scale, py = (y) => canvas.height - (y + 60) * scale;
  let chosen = -1, timer = 0;
  const strongest = Math.max(1, ...run.frames.flatMap((f) => f.links.filter((_, i) => i % 3 === 2)));

  function draw() {
    const frame = run.frames[slider.value], c = canvas.getContext("2d"), style = getComputedStyle(canvas);
    c.clearRect(0, 0, canvas.width, canvas.height);
    c.strokeStyle = style.color;
    c.lineWidth = 2;
    c.beginPath();
    c.moveTo(px(0), py(high)); c.lineTo(px(0), py(0)); c.lineTo(px(wide), py(0));
    if (frame.step < run.opens) { c.moveTo(px(4000), py(0)); c.lineTo(px(4000), py(high)); }
    c.stroke();
    run.r.forEach((r, g) => {
      const [x, y] = at(frame, g);
      if (x === null) return;
      c.beginPath();
      c.arc(px(x), py(y), r * scale, 0, 2 * Math.PI);
      c.globalAlpha = g === chosen ? 0.9 : 0.14;
      c.fillStyle = g === chosen ? style.outlineColor : style.color;
      c.fill();
      c.globalAlpha = 0.4;
      c.lineWidth = 1;
      c.stroke();
    });
    c.globalAlpha = 1;
    c.lineCap = "round";
    for (let k = 0; k < frame.links.length; k += 3) {
      const [a, b, force] = frame.links.slice(k, k + 3), [x, y] = at(frame, a);
      if (b < 0) continue;
      c.lineWidth = 0.3 + 14 * force / strongest;
      c.beginPath(); c.moveTo(px(x), py(y)); c.lineTo(px(at(frame, b)[0]), py(at(frame, b)[1])); c.stroke();
    }
    const ms = (frame.step - run.opens) * run.dt * 1000;
    byId("time").textContent = `${Math.round(ms) || 0} ms`;
    describe(frame);
  }

  function describe(frame) {
    if (chosen < 0) return;
    const [x, y] = at(frame, chosen), forces = [];
    for (let k = 0; k < frame.links.length; k += 3)
      if (frame.links[k] === chosen || frame.links[k + 1] === chosen) forces.push(frame.links[k + 2]);
    const before = run.frames[Math.max(0, slider.value - 1)], [x0, y0] = at(before, chosen);
    const time = (frame.step - before.step) * run.dt;
    const speed = time > 0 && x !== null ? Math.hypot(x - x0, y - y0) / 1000 / time : 0;
    said.textContent = x === null ? `Grain ${run.id[chosen]} has left the scene.`
      : `Grain ${run.id[chosen]}: radius ${run.r[chosen] / 1000} cm, at x = ${(x / 1000).toFixed(2)}, y = ${(y / 1000).toFixed(2)} cm; ` +
        `mean speed since the last frame ${speed.toFixed(1)} cm/s; ${forces.length} contacts` +
        (forces.length ? ` with normal forces of ${forces.sort((a, b) => b - a).join(", ")} dyn.` : ".");
  }

  function point(event) {
    const box = canvas.getBoundingClientRect(), frame = run.frames[slider.value];
    const x = (event.clientX - box.left) / box.width * canvas.width, y = (event.clientY - box.top) / box.height * canvas.height;
    const found = run.r.findIndex((r, g) => {
      const [gx, gy] = at(frame, g);
      return gx !== null && Math.hypot(px(gx) - x, py(gy) - y) <= r * scale;
    });
    if (found < 0 || found === chosen) return;
    chosen = found;
    draw();
  }

  function step() {
    slider.value = (Number(slider.value) + 1) % run.frames.length;
    draw();
  }

  slider.max = run.frames.length - 1;
  slider.addEventListener("input", draw);
  canvas.addEventListener("pointermove", point);
  canvas.addEventListener("pointerdown", point);
  play.addEventListener("click", () => {
    if (timer) { clearInterval(timer); timer = 0; } else { timer = setInterval(step, 60); }
    play.textContent = timer ? "Stop" : "Play";
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  const pile = document.querySelector('img[alt^="Pile of the same grains"]');
  if (pile) pile.closest("p").nextElementSibling.after(section);
  section.hidden = false;
  draw();
  unfold();
})();
