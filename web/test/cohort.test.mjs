// node cohort.test.mjs PAGE [PICTURE]: opens the page of a cohort from disk in Chromium, as it is and with ten thousand studies.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { downloaded, needBrowser, withBrowser } from "./browser.mjs";

const path = resolve(process.argv[2]);
needBrowser();

const html = readFileSync(path, "utf8");
const begin = '<script type="application/json" id="data">';
const from = html.indexOf(begin) + begin.length;
const to = html.indexOf("</script>", from);
const data = JSON.parse(html.slice(from, to));

/** Opens a page; whatever it complains of or asks the network for fails the test. */
async function open(context, file) {
  const page = await context.newPage();
  const bad = [];
  page.on("pageerror", (error) => bad.push(error.message));
  page.on("console", (message) => message.type() === "error" && bad.push(message.text()));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || bad.push(request.url()));
  await page.goto(pathToFileURL(file).href);
  return [page, bad];
}

/** Pixels of the colours of the two walls in the thumbnails of the rows in view, a list per row. */
function wallsIn(page) {
  return page.evaluate(() =>
    [...document.querySelectorAll(".row")].map((row) => {
      const canvas = row.querySelector("canvas.slice");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const count = (test) => data.reduce((sum, red, n) => sum + (n % 4 === 0 && test(red, data[n + 2]) ? 1 : 0), 0);
      return { id: row.querySelector("b").textContent, inner: count((red, blue) => blue > red + 50), outer: count((red, blue) => red > blue + 50) };
    }),
  );
}

/** Milliseconds until the page is painted, of the work that a filter makes, and of the frames while the list is dragged. */
function timesOf(page) {
  return page.evaluate(async () => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    const search = document.querySelector('input[type="search"]');
    const filter = async (text) => {
      const begin = performance.now();
      search.value = text;
      search.dispatchEvent(new Event("input", { bubbles: true }));
      await frame();
      document.body.getBoundingClientRect();
      return performance.now() - begin;
    };
    const filters = [await filter("n99"), await filter("n9"), await filter("")];
    const list = document.getElementById("list");
    const frames = [];
    for (let step = 0, last = await frame(); step < 60; ++step) {
      list.scrollTop = (list.scrollHeight * ((step * 37) % 60)) / 60;
      const now = await frame();
      frames.push(now - last);
      last = now;
    }
    frames.sort((a, b) => a - b);
    const painted = performance.getEntriesByName("first-contentful-paint")[0].startTime;
    return { painted, filter: Math.max(...filters), frame: frames[30], slowest: frames[59] };
  });
}

