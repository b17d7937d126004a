// dynasurf.html: takes files, runs the program over them in a worker, shows its report.
import { dropped, type Given, as_zip, picked, read_given, Refusal, save } from "./files";
import { argumentsOf, type ByHand, type FromPage, type FromReport, isSame, maskFile, mask_name, nothing_said, quoted } from "../host";
import { Runner } from "./engine";
import { lineOfError, mb, reasonOf } from "./failure";
import { load, printAlone } from "./frames";
import { type Given as GivenStudy, givenHere, pageWith } from "./given";
import { dataOf, fileOf, History, type Run, type Task, taskOf } from "./history";
import type { Job, Piece, Word } from "./job";
import { OptionPanel } from "./options";
import { Pair, pairJob } from "./pair";
import { Preview } from "./preview";
import { type Found, StudyList, studiesOf } from "./studies";
import { type Key, language, languages, name_of, speak, spoken, stage_name, text } from "./texts";

/** `complaint`: the last error that the program told. */
type Ended = Word & { kind: "end"; complaint?: string | undefined };

const by_id = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const views = ["start", "studies", "working", "failure", "result", "pair"] as const;

let task: Task | null = null;
/** What a person said by hand for the next run. */
let said: ByHand = nothing_said();
/** The last run was asked for by the report. */
let correcting = false;
/** The gate that the report looks at, from 1. */
let gate = 1;
let at_once = false;
/** Says again why something failed. */
let tell_reason = (): void => {};

function show(view: (typeof views)[number]): void {
  for (const name of views) by_id(name).hidden = name !== view;
  // Where a report has its own header the page's is hidden, but for the choice of language.
  const [choice, bar] = [document.querySelector(".language")!, by_id(view).querySelector(".bar p")];
  if (bar) bar.after(choice);
  else document.querySelector("header")!.append(choice);
  document.documentElement.dataset.view = view;
}

/** `say`: the reason in the language of the page; `own`: the program's line that it is a translation of; one searches for it. */
function fail(say: () => string, own = ""): void {
  tell_reason = () => {
    by_id("reason").textContent = say();
    by_id("reason").title = own === say() ? "" : own;
  };
  tell_reason();
  by_id("back").hidden = !history.shown;
  tell_list();
  show("failure");
  by_id("failure").querySelector("button")?.focus();
}

// ---- The engine ----

const runner = new Runner();

/** A browser compiles well what has run for a while: a small heart and a small scan are read before anybody asks, if nobody does. */
async function warm_up(): Promise<void> {
  const phantom = (kind: string, settings: string[]) => ["phantom", kind, "--out", `/${kind}`, ...settings.flatMap((set) => ["--set", set])];
  const commands = [
    phantom("patient", ["gates=4", "lattice.nx=32", "lattice.ny=32", "lattice.nz=18", "lattice.dx_mm=4.5", "lattice.dy_mm=4.5", "lattice.dz_mm=6.5"]),
    ["ventricle", "/patient/study.dcm", "--out", "/heart"],
    phantom("cloud", ["shape=vase", "points=6000"]),
    ["cloud", "/cloud/cloud.ply", "--out", "/levels", "--triangles", "1280,320"],
  ];
  try {
    await runner.run({ files: [], commands, wanted: [] });
    document.documentElement.dataset.warm = "true";
  } catch {
    // Whoever asks for a run is told.
  }
}

// ---- A run ----


function tell_progress(line: string, memory: number): void {
  by_id("memory").textContent = text("memory", { mb: mb(memory) });
  const words = /^(\w+) (\d+)\/(\d+)$/.exec(line);
  if (!words) return;
  const [, stage, done, total] = words;
  const bar = by_id<HTMLProgressElement>("progress");
  by_id("stage").textContent = `${stage_name(stage!)} ${Number(total) > 1 ? `${done}/${total}` : ""}`;
  if (Number(total) > 1) bar.value = Number(done) / Number(total);
  else bar.removeAttribute("value");
}

const commands_of = (of: Task): string[][] => [
  ...of.make,
  [
    of.subject,
    ...of.inputs,
    ...["--out", "/result", ...of.more, ...panel.settings().flatMap((set) => ["--set", set])],
    ...argumentsOf(said).map((word) => (word === mask_name ? `/${mask_name}` : word)),
  ],
];

/** Starts with another study: nothing of the one before counts. */
function begin(next: Task, with_settings: [string, string][] = [], with_said = nothing_said()): Promise<void> {
  history.clear();
  panel.clear();
  by_id<HTMLInputElement>("search").value = "";
  correcting = at_once = false;
  panel.restore(with_settings);
  said = with_said;
  return start(next);
}

