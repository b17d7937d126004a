// node cohort.test.mjs PAGE: opens the page of a cohort from disk in Chromium, as it is and with ten thousand studies.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { program, skipped, withBrowser } from "./browser.mjs";

const path = resolve(process.argv[2]);
if (!program) {
  console.log("SKIPPED: no Chromium found (apt-get install chromium, or name one in the variable CHROMIUM)");
  process.exit(skipped);
}

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

await withBrowser(
  async (context) => {
    const [page, bad] = await open(context, path);
    assert.equal(await page.textContent("#shown"), `${data.studies.length} of ${data.studies.length} studies`);
    // The worst comes first and is chosen.
    const worst = Math.max(...data.studies.map((study) => study.concern));
    const first = data.studies.find((study) => study.concern === worst);
    assert.equal(await page.textContent(".row.chosen b"), first.id);
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
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    const table = readFileSync(await download.path(), "utf8");
    assert.equal(download.suggestedFilename(), "triage.tsv");
    assert.deepEqual(table.split("\n").filter(Boolean).sort(), ["id\tdecision\tcomment", `${first.id}\taccept\t`, `${second}\t\tlow base`].sort());
    const report = await page.getAttribute("#one a", "href");
    assert.ok(readFileSync(join(dirname(path), decodeURI(report)), "utf8").includes("<html"), "the link leads to a report");
    assert.deepEqual(bad, []);

    const many = Array.from({ length: 10000 }, (_, n) => ({ ...data.studies[n % data.studies.length], id: `n${n}` }));
    const large = join(dirname(path), "..", "ten-thousand.html");
    writeFileSync(large, html.slice(0, from) + JSON.stringify({ ...data, studies: many, second: null }).replaceAll("</", "<\\/") + html.slice(to));
    const [big, worse] = await open(context, large);
    assert.match(await big.textContent("#shown"), /^10000 of/);
    await big.focus("#list");
    await big.keyboard.press("End");
    assert.ok((await big.locator(".row").count()) < 60, "only rows in view are in the page");
    assert.match(await big.textContent(".row.chosen b"), /^n\d+$/);
    assert.deepEqual(worse, []);
  },
  { webgl: false },
);
console.log("the page of a cohort works");