await withBrowser(
  async (context) => {
    const [page, bad] = await open(context, path);
    assert.equal(await page.textContent("#shown"), `${data.studies.length} of ${data.studies.length} studies`);
    // The worst comes first and is chosen.
    const worst = Math.max(...data.studies.map((study) => study.concern));
    const first = data.studies.find((study) => study.concern === worst);
    assert.equal(await page.textContent(".row.chosen b"), first.id);
    // The slice of each study that has pictures shows both walls, and no other row shows a slice.
    await page.waitForFunction(() => document.querySelector(".row"));
    await page.waitForTimeout(500);
    const walls = await wallsIn(page);
    assert.ok(walls.some(({ id }) => data.pictures[id]), "the worst studies have pictures");
    for (const { id, inner, outer } of walls)
      if (!data.pictures[id]) assert.equal(inner + outer, 0, `${id} has no picture`);
    assert.ok(walls.some(({ inner, outer }) => inner > 20 && outer > 20), "a slice shows both walls");
    assert.ok(Object.keys(data.pictures).length <= 200, "the page stays small");
    await page.fill('input[type="search"]', data.studies[1].id);
    assert.match(await page.textContent("#shown"), /^1 of /);
    await page.click("text=Show all");
    // By keys: accept, which goes on to the next; a comment there.
    await page.focus("#list");
    await page.keyboard.press("a");
    const second = await page.textContent(".row.chosen b");
    assert.notEqual(second, first.id);
    await page.keyboard.press("c");
    await page.keyboard.type("low base");
    await page.keyboard.press("Enter");
    const { name, bytes } = await downloaded(page, "#save");
    const table = bytes.toString("utf8");
    assert.equal(name, "triage.tsv");
    assert.deepEqual(table.split("\n").filter(Boolean).sort(), ["id\tdecision\tcomment", `${first.id}\taccept\t`, `${second}\t\tlow base`].sort());
    // A click on a study that has a result leads to its report.
    await page.fill('input[type="search"]', data.studies.find((study) => study.report).id);
    await page.click(".row");
    const report = await page.getAttribute("#one a", "href");
    assert.ok(readFileSync(join(dirname(path), decodeURI(report)), "utf8").includes("<html"), "the link leads to a report");
    assert.equal(await page.locator('[data-name="Recorded"]').count(), 0, "nobody recorded a decision");
    assert.deepEqual(bad, []);

    // What readers recorded: shown in the list and of the chosen one, a filter, an order, groups of the plots.
    const says = [{ decision: "accepted", reader: "A. Reader", comment: "apex <b>well</b> seen" }, { decision: "rejected", reader: "", comment: "" }, { decision: "", reader: "", comment: "dim" }];
    const read = join(dirname(path), "..", "decided.html");
    const studies = data.studies.map((study, n) => (says[n] ? { ...study, manual: says[n] } : study));
    writeFileSync(read, html.slice(0, from) + JSON.stringify({ ...data, studies }).replaceAll("</", "<\\/") + html.slice(to));
    const [decided, wrong] = await open(context, read);
    const ids = () => decided.locator(".row b").allTextContents();
    await decided.selectOption("#order", "recorded");
    assert.deepEqual((await ids()).slice(0, 3), [1, 0, 2].map((n) => studies[n].id));
    assert.deepEqual(await decided.locator(".row .recorded").allTextContents(), ["rejected", "accepted by A. Reader", "looked at", ...studies.slice(3).map(() => "")]);
    await decided.check("#up");
    assert.deepEqual((await ids()).slice(-3), [2, 0, 1].map((n) => studies[n].id));
    await decided.selectOption("#by", "recorded");
    assert.match(await decided.textContent("#means"), /accepted.*looked at.*nobody decided.*rejected/);
    await decided.selectOption('[data-name="Recorded"]', "accepted");
    assert.deepEqual(await ids(), [studies[0].id]);
    await decided.click(".row");
    assert.equal(await decided.textContent("#one .recorded"), "accepted by A. Reader: apex <b>well</b> seen");
    if (process.argv[3]) await decided.screenshot({ path: process.argv[3].replace(/(\.\w+)$/, "-decided$1") });
    assert.deepEqual(wrong, []);

    const many = Array.from({ length: 10000 }, (_, n) => ({ ...data.studies[n % data.studies.length], id: `n${n}` }));
    const large = join(dirname(path), "..", "ten-thousand.html");
    writeFileSync(large, html.slice(0, from) + JSON.stringify({ ...data, studies: many, second: null }).replaceAll("</", "<\\/") + html.slice(to));
    const [big, worse] = await open(context, large);
    assert.match(await big.textContent("#shown"), /^10000 of/);
    await big.focus("#list");
    await big.keyboard.press("End");
    assert.ok((await big.locator(".row").count()) < 60, "only rows in view are in the page");
    assert.match(await big.textContent(".row.chosen b"), /^n\d+$/);
    // Wide limits: the machine may have other work. A smooth page has about 16 ms a frame.
    const times = await timesOf(big);
    // The middle 95 % of all as the normal range, from the numbers themselves.
    await big.selectOption("#normal", "all");
    const values = many.filter((s) => s.state === "done" && s.verdict !== "fail" && s.numbers[0] !== null).map((s) => s.numbers[0]).sort((a, b) => a - b);
    const said = (await big.textContent("#normal-words")).match(/([\d.]+) to ([\d.]+) %, n = (\d+)/);
    assert.equal(Number(said[3]), values.length);
    [0.025, 0.975].forEach((share, n) => assert.ok(Math.abs(Number(said[n + 1]) - values[Math.round(share * (values.length - 1))]) < 0.1, said[0]));
    assert.equal(await big.locator("#histogram .normal").count(), 1);
    console.log(`${many.length} studies: ${Object.entries(times).map(([name, ms]) => `${name} ${Math.round(ms)} ms`).join(", ")}`);
    assert.ok(times.painted < 20000 && times.filter < 2000 && times.frame < 200, "ten thousand studies stay smooth");
    if (process.argv[3]) await big.screenshot({ path: process.argv[3] });
    assert.deepEqual(worse, []);
  },
  { webgl: false },
);
console.log("the page of a cohort works");