async function start(next: Task): Promise<void> {
  task = next;
  preview.stop();
  show("working");
  tell_progress("start 0/1", 0);
  by_id("cancel").focus();
  // Copies are given away: the files stay here for another run.
  const files = copy_of(next.files);
  if (said.paint) files.push({ path: mask_name, bytes: maskFile(said.paint) });
  const word = await work({ files, commands: commands_of(next), wanted: ["result"] }, (end) => end.code === 0 || end.code === 3);
  if (word) present(word);
}

const copy_of = (files: Piece[]): Piece[] => files.map(({ path, bytes }) => ({ path, bytes: bytes.slice() }));

/** Runs a job with its progress; null: it failed, which is told, or files are missing. */
async function work(job: Job, is_done: (end: Ended) => boolean): Promise<Ended | null> {
  const lines: string[] = [];
  let word: Word;
  try {
    word = await runner.run(job, (line) => {
      lines.push(line.text);
      tell_progress(line.text, line.memory);
    });
  } catch (error) {
    fail(() => text("lost", { reason: String(error) }));
    return null;
  }
  const complaint = lineOfError(lines);
  if (word.kind === "end" && is_done(word) && word.files.length > 0) return { ...word, complaint };
  fail(reasonOf(word, complaint), complaint);
  return null;
}

