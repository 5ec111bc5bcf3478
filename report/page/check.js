// Appended to a copy of the page by check.sh: works its controls, and writes what is wrong into the title.
(async () => {
  const wrong = [], say = (ok, what) => { if (!ok) wrong.push(what); };
  const all = (what) => [...document.querySelectorAll(what)];
  const seen = (row) => row.getClientRects().length > 0;
  try {
    const pictures = all("main img");
    say(pictures.length >= 25, `${pictures.length} pictures`);
    for (const img of pictures) {
      await img.decode().catch(() => {});
      say(img.naturalWidth > 0 && img.src.startsWith("data:image/svg"), `picture: ${img.alt}`);
    }
    for (const a of all('a[href^="#"]'))
      say(a.hash === "" || document.getElementById(decodeURIComponent(a.hash.slice(1))), `link ${a.getAttribute("href")}`);
    say(all("a[href]").every((a) => /^(#|https?:)/.test(a.getAttribute("href"))), "a link leaves the page: " +
      all("a[href]").map((a) => a.getAttribute("href")).filter((h) => !/^(#|https?:)/.test(h)));
    say(document.documentElement.scrollWidth <= innerWidth, `scrolls sideways: ${document.documentElement.scrollWidth} of ${innerWidth}`);

    // Filter: only rows with this verdict, as many as announced; then all again.
    const select = document.getElementById("verdict");
    const judged = () => all("main > table, main > div > table").flatMap((t) =>
      t.tHead && t.tHead.textContent.trim().endsWith("verdict") && !t.closest("details") ? [...t.tBodies[0].rows] : []);
    const before = judged().filter(seen).length;
    say(before >= 100, `${before} claims`);
    for (const option of [...select.options].slice(1)) {
      select.value = option.value;
      select.dispatchEvent(new Event("change"));
      const rows = judged().filter(seen), n = Number(option.text.match(/\((\d+)\)/)[1]);
      say(rows.length === n && rows.every((r) => r.lastElementChild.textContent.trim().startsWith(option.value)),
        `filter ${option.value}: ${rows.length} of ${n}`);
    }
    select.value = "all";
    select.dispatchEvent(new Event("change"));
    say(judged().filter(seen).length === before, "filter: not all again");

    // Sort: by the verdict, up and down.
    const table = all("main table").find((t) => t.tBodies[0].rows.length > 5);
    const button = table.tHead.rows[0].lastElementChild.querySelector("button");
    const verdicts = () => [...table.tBodies[0].rows].map((r) => r.lastElementChild.textContent.trim());
    const sorted = verdicts().sort((a, b) => a.localeCompare(b));
    button.click();
    say(verdicts().join() === sorted.join(), "sort up");
    button.click();
    say(verdicts().join() === sorted.reverse().join(), "sort down");
    const values = all("main table").find((t) => t.tHead.textContent.trim().startsWith("mu"));
    values.closest("details").open = true;
    values.tHead.querySelectorAll("button")[0].click();
    values.tHead.querySelectorAll("button")[0].click();
    const numbers = [...values.tBodies[0].rows].map((r) => parseFloat(r.cells[0].textContent));
    say(numbers.every((x, i) => !i || x <= numbers[i - 1]), `sort numbers: ${numbers}`);

    // Avalanche: the slider changes the picture and the time, a grain pointed at is named.
    const canvas = document.querySelector("canvas"), slider = document.getElementById("frame"), time = document.getElementById("time");
    const picture = () => canvas.toDataURL(), first = picture(), start = time.textContent;
    slider.value = slider.max;
    slider.dispatchEvent(new Event("input"));
    say(Number(slider.max) >= 50 && picture() !== first && time.textContent !== start, "slider");
    say(window.avalanche.frames.every((f) => f.links.length > 300), "frames without forces");
    const box = canvas.getBoundingClientRect(), said = document.getElementById("grain");
    for (let k = 0; k < 20 && !said.textContent.startsWith("Grain"); k++)
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + box.width * (0.05 + 0.01 * k), clientY: box.bottom - box.height * 0.06 }));
    say(/^Grain \d+: radius .* contacts/.test(said.textContent), `pointing: ${said.textContent}`);
    document.getElementById("play").click();
    await new Promise((done) => setTimeout(done, 300));
    say(Number(slider.value) < Number(slider.max), "play");
    document.getElementById("play").click();
    document.getElementById("theme").click();
    say(/light|dark/.test(document.documentElement.style.colorScheme), "theme");
  } catch (error) {
    wrong.push(String(error));
  }
  wrong.push(...window.failures);
  document.title = wrong.length ? `WRONG ${wrong.join("; ")}` : "RIGHT";
})();
