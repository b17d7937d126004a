// node cloud.test.mjs FOLDER [SCREENSHOTS]: opens the sample reports of clouds, and the page of instances, in a browser.
import assert from "node:assert/strict";
import { mkdirSync, statSync } from "node:fs";
import { join, resolve } from "node:path";
import { check, checkAll, finish, needBrowser, openReport, paleTexts, withBrowser } from "./browser.mjs";

const folder = resolve(process.argv[2]);
const screenshots = process.argv[3];
needBrowser();

const path_of = (name) => (name.startsWith("instance") ? join(folder, `${name}.html`) : join(folder, "results", name, "report.html"));
const text = (page, selector) => page.locator(selector).innerText();
const shot = async (page, selector) => {
  await page.waitForTimeout(250);
  return page.locator(`${selector} canvas`).screenshot();
};
/** Waits for two frames: one that began before, and one that shows what was asked. */
const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const set = (page, selector, value) =>
  page.locator(selector).evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input"));
  }, String(value));

/** The page of one instance, which stands still in the middle, about 100 pixels large and in one colour. */
async function alone(page, mode) {
  await page.setViewportSize({ width: 260, height: 1400 });
  await page.waitForTimeout(300);
  await page.selectOption("#mode", mode);
  await page.evaluate(() => {
    document.getElementById("edge").step = "any";
    for (const name of ["move", "tint"]) document.getElementById(name).click();
  });
  return {
    /** The level it is drawn at when edges may be so long on the screen. */
    level: (edge) =>
      page.evaluate(async (to) => {
        const input = document.getElementById("edge");
        input.value = to;
        input.dispatchEvent(new Event("input"));
        for (let n = 0; n < 2; ++n) await new Promise(requestAnimationFrame);
        return document.documentElement.dataset.counts.split(" ").indexOf("1");
      }, edge),
    /** Mean change of the picture since the last call, in grey levels. */
    change: () =>
      page.evaluate(async () => {
        await new Promise(requestAnimationFrame); // after the page's own: what it drew can still be read
        const drawn = document.querySelector("#view canvas"), side = 180;
        const copy = Object.assign(document.createElement("canvas"), { width: side, height: side });
        const context = copy.getContext("2d");
        context.drawImage(drawn, (drawn.width - side) / 2, (drawn.height - side) / 2, side, side, 0, 0, side, side);
        const now = context.getImageData(0, 0, side, side).data.filter((_, n) => n % 4 === 1), last = window.last ?? now;
        window.last = now;
        return now.reduce((sum, value, n) => sum + Math.abs(value - last[n]), 0) / now.length;
      }),
  };
}

