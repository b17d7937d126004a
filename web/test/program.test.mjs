// node program.test.mjs dynasurf.html dynasurf [SCREENSHOTS]: opens the page that is the program from disk in Chromium,
// uses it, and holds what it computes against the native program.
import assert from "node:assert/strict";
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { inflateSync } from "node:zlib";
import { gunzipSync, unzipSync, zipSync } from "fflate";
import { bundle } from "../bundle.mjs";
import { check, downloaded, finish, has_devtools, isOfDriver, needBrowser, paleTexts, serve, skip, withBrowser } from "./browser.mjs";
import { german, notGerman, saidIn } from "./words.mjs";

const [page_path, native, screenshots] = process.argv.slice(2).map((path) => resolve(path));
if (!existsSync(page_path)) skip(`${page_path} is not there; ./dev web makes it`);
needBrowser();
if (screenshots) mkdirSync(screenshots, { recursive: true });

const work = mkdtempSync(join(tmpdir(), "program-page-"));
const most_wait = 300_000;

/** Runs the native program in one thread; its seconds. */
function run_native(...words) {
  const begin = performance.now();
  execFileSync(native, words, { cwd: work, stdio: ["ignore", "ignore", "pipe"] });
  return (performance.now() - begin) / 1000;
}
/** The same, and the most memory that it held. */
async function measure_native(...words) {
  const begin = performance.now();
  const child = spawn(native, words, { cwd: work, stdio: "ignore" });
  let memory = 0;
  const watch = setInterval(() => {
    const status = existsSync(`/proc/${child.pid}/status`) ? readFileSync(`/proc/${child.pid}/status`, "utf8") : "";
    memory = Math.max(memory, 1024 * Number(/VmHWM:\s+(\d+)/.exec(status)?.[1] ?? 0));
  }, 10);
  const code = await new Promise((done) => child.on("exit", done));
  clearInterval(watch);
  assert.ok(code === 0 || code === 3, `${words.join(" ")} ended with ${code}`);
  return { seconds: (performance.now() - begin) / 1000, memory };
}
const results_of = (folder) => JSON.parse(readFileSync(join(work, folder, "results.json"), "utf8"));

/** All numbers of a result by their place in it, without what tells of the run: times, memory, program. */
function numbers_of(json, at = "", found = new Map()) {
  for (const [key, value] of Object.entries(json ?? {})) {
    if (/^(timings|seconds|peak_bytes|provenance|memory)/.test(key) || key.endsWith("seconds")) continue;
    if (typeof value === "number") found.set(`${at}/${key}`, value);
    else if (typeof value === "object") numbers_of(value, `${at}/${key}`, found);
  }
  return found;
}

