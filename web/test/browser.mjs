// A real browser with nothing but the page in it: Chromium, or Firefox where the variable DYNASURF_BROWSER says so.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium, firefox } from "playwright-core";

const skipped = 77; // the exit code by which ctest knows a test that could not run
const browser = process.env.DYNASURF_BROWSER || "chromium";
const candidates = {
  chromium: [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"],
  firefox: [process.env.FIREFOX, "/usr/bin/firefox-esr", "/usr/bin/firefox"],
};
assert.ok(browser in candidates, `DYNASURF_BROWSER is ${browser}; expected ${Object.keys(candidates).join(" or ")}`);
/** Whether tests can speak with the browser as its developer tools do. */
export const has_devtools = browser === "chromium";
const program = candidates[browser].find((path) => path && existsSync(path));
const screen_server = "/usr/bin/Xvfb";

/** Ends a test that could not run. */
export function skip(reason) {
  console.log(`SKIPPED: ${reason}`);
  process.exit(skipped);
}

/** Ends a test that has no browser to run in. */
export function needBrowser() {
  if (!program) skip(`no ${browser} found; install it, or name it in the variable ${browser.toUpperCase()}`);
  if (browser === "firefox" && !existsSync(screen_server)) skip("Firefox has no WebGL without a screen; install xvfb");
}

const quiet = [
  "--no-sandbox",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];
const software_webgl = ["--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

let downloads; // where Firefox puts what a page saves

/** A screen in memory: the process that holds it, and its name. */
async function openScreen() {
  const server = spawn(screen_server, ["-displayfd", "1", "-screen", "0", "2200x2400x24"], { stdio: ["ignore", "pipe", "ignore"] });
  const number = await new Promise((done, failed) => {
    server.stdout.once("data", (text) => done(String(text).trim()));
    server.once("exit", () => failed(new Error(`${screen_server} opened no screen`)));
  });
  return { server, name: `:${number}` };
}

const launch = {
  async chromium(profile, { webgl, ...options }) {
    const args = [...quiet, ...(webgl ? software_webgl : ["--disable-gpu", "--disable-3d-apis"])];
    return [await chromium.launchPersistentContext(profile, { args, headless: true, ...options })];
  },
  async firefox(profile, { webgl, ...options }) {
    const screen = await openScreen(); // headless it has no WebGL without a graphics card
    const close = () => screen.server.kill();
    try {
      const context = await firefox.launchPersistentContext(profile, {
        channel: "moz-firefox",
        firefoxUserPrefs: { "webgl.disabled": !webgl, "webgl.force-enabled": webgl },
        env: { ...process.env, DISPLAY: screen.name },
        downloadsPath: downloads,
        headless: false,
        ...options,
      });
      return [context, close];
    } catch (reason) {
      close();
      throw reason;
    }
  },
};

/** Calls `work(context)` with a browser of its own, and leaves nothing behind. */
export async function withBrowser(work, { width = 1400, height = 1000, webgl = true, ...options } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "report-browser-"));
  downloads = join(profile, "saved");
  mkdirSync(downloads);
  const [context, leave] = await launch[browser](profile, { executablePath: program, viewport: { width, height }, webgl, ...options });
  try {
    return await work(context);
  } finally {
    await context.close();
    leave?.();
    rmSync(profile, { recursive: true, force: true });
  }
}

/** A page as a server of a clinic gives it, isolated from all others: it may then share memory between its threads. */
export async function serve(path) {
  const headers = {
    "Content-Type": "text/html; charset=utf-8",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Embedder-Policy": "require-corp",
  };
  const server = createServer((_, answer) => answer.writeHead(200, headers).end(readFileSync(path)));
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

// Before a picture is taken of Firefox, the driver puts an empty style into the page, whose policy refuses it aloud.
const empty_style = createHash("sha256").update("body {}").digest("base64");
export const isOfDriver = (complaint) => complaint.includes(empty_style);

/**
 * Opens a file and collects what a good page never does: asking for anything else, and complaining. It rests unless it
 * shall play: a beat that is drawn without a graphics card takes all of a processor.
 */
export async function openReport(context, path, { plays = false } = {}) {
  const page = await context.newPage();
  if (browser === "firefox") await page.addInitScript(preferRest, !plays);
  else await page.emulateMedia({ reducedMotion: plays ? "no-preference" : "reduce" });
  const url = `file://${path}`;
  const requests = [];
  const complaints = [];
  page.on("request", (request) => request.url() !== url && requests.push(request.url()));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => isOfDriver(String(error)) || complaints.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 20000 });
  return { page, requests, complaints };
}

