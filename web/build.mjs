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

// Name of the page, its document, its script and its style.
const pages = [
  ["report.html", "index.html", "main.ts", "style.css"],
  ["cloud.html", "cloud/index.html", "cloud/main.ts", "cloud/style.css"],
  ["lod.html", "lod/index.html", "lod/main.ts", "lod/style.css"],
];
const licence = readFileSync(join(here, "node_modules/three/LICENSE"), "utf8").trim();
mkdirSync(folder, { recursive: true });
for (const [name, document, script_entry, style_entry] of pages) {
  const script = await bundle(script_entry);
  const style = await bundle(style_entry);
  const policy = [
    "default-src 'none'",
    `script-src ${source(script)}`,
    `style-src ${source(style)}`,
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");
  // Functions as replacements: a string would give its dollar signs a meaning.
  const page = readFileSync(join(here, "src", document), "utf8")
    .replace("{{LICENCE}}", () => licence)
    .replace("{{POLICY}}", () => policy)
    .replace("{{STYLE}}", () => style)
    .replace("{{SCRIPT}}", () => script);
  writeFileSync(join(folder, name), page);
}
