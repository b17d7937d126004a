// node report.test.mjs FOLDER [SCREENSHOTS]: opens the sample reports from disk in a browser and uses them.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, statSync } from "node:fs";
import { join, resolve } from "node:path";
import { inflateSync } from "node:zlib";
import { check, checkAll, downloaded, finish, needBrowser, openReport, paleTexts, withBrowser } from "./browser.mjs";

const folder = resolve(process.argv[2]);
const screenshots = process.argv[3];
needBrowser();

const path_of = (name) => join(folder, name, "report.html");
const gate = (page) => page.evaluate(() => Number(document.documentElement.dataset.gate));
const cursor = (page) => page.evaluate(() => Number(document.querySelector(".cursor").dataset.x));
const text = (page, selector) => page.locator(selector).innerText();
/** Waits until a condition holds: drawing takes its time on a busy machine. */
const until = async (holds, otherwise) => {
  for (let n = 0; n < 60; ++n) {
    if (await holds()) return;
    await new Promise((done) => setTimeout(done, 50));
  }
  assert.fail(otherwise);
};
/** The pages of a PDF, which may pack the list of them. */
const pagesOf = (pdf) => {
  const plain = pdf.toString("latin1");
  const packed = [...plain.matchAll(/\/ObjStm[^]*?stream\r?\n/g)].map((head) => {
    const start = head.index + head[0].length;
    return inflateSync(pdf.subarray(start, plain.indexOf("endstream", start))).toString("latin1");
  });
  return [plain, ...packed].join("").match(/\/Type *\/Page\b/g)?.length ?? 0;
};
/** All pixels of a canvas as one number that changes with the picture. */
const picture = (page, selector) =>
  page.evaluate((of) => {
    const canvas = document.querySelector(of);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let hash = 0;
    for (const value of data) hash = (hash * 31 + value) | 0;
    return hash;
  }, selector);
/** Pixels of a picture in which blue or red is far from grey. */
const coloured = (page, selector) =>
  page.evaluate((of) => {
    const canvas = document.querySelector(of);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let n = 0; n < data.length; n += 4) if (Math.abs(data[n] - data[n + 2]) > 60) ++count;
    return count;
  }, selector);

