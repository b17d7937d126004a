// Makes the page that is the program: node build_program.mjs dynasurf.wasm.gz FOLDER-OF-PAGES dynasurf.html
//
// Its policy lets it run its own script, the program and the scripts of the reports that the program writes, and fetch
// nothing at all. The program waits, packed, in an element that no browser runs.
import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { deflateRawSync } from "node:zlib";
import { bundle, filled, here, source } from "./bundle.mjs";

const [program, pages, page] = process.argv.slice(2);
if (!page) {
  console.error("usage: node build_program.mjs dynasurf.wasm.gz FOLDER-OF-PAGES dynasurf.html");
  process.exit(1);
}
const hashes = (kind) =>
  ["report.html", "cloud.html"].map((name) => {
    const found = new RegExp(`${kind} ('sha256-[^']+')`).exec(readFileSync(join(pages, name), "utf8"));
    if (!found) throw new Error(`${name}: names no hash for ${kind}`);
    return found[1];
  });

/** Hash of a style sheet that the program itself writes: into the page that compares two results, into its maps. */
function hash_in(name, pattern) {
  const found = pattern.exec(readFileSync(join(here, "../src/dynasurf/report", name), "utf8"));
  if (!found) throw new Error(`${name}: has no style sheet`);
  return source(found[1].replace(/"\s*"/g, ""));
}
const written = [hash_in("comparison_page.cpp", /style = R"\(([^]*?)\)";/), hash_in("polar_svg.cpp", /"<style>([^]*?)<\/style>/)];

const read = (name) => readFileSync(join(here, "src/program", name), "utf8");
const worker = await bundle("program/worker.ts");
const folder = join(here, "src/translations");
const packed = (name) => deflateRawSync(JSON.stringify(JSON.parse(readFileSync(join(folder, name), "utf8"))), { level: 9 }).toString("base64");
const translations = Object.fromEntries(readdirSync(folder).sort().map((name) => [name.replace(".json", ""), packed(name)]));
const script = await bundle("program/main.ts", { WORKER: JSON.stringify(worker), TRANSLATIONS: JSON.stringify(translations) });
const style = await bundle("program/style.css");
const policy = [
  "default-src 'none'",
  `script-src ${[source(script), ...hashes("script-src")].join(" ")} 'wasm-unsafe-eval'`,
  `style-src ${[source(style), ...hashes("style-src"), ...written].join(" ")}`,
  "img-src data:",
  "worker-src blob:",
  "frame-src blob:",
  "connect-src 'none'",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const { textOf } = await import(`data:text/javascript,${encodeURIComponent(await bundle("program/base85.ts", {}, "esm"))}`);
const engine = textOf(readFileSync(program));
const licence = ["fflate/LICENSE", "@bjorn3/browser_wasi_shim/LICENSE-MIT"]
  .map((name) => readFileSync(join(here, "node_modules", name), "utf8").trim())
  .join("\n\n");
const parts = { LICENCE: licence, POLICY: policy, STYLE: style, BODY: read("body.html").trimEnd(), SCRIPT: script, ENGINE: engine };
writeFileSync(page, filled(read("frame.html"), parts));
console.log(`${page}: ${statSync(page).size} bytes`);
