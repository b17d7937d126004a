// node library.test.mjs FOLDER: runs the libraries' own tests, compiled to WebAssembly, in a browser, in the worker of the
// page that is the program.
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { bundle } from "../bundle.mjs";
import { check, finish, needBrowser, skip, withBrowser } from "./browser.mjs";

const [folder] = process.argv.slice(2);
const programs = existsSync(folder) ? readdirSync(folder).filter((name) => name.endsWith(".wasm")) : [];
if (programs.length === 0) skip(`no tests in ${folder}; after ./dev web, ninja -C build/web browser_tests makes them`);
needBrowser();
const worker = await bundle("program/worker.ts");
const memory = await bundle("program/memory.ts", {}, "cjs");

/** Runs a program in a worker of the page; its exit code and what it prints. */
const run = (page, bytes) =>
  page.evaluate(
    async ([script, memory, program]) => {
      const { compile } = eval(`(() => { const module = {}; ${memory}; return module.exports; })()`);
      const engine = await compile(Uint8Array.from(atob(program), (letter) => letter.charCodeAt(0)), false);
      const mine = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
      return new Promise((done) => {
        mine.onerror = ({ message }) => done({ code: -1, output: message });
        mine.onmessage = ({ data }) => /end|lost/.test(data.kind) && done(data.kind === "end" ? { code: data.code, output: data.output } : { code: -1, output: data.reason });
        mine.postMessage({ engine });
        mine.postMessage({ files: [], commands: [["--gtest_brief=1"]], wanted: [] });
      });
    },
    [worker, memory, bytes.toString("base64")],
  );

await withBrowser(async (context) => {
  const page = await context.newPage();
  for (const name of programs)
    await check(name, async () => {
      const begin = performance.now();
      const { code, output } = await run(page, readFileSync(join(folder, name)));
      const count = /(\d+) tests? from/.exec(output)?.[1];
      assert.equal(code, 0, output.slice(-4000));
      assert.ok(Number(count) > 20, output.slice(-400));
      console.log(`     ${count} tests in ${((performance.now() - begin) / 1000).toFixed(1)} s`);
    });
});
finish();
