// A real Chromium with nothing but the page in it.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const skipped = 77; // the exit code by which ctest knows a test that could not run
const candidates = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
export const program = candidates.find((path) => path && existsSync(path));

const quiet = [
  "--no-sandbox",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];
const software_webgl = ["--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** Calls `work(context)` with a browser of its own, and leaves nothing behind. */
export async function withBrowser(work, { width = 1400, height = 1000, webgl = true, ...options } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "report-browser-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: program,
    headless: true,
    args: [...quiet, ...(webgl ? software_webgl : ["--disable-gpu", "--disable-3d-apis"])],
    viewport: { width, height },
    ...options,
  });
  try {
    return await work(context);
  } finally {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

/**
 * Opens a file and collects what a good page never does: asking for anything else, and complaining. It rests unless it
 * shall play: a beat that is drawn without a graphics card takes all of a processor.
 */
export async function openReport(context, path, { plays = false } = {}) {
  const page = await context.newPage();
  await page.emulateMedia({ reducedMotion: plays ? "no-preference" : "reduce" });
  const url = `file://${path}`;
  const requests = [];
  const complaints = [];
  page.on("request", (request) => request.url() !== url && requests.push(request.url()));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 20000 });
  return { page, requests, complaints };
}

let failures = 0;

/** Runs one test and prints how it went; `finish` ends the program by what all of them said. */
export async function check(name, work) {
  try {
    await work();
    console.log(`ok   ${name}`);
  } catch (error) {
    ++failures;
    console.log(`FAIL ${name}\n     ${error.message.replaceAll("\n", "\n     ")}`);
  }
}
export const finish = () => process.exit(failures ? 1 : 0);

/** Runs tests by name. Each gets `open(sample, options)`; no page it opened may have asked for anything or complained. */
export async function checkAll(context, tests, path_of) {
  for (const [name, test] of Object.entries(tests).filter(([of]) => of.includes(process.env.ONLY ?? "")))
    await check(name, async () => {
      const opened = [];
      await test(async (sample, options) => {
        opened.push(await openReport(context, path_of(sample), options));
        return opened.at(-1).page;
      });
      for (const { page, requests, complaints } of opened) {
        await page.close();
        assert.deepEqual(requests, [], "the page asked for something");
        assert.deepEqual(complaints, [], "the page complained");
      }
    });
}