function present(word: Ended): void {
  history.add({
    name: "",
    settings: panel.snapshot(),
    said,
    result: word.files.map(({ path, bytes }) => ({ path: path.replace(/^result\//, "dynasurf-result/"), bytes })),
    code: word.code,
    seconds: word.seconds,
    memory: word.memory,
  });
}

/** Loads the report of a run in the language of the page. */
function load_report(run: Run): void {
  said = run.said;
  hold_language(false);
  const frame = load(by_id<HTMLIFrameElement>("report"), spoken(fileOf(run.result, "report.html")));
  // The report's keys work at once where nobody is elsewhere in the page.
  frame.addEventListener("load", () => document.activeElement === document.body && frame.focus());
}

/** Shows what the history has chosen: another run, or another one to compare with. */
function show_chosen(is_other_run: boolean): void {
  const run = history.shown!;
  if (is_other_run) {
    panel.restore(run.settings);
    show("result");
    load_report(run);
    Object.assign(document.documentElement.dataset, { seconds: run.seconds.toFixed(3), memory: String(run.memory) });
  } else tell_report();
  tell_run(run);
}

function tell_run(run: Run): void {
  tell_list();
  by_id("summary").textContent = text(run.code === 3 ? "done_check" : "done", { s: run.seconds.toFixed(1), mb: mb(run.memory) });
  by_id("compared").textContent = history.comparison();
  by_id<HTMLButtonElement>("undo").disabled = history.at <= 0;
  by_id<HTMLButtonElement>("redo").disabled = history.at >= history.runs.length - 1;
  history.draw();
}

const history = new History(by_id("runs"), show_chosen);

/** Gives the report what was said by hand, and the result it is compared with. */
function tell_report(): void {
  const { shown, compared } = history;
  if (!shown) return;
  const words: FromPage = { dynasurf: "page", word: "study", said: shown.said, before: compared ? dataOf(compared) : null, at_once, correcting };
  by_id<HTMLIFrameElement>("report").contentWindow?.postMessage(words, "*");
}

function hear_report(event: MessageEvent<FromReport>): void {
  if (event.source !== by_id<HTMLIFrameElement>("report").contentWindow || event.data?.dynasurf !== "report") return;
  if (event.data.word === "ready") {
    tell_report();
    preview.stop(); // a report that is loaded anew shows none
    return look();
  }
  if (event.data.word !== "by hand") return;
  said = event.data.said;
  gate = event.data.gate;
  at_once = event.data.at_once;
  hold_language(history.shown !== undefined && !isSame(said, history.shown.said));
  if (!event.data.run) return look();
  if (!task || !panel.is_valid) return;
  correcting = true;
  void start(task);
}

/** Borders and fields as they would be with what is said and chosen, shown in the report. */
const preview = new Preview((found) => by_id<HTMLIFrameElement>("report").contentWindow?.postMessage({ dynasurf: "page", word: "borders", found } satisfies FromPage, "*"));
function look(): void {
  const { shown } = history;
  if (!task || !shown || !panel.is_valid) return;
  const settings = (values: [string, string][]) => values.map(([path, value]) => `${path}=${value}`);
  preview.ask({ task, settings: panel.settings(), said, gate }, { task, settings: settings(shown.settings), said: shown.said, gate });
}

function cancel(): void {
  runner.stop();
  fail(() => text("cancelled"));
}

// ---- What is given ----

async function take(given: Promise<Given[]> | Given[]): Promise<void> {
  try {
    const list = await given;
    if (list.length === 0) return;
    const pieces = await read_given(list);
    studies.studies = await several_in(pieces);
    if (studies.studies.length === 0) await begin(taskOf(pieces));
    else show_studies();
  } catch (error) {
    fail(() => (error instanceof Refusal ? text(error.code, { about: error.about }) : text("lost", { reason: String(error) })));
  }
}

/** The studies of a folder that holds more than one. */
async function several_in(pieces: Piece[]): Promise<Found[]> {
  const { subject, inputs } = taskOf(pieces);
  if (subject !== "ventricle" || inputs[0] !== "/in") return [];
  show("working");
  tell_progress("read 0/1", 0);
  const word = await runner.run({ files: copy_of(pieces), commands: [["info", "/in", "--json"]], wanted: [] });
  return word.kind === "end" && word.code === 0 ? studiesOf(word.output, pieces) : [];
}

const studies = new StudyList(
  by_id("study-list"),
  (study) => begin(taskOf(study.files)),
  (is_pair) => (by_id<HTMLButtonElement>("open-pair").disabled = !is_pair),
);

function show_studies(): void {
  by_id("studies-title").textContent = text("studies", { n: studies.studies.length });
  show("studies");
  tell_list();
  void studies.show(studies.studies, async (study) => {
    const { files, inputs } = taskOf(study.files);
    const word = await runner.run({ files: copy_of(files), commands: [["info", inputs[0]!, "--json", "--picture"]], wanted: [] });
    return word.kind === "end" && word.code === 0 ? word.output : null;
  });
}

/** The way back to the list stands wherever there is one. */
function tell_list(): void {
  for (const button of document.querySelectorAll<HTMLElement>(".to-list")) button.hidden = studies.studies.length === 0;
}

const pair = new Pair(
  [by_id<HTMLIFrameElement>("first"), by_id<HTMLIFrameElement>("second")],
  [by_id("first-title"), by_id("second-title")],
  by_id<HTMLIFrameElement>("both"),
  by_id("pair-numbers"),
  by_id("pair-complaint"),
);

async function show_pair(): Promise<void> {
  const chosen = studies.pair;
  if (!chosen) return;
  show("working");
  tell_progress("start 0/1", 0);
  by_id("cancel").focus();
  const has_both = ({ files }: Ended) => ["first", "second"].every((name) => files.some(({ path }) => path === `${name}/report.html`));
  const word = await work(pairJob(chosen), has_both);
  if (!word) return;
  show("pair");
  show_difference(false);
  pair.show(chosen, word.files, word.complaint);
  by_id("show-difference").hidden = !pair.has_difference;
}

function show_difference(on: boolean): void {
  by_id("both").hidden = !on;
  if (on) pair.showDifference();
  for (const half of document.querySelectorAll<HTMLElement>("#pair .half")) half.hidden = on;
  by_id("show-difference").setAttribute("aria-pressed", String(on));
}

const patient: Task = {
  subject: "ventricle",
  files: [],
  make: [["phantom", "patient", "--seed", "1", "--out", "/made"]],
  inputs: ["/made/study.dcm"],
  more: [],
};
const vase: Task = {
  subject: "cloud",
  files: [],
  make: [["phantom", "cloud", "--set", "shape=vase", "--set", "points=30000", "--set", "noise_percent=0.1", "--out", "/made"]],
  inputs: ["/made/cloud.ply"],
  more: ["--triangles", "5120,1280,320"],
};

// ---- Options ----

const panel = new OptionPanel(by_id<HTMLFormElement>("controls"), (changed) => {
  by_id("changed").textContent = changed > 0 ? text("options_changed", { n: changed }) : "";
  look();
});

async function show_options(): Promise<void> {
  const aside = by_id("options");
  aside.hidden = !aside.hidden;
  by_id("show-options").setAttribute("aria-expanded", String(!aside.hidden));
  if (aside.hidden || panel.is_described || !task) return;
  const word = await runner.run({ files: [], commands: [["options", task.subject, "--json"]], wanted: [] });
  if (word.kind === "end") panel.describe(word.output);
}

function show_history(): void {
  const aside = by_id("history");
  aside.hidden = !aside.hidden;
  by_id("show-history").setAttribute("aria-expanded", String(!aside.hidden));
}

/** The result's folder, and beside it the mask that its command line names. */
function save_zip(): void {
  const run = history.shown!;
  const mask = run.said.paint ? [{ path: mask_name, bytes: maskFile(run.said.paint) }] : [];
  save(as_zip([...run.result, ...mask]), "dynasurf-result.zip", "application/zip");
}

async function save_page(): Promise<void> {
  const run = history.shown!;
  save(await pageWith({ task: task!, settings: run.settings, said: run.said } satisfies GivenStudy), "dynasurf-study.html", "text/html");
}

function command_line(): string {
  const words = [...panel.settings().flatMap((set) => ["--set", set]), ...argumentsOf(said)].map(quoted);
  const input = task?.subject === "cloud" ? "CLOUD" : "STUDY";
  return ["dynasurf", task?.subject ?? "ventricle", input, "--out RESULT", ...(task?.more ?? []), ...words].join(" ");
}

async function copy(): Promise<void> {
  const button = by_id("copy");
  const area = document.createElement("textarea");
  area.value = command_line();
  by_id("options").append(area);
  area.select();
  // The clipboard's own interface is for pages from the network; a file has this one.
  document.execCommand("copy");
  area.remove();
  button.textContent = text("copied");
  button.dataset.copied = command_line();
  setTimeout(() => (button.textContent = text("copy")), 1500);
}

// ---- The page ----

/** Another language loads the report anew, without what was said in it and not run yet. */
function hold_language(is_held: boolean): void {
  const choice = by_id<HTMLSelectElement>("language");
  choice.disabled = is_held;
  choice.title = is_held ? text("language_waits") : "";
}

/** Texts of the page, and again all that was written in the former language. */
function change_language(name: string): void {
  speak(name);
  tell_reason();
  pair.speak();
  panel.speak();
  if (history.shown) {
    load_report(history.shown);
    tell_run(history.shown);
  }
  if (document.documentElement.dataset.view === "studies") show_studies();
}

function connect(): void {
  const click = (id: string, work: () => unknown) => by_id(id).addEventListener("click", work);
  click("pick-files", () => by_id("files").click());
  click("pick-folder", () => by_id("folder").click());
  for (const id of ["files", "folder"])
    by_id(id).addEventListener("change", (event) => {
      const input = event.target as HTMLInputElement;
      void take(picked(input.files!)).finally(() => (input.value = ""));
    });
  click("example-patient", () => begin(patient));
  click("example-vase", () => begin(vase));
  click("cancel", cancel);
  click("open-pair", show_pair);
  click("show-difference", () => show_difference(by_id("both").hidden !== false));
  click("save-pair", () => save(as_zip(pair.files), "dynasurf-results.zip", "application/zip"));
  for (const button of document.querySelectorAll(".to-list")) button.addEventListener("click", show_studies);
  const saved = (name: string) => fileOf(history.shown?.result ?? [], name);
  click("save-report", () => save(saved("report.html"), "report.html", "text/html"));
  click("save-zip", save_zip);
  click("save-page", save_page);
  click("back", () => show("result")); // with what was chosen and said for the next run
  click("undo", () => history.go(history.at - 1));
  click("redo", () => history.go(history.at + 1));
  click("show-history", show_history);
  click("show-options", show_options);
  window.addEventListener("message", hear_report);
  document.addEventListener("keydown", (event) => {
    if (document.documentElement.dataset.view === "result") printAlone(by_id<HTMLIFrameElement>("report"), event);
    if (event.key === "Escape") for (const aside of ["options", "history"]) if (!by_id(aside).hidden) by_id(`show-${aside}`).click();
  });
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || (event.target as HTMLElement).closest("input")) return;
    event.preventDefault();
    history.go(history.at + (event.shiftKey ? 1 : -1));
  });
  click("again", () => {
    if (!panel.is_valid) {
      by_id<HTMLInputElement>("search").value = "";
      return panel.tell_bad();
    }
    if (!task) return;
    correcting = false;
    void start(task);
  });
  click("reset", () => panel.reset());
  click("copy", copy);
  click("save-options", () => save(saved("options.json"), "options.json", "application/json"));
  by_id("search").addEventListener("input", (event) => panel.show((event.target as HTMLInputElement).value));
  for (const button of document.querySelectorAll(".other"))
    button.addEventListener("click", () => {
      studies.studies = [];
      show("start");
    });
  window.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("over");
  });
  window.addEventListener("dragleave", (event) => event.relatedTarget === null && document.body.classList.remove("over"));
  // No pointer moves during a drag: one that ended elsewhere leaves the frames usable.
  window.addEventListener("pointermove", () => document.body.classList.remove("over"));
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    if (event.dataTransfer && document.documentElement.dataset.view !== "working") void take(dropped(event.dataTransfer));
  });
  const choice = by_id<HTMLSelectElement>("language");
  choice.replaceChildren(...languages.map((name) => new Option(name_of(name), name)));
  choice.value = language();
  choice.addEventListener("change", () => change_language(choice.value));
}

connect();
speak(language());
show("start");
if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") fail(() => text("old_browser" satisfies Key));
else
  givenHere()
    .then((given) => (given ? begin(given.task, given.settings, given.said) : warm_up()))
    .catch((error: unknown) => fail(() => text("lost", { reason: String(error) })));
document.documentElement.dataset.ready = "true";
