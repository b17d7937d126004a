// A real Chromium with nothing but the page in it.
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

/** Opens a file and collects what a good page never does: asking for anything else, and complaining. */
export async function openReport(context, path) {
  const page = await context.newPage();
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