const tests = {
  async "is light or dark as the system asks for, until a reader chooses; every text has a contrast of AA"(open) {
    const page = await open("ok");
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    for (const [colorScheme, expected] of [["light", "rgb(243, 245, 248)"], ["dark", "rgb(13, 18, 24)"]]) {
      await page.emulateMedia({ colorScheme });
      assert.equal(await ground(), expected);
      assert.deepEqual(await paleTexts(page), [], colorScheme);
    }
    await page.keyboard.press("l");
    assert.equal(await ground(), "rgb(243, 245, 248)");
  },

  async "is small and shows the certificate of every level"(open) {
    const page = await open("ok");
    assert.ok(statSync(path_of("ok")).size < 3e6);
    assert.match(await text(page, "#verdict"), /The points support every level/);
    assert.ok(await page.locator("#verdict.ok").isVisible());
    assert.equal(await page.locator("#certificates thead th[data-level]").count(), 3);
    const results = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent).results);
    const first = (await page.locator("#certificates tbody td:nth-child(2)").allInnerTexts()).join(" ");
    assert.ok(first.includes(results.levels[0].triangles.toLocaleString("en")));
    assert.ok(first.includes(`${results.levels[0].certificate.angles_deg.smallest.toFixed(1)}°`));
    assert.match(await text(page, "#cloud"), /6,000/);
    assert.match(await text(page, "#options"), /triangles\s+5120,1280,320/);
  },

  async "says which level is not watertight, and why"(open) {
    const page = await open("broken");
    assert.match(await text(page, "#verdict"), /Do not use it[\s\S]*Level 2 is not watertight: not closed/);
    assert.match(await text(page, "#tiles"), /not watertight/);
    assert.ok((await page.locator("#certificates td.bad").count()) > 0);
  },

  async "speaks of an open surface by its boundary loops"(open) {
    const page = await open("open");
    assert.ok(await page.locator("#verdict.ok").isVisible());
    assert.match(await text(page, "#verdict"), /An open surface with 1 boundary loop: every level is manifold/);
    assert.match(await text(page, "#tiles"), /open, 1 boundary loop/);
    assert.match(await text(page, "#certificates"), /Sound\s+yes\s+yes\s+Boundary loops\s+1\s+1/);
    assert.doesNotMatch(await page.locator("body").innerText(), /watertight/i);
    assert.equal(await page.locator("#certificates td.bad").count(), 0);
    await set(page, "#morph", 500);
    assert.match(await text(page, "#morph-now"), /level 2 to 1: 50 %/);
  },

  async "doubts a body that is half made up, draws what is, and flies to the worst places"(open) {
    const page = await open("half");
    assert.ok(await page.locator("#verdict.check").isVisible());
    assert.match(await text(page, "#verdict"), /away from all points/);
    const shown = await shot(page, "#tiles");
    await page.keyboard.press("m");
    assert.equal(await page.locator("#toggle-made_up").getAttribute("aria-pressed"), "false");
    assert.ok(!shown.equals(await shot(page, "#tiles")), "what is made up is drawn in its own colour");
    await page.keyboard.press("m");
    assert.ok((await page.locator("#worst li").count()) > 2);
    assert.match(await text(page, "#worst li:first-child"), /made up/);
    const before = await shot(page, "#tiles");
    await page.locator("#worst li:first-child button").click();
    assert.ok(!before.equals(await shot(page, "#tiles")), "a click goes there");
  },

  async "shows all of the certificates on a screen 1300 pixels wide"(open) {
    const page = await open("ok");
    await page.setViewportSize({ width: 1300, height: 900 });
    const { needed, given } = await page.locator("#certificates").evaluate((box) => ({ needed: box.scrollWidth, given: box.clientWidth }));
    assert.ok(needed <= given, `${needed} in ${given} pixels`);
  },

  async "shows a result without a level and one with a single level"(open) {
    assert.match(await text(await open("empty"), "#verdict"), /no level/);
    const page = await open("one");
    assert.ok(await page.locator("#morph").isDisabled());
    assert.equal(await page.locator(".tile-label").count(), 2);
  },

  async "draws the cloud and the levels, and turns them together"(open) {
    const page = await open("ok");
    await page.setViewportSize({ width: 1400, height: 1900 });  // both views without scrolling
    assert.equal(await page.locator(".tile-label").count(), 4);
    const [tiles, morph] = [await shot(page, "#tiles"), await shot(page, "#morph-view")];
    await page.evaluate(() => scrollTo(0, 0)); // Firefox moves what a picture is taken of to the middle
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
    for (const key of ["w", "f", "p", "z"]) {
      await page.keyboard.press(key);
      const now = await shot(page, "#tiles");
      assert.ok(!before.equals(now), key);
      before = now;
    }
    assert.equal(await page.getAttribute("#toggle-wire", "aria-pressed"), "true");
  },

  async "fits narrow screens"(open) {
    const page = await open("ok");
    for (const width of [1920, 1000, 700, 390]) {
      await page.setViewportSize({ width, height: 900 });
      await page.waitForTimeout(150);
      assert.ok(await page.evaluate(() => document.body.scrollWidth <= innerWidth), `too wide at ${width}`);
      const boxes = await page.locator(".tile-label").evaluateAll((labels) => labels.map((label) => [label.scrollWidth, label.clientWidth]));
      for (const [needed, given] of boxes) assert.ok(needed <= given, `a label of ${needed} pixels in ${given} at ${width}`);
    }
  },

  async "moves 200 instances and draws far ones with fewer triangles"(open) {
    const page = await open("instances");
    const read = () => page.evaluate(() => ({ counts: document.documentElement.dataset.counts.split(" ").map(Number), triangles: Number(document.documentElement.dataset.triangles) }));
    const sum = (counts) => counts.reduce((a, b) => a + b);
    await drawn(page);
    const morph = await read();
    assert.equal(sum(morph.counts), 200);
    assert.ok(morph.counts.every((count) => count > 0), `every level is in use: ${morph.counts}`);
    await page.selectOption("#mode", "finest");
    await drawn(page);
    const finest = await read();
    assert.deepEqual(finest.counts, [200, 0, 0]);
    assert.ok(morph.triangles < 0.4 * finest.triangles, `${morph.triangles} against ${finest.triangles}`);
    await page.selectOption("#mode", "switch");
    await set(page, "#edge", 40);
    await drawn(page);
    const rough = await read();
    assert.ok(rough.triangles < morph.triangles, "longer edges, fewer triangles");
    await set(page, "#count", 20);
    await drawn(page);
    assert.equal(sum((await read()).counts), 20);
    assert.ok(await page.evaluate(() => document.getElementById("panel").scrollWidth <= document.getElementById("panel").clientWidth), "the panel holds its texts");
  },

  async "changes levels at their limits, and back only when these are passed by the hysteresis"(open) {
    const page = await open("instance");
    const one = await alone(page, "switch");
    const data = await page.evaluate(() => JSON.parse(document.getElementById("data").textContent));
    // Longer edges allowed on the screen ask for coarser levels of an instance that stays where it is.
    const changes = async (edges) => {
      const found = [];
      for (let before = await one.level(edges[0]), n = 1; n < edges.length; ++n) {
        const now = await one.level(edges[n]);
        if (now !== before) found.push({ edge: (edges[n] + edges[n - 1]) / 2, from: before, to: now });
        before = now;
      }
      return found;
    };
    const edges = Array.from({ length: 60 }, (_, n) => 2 * 20 ** (n / 59));
    const coarser = await changes(edges), finer = await changes([...edges].reverse());
    assert.deepEqual(coarser.map(({ from, to }) => [from, to]), [[0, 1], [1, 2]]);
    assert.deepEqual(finer.map(({ from, to }) => [from, to]), [[2, 1], [1, 0]]);
    const near = (value, expected, what) => assert.ok(Math.abs(value / expected - 1) < 0.06, `${what}: ${value}, expected ${expected}`); // a step is 5 %
    for (const n of [0, 1]) near(coarser[n].edge / finer[1 - n].edge, 1.1 / 0.9, "hysteresis of 10 %");
    near(coarser[1].edge / coarser[0].edge, data.levels[2].mean_edge / data.levels[1].mean_edge, "limits follow the edges");
    // A size that trembles around a limit changes nothing.
    await one.level(finer[1].edge * 0.8);
    for (const share of [0.95, 1.05, 0.95, 1.05]) assert.equal(await one.level(coarser[0].edge * 0.9 * share), 0);
  },

  async "pops nowhere: interpolated levels change the picture in small steps"(open) {
    // The largest change of the picture between two steps of the edge, while one level turns into the next.
    const largest = async (mode) => {
      const page = await open("instance");
      const one = await alone(page, mode);
      const changes = [];
      for (let n = 0; n <= 120; ++n) {
        await one.level(2 * 20 ** (n / 120));
        changes.push(await one.change());
      }
      return Math.max(...changes);
    };
    const pop = await largest("switch"), smooth = await largest("morph");
    console.log(`     largest change between two pictures, grey levels: at once ${pop.toFixed(3)}, interpolated ${smooth.toFixed(3)}`);
    assert.ok(pop > 0.02, "a change at once is seen");
    // The band of 10 % is passed in four of these steps.
    assert.ok(smooth < 0.5 * pop, `${smooth} against ${pop}`);
  },

  async "leaves the frame to the graphics card: scripts take less than 4 ms for 200 instances"(open) {
    const page = await open("instances");
    // Drawing itself is a graphics card's work, which a browser without one does on the processor.
    await page.evaluate(() => (WebGL2RenderingContext.prototype.drawElementsInstanced = () => {}));
    await page.waitForTimeout(600);
    const scripts = [];
    for (let n = 0; n < 6; ++n) {
      await page.waitForTimeout(600);
      scripts.push(Number(await page.evaluate(() => document.documentElement.dataset.script)));
    }
    console.log(`     ms of script a frame: ${scripts.join(" ")}`);
    assert.ok(scripts.every((script) => script > 0));
    assert.ok(Math.min(...scripts) < 4, "the least disturbed of six");
    assert.ok(Number(await page.evaluate(() => document.documentElement.dataset.calls)) <= 5, "a draw call per level, and one per level that grows");
  },
};

await withBrowser(async (context) => {
  await checkAll(context, tests, path_of);
  if (screenshots) {
    mkdirSync(screenshots, { recursive: true });
    for (const sample of ["ok", "broken", "one", "half", "open", "empty", "instances"]) {
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
      assert.equal(await page.locator("#certificates thead th[data-level]").count(), 3);
      const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      const before = await paper();
      await page.keyboard.press("l");
      assert.notEqual(await paper(), before);
      assert.deepEqual(requests, []);
    }),
  { webgl: false },
);
finish();