/**
 * Texts whose contrast with what is behind them is below AA of WCAG 2.1: 4.5, or 3 for large letters. Behind a gradient
 * stands its colour that is worst for the text.
 */
export const paleTexts = (page) =>
  page.evaluate(() => {
    const brush = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const rgba = (colour) => {
      brush.clearRect(0, 0, 1, 1);
      brush.fillStyle = colour;
      brush.fillRect(0, 0, 1, 1);
      return brush.getImageData(0, 0, 1, 1).data;
    };
    const over = (above, below) => [0, 1, 2].map((n) => (above[n] * above[3] + below[n] * (255 - above[3])) / 255);
    const luminance = (colour) => {
      const [r, g, b] = colour.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const grounds = (element) => {
      if (!element) return [[255, 255, 255]];
      const { backgroundColor, backgroundImage } = getComputedStyle(element);
      const gradient = backgroundImage.match(/rgba?\([^)]*\)/g);
      if (gradient) return gradient.map((colour) => over(rgba(colour), [0, 0, 0]));
      const own = rgba(backgroundColor);
      return own[3] === 255 ? [[...own].slice(0, 3)] : grounds(element.parentElement).map((below) => over(own, below));
    };
    const contrast = (a, b) => (Math.max(luminance(a), luminance(b)) + 0.05) / (Math.min(luminance(a), luminance(b)) + 0.05);
    const pale = new Set();
    for (const element of document.body.querySelectorAll("*")) {
      const says = [...element.childNodes].filter((node) => node.nodeType === 3 && node.data.trim()).map((node) => node.data.trim())[0];
      if (!says || !element.checkVisibility({ checkOpacity: true }) || element.closest("#paper, :disabled, option")) continue;
      const style = getComputedStyle(element);
      const ink = rgba(element.closest("svg") ? style.fill : style.color);
      const size = parseFloat(style.fontSize);
      const least = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
      const worst = Math.min(...grounds(element).map((ground) => contrast(over(ink, ground), ground)));
      if (worst < least) pale.add(`${says.slice(0, 40)}: ${worst.toFixed(2)} of ${least}`);
    }
    return [...pale];
  });

/** Presses a button, in its menu if it has one, which closes where the page moves on meanwhile. */
async function press(page, selector, timeout) {
  const menu = page.locator("details", { has: page.locator(selector) });
  if ((await menu.count()) === 0) return page.click(selector);
  for (const end = Date.now() + timeout; ; )
    try {
      if (!(await menu.evaluate((element) => element.open))) await menu.locator("summary").click({ timeout });
      return await page.click(selector, { timeout: 10_000 }); // packing a result takes a slow machine seconds
    } catch (error) {
      if (Date.now() > end) throw error;
    }
}

/** What a page saves on a click: its name and its bytes. */
export async function downloaded(page, selector, timeout = 30_000) {
  if (browser === "chromium") {
    const [download] = await Promise.all([page.waitForEvent("download", { timeout }), press(page, selector, timeout)]);
    return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
  }
  // Firefox tells of no download that is no navigation.
  const before = new Set(readdirSync(downloads));
  await press(page, selector, timeout);
  for (const end = Date.now() + timeout; Date.now() < end; await new Promise((done) => setTimeout(done, 200))) {
    const names = readdirSync(downloads).filter((name) => !before.has(name));
    if (names.length !== 1 || names[0].endsWith(".part") || statSync(join(downloads, names[0])).size === 0) continue;
    const bytes = readFileSync(join(downloads, names[0]));
    rmSync(join(downloads, names[0]));
    return { name: names[0], bytes };
  }
  throw new Error(`nothing was saved within ${timeout / 1000} s of a click on ${selector}`);
}

/** What a browser says of motion, where no one can tell it to say so. */
function preferRest(rests) {
  const real = matchMedia.bind(window);
  window.matchMedia = (query) => (query.includes("prefers-reduced-motion") ? Object.assign(new EventTarget(), { media: query, matches: rests }) : real(query));
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
