// Bundles each page into one HTML file: node build.mjs FOLDER
//
// A page may load nothing and run nothing but what is written into it here: its Content-Security-Policy names the
// hashes of the one script and the one style sheet. {{DATA}} is where the program puts a result.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { bundle, filled, here, source } from "./bundle.mjs";

const folder = process.argv[2];
if (!folder) {
  console.error("usage: node build.mjs FOLDER");
  process.exit(1);
}

// Name of the page, folder of its body, script and style, its title, and the colours it is made for.
const pages = [
  ["report.html", "", "Left ventricle report", "light dark"],
  ["cloud.html", "cloud", "Cloud report", "light dark"],
  ["lod.html", "lod", "Levels of detail", "dark"],
  ["cohort.html", "cohort", "Cohort", "light"],
];
const licence = readFileSync(join(here, "node_modules/three/LICENSE"), "utf8").trim();
mkdirSync(folder, { recursive: true });
const frame = readFileSync(join(here, "src/frame.html"), "utf8");
for (const [name, home, title, scheme] of pages) {
  const script = await bundle(join(home, "main.ts"));
  const style = await bundle(join(home, "style.css"));
  const policy = [
    "default-src 'none'",
    `script-src ${source(script)}`,
    `style-src ${source(style)}`,
    ...(home === "cohort" ? ["img-src data:"] : []),
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");
  const body = readFileSync(join(here, "src", home, "body.html"), "utf8").trimEnd();
  const parts = { LICENCE: licence, POLICY: policy, SCHEME: scheme, TITLE: title, STYLE: style, BODY: body, SCRIPT: script };
  writeFileSync(join(folder, name), filled(frame, parts));
}
