// node cloud.test.mjs FOLDER [SCREENSHOTS]: opens the sample reports of clouds, and the page of instances, in Chromium.
import assert from "node:assert/strict";
import { mkdirSync, statSync } from "node:fs";
import { join, resolve } from "node:path";
import { check, checkAll, finish, openReport, program, skipped, withBrowser } from "./browser.mjs";

const folder = resolve(process.argv[2]);
const screenshots = process.argv[3];
if (!program) {
  console.log("SKIPPED: no Chromium found (apt-get install chromium, or name one in the variable CHROMIUM)");
  process.exit(skipped);
}

const path_of = (name) => (name === "instances" ? join(folder, "instances.html") : join(folder, "results", name, "report.html"));
const text = (page, selector) => page.locator(selector).innerText();
const shot = async (page, selector) => {
  await page.waitForTimeout(250);
  return page.locator(`${selector} canvas`).screenshot();
};
const set = (page, selector, value) =>
  page.locator(selector).evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input"));
  }, String(value));

const tests = {
  async "is small and shows the certificate of every level"(open) {
    const page = await open("ok");
    assert.ok(statSync(path_of("ok")).size < 3e6);
    assert.match(await text(page, "#verdict"), /Every level is watertight/);
    assert.equal(await page.locator("#certificates tbody tr").count(), 3);
    const results = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).results);
    const first = await text(page, '#certificates tr[data-level="1"]');
    assert.ok(first.includes(results.levels[0].triangles.toLocaleString("en")));
    assert.ok(first.includes(`${results.levels[0].certificate.angles_deg.smallest.toFixed(1)}°`));
    assert.match(await text(page, "#cloud"), /6,000/);
    assert.match(await text(page, "#options"), /triangles\s+5120,1280,320/);
  },

  async "says which level is not watertight, and why"(open) {
    const page = await open("broken");
    assert.match(await text(page, "#verdict"), /Not every level is watertight[\s\S]*Level 2: not closed/);
    assert.match(await text(page, "#tiles"), /not watertight/);
    assert.ok((await page.locator("#certificates td.bad").count()) > 0);
  },

  async "shows a result without a level and one with a single level"(open) {
    assert.match(await text(await open("empty"), "#verdict"), /no level/);
    const page = await open("one");
    assert.ok(await page.locator("#morph").isDisabled());
    assert.equal(await page.locator(".tile-label").count(), 2);
  },

  async "draws the cloud and the levels, and turns them together"(open) {
    const page = await open("ok");
    assert.equal(await page.locator(".tile-label").count(), 4);
    const [tiles, morph] = [await shot(page, "#tiles"), await shot(page, "#morph-view")];
    const box = await page.locator("#tiles").boundingBox();
    await page.mouse.move(box.x + 100, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 260, box.y + 140, { steps: 4 });
    await page.mouse.up();
    assert.ok(!tiles.equals(await shot(page, "#tiles")), "dragging turns the tiles");
    assert.ok(!morph.equals(await shot(page, "#morph-view")), "and the other view follows");
    await page.keyboard.press("r");
    await page.evaluate(() => document.activeElement.blur()); // a key shows the focus, which is part of the picture
    assert.ok(tiles.equals(await shot(page, "#tiles")), "R goes back to the first view");
  },

  async "turns one level into the next with the slider"(open) {
    const page = await open("ok");
    const states = [];
    for (const at of [0, 250, 500, 750, 1000]) {
      await set(page, "#morph", at);
      states.push({ picture: await shot(page, "#morph-view"), at: await page.evaluate(() => document.documentElement.dataset.morph) });
    }
    assert.deepEqual(states.map((s) => s.at), ["3 1.000", "2 0.500", "2 1.000", "1 0.500", "1 1.000"]);
    for (let n = 1; n < states.length; ++n) assert.ok(!states[n].picture.equals(states[n - 1].picture), `step ${n} shows nothing new`);
    assert.match(await text(page, "#morph-now"), /level 1, 5,120 triangles/);
  },

  async "colours by distance, with a legend and a scale, or as the points"(open) {
    const page = await open("ok");
    const error = await shot(page, "#tiles");
    const full = await text(page, "#ramp-end");
    await set(page, "#scale", 10);
    assert.notEqual(await text(page, "#ramp-end"), full);
    assert.ok(!error.equals(await shot(page, "#tiles")), "another scale, another picture");
    await page.selectOption("#colouring", "own");
    const own = await shot(page, "#tiles");
    assert.ok(!error.equals(own));
    assert.ok(!(await page.locator("#ramp").isVisible()), "no legend for what is not shown");
    await page.selectOption("#colouring", "plain");
    assert.ok(!own.equals(await shot(page, "#tiles")));
    const without = await open("one");
    assert.ok(await without.locator('#colouring [value="own"]').evaluate((option) => option.disabled));
  },

  async "shows triangles, flat shading and points by their keys"(open) {
    const page = await open("ok");
    let before = await shot(page, "#tiles");
    for (const key of ["w", "f", "p"]) {
      await page.keyboard.press(key);
      const now = await shot(page, "#tiles");
      assert.ok(!before.equals(now), key);
      before = now;
    }
    assert.equal(await page.getAttribute("#toggle-wire", "aria-pressed"), "true");
  },

  async "fits narrow screens"(open) {
    const page = await open("ok");
    for (const width of [1920, 1000, 700]) {
      await page.setViewportSize({ width, height: 900 });
      await page.waitForTimeout(150);
      assert.ok(await page.evaluate(() => document.body.scrollWidth <= innerWidth), `too wide at ${width}`);
    }
  },

  async "moves 200 instances and draws far ones with fewer triangles"(open) {
    const page = await open("instances");
    const read = () => page.evaluate(() => ({ counts: document.documentElement.dataset.counts.split(" ").map(Number), triangles: Number(document.documentElement.dataset.triangles) }));
    const sum = (counts) => counts.reduce((a, b) => a + b);
    const morph = await read();
    assert.equal(sum(morph.counts), 200);
    assert.ok(morph.counts.every((count) => count > 0), `every level is in use: ${morph.counts}`);
    await page.selectOption("#mode", "finest");
    await page.waitForTimeout(400);
    const finest = await read();
    assert.deepEqual(finest.counts, [200, 0, 0]);
    assert.ok(morph.triangles < 0.4 * finest.triangles, `${morph.triangles} against ${finest.triangles}`);
    await page.selectOption("#mode", "switch");
    await set(page, "#edge", 40);
    await page.waitForTimeout(400);
    const rough = await read();
    assert.ok(rough.triangles < morph.triangles, "longer edges, fewer triangles");
    await set(page, "#count", 20);
    await page.waitForTimeout(400);
    assert.equal(sum((await read()).counts), 20);
  },
};

await withBrowser(async (context) => {
  await checkAll(context, tests, path_of);
  if (screenshots) {
    mkdirSync(screenshots, { recursive: true });
    for (const sample of ["ok", "broken", "one", "empty", "instances"]) {
      const { page } = await openReport(context, path_of(sample));
      await page.waitForTimeout(600);
      await page.screenshot({ path: join(screenshots, `${sample}.png`), fullPage: sample !== "instances" });
      await page.close();
    }
  }
});
await withBrowser(
  (context) =>
    check("works without WebGL and says so", async () => {
      const { page, requests } = await openReport(context, path_of("ok"));
      assert.match(await text(page, "#tiles"), /3D needs WebGL/);
      assert.equal(await page.locator("#certificates tbody tr").count(), 3);
      assert.deepEqual(requests, []);
    }),
  { webgl: false },
);
finish();
