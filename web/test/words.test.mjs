// node words.test.mjs SAMPLES CLOUDS PROGRAM [SCREENSHOTS]: reports of all kinds as a page shows them that speaks German,
// and what the program refuses.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { checkAll, finish, needBrowser, withBrowser } from "./browser.mjs";
import { bundle } from "../bundle.mjs";
import { german, inGerman, notGerman, saidIn } from "./words.mjs";

const [samples, clouds, native, screenshots] = process.argv.slice(2).map((path) => resolve(path));
needBrowser();
if (screenshots) mkdirSync(screenshots, { recursive: true });
const hearts = ["ok", "fitted", "check", "fail", "no_endo", "pool", "ungated", "gates16", "moving", "contours"];
const scans = ["ok", "open", "half", "broken", "empty"];

const work = mkdtempSync(join(tmpdir(), "words-"));
const pathOf = (sample) => join(work, `${sample.replace("/", "-")}.html`);
const sources = [...hearts.map((name) => [`heart/${name}`, join(samples, name)]), ...scans.map((name) => [`scan/${name}`, join(clouds, name)])];
for (const [sample, folder] of sources) writeFileSync(pathOf(sample), inGerman(readFileSync(join(folder, "report.html"), "utf8")));

/** Files that the program refuses, by name. */
function broken(study) {
  const text = (name, content) => [name, Buffer.from(content)];
  const ply = (body) => `ply\nformat ascii 1.0\n${body}`;
  const vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const changed = (name, from, to) => [name, Buffer.from(study.toString("latin1").replace(from, to.padEnd(from.length)), "latin1")];
  const nifti = (name, change) => {
    const header = Buffer.alloc(352);
    header.writeInt32LE(348, 0);
    [4, 8, 8, 8, 2, 1, 1, 1].forEach((n, at) => header.writeInt16LE(n, 40 + 2 * at));
    header.writeInt16LE(4, 70); // 16-bit integers
    header.writeInt16LE(16, 72);
    [1, 2, 2, 2].forEach((mm, at) => header.writeFloatLE(mm, 76 + 4 * at));
    header.writeFloatLE(352, 108);
    header.write("n+1", 344);
    change(header);
    return [name, header];
  };
  const nrrd = (name, fields) => {
    const all = { type: "short", dimension: 3, sizes: "2 2 2", spacings: "1 1 1", endian: "little", encoding: "raw", ...fields };
    const lines = Object.entries(all).flatMap(([field, value]) => (value === null ? [] : [`${field}: ${value}`]));
    return text(name, `NRRD0004\n${lines.join("\n")}\n\n`);
  };
  return [
    text("words.dcm", "no heart"),
    text("empty.nii", ""),
    ["short.dcm", study.subarray(0, study.length - 5000)],
    ["head.dcm", study.subarray(0, 700)],
    changed("projections.dcm", "RECON GATED TOMO", "GATED TOMO"),
    changed("planar.dcm", "RECON GATED TOMO", "WHOLE BODY"),
    changed("unsaid.dcm", "RECON GATED TOMO", "SOMETHING"),
    changed("packed.dcm", "1.2.840.10008.1.2.1\0", "1.2.840.10008.1.2.7\0"),
    nifti("cut.nii", () => {}),
    nifti("flat.nii", (header) => header.writeInt16LE(2, 40)),
    nifti("none.nii", (header) => header.writeInt16LE(0, 42)),
    nifti("five.nii", (header) => [5, 8, 8, 8, 2, 3].forEach((n, at) => header.writeInt16LE(n, 40 + 2 * at))),
    nifti("type.nii", (header) => header.writeInt16LE(32, 70)),
    nifti("bits.nii", (header) => header.writeInt16LE(8, 72)),
    nifti("thin.nii", (header) => header.writeFloatLE(0, 80)),
    nifti("unit.nii", (header) => header.writeUInt8(7, 123)),
    nifti("offset.nii", (header) => header.writeFloatLE(1, 108)),
    nifti("analyze.nii", (header) => header.fill(0, 344, 348)),
    nrrd("type.nrrd", { type: "block" }),
    nrrd("rank.nrrd", { dimension: 2 }),
    nrrd("sizes.nrrd", { sizes: "2 2" }),
    nrrd("number.nrrd", { sizes: "2 2 x" }),
    nrrd("endian.nrrd", { endian: "middle" }),
    nrrd("packed.nrrd", { encoding: "bzip2" }),
    nrrd("absent.nrrd", { encoding: null }),
    nrrd("short.nrrd", {}),
    text("ends.nrrd", "NRRD0004\ntype: short"),
    text("twice.nrrd", "NRRD0004\ntype: short\ntype: short\n\n"),
    text("what.ply", "nope\n"),
    text("what.laz", "nope\n"),
    text("what.e57", "nope\n"),
    text("head.ply", ply("element vertex 3\n")),
    text("word.ply", ply("corners 3\n")),
    text("type.ply", ply("element vertex 3\nproperty number x\n")),
    text("axis.ply", ply("element vertex 1\nproperty float x\nend_header\n0\n")),
    text("short.ply", ply(`${vertices}end_header\n0 0 0\n`)),
    text("many.ply", ply(`${vertices}end_header\n0 0 0\n1 0 0\n0 1 0 7\n`)),
    text("more.ply", ply(`${vertices}end_header\n0 0 0\n1 0 0\n0 1 0\n7 7 7\n`)),
    text("word.xyz", "0 0 0\n1 x 0\n"),
    text("two.xyz", "0 0\n1 1\n"),
    text("uneven.xyz", "0 0 0\n1 1 1 1\n"),
    text("flat.xyz", Array.from({ length: 400 }, (_, n) => `${n % 20} ${Math.floor(n / 20)} 0`).join("\n")),
    text("few.xyz", "0 0 0\n1 0 0\n0 1 0\n"),
    text("block.pts", "5\n0 0 0\n1 0 0\n"),
    text("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
    text("zero.obj", "v 0 0 0\nf 0 1 1\n"),
    text("word.obj", "v 0 0 0\nteapot 1\n"),
    text("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"),
    text("told.obj", "# Vertices: 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"),
    text("none.off", "OFF\n"),
    text("word.off", "ON\n3 1 0\n"),
    text("what.stl", "shape of a heart"),
    text("words.stl", "solid a\nfacet normal 0 0 1\nround loop\n"),
    text("ends.stl", "solid a\n"),
    text("what.las", "no laser"),
    text("head.las", "LASF"),
    text("head.pcd", "VERSION .7\nFIELDS x y\n"),
    text("word.pcd", "COLOUR red\n"),
    text("grid.ptx", "2\n"),
    text("packed.laz", "LASF"),
    text("scan.e57", "x"),
  ];
}

/** Settings that the program refuses. */
const settings = [
  "edges.sigma_px=wide", "edges.sigma_px=-3", "edges.sigm_px=2", "qqq=1", "edges=cann", "edges=zzzzzzzz", "fit.run=maybe", "manual.first_slice=1.5",
  "manual.exclude_gates=1,2,x", "manual.exclude_gates=9", "manual.axis=0,0,0", "manual.axis=1,2", "manual.center_mm=1e6,0,0", "manual.last_slice=99",
  "manual.base_plane_mm=9999", "manual.endo_points=1,2,3", "manual.decision=perhaps", "manual=1", "manual.radius_mm.x=1",
];

/** How the program refuses: its last line. */
function refusal(command, input, ...more) {
  const done = spawnSync(native, [command, input, "--out", "result", "--quiet", ...more], { cwd: work, encoding: "utf8" });
  const line = done.stderr.split("\n").filter((text) => text.includes("error: ")).at(-1);
  assert.ok(line && done.status !== 0, `${input} ${more.join(" ")} is not refused: ${done.stderr}`);
  return line.replace(/^.*?error: /, "");
}

/** What is nobody's language: names of options, files and codes, and the notes that the samples made up. */
async function namesOf(page) {
  const { results } = JSON.parse(await page.locator("#data").textContent());
  const options = JSON.stringify(results.provenance.options).match(/[\w.]+/g) ?? [];
  const notes = [...results.notes, ...(results.quality?.flags ?? [])].map(({ message }) => message);
  return new Set([results.provenance.command, ...options, ...notes, ...results.provenance.inputs.map(({ file }) => file)]);
}

async function assertGerman(page, sample) {
  const names = await namesOf(page);
  const left = notGerman(await saidIn(page)).filter((text) => !names.has(text) && !/^[\w.-]+$/.test(text));
  assert.deepEqual(left, [], `${sample}: not German`);
}

/** Texts that their boxes cut off, and how much wider the page is than the window. */
const cutOff = (page) =>
  page.evaluate(() => {
    const boxes = [...document.querySelectorAll("button, h1, h2, h3, label, th, td, .legend span, .card, .tile-label, p, li")];
    const is_cut = (box) => box.clientWidth > 0 && box.scrollWidth > box.clientWidth + 1 && !box.classList.contains("visually-hidden");
    const cut = boxes.filter(is_cut).map((box) => box.textContent.trim().slice(0, 60));
    return { cut, wide: document.documentElement.scrollWidth - document.documentElement.clientWidth };
  });

const tests = {
  async "says all of a heart's report in German, on screens of three sizes"(open) {
    for (const name of hearts) {
      const page = await open(`heart/${name}`);
      if (await page.locator("#toggle-hand").isEnabled()) await page.click("#toggle-hand");
      for (const [width, height] of [[390, 800], [1280, 720], [1600, 1000]]) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(100);
        const { cut, wide } = await cutOff(page);
        assert.deepEqual(cut, [], `${name}: cut off at ${width} px`);
        assert.ok(wide <= 0, `${name}: ${wide} px too wide at ${width} px`);
      }
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}.png`), fullPage: true });
      await page.click("#help");
      await assertGerman(page, name);
    }
  },

  async "prints two German sheets that hold all they show"(open) {
    for (const name of ["ok", "fitted", "check", "pool", "gates16", "fail", "ungated"]) {
      const page = await open(`heart/${name}`);
      await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
      const sheets = await page.evaluate(() =>
        [...document.querySelectorAll(".sheet")].map((s) => ({ held: s.clientHeight, needed: s.scrollHeight, wide: s.scrollWidth - s.clientWidth })),
      );
      assert.equal(sheets.length, 2);
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}-paper.png`), fullPage: true });
      for (const { held, needed, wide } of sheets) assert.ok(needed <= held + 1 && wide <= 0, `${name}: ${needed} of ${held} px, ${wide} px too wide`);
      await assertGerman(page, name);
      if (screenshots) await page.screenshot({ path: join(screenshots, `${name}-paper.png`), fullPage: true });
    }
  },

  async "says all that the program refuses in German"() {
    globalThis.document = { getElementById: () => null };
    const { Words } = await import(`data:text/javascript,${encodeURIComponent(await bundle("words.ts", {}, "esm"))}`);
    delete globalThis.document;
    const words = new Words(german);
    const small = ["gates=4", "lattice.nx=32", "lattice.ny=32", "lattice.nz=18", "lattice.dx_mm=4.5", "lattice.dy_mm=4.5", "lattice.dz_mm=6.5"];
    const made = spawnSync(native, ["phantom", "patient", "--out", "patient", ...small.flatMap((set) => ["--set", set])], { cwd: work, encoding: "utf8" });
    assert.equal(made.status, 0, made.stderr);
    const lines = [];
    for (const [name, bytes] of broken(readFileSync(join(work, "patient/study.dcm")))) {
      writeFileSync(join(work, name), bytes);
      lines.push(refusal(/\.(dcm|nii|nrrd)$/.test(name) ? "ventricle" : "cloud", name));
    }
    for (const set of settings) lines.push(refusal("ventricle", "patient/study.dcm", "--set", set));
    lines.push(refusal("ventricle", "patient/study.dcm", "--memory-limit", "1M"));
    const english = /\b(line|expected|holds|has|have|needs|stands|vertices)\b/;
    const left = lines.map((line) => [line, words.told(line)]).filter(([line, told]) => told === line || english.test(told) || notGerman([told]).length > 0);
    assert.deepEqual(left, []);
    // Names stay as they are, whatever they mean elsewhere; so does a line without an entry.
    assert.equal(words.told("option edges is 'cann'; choices: canny, sobel"), "Option edges ist „cann“; zur Wahl stehen: canny, sobel");
    assert.equal(words.told("no line of the program"), "no line of the program");
  },

  async "knows every kind of scan that the program reads by its name"() {
    const { isScan } = await import(`data:text/javascript,${encodeURIComponent(await bundle("program/scans.ts", {}, "esm"))}`);
    writeFileSync(join(work, "scan.bin"), "x");
    const endings = refusal("cloud", "scan.bin").split("ends in ")[1].match(/\.[a-z0-9]+/g);
    assert.ok(endings.length > 12, endings.join());
    assert.deepEqual(endings.filter((ending) => !isScan(`scan${ending}`)), []);
  },

  async "says all of a scan's report in German"(open) {
    for (const name of scans) {
      const page = await open(`scan/${name}`);
      for (const [width, height] of [[390, 800], [1280, 720]]) {
        await page.setViewportSize({ width, height });
        await page.waitForTimeout(100);
        assert.deepEqual((await cutOff(page)).cut, [], `${name}: cut off at ${width} px`);
      }
      await assertGerman(page, name);
      if (screenshots) await page.screenshot({ path: join(screenshots, `scan-${name}.png`), fullPage: true });
    }
  },
};

await withBrowser((context) => checkAll(context, tests, pathOf));
rmSync(work, { recursive: true, force: true });
finish();