const tests = {
  async "is at most 5 MB"() {
    const { size } = statSync(path_of("ok"));
    assert.ok(size <= 5e6, `${size} bytes`);
  },

  async "is light or dark as the system asks for, until a reader chooses; every text has a contrast of AA"(open) {
    const ground = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    for (const sample of ["ok", "check", "fail", "fitted", "moving"]) {
      const page = await open(sample);
      await page.emulateMedia({ colorScheme: "light" });
      assert.equal(await ground(page), "rgb(243, 245, 248)");
      assert.deepEqual(await paleTexts(page), [], `${sample}, light`);
      await page.emulateMedia({ colorScheme: "dark" });
      assert.equal(await ground(page), "rgb(13, 18, 24)");
      assert.deepEqual(await paleTexts(page), [], `${sample}, dark`);
      await page.waitForSelector("#theme[aria-pressed=false]", { timeout: 10_000 }); // told by an event after the frame
      await page.keyboard.press("l");
      assert.equal(await ground(page), "rgb(243, 245, 248)");
      assert.equal(await page.getAttribute("#theme", "aria-pressed"), "true");
      await page.emulateMedia({ colorScheme: "light" });
      await page.click("#theme");
      assert.equal(await ground(page), "rgb(13, 18, 24)");
    }
  },

  async "rests until asked when motion is unwelcome"(open) {
    const page = await open("ok");
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "false");
    await page.keyboard.press("Space");
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
  },

  async "plays, and pauses with the space bar"(open) {
    const page = await open("ok", { plays: true });
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "true", "it starts by itself");
    const seen = new Set();
    for (let n = 0; n < 12; ++n) {
      seen.add(await cursor(page));
      await page.waitForTimeout(60);
    }
    assert.ok(seen.size > 3, `the cursor stood at ${[...seen]}`);
    await page.keyboard.press("Space");
    const still = await cursor(page);
    await page.waitForTimeout(200);
    assert.equal(await cursor(page), still);
  },

  async "takes what a person says by hand, and tells the command line that repeats it"(open) {
    const page = await open("ok");
    await page.keyboard.press("h");
    assert.equal(await page.getAttribute("#toggle-hand", "aria-pressed"), "true");
    const value = (key) => page.inputValue(`#hand-${key}`);
    const drag = async (selector, from, to) => {
      await page.locator(selector).scrollIntoViewIfNeeded();
      const box = await page.locator(selector).boundingBox();
      const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
      await page.mouse.move(...at(from));
      await page.mouse.down();
      await page.mouse.move(...at(to), { steps: 4 });
      await page.mouse.up();
    };
    // Where the pointer turns into a hand there is a handle.
    const handle = async (selector, x, from, to) => {
      await page.locator(selector).scrollIntoViewIfNeeded();
      const box = await page.locator(selector).boundingBox();
      for (let y = from; y < to; y += 0.01) {
        await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
        if ((await page.evaluate((of) => document.querySelector(of).style.cursor, selector)) === "grab") return y + 0.01;
      }
      return assert.fail(`no handle between ${from} and ${to}`);
    };
    const middle = [0.5, await handle("canvas.large", 0.5, 0.35, 0.65)];
    await drag("canvas.large", middle, [0.55, 0.55]);
    const moved = (await value("center_mm")).split(",").map(Number);
    assert.equal(moved.length, 3);
    assert.ok(moved.every(Number.isFinite));
    const cut = ".long canvas:first-child";
    const apex = await handle(cut, 0.1, 0.6, 1);
    const before = await page.getAttribute("#hand-first_slice", "placeholder");
    await drag(cut, [0.1, apex], [0.1, apex - 0.1]);
    assert.ok(Number(await value("first_slice")) > Number(before), `${before} to ${await value("first_slice")}`);
    await page.fill("#hand-axis", "0,0");
    await page.press("#hand-axis", "Enter");
    assert.ok(await page.evaluate(() => !document.getElementById("hand-axis").checkValidity()), "two numbers are an axis");
    await page.fill("#hand-axis", "");
    await page.press("#hand-axis", "Enter");
    await page.click("#hand-exclude");
    const gate_now = await gate(page);
    assert.equal(await value("exclude_gates"), String(gate_now));
    await page.click("#hand-copy");
    const line = await page.getAttribute("#hand-copy", "data-copied");
    assert.match(line, new RegExp(`^dynasurf ventricle .*--set manual.center_mm=${moved.join(",")} --set manual.first_slice=\\d+ --set manual.exclude_gates=${gate_now}$`));
    assert.ok(await page.locator("#hand-run").isHidden(), "nobody is there to run it");
    await page.click("#hand-paint");
    const clean = await picture(page, "canvas.large");
    await drag("canvas.large", [0.3, 0.3], [0.4, 0.3]);
    await page.mouse.move(2, 2); // a pointer over the wall lights a segment
    assert.notEqual(await picture(page, "canvas.large"), clean);
    await page.locator("#toggle-hand").focus();
    await page.keyboard.press("Control+z");
    assert.equal(await picture(page, "canvas.large"), clean, "undo leaves paint");
    await page.click("#hand-reset");
    assert.equal(await value("center_mm"), "");
    if (screenshots) await page.screenshot({ path: join(screenshots, "by-hand.png") });
  },

  async "takes a reader's decision, quoted for a shell"(open) {
    const page = await open("ok");
    await page.keyboard.press("h");
    await page.click("#hand-rejected");
    await page.click("#hand-accepted");
    assert.equal(await page.getAttribute("#hand-rejected", "aria-pressed"), "false");
    await page.fill("#hand-reader", "A. O'Reader");
    await page.press("#hand-reader", "Enter");
    await page.fill("#hand-comment", "apex well seen");
    await page.press("#hand-comment", "Enter");
    await page.click("#hand-copy");
    const line = await page.getAttribute("#hand-copy", "data-copied");
    assert.ok(line.endsWith(` --set 'manual.reader=A. O'\\''Reader' --set 'manual.comment=apex well seen' --set manual.decision=accepted`), line);
  },

  async "saves a film of the beat"(open) {
    const page = await open("ok");
    const { bytes } = await downloaded(page, "#film", 60_000);
    assert.equal(bytes.subarray(0, 4).toString("hex"), "1a45dfa3", "this is no WebM");
    const viewer = await page.context().newPage();
    await viewer.setContent("<video muted></video>");
    const film = await viewer.evaluate(async (base64) => {
      const video = document.querySelector("video");
      video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: "video/webm" }));
      await new Promise((done) => (video.onloadeddata = done));
      const canvas = Object.assign(document.createElement("canvas"), { width: 128, height: 72 });
      const context = canvas.getContext("2d", { willReadFrequently: true });
      /** The surfaces at a part of a beat, as small numbers. */
      const look = async (beats) => {
        // A busy browser tells of the place that was sought before it has the picture of it.
        const shown = new Promise((done) => video.requestVideoFrameCallback(done));
        video.currentTime = (beats * video.duration) / 2;
        await shown;
        context.drawImage(video, 0, 0, 128, 72);
        return Array.from(context.getImageData(0, 0, 70, 66).data);
      };
      const difference = (a, b) => a.reduce((sum, v, n) => sum + Math.abs(v - b[n]), 0) / a.length;
      const [start, middle, again] = [await look(0.05), await look(0.4), await look(1.05)];
      return { width: video.videoWidth, height: video.videoHeight, seconds: video.duration, moved: difference(start, middle), returned: difference(start, again) };
    }, bytes.toString("base64"));
    await viewer.close();
    assert.deepEqual([film.width, film.height], [1280, 720]);
    const beat = (await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).results.study.cycle_ms)) / 1000;
    assert.ok(Math.abs(film.seconds - 2 * beat) < 0.005, `${film.seconds} s of two beats of ${beat} s`);
    assert.ok(film.moved > 5 * film.returned + 0.5, `the surfaces differ by ${film.moved} within a beat, by ${film.returned} after one`);
    assert.ok(await page.locator("#film").isEnabled());
    console.log(`     ${bytes.length} bytes, ${film.seconds.toFixed(2)} s, moved ${film.moved.toFixed(2)}, returned to ${film.returned.toFixed(2)}`);
  },

  async "steps through the gates with the arrow keys, and around the beat"(open) {
    const page = await open("ok");
    await page.keyboard.press("ArrowRight");
    const start = await gate(page);
    for (let n = 1; n <= 8; ++n) {
      await page.keyboard.press("ArrowRight");
      assert.equal(await gate(page), ((start - 1 + n) % 8) + 1);
    }
    await page.keyboard.press("ArrowLeft");
    assert.equal(await gate(page), ((start + 6) % 8) + 1);
    assert.match(await text(page, "#gate"), /^Gate \d of 8 · \d+ ms$/);
    assert.equal(await page.locator("tr[aria-current]").getAttribute("data-gate"), String(await gate(page)));
  },

  async "goes through the slices with the arrow keys"(open) {
    const page = await open("ok");
    assert.match(await text(page, ".caption"), /^Slice 14 of 23/);
    const before = await picture(page, ".large");
    await page.keyboard.press("ArrowUp");
    assert.match(await text(page, ".caption"), /^Slice 15 of 23/);
    assert.notEqual(await picture(page, ".large"), before);
    for (let n = 0; n < 30; ++n) await page.keyboard.press("ArrowDown");
    assert.match(await text(page, ".caption"), /^Slice 1 of 23/);
    assert.equal(await page.locator(".tile").count(), 23);
  },

  async "marks one place in three planes, on the surfaces and on the polar map"(open) {
    const page = await open("ok");
    // All of it in one view: scrolling would move the pointer to another place.
    await page.setViewportSize({ width: 1400, height: 3200 });
    const shot = () => page.locator("#scene canvas").screenshot();
    const marked = async () => {
      const at = await page.locator(".polar .cross").getAttribute("transform");
      return at.match(/-?[\d.]+/g).map(Number);
    };
    const click = async (selector, x, y) => {
      const box = await page.locator(selector).first().boundingBox();
      await page.mouse.click(box.x + box.width * x, box.y + box.height * y);
    };
    const [plain, cut] = [await shot(), await picture(page, ".cut")];
    await click(".large", 0.7, 0.5);
    assert.notEqual(await picture(page, ".cut"), cut, "the cut along the heart did not move");
    await until(async () => !plain.equals(await shot()), "the surfaces mark nothing");
    await click(".cut", 0.5, 0.5);
    assert.match(await text(page, ".caption"), /^Slice 1[12] of 23/, "a cut chooses the slice");
    // The map has its middle at 122 of 276 units across and half of its height, and a radius of 100.
    const box = await page.locator(".polar").boundingBox();
    const unit = Math.min(box.width / 276, box.height / 244);
    const middle = [box.x + box.width / 2 - 16 * unit, box.y + box.height / 2];
    const large = await picture(page, ".large");
    for (const [x, y] of [[-60, 0], [0, -80], [50, 50]]) {
      await page.mouse.click(middle[0] + x * unit, middle[1] + y * unit);
      const [mx, my] = await marked();
      assert.ok(Math.hypot(mx - x, my - y) < 25, `clicked at ${x} ${y}, marked at ${mx} ${my}`);
    }
    assert.notEqual(await picture(page, ".large"), large, "the polar map does not move the planes");
    const before = await marked();
    await click("#scene canvas", 0.45, 0.6);
    await until(async () => String(await marked()) !== String(before), "a click on the surfaces does not move the mark");
  },

  async "shows the panels of each layout, and everything again"(open) {
    const page = await open("ok");
    const shown = async () =>
      (await page.locator("main > .panel:visible").evaluateAll((panels) => panels.map((p) => p.querySelector("h2").id.replace("-title", "")))).join(" ");
    const all = await shown();
    for (const [key, panels] of [["2", "scene"], ["3", "slices"], ["4", "scene slices"], ["5", "scene polar segments"], ["6", "curve gates"]]) {
      await page.keyboard.press(key);
      assert.equal(await shown(), panels);
      assert.equal(await page.locator("#layout").inputValue(), key);
      assert.ok(await page.locator("#play").isVisible());
    }
    for (const layout of ["2", "3", "4", "5", "6"])
      for (const [width, height] of [[1920, 1080], [1280, 720], [390, 800]]) {
        await page.setViewportSize({ width, height });
        await page.selectOption("#layout", layout);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `layout ${layout} is too wide at ${width}`);
      }
    await page.selectOption("#layout", "1");
    assert.equal(await shown(), all);
  },

  async "fits all slices on one screen"(open) {
    const page = await open("ok");
    for (const [width, height] of [[1920, 1080], [1400, 1000], [1000, 1100]]) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(200);
      const box = await page.locator(".slices").boundingBox();
      assert.ok(box.height < height, `${box.height} px high at ${width} x ${height}`);
      assert.ok(await page.evaluate(() => document.body.scrollWidth <= innerWidth), `too wide at ${width}`);
    }
  },

  async "shows and hides borders and mesh sections"(open) {
    const page = await open("ok");
    const both = await coloured(page, ".large");
    await page.keyboard.press("c");
    assert.equal(await page.getAttribute("#toggle-contours", "aria-pressed"), "false");
    const sections = await coloured(page, ".large");
    await page.keyboard.press("m");
    const none = await coloured(page, ".large");
    await page.click("#toggle-contours");
    const borders = await coloured(page, ".large");
    assert.ok(both > sections && sections > none, `${both} > ${sections} > ${none}`);
    assert.ok(borders > none, `${borders} > ${none}`);
    assert.equal(none, 0, "a bare image is grey");
  },

  async "draws surfaces that move with the beat"(open) {
    const page = await open("ok");
    const shot = () => page.locator("#scene canvas").screenshot();
    await page.locator('#curve [role="slider"]').click({ position: { x: 55, y: 150 } });
    const relaxed = await shot();
    for (let n = 0; n < 3; ++n) await page.keyboard.press("ArrowRight");
    await page.waitForTimeout(150);
    assert.ok(!relaxed.equals(await shot()), "end diastole and end systole look alike");
  },

  async "lights a segment in the map, the table and on the surfaces"(open) {
    const page = await open("ok");
    // All of it in one view: scrolling would move the pointer to another place.
    await page.setViewportSize({ width: 1400, height: 1900 });
    const clip = await page.locator("#scene canvas").boundingBox();
    const shot = () => page.screenshot({ clip });
    const plain = await shot();
    await page.locator('.polar [data-segment="7"]').hover();
    assert.match(await text(page, "#polar .polar-caption"), /^7 mid anterior \(LAD\): \d+\.\d %$/);
    assert.equal(await page.locator("#segments tr[aria-current]").getAttribute("data-segment"), "7");
    await until(async () => !plain.equals(await shot()), "the surfaces show nothing of it");
    await page.locator('#segments tr[data-segment="17"]').hover();
    assert.equal(await page.locator(".polar .segment.lit").getAttribute("data-segment"), "17");
    await page.locator("#scene").hover();
    await until(async () => /^\d+ (basal|mid|apical)/.test(await text(page, "#polar .polar-caption")), "the heart does not answer the pointer");
    await page.selectOption("#polar-map", { label: "Inward motion, mm" });
    assert.equal(await page.locator("#segments tbody tr").count(), 17);
  },

  async "paints the polar map on the heart"(open) {
    const page = await open("ok");
    await page.setViewportSize({ width: 1400, height: 1900 });
    const shot = () => page.locator("#scene canvas").screenshot();
    const plain = await shot();
    await page.locator("#polar-paint").check();
    await until(async () => !plain.equals(await shot()), "nothing was painted");
    const perfusion = await shot();
    await page.selectOption("#polar-map", { label: "Inward motion, mm" });
    await until(async () => !perfusion.equals(await shot()), "another map paints the same");
    await page.selectOption("#polar-map", { index: 0 });
    await until(async () => perfusion.equals(await shot()), "the same map paints another heart");
    await page.locator("#polar-paint").uncheck();
    await until(async () => plain.equals(await shot()), "the paint stays");
  },

  async "tells of a blood pool what the cavity tells"(open) {
    const page = await open("pool");
    const cards = await text(page, "#numbers");
    assert.match(cards, /Ejection fraction/);
    assert.match(cards, /Peak filling rate/);
    assert.match(cards, /Phase SD, motion/);
    assert.doesNotMatch(cards, /Wall|Muscle/);
    const maps = await page.locator("#polar-map option").allTextContents();
    assert.deepEqual(maps, ["Inward motion, mm", "Onset by motion, deg"]);
    const head = await text(page, "#segments thead");
    assert.match(head, /Motion/);
    assert.doesNotMatch(head, /Perfusion|Thick/);
    assert.match(await text(page, "#segments-remark"), /blood pool/);
  },

  async "is no wider than a telephone"(open) {
    for (const sample of ["fitted", "check", "fail"]) {
      const page = await open(sample);
      await page.setViewportSize({ width: 390, height: 800 });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= 390, `${sample}: ${wide} px`);
    }
  },

  async "draws no polar map without surfaces"(open) {
    const page = await open("fail");
    assert.equal(await page.locator("#polar-panel").count(), 0);
    assert.equal(await page.locator("#segments-panel").count(), 0);
  },

  async "lists its keys"(open) {
    const page = await open("ok");
    await page.keyboard.press("?");
    assert.ok(await page.locator("#keys").isVisible());
    await page.keyboard.press("Escape");
    assert.ok(!(await page.locator("#keys").isVisible()));
  },

  async "shows the numbers of results.json"(open) {
    const page = await open("ok");
    const results = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).results);
    const cards = await text(page, "#numbers");
    for (const key of ["ef_percent", "edv_ml", "esv_ml", "sv_ml"]) assert.ok(cards.includes(results[key].toFixed(1)), key);
    assert.equal(await page.locator("#gates tbody tr").count(), 8);
    assert.match(await text(page, "#options"), /edges\.sigma_px\s+1\.8/);
    assert.match(await text(page, "#provenance"), /9f86d081884c7d65/);
    assert.match(await text(page, ".research"), /Research use only/);
  },

  async "puts what is doubtful first"(open) {
    const page = await open("check");
    assert.match(await text(page, "#verdict"), /Check this result/);
    assert.match(await text(page, "#verdict"), /varies by 24 %/);
    const box = await page.locator("#verdict").boundingBox();
    assert.ok(box.y + box.height < 400, "the banner is on the first screen");
  },

  async "shows slices, edges and the reason of a failed study"(open) {
    const page = await open("fail");
    assert.match(await text(page, "#verdict"), /do not use these numbers[\s\S]*no endocardial border was found/);
    assert.match(await text(page, "#scene"), /No surface was found/);
    assert.match(await text(page, "#notes"), /no edge of any slice/);
    assert.equal(await page.getAttribute("#toggle-edges", "aria-pressed"), "true");
    assert.ok((await coloured(page, ".large")) > 0, "the edges are drawn");
  },

  async "says that an ungated study has no ejection fraction"(open) {
    const page = await open("ungated");
    assert.match(await text(page, "#numbers"), /not gated/);
    assert.match(await text(page, "#curve"), /No volume curve/);
    assert.ok(await page.locator("#play").isDisabled());
    assert.ok(await page.locator("#scene canvas").isVisible());
  },

  async "shows one wall when the other is missing"(open) {
    const page = await open("no_endo");
    assert.match(await text(page, "#scene-legend"), /Endocardium was not found/);
    assert.ok((await coloured(page, ".large")) > 0);
  },

  async "steps around sixteen gates"(open) {
    const page = await open("gates16");
    await page.keyboard.press("ArrowLeft");
    assert.match(await text(page, "#gate"), /of 16/);
  },
  async "lights the segment under the pointer of a slice and of the splash"(open) {
    const page = await open("ok");
    const lit = () => page.locator("#segments tr[aria-current]").count();
    await page.locator(".large").scrollIntoViewIfNeeded();
    const box = await page.locator(".large").boundingBox();
    const before = await picture(page, ".large");
    // From the middle to each side the pointer crosses another wall.
    const walls = [];
    for (const [dx, dy] of [[0, -1], [1, 0], [0, 1], [-1, 0]]) {
      let name = "";
      for (let share = 0; share < 0.5 && !/\(/.test(name); share += 0.02) {
        await page.mouse.move(box.x + box.width * (0.5 + dx * share), box.y + box.height * (0.5 + dy * share));
        name = await text(page, "#polar .polar-caption");
      }
      walls.push(name.match(/^\d+ \w+ (\w+)/)?.[1]);
    }
    assert.equal(new Set(walls).size, 4, walls.join(", "));
    assert.equal(await lit(), 1);
    assert.notEqual(await picture(page, ".large"), before, "the slice shows nothing of it");
    await page.mouse.move(box.x + 2, box.y + 2);
    await until(async () => (await lit()) === 0, "far from the wall no segment is meant");
    assert.equal(await page.locator("#splash .splash-row").count(), 4);
    assert.ok((await coloured(page, "#splash canvas")) > 0, "the splash shows no borders");
    const shown = await picture(page, "#splash canvas:nth-of-type(1)");
    await page.locator('#segments tr[data-segment="17"]').hover();
    assert.notEqual(await picture(page, "#splash canvas:nth-of-type(1)"), shown, "the apical slice does not light the apex");
  },

  async "leads with the PSF-corrected reading and its error bars"(open) {
    const page = await open("fitted");
    const results = JSON.parse(await page.evaluate(() => document.getElementById("data").textContent)).results;
    const { psf_corrected, edge } = results.readings;
    const cards = await text(page, "#numbers");
    assert.ok(cards.includes(psf_corrected.edv_ml.toFixed(1)) && !cards.includes(edge.edv_ml.toFixed(1)), cards);
    assert.ok(cards.includes(`90 %: ${psf_corrected.ef_percent_90[0].toFixed(1)} to ${psf_corrected.ef_percent_90[1].toFixed(1)}`), cards);
    const rows = await page.locator("#readings tbody tr").allInnerTexts();
    assert.match(rows[0], /^PSF-corrected/);
    assert.match(rows[1], /^Edge/);
    assert.equal(await page.locator("#readings tr.leads").count(), 1);
    assert.match(await page.locator(".chart .band title").textContent(), /90 % interval/);
    assert.match(await (await open("ok")).locator(".chart .band title").textContent(), /scatter/);
  },

  async "shows what the fit explains and what it leaves"(open) {
    const page = await open("fitted");
    assert.equal(await page.locator("#residuals canvas").count(), 8);
    assert.match(await text(page, "#residuals .caption"), /^Gate \d, slice \d+ · difference here \d+\.\d %, in all gates and slices \d+\.\d %/);
    const [data, model, left] = [0, 1, 2].map((n) => `#residuals figure:nth-of-type(${n + 1}) canvas`);
    assert.notEqual(await picture(page, data), await picture(page, model));
    // Their outlines alone are coloured in grey pictures; what is left is blue or orange all over the wall.
    assert.ok((await coloured(page, left)) > 2 * (await coloured(page, data)), "nothing is left");
    const before = await picture(page, model);
    for (let n = 0; n < 4; ++n) await page.keyboard.press("ArrowDown");
    assert.notEqual(await picture(page, model), before, "it does not follow the cursor");
    const slice = await picture(page, model);
    for (let n = 0; n < 3; ++n) await page.keyboard.press("ArrowRight");
    assert.notEqual(await picture(page, model), slice, "it does not follow the beat");
    assert.equal(await (await open("ok")).locator("#residuals-panel").count(), 0);
  },

  async "plays, steps and scrubs the motion of the meshes"(open) {
    const page = await open("moving");
    const now = () => text(page, "#motion .motion-bar output");
    const slider = page.getByLabel("Step of the motion");
    const counts = async () => [...(await now()).matchAll(/(\d+) of (\d+) stopped/g)].map((m) => [Number(m[1]), Number(m[2])]);
    assert.match(await now(), /^Step 0 of 200 · endo 0 of \d+ stopped, epi 0 of \d+ stopped$/);
    await page.getByLabel("Next kept step").click();
    assert.match(await now(), /^Step 20 of 200/);
    const chart = ".particle-charts figure:nth-child(2) canvas";
    const before = await picture(page, chart);
    await slider.fill("119");
    assert.notEqual(await picture(page, chart), before, "the distances do not follow the step");
    const inner = await picture(page, ".particle-charts figure:nth-child(3) canvas");
    await page.locator("#motion .motion-bar select").selectOption("epi");
    assert.notEqual(await picture(page, ".particle-charts figure:nth-child(3) canvas"), inner, "the other wall has other triangles");
    for (const [stopped, all] of await counts()) assert.ok(stopped > 0.3 * all && stopped < 0.7 * all, `${stopped} of ${all}`);
    await page.getByLabel("Kept step before").click();
    assert.match(await now(), /^Step 100 of 200/);
    await slider.fill("0");
    const canvas = page.locator("#motion .frame3d canvas");
    const start = await canvas.screenshot();
    await page.locator("#motion .motion-bar button.primary").click();
    await page.waitForFunction(() => document.querySelector(".motion-bar output").textContent.startsWith("Step 200 of 200"));
    for (const [stopped, all] of await counts()) assert.equal(stopped, all);
    assert.notDeepEqual(await canvas.screenshot(), start, "nothing moved");
    await slider.fill("40");
    const { width, height } = await canvas.boundingBox();
    for (let x = 0; x < 12; ++x) await canvas.hover({ position: { x: width * (0.4 + 0.015 * x), y: height / 2 } });
    assert.match(await text(page, "#motion .caption"), /^Particle \d+ of (endo|epi): \d+\.\d mm from its start, force [\d.e-]+ N$/);
    assert.equal(await (await open("ok")).locator("#motion-panel").count(), 0);
  },

  async "shows the voxels, the lines of the field and the drag around the meshes"(open) {
    const page = await open("moving");
    await page.getByLabel("Step of the motion").fill("40");
    const canvas = page.locator("#motion .frame3d canvas");
    let before = await canvas.screenshot();
    for (const name of ["Border voxels", "Field lines", "Drag"]) {
      const box = page.locator("#motion").getByRole("checkbox", { name });
      await box.check();
      await page.waitForTimeout(100);
      const after = await canvas.screenshot();
      assert.notDeepEqual(after, before, `${name} changes nothing`);
      await box.uncheck();
      await page.waitForTimeout(100);
      before = await canvas.screenshot();
    }
  },

  async "shows the field on any plane, and what it has along a line"(open) {
    const page = await open("moving");
    const place = "#field .field-plane";
    const caption = () => text(page, "#field .caption");
    // The middle row of a slice meets the wall twice, 34 pixels of 4.4 mm or less apart; the field is 0.1 1/mm there.
    assert.match(await caption(), /^Slice \d+, epi border · at the cross 0\.0\d+ 1\/mm · vectors meet \d+\.\d, \d+\.\d mm along the line/);
    const [, from, to] = (await caption()).match(/meet ([\d.]+), ([\d.]+) mm/).map(Number);
    assert.ok(Math.abs(to - from - 70) < 5, `the wall is ${to - from} mm wide; it is 70 mm`);
    assert.match(await text(page, "#field .field-scale"), /0\.09\d* 1\/mm|0\.1\d* 1\/mm/);
    for (const name of ["Arrows", "Ways of the particles", "Mesh", "Border voxels"]) {
      const before = await picture(page, place);
      await page.locator("#field").getByLabel(name).uncheck();
      assert.notEqual(await picture(page, place), before, `${name} changes nothing`);
      await page.locator("#field").getByLabel(name).check();
      assert.equal(await picture(page, place), before);
    }
    // The mesh follows the step of its motion.
    const start = await picture(page, place);
    await page.locator('#motion .motion-bar input[type="range"]').fill("200");
    assert.notEqual(await picture(page, place), start, "the mesh does not follow the step");
    // Another line, drawn with the pointer: shorter than the wall is wide, from its middle: it meets once.
    const box = await page.locator(place).boundingBox();
    await page.locator(place).scrollIntoViewIfNeeded();
    const at = await page.locator(place).boundingBox();
    await page.mouse.move(at.x + at.width / 2, at.y + at.height / 2);
    await page.mouse.down();
    await page.mouse.move(at.x + at.width * 0.98, at.y + at.height / 2, { steps: 4 });
    await page.mouse.up();
    assert.match(await caption(), /vectors meet \d+\.\d mm along/);
    const slices = await page.locator("#field select").nth(1);
    await slices.selectOption("Cut along rows");
    assert.match(await caption(), /^Row \d+, epi border/);
    await page.locator("#field select").first().selectOption("endo");
    assert.match(await caption(), /^Row \d+, endo border/);
    assert.ok(box.width > 200);
    assert.equal(await (await open("ok")).locator("#field-panel").count(), 0);
  },

  async "shows contours with their forces and their stack"(open) {
    const page = await open("contours");
    const slider = page.getByLabel("Slice of the contours, 1 is the apex");
    await slider.fill("16");
    const words = await text(page, "#contours .caption");
    assert.match(words, /^Slice 16 · endo: 40 points, .*the first of all · epi: 40 points/);
    // A regular polygon of 40 points: its edges are alike, and its area is almost that of the circle.
    const [, least, mean, most, area] = words.match(/epi: 40 points, edges of ([\d.]+), ([\d.]+) and ([\d.]+) px .*?([\d.]+) px²/).map(Number);
    assert.ok(most - least < 0.11, "edges differ");
    const radius = (40 * mean) / (2 * Math.PI);
    assert.ok(Math.abs(area / (Math.PI * radius ** 2) - 1) < 0.05, `area ${area}`);
    const place = "#contours .field-plane";
    const before = await picture(page, place);
    await page.locator("#contours").getByLabel("Forces").uncheck();
    assert.notEqual(await picture(page, place), before, "no forces were drawn");
    const stack = await page.locator("#contours .frame3d canvas").screenshot();
    await slider.fill("9");
    await page.waitForTimeout(100);
    assert.notDeepEqual(await page.locator("#contours .frame3d canvas").screenshot(), stack, "the slice is not marked in the stack");
    await slider.fill("1");
    assert.match(await text(page, "#contours .caption"), /no contour here/);
    assert.equal(await (await open("ok")).locator("#contours-panel").count(), 0);
  },

  async "prints two pages that hold all they show"(open) {
    for (const sample of ["ok", "fitted", "check", "pool", "gates16", "fail", "ungated"]) {
      const page = await open(sample);
      await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
      const sheets = await page.evaluate(() =>
        [...document.querySelectorAll(".sheet")].map((s) => ({ held: s.clientHeight, needed: s.scrollHeight, wide: s.scrollWidth - s.clientWidth })),
      );
      assert.equal(sheets.length, 2);
      for (const { held, needed, wide } of sheets) assert.ok(needed <= held + 1 && wide <= 0, `${sample}: ${needed} of ${held} px, ${wide} px too wide`);
      await page.evaluate(() => dispatchEvent(new Event("afterprint")));
      assert.equal(pagesOf(await page.pdf({ preferCSSPageSize: true })), 2, `${sample}: pages`);
      assert.ok(await page.locator("#numbers").isVisible(), "the screen is back after printing");
    }
  },
};

await withBrowser(async (context) => {
  await checkAll(context, tests, path_of);
  if (screenshots) {
    mkdirSync(screenshots, { recursive: true });
    for (const sample of ["ok", "fitted", "check", "fail", "ungated", "no_endo", "gates16"])
      for (const [width, height] of [[1400, 1000], [1000, 800]]) {
        const { page } = await openReport(context, path_of(sample));
        await page.setViewportSize({ width, height });
            await page.waitForTimeout(400);
        await page.screenshot({ path: join(screenshots, `${sample}_${width}.png`) });
        await page.screenshot({ path: join(screenshots, `${sample}_${width}_full.png`), fullPage: true });
        await page.close();
      }
  }
});

await withBrowser(
  (context) =>
    check("works without WebGL and says so", async () => {
      const { page, requests } = await openReport(context, path_of("ok"));
      assert.match(await text(page, "#scene"), /3D needs WebGL/);
      await page.keyboard.press("ArrowRight");
      assert.match(await text(page, "#gate"), /^Gate \d of 8/);
      assert.ok((await coloured(page, ".large")) > 0);
      assert.deepEqual(requests, []);
    }),
  { webgl: false },
);
finish();
