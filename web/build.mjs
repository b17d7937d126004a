// Bundles each page into one HTML file: node build.mjs FOLDER
//
// A page may load nothing and run nothing but what is written into it here: its Content-Security-Policy names the
// hashes of the one script and the one style sheet. {{DATA}} is where the program puts a result.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const folder = process.argv[2];
if (!folder) {
  console.error("usage: node build.mjs FOLDER");
  process.exit(1);
}

const bundle = async (entry) => {
  const result = await build({
    entryPoints: [join(here, "src", entry)],
    bundle: true,
    minify: true,
    write: false,
    charset: "utf8",
    format: "iife",
    target: "es2022",
    legalComments: "inline",
  });
  // An HTML parser ends the element at this text wherever it stands.
  return result.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
};
const source = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

// Name of the page, folder of its body, script and style, its title, and the colours it is made for.
const pages = [
  ["report.html", "", "Left ventricle report", "dark light"],
  ["cloud.html", "cloud", "Cloud report", "dark"],
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
  // A function as replacement: a string would give its dollar signs a meaning.
  writeFileSync(join(folder, name), frame.replace(/{{(\w+)}}/g, (place, part) => parts[part] ?? place));
}