/** All numbers of a result, and all files but those that tell of the run or are packed, are the native program's. */
function assert_same(mine, folder) {
  const numbers = numbers_of(mine.json);
  assert.deepEqual(numbers, numbers_of(results_of(folder)));
  const same = Object.entries(mine.files).filter(([name]) => /\.(glb|csv|ply|stl|obj|off|pvd|vtp)$/.test(name));
  assert.ok(same.length > 1);
  for (const [name, bytes] of same) {
    const theirs = readFileSync(join(work, folder, name.replace(/^[^/]*\//, "")));
    assert.ok(theirs.equals(bytes), `${name} is another file than the native program's`);
  }
  console.log(`     ${numbers.size} numbers and ${same.length} files are the native program's`);
}

const view = (page) => page.evaluate(() => document.documentElement.dataset.view);
const reason = (page) => page.locator("#reason").innerText();
/** Drags files or folders of the disk to a place of the window, as a person does. */
async function drag(page, paths, x = 640, y = 300) {
  const driver = await page.context().newCDPSession(page);
  const data = { items: [], files: paths.map((path) => join(work, path)), dragOperationsMask: 1 };
  // Over a report the second step already comes to the page.
  for (const type of ["dragEnter", "dragOver", "dragOver", "drop"]) await driver.send("Input.dispatchDragEvent", { type, x, y, data });
}
const until_view = (page, ...names) =>
  page.waitForFunction((of) => of.includes(document.documentElement.dataset.view), names, { timeout: most_wait });

/** Types into a field and enters it. */
async function enter(field, words) {
  await field.fill("");
  await field.pressSequentially(words);
  await field.press("Enter");
}

/** Waits for a result and reads it as a user would: by saving it. */
async function saved(page) {
  await until_view(page, "result", "failure");
  assert.equal(await view(page), "result", await reason(page));
  const files = unzipSync((await downloaded(page, "#save-zip")).bytes);
  const names = Object.keys(files);
  const json = JSON.parse(new TextDecoder().decode(files["dynasurf-result/results.json"]));
  const facts = await page.evaluate(() => ({ ...document.documentElement.dataset }));
  return { json, names, files, seconds: Number(facts.seconds), memory: Number(facts.memory) };
}

const drop = (page, files) =>
  page.evaluate((list) => {
    const transfer = new DataTransfer();
    for (const { name, base64 } of list)
      transfer.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, files.map(({ name, bytes }) => ({ name, base64: Buffer.from(bytes).toString("base64") })));

const give = (page, name, bytes) =>
  page.setInputFiles("#files", [{ name, mimeType: "application/octet-stream", buffer: Buffer.from(bytes) }]);

/** The report in the page has drawn itself. */
async function report_is_drawn(page, id = "report") {
  const frame = await (await page.waitForSelector(`#${id}[srcdoc]`, { state: "attached" })).contentFrame();
  await frame.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 30_000 });
  return frame;
}

function small_study() {
  const small = ["gates=4", "lattice.nx=32", "lattice.ny=32", "lattice.nz=18", "lattice.dx_mm=4.5", "lattice.dy_mm=4.5", "lattice.dz_mm=6.5"];
  run_native("phantom", "patient", "--out", "small", ...small.flatMap((set) => ["--set", set]), "--replace", "--quiet");
  return readFileSync(join(work, "small/study.nii.gz"));
}

const shoot = (page, name) => screenshots && page.screenshot({ path: join(screenshots, `${name}.png`) });

const tests = {
  async "is at most 3 MB, and tells when its first paint came"(page) {
    assert.ok(statSync(page_path).size <= 3e6, `${statSync(page_path).size} bytes`);
    const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
    console.log(`     ${statSync(page_path).size} bytes, first paint after ${Math.round(paint)} ms`);
  },

  async "computes the virtual patient as the native program does"(page) {
    run_native("ventricle", "patient/study.dcm", "--out", "patient/native", "--threads", "1");
    await page.click("#example-patient");
    const mine = await saved(page);
    const theirs = results_of("patient/native");
    assert_same(mine, "patient/native");
    assert.equal(mine.json.verdict, theirs.verdict);
    console.log(`     ${mine.memory / 1e6} MB`);
    for (const name of ["report.html", "results.csv", "options.json", "cycle.glb", "manifest.txt"])
      assert.ok(mine.names.includes(`dynasurf-result/${name}`), `${name} is missing`);
    const frame = await report_is_drawn(page);
    assert.ok((await frame.locator("#numbers").innerText()).includes(`${theirs.edv_ml.toFixed(1)}mL`), "the report shows other volumes");
    await shoot(page, "patient");
  },

  async "takes a dropped study, and the same in a zip archive, with equal results"(page) {
    const bytes = readFileSync(join(work, "patient/study.dcm"));
    await page.waitForFunction(() => document.documentElement.dataset.warm === "true", null, { timeout: most_wait });
    const seconds = run_native("ventricle", "patient/study.dcm", "--out", "patient/again", "--threads", "1", "--quiet");
    await drop(page, [{ name: "study.dcm", bytes }]);
    const dropped = await saved(page);
    console.log(`     ${dropped.seconds} s (native, one thread: ${seconds.toFixed(1)} s), ratio ${(dropped.seconds / seconds).toFixed(2)}`);
    const theirs = results_of("patient/native");
    assert_same(dropped, "patient/native");
    await page.click("#result .other");
    await give(page, "study.zip", zipSync({ "folder/Bild ä.dcm": new Uint8Array(bytes) }));
    const zipped = await saved(page);
    assert.deepEqual(numbers_of(zipped.json), numbers_of(dropped.json));
    assert.equal(zipped.json.provenance.inputs[0].sha256, theirs.provenance.inputs[0].sha256);
  },

  async "takes files and folders that are dragged from the disk, over a report too, which makes films and fills the screen"(page) {
    if (process.env.DYNASURF_BROWSER === "firefox") return; // its driver cannot drag from outside the window
    mkdirSync(join(work, "dragged/inner"), { recursive: true });
    copyFileSync(join(work, "patient/study.dcm"), join(work, "dragged/inner/Bild 1.dcm"));
    await drag(page, ["patient/study.dcm"]);
    assert_same(await saved(page), "patient/native");
    const frame = await report_is_drawn(page);
    assert.ok(await frame.locator("#film").isVisible(), "a report in the page makes no film");
    assert.ok(await frame.locator("#full-screen").isEnabled(), "a report in the page cannot fill the screen");
    await drag(page, ["dragged"], 300, 500);
    assert_same(await saved(page), "patient/native");
  },

  async "takes a list of numbers, tells a value that a search hides, and prints the report alone"(page) {
    await page.click("#example-vase");
    await saved(page);
    await page.click("#show-options");
    await enter(page.locator('[data-path="triangles"] input'), "2000,500");
    await enter(page.locator('[data-path="outliers"] input'), "-1");
    await page.fill("#search", "triangles of each");
    await page.click("#again");
    assert.equal(await view(page), "result", "a value that cannot be was run");
    assert.ok(await page.locator('[data-path="outliers"] input').isVisible(), "what cannot be is still hidden");
    await enter(page.locator('[data-path="outliers"] input'), "6");
    await page.click("#again");
    await until_view(page, "working");
    assert.equal((await saved(page)).json.levels.length, 2);
    await page.evaluate(() => (document.getElementById("report").contentWindow.print = () => (document.title = "printed")));
    await page.keyboard.press("Control+p");
    assert.equal(await page.title(), "printed");
    await page.keyboard.press("Escape");
    assert.ok(await page.locator("#options").isHidden());
  },

  async "makes levels of detail of the vase"(page) {
    await page.waitForFunction(() => document.documentElement.dataset.warm === "true", null, { timeout: most_wait });
    const seconds =
      run_native("phantom", "cloud", "--set", "shape=vase", "--set", "points=30000", "--set", "noise_percent=0.1", "--out", "vase", "--replace", "--quiet", "--threads", "1") +
      run_native("cloud", "vase/cloud.ply", "--out", "vase/native", "--triangles", "5120,1280,320", "--threads", "1");
    await page.click("#example-vase");
    const mine = await saved(page);
    assert_same(mine, "vase/native");
    console.log(`     ${mine.seconds} s (native, one thread: ${seconds.toFixed(1)} s), ratio ${(mine.seconds / seconds).toFixed(2)}, ${mine.memory / 1e6} MB`);
    await report_is_drawn(page);
    await shoot(page, "vase");
  },

  async "takes time and memory that stand beside those of the native program"(page) {
    const many = ["gates=16", "lattice.nx=128", "lattice.ny=128", "lattice.nz=48", "lattice.dx_mm=1.4", "lattice.dy_mm=1.4", "lattice.dz_mm=2.8"];
    run_native("phantom", "patient", "--out", "many", ...many.flatMap((set) => ["--set", set]), "--quiet");
    run_native("phantom", "cloud", "--set", "shape=spring", "--set", "points=100000", "--out", "spring", "--quiet");
    await page.emulateMedia({ reducedMotion: "reduce" }); // a beat drawn without a graphics card takes all of a processor
    const table = [["", "page s", "native s", "ratio", "page MB", "native MB"]];
    for (const [name, path, ...words] of [
      ["8 gates of 64x64x23", "patient/study.dcm", "ventricle"],
      ["16 gates of 128x128x48", "many/study.dcm", "ventricle"],
      ["100,000 points", "spring/cloud.ply", "cloud", "--triangles", "5120,1280,320"],
    ]) {
      await page.waitForFunction(() => document.documentElement.dataset.warm === "true", null, { timeout: most_wait });
      await give(page, path.replace(/.*\//, ""), readFileSync(join(work, path)));
      const mine = await saved(page);
      const theirs = await measure_native(words[0], path, "--out", `${path}.native`, "--threads", "1", "--quiet", ...words.slice(1));
      assert_same(mine, `${path}.native`);
      const mb = (bytes) => (bytes / 1e6).toFixed(0);
      table.push([name, mine.seconds.toFixed(1), theirs.seconds.toFixed(1), (mine.seconds / theirs.seconds).toFixed(2), mb(mine.memory), mb(theirs.memory)]);
      assert.ok(mine.memory < 2 * theirs.memory + 64e6, `${name}: ${mb(mine.memory)} MB in the page, ${mb(theirs.memory)} in the native program`);
      await page.click("#result .other");
    }
    for (const row of table) console.log(`     ${row[0].padEnd(24)}${row.slice(1).map((cell) => cell.padStart(11)).join("")}`);
  },

  async "gives every option a control, whose other values the program takes"(page) {
    await page.click("#example-patient");
    await saved(page);
    await page.click("#show-options");
    await page.waitForSelector(".control", { timeout: most_wait });
    const { lines, kinds } = await page.evaluate(() => {
      const [lines, kinds, seen] = [[], {}, new Set()];
      const element = (id) => document.getElementById(id);
      const set = (path, value) => {
        element(`option-${path}`).value = value;
        element(`option-${path}`).dispatchEvent(new Event("change"));
      };
      const note = (kind, path) => {
        element("copy").click();
        lines.push([path, element("copy").dataset.copied]);
        kinds[kind] = (kinds[kind] ?? 0) + 1;
      };
      /** Another value that the control allows. */
      const other = ({ type, min, max, placeholder }) => {
        if (type !== "number") return placeholder.includes(",") ? placeholder.split(",").slice(0, -1).join(",") : "2";
        const [low, high, usual] = [min === "" ? 0 : Number(min), max === "" ? 1e6 : Number(max), Number(placeholder) || 0];
        const near = [usual + 1, usual - 1].find((value) => value >= low && value <= high);
        return String(near ?? (usual + (usual < high ? high : low)) / 2);
      };
      const choose = (choices) => {
        element("reset").click();
        for (const [path, value] of choices) set(path, value);
      };
      /** All controls that these choices show and none before did. */
      const visit = (choices) => {
        choose(choices);
        const paths = [...document.querySelectorAll(".control")].filter((box) => !box.dataset.path.startsWith("manual."));
        const fresh = paths.filter((box) => !seen.has(box.textContent) && seen.add(box.textContent)).map((box) => box.dataset.path);
        for (const path of fresh) {
          choose(choices);
          const field = element(`option-${path}`);
          if (field.tagName === "SELECT")
            for (const { value } of [...field.options].filter((option) => !option.selected)) {
              choose([...choices, [path, value]]);
              note("choice", path);
              visit([...choices, [path, value]]);
            }
          else {
            set(path, other(field));
            note(field.type === "number" ? "number" : "words", path);
          }
        }
      };
      visit([]);
      element("reset").click();
      return { lines, kinds };
    });
    for (const [path, line] of lines) {
      const sets = [...line.matchAll(/--set (\S+)/g)].flatMap(([, set]) => ["--set", set]);
      assert.ok(sets.length > 0, `${path} changed nothing: ${line}`);
      assert.equal(spawnSync(native, ["options", "ventricle", "--as-file", ...sets], { encoding: "utf8" }).stderr, "", line);
    }
    console.log(`     ${JSON.stringify(kinds)}`);
    assert.ok(kinds.choice > 50 && kinds.number > 100 && kinds.words > 3, JSON.stringify(kinds));
  },

  async "changes an option by its control, and repeats it by the command line it copies"(page) {
    await page.click("#example-patient");
    const first = (await saved(page)).json;
    await page.emulateMedia({ colorScheme: "dark" }); // Firefox's driver cannot, and stays light
    const theme = await page.evaluate(() => (matchMedia("(prefers-color-scheme: light)").matches ? "dark" : "light"));
    const is_chosen = (chosen) => document.documentElement.dataset.theme === chosen;
    await (await report_is_drawn(page)).locator("#theme").click();
    await page.waitForFunction(is_chosen, theme, { timeout: 10_000 });
    await page.click("#show-options");
    await page.waitForSelector(".control", { timeout: most_wait });
    assert.deepEqual(await paleTexts(page), [], "texts that are hard to see");
    await page.fill("#search", "sigma");
    await enter(page.locator('[data-path="edges.sigma_px"] input'), "1.4");
    await page.click("#copy");
    const line = await page.getAttribute("#copy", "data-copied");
    assert.equal(line, "dynasurf ventricle STUDY --out RESULT --set edges.sigma_px=1.4");
    await shoot(page, "options");
    await page.click("#again");
    await until_view(page, "working", "failure");
    const mine = await saved(page);
    const again = await report_is_drawn(page);
    await again.waitForFunction(is_chosen, theme, { timeout: 10_000 });
    const words = line.replace("STUDY", "patient/study.dcm").replace("RESULT", "patient/changed").split(" ").slice(1);
    run_native(...words);
    assert_same(mine, "patient/changed");
    const edge = "/readings/edge/edv_ml"; // the fit goes its own way from any start
    assert.notEqual(numbers_of(mine.json).get(edge), numbers_of(first).get(edge), "the option changed nothing");
  },

  async "corrects the valve plane by hand as the native program does, undoes it, and compares"(page) {
    await page.click("#example-patient");
    const first = (await saved(page)).json;
    let frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    assert.ok(await frame.locator("#hand-run").isDisabled(), "nothing is said, yet it can be run");
    await frame.fill("#hand-base_shift_mm", "-10");
    await frame.press("#hand-base_shift_mm", "Enter");
    await shoot(page, "by-hand");
    await frame.click("#hand-run");
    await until_view(page, "working");
    const mine = await saved(page);
    run_native("ventricle", "patient/study.dcm", "--out", "patient/moved", "--set", "manual.base_shift_mm=-10");
    assert_same(mine, "patient/moved");
    const less = first.edv_ml - mine.json.edv_ml; // 10 mm of a cavity some 46 mm wide
    assert.ok(less > 13 && less < 20, `${less} mL less`);
    frame = await report_is_drawn(page);
    assert.match(await frame.locator("#verdict").innerText(), /Changed by hand: valve plane moved by -10 mm/);
    await frame.waitForFunction(() => !document.getElementById("before-legend").hidden);
    const compared = () => page.locator("#compared").innerText();
    assert.equal(await compared(), `EDV ${mine.json.edv_ml.toFixed(1)} mL (before ${first.edv_ml.toFixed(1)}), EF ${mine.json.ef_percent.toFixed(1)} % (${first.ef_percent.toFixed(1)})`);
    await page.click("#show-history");
    assert.equal(await page.locator("#runs li").count(), 2);
    await enter(page.locator("#runs li:nth-child(2) input[type=text]"), "Lower valve");
    await shoot(page, "history");
    await page.click("#undo");
    frame = await report_is_drawn(page);
    assert.ok(!(await frame.locator("#verdict").innerText()).includes("Changed by hand"));
    assert.deepEqual(numbers_of((await saved(page)).json), numbers_of(first));
    await page.keyboard.press("Control+Shift+Z");
    await page.waitForFunction(() => document.querySelector("#runs li:nth-child(2)")?.getAttribute("aria-current") === "true");
    assert.equal(await page.inputValue("#runs li:nth-child(2) input[type=text]"), "Lower valve");
    assert.deepEqual(numbers_of((await saved(page)).json), numbers_of(mine.json));
  },

  async "paints out a place, and gives the mask that repeats it"(page) {
    await drop(page, [{ name: "study.dcm", bytes: readFileSync(join(work, "patient/study.dcm")) }]);
    const first = await saved(page);
    const frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    await frame.click("#hand-paint");
    const canvas = frame.locator("canvas.large");
    await canvas.scrollIntoViewIfNeeded();
    const box = await canvas.boundingBox();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.2 * box.height);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.2 * box.height, { steps: 4 });
    await page.mouse.up();
    assert.deepEqual(await canvas.boundingBox(), box, "the slice moves under the brush");
    assert.match(await frame.locator("#hand .hand-state").innerText(), /1 changed by hand · \d+ mL painted out/);
    await shoot(page, "painted");
    await frame.click("#hand-run");
    await until_view(page, "working");
    const mine = await saved(page);
    writeFileSync(join(work, "mask.nrrd"), mine.files["mask.nrrd"]);
    run_native("ventricle", "patient/study.dcm", "--out", "patient/painted", "--mask", "mask.nrrd");
    assert_same(mine, "patient/painted");
    assert.notDeepEqual(numbers_of(mine.json), numbers_of(first.json), "paint on the wall changed nothing");
    const again = await report_is_drawn(page);
    assert.match(await again.locator("#verdict").innerText(), /Changed by hand: mask/);
    await again.waitForFunction(() => !document.getElementById("hand").hidden); // where the user was
    assert.match(await again.locator("#hand .hand-state").innerText(), /mL painted out/);
    assert.ok(await again.locator("#hand-run").isDisabled(), "what was run counts as changed");
    // The zip archive and the study give the paint back.
    const zip = (await downloaded(page, "#save-zip")).bytes;
    await page.click("#result .other");
    await drop(page, [{ name: "result.zip", bytes: zip }, { name: "study.dcm", bytes: readFileSync(join(work, "patient/study.dcm")) }]);
    await until_view(page, "result", "failure");
    assert.equal(await page.innerText("#summary"), "Opened: dynasurf-result");
    const opened = await report_is_drawn(page);
    await opened.click("#toggle-hand");
    await opened.waitForFunction(() => /mL painted out/.test(document.querySelector("#hand .hand-state").textContent));
    assert.deepEqual((await saved(page)).files["mask.nrrd"], mine.files["mask.nrrd"]);
  },

  async "moves a point of a border, which the fit goes through as the native program does"(page) {
    await page.click("#example-patient");
    const first = (await saved(page)).json;
    const frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    await frame.click("#hand-border");
    const canvas = frame.locator("canvas.large");
    await canvas.scrollIntoViewIfNeeded();
    const box = await canvas.boundingBox();
    const [y, step] = [box.y + 0.5 * box.height, 2];
    let x = box.x + 0.5 * box.width;
    for (const end = box.x + box.width; x < end; x += step) {
      await page.mouse.move(x, y);
      if ((await canvas.evaluate((element) => element.style.cursor)) === "grab") break;
    }
    await page.mouse.down();
    await page.mouse.move(x + 16, y, { steps: 4 });
    await page.mouse.up();
    const numbers = await frame.inputValue("#hand-endo_points");
    assert.match(numbers, /^\d(,-?[\d.]+){3}$/, "the first wall from the middle is the inner one");
    const gate = Number(numbers[0]) - 1;
    await shoot(page, "border-point");
    await frame.click("#hand-run");
    await until_view(page, "working");
    const mine = await saved(page);
    run_native("ventricle", "patient/study.dcm", "--out", "patient/point", "--set", `manual.endo_points=${numbers}`);
    assert_same(mine, "patient/point");
    assert.ok(mine.json.gates[gate].endo_ml > first.gates[gate].endo_ml + 0.2, "the cavity is not larger");
    const again = await report_is_drawn(page);
    assert.match(await again.locator("#verdict").innerText(), /Changed by hand: 1 point of the inner border/);
    await again.waitForFunction(() => !document.getElementById("hand").hidden);
    assert.equal(await again.inputValue("#hand-endo_points"), numbers);
    await shoot(page, "border-moved");
  },

  async "shows borders and fields while options and handles move, as the native program finds them"(page) {
    await page.click("#example-patient");
    await saved(page);
    const frame = await report_is_drawn(page);
    await frame.evaluate(() => addEventListener("message", ({ data }) => data.word === "borders" && (window.heard = data.found)));
    /** What is packed may differ, and its content not. */
    const unpacked = (text) => JSON.parse(text, (key, value) => (/^(marks|border|directions|lengths)$/.test(key) ? inflateSync(Buffer.from(value, "base64")).toString("base64") : value));
    const same_as_native = async (...words) => {
      await frame.waitForFunction(() => window.heard, null, { timeout: most_wait });
      const { text, seconds } = await frame.evaluate(() => window.heard);
      const found = unpacked(text);
      const printed = execFileSync(native, ["borders", "patient/study.dcm", "--json", "--gate", String(found.gate), ...words], { cwd: work, encoding: "utf8", maxBuffer: 1e8 });
      assert.deepEqual(found, unpacked(printed));
      const warnings = found.notes.filter(({ severity }) => severity !== "info").map(({ message }) => message);
      const expected = [`Borders of gate ${found.gate} as they would be found (${seconds.toFixed(2)} s)`, ...warnings].join(" · ");
      await frame.waitForFunction((text) => document.getElementById("preview").textContent === text, expected, { timeout: most_wait });
      console.log(`     ${seconds.toFixed(2)} s`);
    };
    await page.click("#show-options");
    await page.waitForSelector(".control", { timeout: most_wait });
    await page.fill("#search", "sigma");
    await enter(page.locator('[data-path="edges.sigma_px"] input'), "2.5");
    await same_as_native("--set", "edges.sigma_px=2.5");
    await shoot(page, "preview");
    // The heart is where it was.
    for (const sigma of ["1.5", "1.6", "1.7", "1.8"]) {
      await frame.evaluate(() => (window.heard = null));
      await enter(page.locator('[data-path="edges.sigma_px"] input'), sigma);
      await same_as_native("--set", `edges.sigma_px=${sigma}`);
    }
    await frame.evaluate(() => (window.heard = null));
    await page.fill("#search", "last_slice");
    await enter(page.locator('[data-path="manual.last_slice"] input'), "6");
    await same_as_native("--set", "edges.sigma_px=1.8", "--set", "manual.last_slice=6");
    assert.match(await frame.locator("#preview").innerText(), /The endo border was found in no slice/);
    await page.fill("#search", "first_slice");
    await enter(page.locator('[data-path="manual.first_slice"] input'), "9");
    const refused = "No preview: option manual.first_slice is 9 and manual.last_slice 6; expected the first, nearer to the apex, not to lie after the last";
    await frame.waitForFunction((text) => document.getElementById("preview").textContent === text, refused, { timeout: most_wait });
    await page.click("#reset");
    await frame.waitForFunction(() => window.heard === null);
    assert.equal(await frame.locator("#preview").innerText(), "");
    await page.click("#show-options");
    await frame.click("#toggle-hand");
    await frame.fill("#hand-radius_mm", "40");
    await frame.press("#hand-radius_mm", "Enter");
    await same_as_native("--set", "manual.radius_mm=40");
  },

  async "tells why there is no preview where its program cannot start"(page) {
    await page.click("#example-patient");
    await saved(page);
    const frame = await report_is_drawn(page);
    await page.evaluate(() => {
      const Plain = Worker;
      Worker = class extends Plain {
        constructor() {
          super(URL.createObjectURL(new Blob(["throw new Error('no room')"], { type: "text/javascript" })));
        }
      };
    });
    await frame.click("#toggle-hand");
    await frame.fill("#hand-radius_mm", "40");
    await frame.press("#hand-radius_mm", "Enter");
    await frame.waitForFunction(() => document.getElementById("preview").textContent, null, { timeout: most_wait });
    assert.match(await frame.locator("#preview").innerText(), /^No preview: The program stopped unexpectedly \(.*no room\)\.$/);
  },

  async "does again what a change touches, as the native program does all of it"(page) {
    const again = async (path, value) => {
      await page.fill("#search", path);
      await enter(page.locator(`[data-path="${path}"] input`), value);
      await page.click("#again");
      await until_view(page, "working");
      const mine = await saved(page);
      console.log(`     ${path}: ${mine.seconds.toFixed(2)} s, ${(mine.memory / 1e6).toFixed(0)} MB`);
      return mine;
    };
    const options = async () => {
      await page.click("#show-options");
      await page.waitForSelector(".control", { timeout: most_wait });
    };
    await page.click("#example-patient");
    const whole = await saved(page);
    console.log(`     all: ${whole.seconds.toFixed(2)} s, ${(whole.memory / 1e6).toFixed(0)} MB`);
    await options();
    const settings = [];
    for (const [path, value, stages] of [
      ["measures.waves", "2", ["measures"]],
      ["fit.thickness_mm", "9", ["readings", "fit", "measures"]],
      ["evolution.force.strength", "3e-5", ["field", "surfaces", "settling", "measures", "readings", "fit"]],
      // Whether the wall is light is asked of the edges.
      ["edges.sigma_px", "1.8", ["locate", "valve plane", "edges", "labels", "field", "surfaces", "settling", "measures", "readings", "fit"]],
    ]) {
      settings.push("--set", `${path}=${value}`);
      const mine = await again(path, value);
      run_native("ventricle", "patient/study.dcm", "--out", "patient/again", "--replace", "--threads", "1", ...settings);
      assert_same(mine, "patient/again");
      assert.deepEqual(new Set(Object.keys(mine.json.timings_s)), new Set(stages), path);
      if (stages.length === 1) assert.ok(mine.seconds < 0.5 * whole.seconds, "no faster than all of it");
    }
    await page.click("#result .other");
    await page.click("#example-vase");
    const levels = await saved(page);
    assert.ok(levels.json.timings_s.inside > 0);
    await options();
    const coarser = await again("triangles", "5120,640");
    assert.equal(coarser.json.timings_s.inside, undefined);
    run_native("phantom", "cloud", "--set", "shape=vase", "--set", "points=30000", "--set", "noise_percent=0.1", "--out", "again", "--replace", "--quiet");
    run_native("cloud", "again/cloud.ply", "--out", "again/native", "--triangles", "5120,640", "--replace", "--threads", "1");
    assert_same(coarser, "again/native");
  },

  async "records what a reader decides, and changes no number"(page) {
    await page.click("#example-patient");
    const first = (await saved(page)).json;
    const frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    await frame.click("#hand-accepted");
    await frame.fill("#hand-reader", "A. Reader");
    await frame.press("#hand-reader", "Enter");
    await frame.click("#hand-run");
    await until_view(page, "working");
    const mine = (await saved(page)).json;
    assert.deepEqual(numbers_of(mine), numbers_of(first));
    assert.equal(mine.provenance.options.manual.decision, "accepted");
    const again = await report_is_drawn(page);
    assert.match(await again.locator("#verdict .decision").innerText(), /Accepted by A\. Reader/);
    assert.ok(!(await again.locator("#verdict").innerText()).includes("Changed by hand"));
    await shoot(page, "accepted");
  },

  async "saves what it shows as DICOM objects of the patient's study, as the native program does"(page) {
    run_native("ventricle", "patient/study.dcm", "--dicom", "--out", "patient/dicom", "--threads", "1", "--quiet");
    await give(page, "study.dcm", readFileSync(join(work, "patient/study.dcm")));
    await saved(page);
    // On a phone too the menu opens within the window.
    const usual = page.viewportSize();
    await page.setViewportSize({ width: 390, height: 800 });
    await page.click("#save summary");
    const { x, width } = await page.locator("#save div").boundingBox();
    assert.ok(x >= 0 && x + width <= 390, `the menu stands from ${x} to ${x + width}`);
    await page.keyboard.press("Escape");
    assert.ok(await page.locator("#save div").isHidden());
    await page.setViewportSize(usual);
    const files = unzipSync((await downloaded(page, "#save-dicom", most_wait)).bytes);
    assert.equal(await view(page), "result");
    const folder = join(work, "patient/dicom/dicom");
    assert.deepEqual(Object.keys(files).sort(), readdirSync(folder).sort().map((name) => `dynasurf-dicom/${name}`));
    // UIDs hold the time; masks and surfaces end a file.
    for (const [name, bytes] of Object.entries(files)) {
      assert.ok(Buffer.from(bytes).includes("PHANTOM^DYNASURF"), `${name} names nobody`);
      const theirs = readFileSync(join(folder, name.split("/")[1]));
      if (!name.includes("measurements")) assert.deepEqual(Buffer.from(bytes).subarray(-10000), theirs.subarray(-10000), name);
    }
    const report = Buffer.from(files["dynasurf-dicom/measurements.dcm"]);
    assert.ok(report.includes(String(Math.round(1000 * results_of("patient/dicom").edv_ml) / 1000)), "the report tells other volumes");
  },

  async "saves itself with the study and its result inside, and that page shows it at once and does it all again"(page, context) {
    await page.click("#example-patient");
    await saved(page);
    let frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    await frame.click("#hand-exclude");
    await frame.click("#hand-run");
    await until_view(page, "working");
    const first = await saved(page);
    assert.equal(first.json.provenance.options.manual.exclude_gates.length, 1);
    const path = join(work, "study.html");
    writeFileSync(path, (await downloaded(page, "#save-page")).bytes);
    const other = await context.newPage();
    await other.goto(`file://${path}`);
    assert.deepEqual((await saved(other)).files, first.files, "the result is another one");
    frame = await report_is_drawn(other);
    assert.match(await frame.locator("#verdict").innerText(), /Changed by hand: without gate \d/);
    await other.click("#show-options");
    await other.click("#again");
    await until_view(other, "working");
    assert.deepEqual(numbers_of((await saved(other)).json), numbers_of(first.json));
    console.log(`     ${statSync(path).size} bytes`);
    await other.close();
  },

  async "keeps the runs when another one cannot be done"(page) {
    await page.click("#example-patient");
    const first = (await saved(page)).json;
    let frame = await report_is_drawn(page);
    await frame.click("#toggle-hand");
    await frame.fill("#hand-exclude_gates", "1,2,3,4,5");
    await frame.press("#hand-exclude_gates", "Enter");
    await frame.click("#hand-run");
    await until_view(page, "failure");
    assert.match(await reason(page), /exclude_gates names more than half of the 8 gates/);
    await page.click("#back");
    assert.deepEqual(numbers_of((await saved(page)).json), numbers_of(first));
    frame = await report_is_drawn(page);
    assert.equal(await frame.inputValue("#hand-exclude_gates"), "1,2,3,4,5", "what was said is lost");
    await frame.click("#hand-undo");
    assert.equal(await frame.inputValue("#hand-exclude_gates"), "");
  },

  async "compares with the run that is chosen, and keeps what was not run yet"(page) {
    await page.click("#example-patient");
    await saved(page);
    for (const mm of [-14, 6]) {
      const frame = await report_is_drawn(page);
      if (mm < 0) await frame.click("#toggle-hand");
      await frame.waitForFunction(() => !document.getElementById("hand").hidden); // after a run it opens again
      await frame.fill("#hand-base_shift_mm", String(mm));
      await frame.press("#hand-base_shift_mm", "Enter");
      await frame.click("#hand-run");
      await until_view(page, "working");
      await saved(page);
    }
    const frame = await report_is_drawn(page);
    const compared = (n) => page.locator(`#runs li:nth-child(${n}) input[name=compared]`).click();
    const picture = () =>
      frame.evaluate(() => {
        const canvas = document.querySelector(".long canvas");
        return canvas.toDataURL();
      });
    await page.click("#show-history");
    await frame.waitForFunction(() => !document.getElementById("before-legend").hidden);
    await frame.fill("#hand-radius_mm", "44");
    await frame.press("#hand-radius_mm", "Enter");
    const lower = await picture();
    await compared(1);
    await page.waitForTimeout(1500);
    const as_found = await picture();
    assert.notEqual(as_found, lower, "the outlines are those of another run");
    await compared(2);
    await page.waitForTimeout(1500);
    assert.equal(await picture(), lower);
    await compared(2);
    await frame.waitForFunction(() => document.getElementById("before-legend").hidden);
    assert.equal(await page.locator("#compared").innerText(), "");
    assert.equal(await frame.inputValue("#hand-radius_mm"), "44");
  },

  async "lists several studies with a picture each, opens one, and comes back"(page) {
    run_native("phantom", "patient", "--seed", "2", "--out", "other", "--quiet");
    run_native("ventricle", "other/study.dcm", "--out", "other/native");
    const files = ["patient", "other"].map((name) => ({ name: `${name}.dcm`, bytes: readFileSync(join(work, name, "study.dcm")) }));
    await drop(page, [...files, { name: "letter.txt", bytes: Buffer.from("no image\n") }]);
    await until_view(page, "studies", "failure");
    assert.deepEqual(await page.locator("#study-list b").allInnerTexts(), ["other.dcm", "patient.dcm"]);
    assert.match(await page.locator("#study-list span").first().innerText(), /^8 gates of 64 x 64 x 23, short axis/);
    await page.waitForFunction(() => document.querySelectorAll('#study-list li[data-drawn="true"]').length === 2, null, { timeout: most_wait });
    const bright = await page.evaluate(() =>
      [...document.querySelectorAll("#study-list canvas")].map((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return data.reduce((count, v, n) => count + (n % 4 === 0 && v > 128 ? 1 : 0), 0);
      }),
    );
    assert.ok(bright.every((n) => n > 50), `pictures with ${bright} bright pixels`);
    await shoot(page, "studies");
    await page.click("#study-list li:first-child button");
    assert_same(await saved(page), "other/native");
    await page.click("#result .to-list");
    assert.equal(await view(page), "studies");
    await page.click("#studies .other");
    assert.equal(await view(page), "start");
  },

  async "shows rest and stress side by side, in one beat, with the difference of their maps"(page) {
    const described = (folder, word) => {
      const bytes = Buffer.from(readFileSync(join(work, folder, "study.dcm")));
      const at = bytes.indexOf("Dynasurf phantom patient");
      assert.ok(at > 0);
      bytes.write(word.padEnd(24), at, "latin1");
      writeFileSync(join(work, `${word}.dcm`), bytes);
      return { name: `${word}.dcm`, bytes };
    };
    run_native("phantom", "patient", "--seed", "3", "--set", "ef_percent=45", "--out", "weak", "--quiet");
    await drop(page, [described("weak", "STRESS"), described("patient", "REST")]);
    await until_view(page, "studies", "failure");
    assert.ok(await page.locator("#open-beside").isDisabled(), "nothing is chosen");
    for (const box of await page.locator("#study-list input").all()) await box.check();
    await page.click("#open-beside");
    await until_view(page, "beside", "failure");
    assert.equal(await view(page), "beside", await reason(page));
    for (const word of ["REST", "STRESS"]) run_native("ventricle", `${word}.dcm`, "--out", `both/${word}`);
    run_native("perfusion", "compare", "both/REST", "both/STRESS", "--out", "both/difference");
    assert.match(await page.locator("#first-title").innerText(), /^REST\.dcm .*, rest$/);
    const [rest, stress] = ["both/REST", "both/STRESS"].map(results_of);
    assert.ok((await page.locator("#beside-numbers").innerText()).includes(`EF ${rest.ef_percent.toFixed(1)} → ${stress.ef_percent.toFixed(1)} %`));
    const frames = [];
    for (const id of ["first", "second"]) frames.push(await report_is_drawn(page, id));
    await shoot(page, "pair");
    for (const [leader, other] of [frames, [...frames].reverse()]) {
      for (const key of ["ArrowRight", "ArrowRight", "ArrowRight"]) await leader.locator("#theme").press(key);
      const gate = await leader.evaluate(() => document.documentElement.dataset.gate);
      await other.waitForFunction((of) => document.documentElement.dataset.gate === of, gate, { timeout: 10_000 });
      const theme = leader === frames[0] ? "dark" : "light";
      await leader.locator("#theme").press("l");
      for (const all of [other, page]) await all.waitForFunction((of) => document.documentElement.dataset.theme === of, theme, { timeout: 10_000 });
    }
    await page.click("#show-difference");
    const heading = page.frameLocator("#both").locator("h1");
    assert.equal(await heading.innerText(), "Left ventricle, rest and stress");
    await page.waitForTimeout(500); // to paint
    await shoot(page, "difference");
    const files = unzipSync((await downloaded(page, "#save-beside")).bytes);
    const theirs = JSON.parse(readFileSync(join(work, "both/difference/comparison.json"), "utf8"));
    assert.deepEqual(numbers_of(JSON.parse(new TextDecoder().decode(files["both/comparison.json"]))), numbers_of(theirs));
    await page.selectOption("#language", "de");
    await page.frameLocator("#both").locator("h1", { hasText: "Linker Ventrikel, Ruhe und Belastung" }).waitFor();
    const texts = await page.frameLocator("#both").locator("html").evaluateAll(([html]) => html.innerText.split("\n"));
    assert.deepEqual(notGerman(texts), []);
    assert.match(await page.locator("#first-title").innerText(), /Phasen von .*, Ruhe$/);
    await shoot(page, "german-difference");
  },

  async "shows four results side by side in one beat, and no more"(page) {
    await page.emulateMedia({ reducedMotion: "reduce" }); // four beats drawn without a graphics card take all of a processor
    small_study();
    rmSync(join(work, "several"), { recursive: true, force: true });
    mkdirSync(join(work, "several"));
    const names = ["a", "b", "c", "d", "e"];
    for (const [n, name] of names.entries())
      run_native("ventricle", "small/study.nii.gz", "--out", `several/${name}`, "--preset", "edges", "--set", `edges.sigma_px=${1.5 + 0.2 * n}`, "--quiet");
    await drag(page, ["several"]);
    await until_view(page, "studies", "failure");
    const boxes = await page.locator("#study-list input").all();
    assert.equal(boxes.length, 5);
    for (const box of boxes) await box.check();
    assert.ok(await page.locator("#open-beside").isDisabled(), "five are too many");
    await boxes[4].uncheck();
    await page.click("#open-beside");
    await until_view(page, "beside", "failure");
    const ids = ["first", "second", "third", "fourth"];
    const frames = [];
    for (const id of ids) frames.push(await report_is_drawn(page, id));
    const titles = await Promise.all(ids.map((id) => page.innerText(`#${id}-title`)));
    const shown = titles.map((title) => title.split(" · ")[0]);
    assert.deepEqual(shown, ["a", "b", "c", "d"]);
    const edv = shown.map((name) => results_of(`several/${name}`).edv_ml.toFixed(1));
    assert.ok((await page.innerText("#beside-numbers")).startsWith(`EDV ${edv.join(" → ")} mL · ESV`));
    await frames[2].locator("#theme").press("ArrowRight");
    const gate = await frames[2].evaluate(() => document.documentElement.dataset.gate);
    for (const frame of frames) await frame.waitForFunction((of) => document.documentElement.dataset.gate === of, gate, { timeout: 10_000 });
    await shoot(page, "beside");
    const saved = Object.keys(unzipSync((await downloaded(page, "#save-beside")).bytes));
    for (const id of ids) assert.ok(saved.includes(`${id}/results.json`), id);
    await page.click("#beside .to-list");
    const two = await page.locator("#study-list input").all();
    for (const [n, box] of two.entries()) await box.setChecked(n < 2);
    await page.click("#open-beside");
    await until_view(page, "beside", "failure");
    await report_is_drawn(page, "second");
    assert.equal(await page.locator("#beside .half").count(), 2);
    assert.match(await page.innerText("#beside-numbers"), /^EDV .* mL \([+−][\d.]+\) · ESV/);
  },

  async "takes a header with its voxels beside it, and scans by every ending"(page) {
    const whole = gunzipSync(readFileSync(join(work, "patient/study.nii.gz")));
    const header = Buffer.from(whole.subarray(0, 348));
    header.writeFloatLE(0, 108);
    header.write("ni1\0", 344, "latin1");
    writeFileSync(join(work, "pair.hdr"), header);
    writeFileSync(join(work, "pair.img"), whole.subarray(352));
    await drop(page, [{ name: "pair.img", bytes: whole.subarray(352) }, { name: "pair.hdr", bytes: header }]);
    const mine = await saved(page);
    run_native("ventricle", "pair.hdr", "--out", "pair");
    assert_same(mine, "pair");
    for (const name of ["a.pcd", "a.ptx"]) {
      writeFileSync(join(work, name), "no scan\n");
      const judged = spawnSync(native, ["cloud", name, "--out", "scan"], { cwd: work, encoding: "utf8" });
      await page.locator(".other:visible").click();
      await give(page, name, Buffer.from("no scan\n"));
      await until_view(page, "failure");
      assert.equal(await reason(page), /error: (.*)/.exec(judged.stderr)[1]);
    }
  },

  async "reads a study that `dynasurf view` put into it, with options, and a result with its study"(page, context) {
    run_native("ventricle", "patient/study.dcm", "--out", "patient/plain");
    run_native("ventricle", "patient/study.dcm", "--out", "patient/edges", "--preset", "edges", "--set", "manual.exclude_gates=2");
    const viewed = async (words, look) => {
      execFileSync(native, ["view", ...words, "--page", page_path, "--out", "viewed.html", "--replace"], { cwd: work });
      const other = await context.newPage();
      await other.goto(`file://${join(work, "viewed.html")}`);
      await look(other);
      await other.close();
    };
    await viewed(["patient/study.dcm"], async (other) => assert_same(await saved(other), "patient/plain"));
    const options = ["--options", "patient/edges/options.json"];
    await viewed(["patient/study.dcm", ...options], async (other) => assert_same(await saved(other), "patient/edges"));
    await viewed(["patient/edges"], async (other) => {
      const begin = performance.now();
      const shown = await saved(other);
      console.log(`     a result in its page is there after ${((performance.now() - begin) / 1000).toFixed(1)} s`);
      assert.ok(Buffer.from(shown.files["dynasurf-result/results.json"]).equals(readFileSync(join(work, "patient/edges/results.json"))));
      assert.equal(await other.innerText("#summary"), "Opened: edges");
      await report_is_drawn(other);
      await other.click("#show-options");
      await other.waitForSelector(".control", { timeout: most_wait });
      await other.click("#again");
      await until_view(other, "working");
      assert_same(await saved(other), "patient/edges");
    });
  },

  async "takes results: alone, with their study later, several as a list, two side by side; and options.json"(page) {
    const read = (folder, ...names) => names.map((name) => ({ name, bytes: readFileSync(join(work, folder, name)) }));
    await drop(page, read("patient/edges", "report.html", "results.json", "options.json"));
    await until_view(page, "result");
    let frame = await report_is_drawn(page);
    assert.match(await page.innerText("#summary"), /drop its study here too/);
    assert.ok(await frame.isHidden("#hand-run"), "a study that is not here cannot be run");
    await drop(page, read("patient", "study.dcm"));
    await page.waitForFunction(() => document.getElementById("summary").textContent === "Opened: result", null, { timeout: most_wait });
    frame = await report_is_drawn(page);
    // What is said by hand stands in both places, and in the file of options before it is run.
    await page.click("#show-options");
    await page.waitForSelector(".control", { timeout: most_wait });
    await enter(page.locator('[data-path="manual.radius_mm"] input'), "61");
    await enter(page.locator('[data-path="manual.center_mm"] input'), "1,2"); // a place has three numbers
    await frame.click("#toggle-hand");
    await frame.waitForFunction(() => document.getElementById("hand-radius_mm").value === "61");
    await enter(frame.locator("#hand-last_slice"), "18");
    await page.waitForFunction(() => document.querySelector('[data-path="manual.last_slice"] input').value === "18");
    assert.equal(await page.inputValue('[data-path="manual.center_mm"] input'), "1,2", "what was typed is gone");
    await page.click("#again");
    assert.ok(await page.evaluate(() => document.activeElement.closest(".control")?.dataset.path === "manual.center_mm"), "it is not told");
    await enter(page.locator('[data-path="manual.center_mm"] input'), "");
    const file = JSON.parse((await downloaded(page, "#save-options")).bytes);
    assert.equal(file.manual.center_mm, null);
    assert.deepEqual([file.manual.radius_mm, file.manual.last_slice, file.manual.exclude_gates], [61, 18, [2]]);
    await drop(page, [{ name: "options.json", bytes: Buffer.from('{"edges": {"method": "canny", "sigma_px": 2}}') }]);
    await page.waitForFunction(() => document.getElementById("changed").textContent === "1 changed");
    await frame.waitForFunction(() => document.getElementById("hand-radius_mm").value === "");
    await drop(page, [{ name: "options.json", bytes: Buffer.from('{"mistake": 1}') }]);
    await until_view(page, "failure");
    assert.match(await reason(page), /^options\.json: unknown option 'mistake'/);
    await page.click("#failure .other");
    await drop(page, [{ name: "options.json", bytes: Buffer.from("{}") }]);
    await until_view(page, "failure");
    assert.equal(await reason(page), "options.json: options without a study; drop both together, or first the study");
    await page.click("#failure .other");
    // All of it at once, without a folder.
    await drop(page, [...read("patient/edges", "report.html", "results.json", "options.json"), ...read("patient", "study.dcm")]);
    await until_view(page, "result", "failure");
    assert.equal(await page.innerText("#summary"), "Opened: result");
    await page.click("#result .other");
    // A scan beside a study is not forgotten.
    const points = Array.from({ length: 60 }, (_, n) => `${n} ${n * n} 1`).join("\n");
    await drop(page, [...read("patient", "study.dcm"), { name: "scan.xyz", bytes: Buffer.from(points) }]);
    await until_view(page, "studies", "failure");
    assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll("#study-list b")].map((name) => name.textContent)), ["study.dcm", "scan.xyz"]);
    await page.click("#studies .other");
    // A folder of results: a list, and two of them side by side.
    mkdirSync(join(work, "cohort"), { recursive: true });
    for (const name of ["plain", "edges"]) cpSync(join(work, "patient", name), join(work, "cohort", name), { recursive: true });
    await drag(page, ["cohort"]);
    await until_view(page, "studies", "failure");
    await page.waitForFunction(() => document.querySelectorAll('#study-list li[data-drawn="true"]').length === 2, null, { timeout: most_wait });
    const edv = results_of("patient/plain").edv_ml.toFixed(1);
    assert.ok((await page.innerText("#study-list")).includes(`EDV ${edv} mL`));
    await shoot(page, "results");
    for (const box of await page.$$("#study-list input")) await box.check();
    await page.click("#open-beside");
    await until_view(page, "beside", "failure");
    await report_is_drawn(page, "first");
    await report_is_drawn(page, "second");
    assert.ok((await page.innerText("#beside-numbers")).includes(edv));
    await page.click("#beside .to-list");
    await page.click("#study-list li:first-child button");
    await until_view(page, "result", "failure");
    assert.match(await page.innerText("#summary"), /^Opened: (plain|edges)\. To run it again/);
    // One whose report is not this program's.
    const other = Buffer.from(readFileSync(join(work, "patient/plain/report.html"), "utf8").replace(/script-src 'sha256-./, "script-src 'sha256-_"));
    await drop(page, [...read("patient/plain", "results.json"), { name: "report.html", bytes: other }]);
    await until_view(page, "failure");
    assert.match(await reason(page), /made by another version/);
  },

  async "records on request how the meshes moved, and makes contours"(page) {
    await page.click("#example-patient");
    await saved(page);
    let frame = await report_is_drawn(page);
    for (const [record, panel, setting] of [["motion", "#motion-panel", "evolution.trajectory_every=5"], ["contours", "#contours-panel", "pipeline=contour"]]) {
      assert.ok(await frame.isHidden(panel));
      await frame.click(`#record-${record}`);
      await until_view(page, "working");
      await until_view(page, "result", "failure");
      frame = await report_is_drawn(page);
      await frame.waitForFunction((of) => Math.abs(document.querySelector(of).getBoundingClientRect().top) < 120, panel);
      assert.ok((await page.evaluate(() => [...document.querySelectorAll("#runs input[type=text]")].at(-1).value)).includes(setting));
      await shoot(page, `record-${record}`);
    }
    assert.ok(await frame.isHidden("#record-panel"));
  },

  async "refuses a study that is too large in the program's line, and goes on"(page) {
    const head = (sizes) => `NRRD0004\ntype: float\ndimension: 3\nsizes: ${sizes}\nencoding: gzip\n\n`;
    await give(page, "huge.nrrd", Buffer.from(head("1200 1200 1200") + "x".repeat(100_000)));
    await until_view(page, "failure");
    assert.match(await reason(page), /^huge.nrrd: declares 1200 x 1200 x 1200 voxels x 1 gates; at most 2048 MiB/);
    await page.click("#failure .other");
    await page.click("#example-vase");
    await saved(page);
  },

  async "tells that memory ended, and goes on"(page, context) {
    const other = await context.newPage();
    // A program that may have 48 MiB: its worker makes the memory, or the page where threads share it.
    await other.addInitScript(() => {
      const lessMemory = () => {
        const Memory = WebAssembly.Memory;
        WebAssembly.Memory = function (wanted) {
          return new Memory({ ...wanted, maximum: 768 });
        };
      };
      lessMemory();
      const Plain = Blob;
      Blob = class extends Plain {
        constructor(parts, facts) {
          super(facts?.type === "text/javascript" ? [`(${lessMemory})();`, ...parts] : parts, facts);
        }
      };
    });
    await other.goto(page.url());
    await other.click("#example-patient");
    await until_view(other, "failure", "result");
    assert.match(await reason(other), /^Out of memory: (4\d|50) MB were in use\. A smaller study/);
    await other.click("#failure .other");
    await give(other, "small.nii.gz", small_study());
    await saved(other);
    await other.close();
  },

  async "keeps no memory of the studies before, for thirty of them"(page) {
    const bytes = small_study();
    const driver = await page.context().newCDPSession(page);
    const held = async () => {
      await driver.send("HeapProfiler.collectGarbage");
      const { usedSize, embedderHeapUsedSize = 0, backingStorageSize = 0 } = await driver.send("Runtime.getHeapUsage");
      return usedSize + embedderHeapUsedSize + backingStorageSize;
    };
    const after = [];
    await page.emulateMedia({ reducedMotion: "reduce" }); // without a graphics card the beat takes the time of the runs
    for (let n = 1; n <= 30; ++n) {
      await drop(page, [{ name: `study${n}.nii.gz`, bytes }]);
      await until_view(page, "result", "failure");
      await report_is_drawn(page);
      assert.equal(await page.evaluate(() => document.querySelectorAll("#runs li").length), 1, "another study has a history of its own");
      if (n === 10 || n === 30) after.push(await held());
      await page.click("#result .other");
    }
    console.log(`     ${after.map((b) => (b / 1e6).toFixed(0)).join(" and ")} MB after 10 and 30 studies`);
    assert.ok(after[1] < 1.1 * after[0] + 5e6);
  },

  async "stops at once when it is cancelled, and can start anew"(page) {
    await page.click("#example-patient");
    await page.waitForFunction(() => /Surfaces|Borders/.test(document.getElementById("stage").textContent), null, { timeout: most_wait });
    await shoot(page, "working");
    const begin = performance.now();
    await page.click("#cancel");
    await until_view(page, "failure");
    assert.ok(performance.now() - begin < 1000);
    assert.match(await reason(page), /Cancelled/);
    await page.click("#failure .other");
    assert.equal(await view(page), "start");
  },

  async "tells what cannot be read in the program's own line, for 50 damaged files"(page) {
    const whole = readFileSync(join(work, "patient/study.dcm"));
    let seed = 1;
    const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
    let refused = 0;
    for (let n = 0; n < 50; ++n) {
      const bytes = n % 2 ? whole.subarray(0, Math.floor(random() * whole.length)) : Buffer.from(whole.subarray(0, 4000 + n * 50));
      if (n % 2 === 0) for (let k = 0; k < 20; ++k) bytes[Math.floor(random() * bytes.length)] = Math.floor(random() * 256);
      writeFileSync(join(work, "damaged.dcm"), bytes);
      const judged = spawnSync(native, ["ventricle", "damaged.dcm", "--out", `damaged/${n}`, "--threads", "1"], { cwd: work, encoding: "utf8" });
      await give(page, "damaged.dcm", bytes);
      await until_view(page, "result", "failure");
      if (judged.status === 0 || judged.status === 3) assert.equal(await view(page), "result", await reason(page));
      else {
        ++refused;
        assert.equal(await reason(page), /error: (.*)/.exec(judged.stderr)[1]);
      }
      await page.locator(".other:visible").click();
    }
    assert.ok(refused > 25, `only ${refused} were refused`);
    console.log(`     ${refused} of 50 refused, each in the native program's words`);
  },

  async "refuses a damaged archive and an empty file"(page) {
    await give(page, "broken.zip", Buffer.from("PK\x03\x04 and nothing that follows"));
    await until_view(page, "failure");
    assert.match(await reason(page), /broken\.zip: the zip archive is damaged/);
    await page.click("#failure .other");
    await give(page, "empty.dcm", Buffer.alloc(0));
    await until_view(page, "failure");
    assert.match(await reason(page), /^empty\.dcm: /);
    await shoot(page, "failure");
  },

  async "shows the report in German, and saves it in English"(page) {
    await page.selectOption("#language", "de");
    await page.click("#example-patient");
    const { files, json } = await saved(page);
    let frame = await report_is_drawn(page);
    assert.equal(await frame.getAttribute("html", "lang"), "de");
    await frame.click("#toggle-hand");
    await frame.click("#hand-exclude");
    await frame.click("#help");
    const in_german = await saidIn(frame);
    // Names of files, programs and options are nobody's language.
    const options = Object.keys(Object.fromEntries(numbers_of({ options: json.provenance.options })));
    const names = new Set([json.provenance.command, ...options]);
    const is_name = (text) => names.has(text) || /^[\w.-]+$/.test(text);
    const left = notGerman(in_german).filter((text) => !is_name(text));
    assert.deepEqual(left, [], "these are not German");
    assert.ok(in_german.includes("Enddiastolisches Volumen") && in_german.includes("7 mittventrikulär anterior"));
    assert.ok((await frame.locator("#numbers").innerText()).includes(json.edv_ml.toFixed(1).replace(".", ",")), "decimals have a point");
    assert.ok(in_german.length > 250, `only ${in_german.length} texts`);
    await frame.press("body", "Escape");
    await shoot(page, "german-report");
    assert.ok(await page.locator("#language").isDisabled(), "another language would forget what was said by hand");
    await frame.click("#hand-reset");
    const report = (await downloaded(page, "#save-report")).bytes;
    assert.ok(report.equals(Buffer.from(files["dynasurf-result/report.html"])), "the saved report is not that of the engine");
    assert.ok(report.includes('<html lang="en">') && !report.includes('id="words"'));
    await page.selectOption("#language", "en");
    await page.waitForTimeout(500);
    frame = await report_is_drawn(page);
    assert.equal(await frame.getAttribute("html", "lang"), "en");
    const in_english = await saidIn(frame);
    assert.ok(in_english.includes("End-diastolic volume") && notGerman(in_english).length > 100, "the check of German sees no English");
  },

  async "tells why two studies are not compared"(page) {
    // In the second one there is nothing but noise.
    const bytes = Buffer.from(readFileSync(join(work, "patient/study.dcm")));
    const voxels = 2 * 64 * 64 * 23 * 8;
    for (let at = bytes.length - voxels, state = 1; at < bytes.length; at += 2) {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      bytes.writeUInt16LE(state >>> 18, at);
    }
    for (const [name, plain] of [["REST", Buffer.from(readFileSync(join(work, "patient/study.dcm")))], ["STRESS", bytes]]) {
      plain.write(name.padEnd(24), plain.indexOf("Dynasurf phantom patient"), "latin1");
      writeFileSync(join(work, `${name}-or-noise.dcm`), plain);
    }
    await drop(page, ["REST", "STRESS"].map((name) => ({ name: `${name}.dcm`, bytes: readFileSync(join(work, `${name}-or-noise.dcm`)) })));
    await until_view(page, "studies", "failure");
    for (const box of await page.locator("#study-list input").all()) await box.check();
    await page.click("#open-beside");
    await until_view(page, "beside", "failure");
    assert.equal(await page.locator("#beside-complaint").innerText(), "Not compared: STRESS.dcm: has no polar map; expected a result with both walls");
    assert.ok(await page.locator("#show-difference").isHidden());
    await shoot(page, "not-compared");
    await page.selectOption("#language", "de");
    assert.match(await page.locator("#beside-complaint").innerText(), /^Nicht verglichen: STRESS\.dcm: hat keine Polarkarte/);
    assert.match(await page.locator("#beside-complaint").getAttribute("title"), /^STRESS\.dcm: has no polar map/);
  },

  async "describes options in German, and finds them in both languages"(page) {
    await page.selectOption("#language", "de");
    await page.click("#example-patient");
    await saved(page);
    await page.click("#show-options");
    await page.waitForSelector(".control", { timeout: most_wait });
    const meanings = await page.locator(".control p").allInnerTexts();
    assert.ok(meanings.length > 100, `${meanings.length} options`);
    const known = Object.values(german.options);
    assert.deepEqual(meanings.filter((meaning) => !known.some((text) => meaning.startsWith(text))), []);
    await shoot(page, "german-options");
    const height = page.locator('[data-path="manual.base_plane_mm"] p');
    for (const [wanted, language, meaning] of [["klappenebene", "de", "Höhe der Klappenebene"], ["valve plane", "de", "Höhe der Klappenebene"], ["valve plane", "en", "height of the valve plane"]]) {
      await page.fill("#search", wanted);
      await page.selectOption("#language", language);
      assert.ok((await height.innerText()).startsWith(meaning));
    }
  },

  async "refuses in German, and keeps the program's own line"(page) {
    const study = readFileSync(join(work, "patient/study.dcm"));
    const flat = Array.from({ length: 400 }, (_, n) => `${n % 20} ${Math.floor(n / 20)} 0`).join("\n");
    const cases = [
      ["words.dcm", Buffer.from("no heart"), /^words\.dcm: ist keine lesbare Herzstudie; erwartet wird DICOM, NIfTI oder NRRD$/, /^words\.dcm: is not a heart study/],
      ["short.dcm", study.subarray(0, study.length - 5000), /^short\.dcm: ist beschädigt oder abgeschnitten: /, /^short\.dcm: is damaged or cut off: /],
      ["flat.xyz", Buffer.from(flat), /^flat\.xyz: alle Punkte der Wolke liegen in einer Ebene; erwartet wird ein Körper$/, /^flat\.xyz: the points of the cloud all lie in one plane/],
      ["few.xyz", Buffer.from("0 0 0\n1 0 0\n0 1 0\n"), /^few\.xyz: die Wolke hat 3 brauchbare Punkte; erwartet werden mindestens \d+$/, /^few\.xyz: the cloud has 3 usable points/],
    ];
    for (const [name, bytes, german_line, own_line] of cases) {
      await page.goto(page.url());
      await page.selectOption("#language", "de");
      await drop(page, [{ name, bytes }]);
      await until_view(page, "failure");
      assert.match(await page.locator("#reason").innerText(), german_line);
      assert.match(await page.locator("#reason").getAttribute("title"), own_line);
    }
    await page.selectOption("#language", "en");
    assert.match(await page.locator("#reason").innerText(), cases.at(-1)[3]);
    assert.equal(await page.locator("#reason").getAttribute("title"), "");
    await page.selectOption("#language", "de");
    await shoot(page, "german-refusal");
  },

  async "speaks German, and can be used by keys alone"(page) {
    await page.selectOption("#language", "de");
    assert.equal(await page.locator("#drop h1").innerText(), "Studie oder Scan hierher ziehen");
    const english = await page.evaluate(() => [...document.querySelectorAll("[data-text]")].every((e) => e.textContent.length > 0));
    assert.ok(english, "a text is empty");
    await page.focus("#language");
    const seen = [];
    for (let n = 0; n < 4; ++n) {
      await page.keyboard.press("Tab");
      seen.push(await page.evaluate(() => document.activeElement.id));
    }
    assert.deepEqual(seen, ["pick-files", "pick-folder", "example-patient", "example-vase"]);
    await page.keyboard.press("Enter");
    await until_view(page, "working");
    assert.equal(await page.evaluate(() => document.activeElement.id), "cancel");
    await page.keyboard.press("Enter");
    await until_view(page, "failure");
    await shoot(page, "german");
  },
};

// Where the page is served with the headers that isolate it, it has threads.
const served_tests = {
  async "served: its threads take pieces of loops, no more of them than it is told"(page) {
    assert.ok(await page.evaluate(() => self.crossOriginIsolated));
    const engine = await bundle("program/engine.ts", { WORKER: JSON.stringify(await bundle("program/worker.ts")) }, "cjs");
    await page.evaluate(`(() => { const module = {}; ${engine}; globalThis.Runner = module.exports.Runner; })()`);
    const threads_of_run = async (...words) => {
      const run = ["ventricle", "/patient/study.dcm", "--out", "/heart", "--trace", "/wanted/trace.json", ...words];
      const { code, reason, trace } = await page.evaluate(
        async (commands) => {
          const { code, output, reason, files } = await new Runner().run({ files: [], commands, wanted: ["wanted"] });
          return { code, reason: reason ?? output, trace: files && new TextDecoder().decode(files[0]?.bytes) };
        },
        [["phantom", "patient", "--out", "/patient"], run],
      );
      assert.equal(code, 0, reason);
      return new Set(JSON.parse(trace).traceEvents.filter(({ cat }) => cat === "piece").map(({ tid }) => tid)).size;
    };
    const processors = await page.evaluate(() => navigator.hardwareConcurrency);
    assert.ok(processors > 1, "this machine has one processor: no test of threads");
    assert.equal(await threads_of_run(), Math.min(processors, 8));
    assert.equal(await threads_of_run("--threads", "1"), 1);
  },
};
for (const name of ["computes the virtual patient as the native program does", "makes levels of detail of the vase"])
  served_tests[`served: ${name}`] = tests[name];

/** Tests that drag files or weigh the heap, which only Chromium's driver can. */
const by_devtools = [
  "shows four results side by side in one beat, and no more",
  "takes results: alone, with their study later, several as a list, two side by side; and options.json",
  "keeps no memory of the studies before, for thirty of them",
];
for (const name of by_devtools) {
  assert.ok(name in tests, name);
  if (has_devtools) continue;
  console.log(`skip ${name}`);
  delete tests[name];
}

run_native("phantom", "patient", "--seed", "1", "--out", "patient", "--quiet");
const server = await serve(page_path);
await withBrowser(
  async (context) => {
    for (const [name, test] of Object.entries({ ...tests, ...served_tests }).filter(([name]) => new RegExp(process.env.ONLY ?? "").test(name)))
      await check(name, async () => {
        const page = await context.newPage();
        const url = process.env.SERVED || name in served_tests ? server.url : `file://${page_path}`;
        const requests = [];
        const words = [];
        page.on("request", (request) => {
          const asked = request.url(); // a blob is memory of the page
          if (asked !== url && !asked.startsWith("blob:")) requests.push(asked);
        });
        // What the driver of a graphics card says is not the page's.
        page.on("console", (message) => message.text().startsWith("[.WebGL-") || words.push(message.text()));
        page.on("pageerror", (error) => isOfDriver(String(error)) || words.push(String(error)));
        await page.goto(url);
        try {
          await test(page, context);
        } finally {
          await page.close();
        }
        assert.deepEqual(requests, [], "the page asked for something");
        assert.deepEqual(words.slice(0, 3), [], "the page wrote to the console");
      });
  },
  { width: 1280, height: 720, acceptDownloads: true },
);
server.close();
rmSync(work, { recursive: true, force: true });
finish();
