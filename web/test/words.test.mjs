// node words.test.mjs SAMPLES CLOUDS [SCREENSHOTS]: reports of all kinds as a page shows them that speaks German.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { checkAll, finish, program, skipped, withBrowser } from "./browser.mjs";
import { inGerman, notGerman, saidIn } from "./words.mjs";

const [samples, clouds, screenshots] = process.argv.slice(2).map((path) => resolve(path));
if (!program) {
  console.log("SKIPPED: no Chromium found (apt-get install chromium, or name one in the variable CHROMIUM)");
  process.exit(skipped);
}
if (screenshots) mkdirSync(screenshots, { recursive: true });
const hearts = ["ok", "fitted", "check", "fail", "no_endo", "pool", "ungated", "gates16", "moving", "contours"];
const scans = ["ok", "open", "half", "broken", "empty"];

const work = mkdtempSync(join(tmpdir(), "words-"));
const pathOf = (sample) => join(work, `${sample.replace("/", "-")}.html`);
const sources = [...hearts.map((name) => [`heart/${name}`, join(samples, name)]), ...scans.map((name) => [`scan/${name}`, join(clouds, name)])];
for (const [sample, folder] of sources) writeFileSync(pathOf(sample), inGerman(readFileSync(join(folder, "report.html"), "utf8")));

/** What is nobody's language: names of options, files and codes, and the notes that the samples made up. */
async function namesOf(page) {
  const { results } = JSON.parse(await page.locator("#data").textContent());
  const options = JSON.stringify(results.provenance.options).match(/[\w.]+/g) ?? [];
  const notes = [...results.notes, ...(results.quality?.flags ?? [])].map(({ message }) => message);
  return new Set([results.provenance.command, ...options, ...notes, ...results.provenance.inputs.map(({ file }) => file)]);
}

async function assertGerman(page, sample) {
  const names = await namesOf(page);
  const left = notGerman(await saidIn(page)).filter((text) => !names.has(text) && !/^[\w.-]+$/.test(text));
  assert.deepEqual(left, [], `${sample}: not German`);
}

/** Texts that their boxes cut off, and how much wider the page is than the window. */
const cutOff = (page) =>
  page.evaluate(() => {
    const boxes = [...document.querySelectorAll("button, h1, h2, h3, label, th, td, .legend span, .card, .tile-label, p, li")];
    const is_cut = (box) => box.clientWidth > 0 && box.scrollWidth > box.clientWidth + 1 && !box.classList.contains("visually-hidden");
    const cut = boxes.filter(is_cut).map((box) => box.textContent.trim().slice(0, 60));
    return { cut, wide: document.documentElement.scrollWidth - document.documentElement.clientWidth };
  });

const tests = {
  async "says all of a heart's report in German, on screens of three sizes"(open) {
    for (const name of hearts) {
      const page = await open(`heart/${name}`);
      if (await page.locator("#toggle-hand").isEnabled()) await page.click("#toggle-hand");
      for (const [width, height] of [[390, 800], [1280, 720], [1600, 1000]]) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(100);
        const { cut, wide } = await cutOff(page);
        assert.deepEqual(cut, [], `${name}: cut off at ${width} px`);
        assert.ok(wide <= 0, `${name}: ${wide} px too wide at ${width} px`);
      }
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}.png`), fullPage: true });
      await page.click("#help");
      await assertGerman(page, name);
    }
  },

  async "prints two German sheets that hold all they show"(open) {
    for (const name of ["ok", "fitted", "check", "pool", "gates16", "fail", "ungated"]) {
      const page = await open(`heart/${name}`);
      await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
      const sheets = await page.evaluate(() =>
        [...document.querySelectorAll(".sheet")].map((s) => ({ held: s.clientHeight, needed: s.scrollHeight, wide: s.scrollWidth - s.clientWidth })),
      );
      assert.equal(sheets.length, 2);
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}-paper.png`), fullPage: true });
      for (const { held, needed, wide } of sheets) assert.ok(needed <= held + 1 && wide <= 0, `${name}: ${needed} of ${held} px, ${wide} px too wide`);
      await assertGerman(page, name);
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}-paper.png`), fullPage: true });
    }
  },

  async "says all of a scan's report in German"(open) {
    for (const name of scans) {
      const page = await open(`scan/${name}`);
      for (const [width, height] of [[390, 800], [1280, 720]]) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(100);
        assert.deepEqual((await cutOff(page)).cut, [], `${name}: cut off at ${width} px`);
      }
      await assertGerman(page, name);
      if (screenshots) await page.screenshot({ path: join(screenshots, `scan-${name}.png`), fullPage: true });
    }
  },
};

await withBrowser((context) => checkAll(context, tests, pathOf));
rmSync(work, { recursive: true, force: true });
finish();
