// What all pages are made with: one script, one style sheet, and their hashes for the Content-Security-Policy.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const here = dirname(fileURLToPath(import.meta.url));

/** A script or style sheet of src/ with all that it imports. */
export async function bundle(entry, define = {}, format = "iife") {
  const result = await build({
    entryPoints: [join(here, "src", entry)],
    bundle: true,
    minify: true,
    write: false,
    charset: "utf8",
    format,
    target: "es2022",
    legalComments: "inline",
    define,
  });
  // An HTML parser ends the element at this text wherever it stands.
  return result.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
}

export const source = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

/** A function as replacement: a string would give its dollar signs a meaning. */
export const filled = (frame, parts) => frame.replace(/{{(\w+)}}/g, (place, part) => parts[part] ?? place);
