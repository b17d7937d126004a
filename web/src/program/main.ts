// dynasurf.html: takes files, runs the program over them in a worker, shows its report.
import { as_zip, dropped, type Given, picked, read_given, Refusal, save } from "./files";
import { copyText } from "../clipboard";
import { argumentsOf, type ByHand, type FromPage, type FromReport, isSame, maskFile, mask_name, nothing_said, quoted } from "../host";
import { answer, settings_of } from "./asked";
import { besideJob, hasAll, SideBySide } from "./beside";
import { Runner, warmUp } from "./engine";
import { patient, vase } from "./examples";
import { lineOfError, mb, reasonOf } from "./failure";
import { load, printAlone } from "./frames";
import { givenHere, pageWith } from "./given";
import { dataOf, fileOf, History, jobOf, keepMade, type Run, type Task, taskOf } from "./history";
import { copyOf, type Job, type Piece, type Word } from "./job";
import { OptionPanel, partSaid } from "./options";
import { attempt, by_id, close_by_itself, fail, show, tell_progress, tell_reason } from "./page";
import { Preview } from "./preview";
import { asGiven, type FoundResult, isOptions, openResult, partResults, recordOf, studyOf } from "./results";
import { type Found, resultsIn, severalIn, StudyList } from "./studies";
import { shareTheme } from "./theme";
import { type Key, language, languages, name_of, number, speak, spoken, text } from "./texts";

/** `complaint`: the last error that the program told. */
type Ended = Word & { kind: "end"; complaint?: string | undefined };

let task: Task | null = null;
/** What a person said by hand for the next run. */
let said: ByHand = nothing_said();
/** The last run was asked for by the report. */
let correcting = false;
/** The panel of the report that the last run was asked for; empty: none. */
let asked_panel = "";
/** The gate that the report looks at, from 1. */
let gate = 1;
let at_once = false;

// ---- A run ----

const runner = new Runner({ keeps: true });

/** Another study or result: nothing of the one before counts. */
function forget(): void {
  history.clear();
  panel.clear();
  preview.stop();
  runner.forget();
  by_id<HTMLInputElement>("search").value = "";
  if (!by_id("options").hidden) by_id("show-options").click(); // those of another subject may be others
  correcting = at_once = false;
  by_id("back").hidden = true;
}

/** Starts with another study. `settings`: what is said by hand among them. */
function begin(next: Task, settings: [string, string][] = []): Promise<void> {
  forget();
  const parts = partSaid(settings);
  said = { options: parts.options, paint: null };
  panel.restore(parts.settings, parts.options);
  return start(next);
}

/** Shows a run that was made before. `of`: null where its study is not here. */
function resume(of: Task | null, run: Run): void {
  forget();
  task = of;
  history.add(run);
}

async function start(next: Task): Promise<void> {
  task = next;
  preview.stop();
  const word = await work(jobOf(next, panel.settings(), said), is_finished);
  if (word) present(word);
}

const is_finished = ({ code }: Ended) => code === 0 || code === 3;
const settings_in = (run: Run) => run.settings.map(([path, value]) => `${path}=${value}`);

/** Runs a job with its progress; null: it failed, which is told, or files are missing. */
async function work(job: Job, is_done: (end: Ended) => boolean): Promise<Ended | null> {
  show("working");
  tell_progress("start 0/1", 0);
  by_id("cancel").focus();
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
  keepMade(task!, word.files);
  history.add({
    name: "",
    settings: panel.snapshot(),
    said,
    result: word.files.filter(({ path }) => /^result\//.test(path)).map(({ path, bytes }) => ({ path: `dynasurf-${path}`, bytes })),
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
  by_id("back").hidden = false;
  if (is_other_run) {
    said = run.said;
    panel.restore(run.settings, run.said.options);
    show("result");
    load_report(run);
    Object.assign(document.documentElement.dataset, { seconds: run.seconds.toFixed(3), memory: String(run.memory) });
  } else tell_report();
  tell_run(run);
}

function tell_run(run: Run): void {
  tell_list();
  const { place } = run;
  by_id("summary").textContent = place ? text(task ? "opened" : "opened_alone", { place }) : text(run.code === 3 ? "done_check" : "done", { s: number(run.seconds, 1), mb: mb(run.memory) });
  for (const id of ["save-page", "save-dicom", "again"]) by_id<HTMLButtonElement>(id).disabled = task === null;
  by_id("save-dicom").hidden = task?.subject === "cloud";
  by_id("compared").textContent = history.comparison();
  by_id<HTMLButtonElement>("undo").disabled = history.at <= 0;
  by_id<HTMLButtonElement>("redo").disabled = history.at >= history.runs.length - 1;
  history.draw();
}

const history = new History(by_id("runs"), show_chosen);

/** Gives the report what was said by hand, and the result it is compared with. */
function tell_report(): void {
  const { shown, compared } = history;
  if (!shown || !task) return; // a report whose study is not here offers the command line
  const words: FromPage = { dynasurf: "page", word: "study", said, before: compared ? dataOf(compared) : null, at_once, correcting, panel: asked_panel };
  asked_panel = "";
  by_id<HTMLIFrameElement>("report").contentWindow?.postMessage(words, "*");
}

function hear_report(event: MessageEvent<FromReport>): void {
  if (event.source !== by_id<HTMLIFrameElement>("report").contentWindow || event.data?.dynasurf !== "report") return;
  if (event.data.word === "ready") {
    tell_report();
    preview.stop(); // a report that is loaded anew shows none
    return look();
  }
  if (event.data.word === "run with" && task && panel.is_valid) {
    asked_panel = event.data.panel;
    panel.set(event.data.settings);
    correcting = false;
    return void start(task);
  }
  if (event.data.word !== "by hand") return;
  said = event.data.said;
  panel.hear(said.options);
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
  preview.ask({ task, settings: panel.settings(), said, gate }, { task, settings: settings_in(shown), said: shown.said, gate });
}

function cancel(): void {
  runner.stop();
  fail(() => text("cancelled"));
}

// ---- What is given ----

const take = (given: Promise<Given[]> | Given[]): Promise<void> =>
  attempt(async () => {
    const list = await given;
    if (list.length > 0) await open_given(list);
  });

/** Opens the one study, scan or result among what is given, or lists them. */
async function open_given(list: Given[]): Promise<void> {
  const { results, rest } = partResults(list);
  const zipped = partResults(rest.length > 0 ? await read_given(rest) : []);
  for (const { place, given } of zipped.results) results.push({ place, given: given.map(asGiven) });
  const files = zipped.rest.filter((piece) => !isOptions(piece));
  const options = zipped.rest.find(isOptions) ?? null;
  if (results.length === 0 && files.length === 0) return options_alone(options!);
  if (results.length === 0 && (await joins(files))) return;
  beside = { files, options };
  studies.studies = [];
  if (results.length === 1) return show_result(results[0]!);
  studies.studies = results.length > 0 ? await resultsIn(results) : await several_in(files);
  if (studies.studies.length > 0) return show_studies();
  await begin_with_options(files);
}

async function begin_with_options(files: Piece[]): Promise<void> {
  const next = taskOf(files);
  await begin(next, beside.options ? await settings_of(next.subject, beside.options.bytes) : []);
}

/** What was given beside the results of the list, and options for its studies. */
let beside: { files: Piece[]; options: Piece | null } = { files: [], options: null };

async function show_result(found: FoundResult): Promise<void> {
  const { place, result, task: of, paint } = await openResult(found, beside.files);
  const json = fileOf(result, "options.json");
  const subject = recordOf(result).schema?.includes("cloud") ? "cloud" : "ventricle";
  const { settings, options } = partSaid(json.length > 0 ? await settings_of(subject, json) : []);
  resume(of, { name: "", place, settings, said: { options, paint }, result, code: 0, seconds: 0, memory: 0 });
}

/** The run that a report stands for, also behind what could not be done. */
const open_run = (): Run | undefined => (["result", "failure"].includes(document.documentElement.dataset.view!) ? history.shown : undefined);

/** Whether the files are the study of the result that is shown and waits for it. */
async function joins(files: Piece[]): Promise<boolean> {
  const shown = open_run();
  const study = shown && !task ? await studyOf(shown.result, files) : null;
  if (!shown || !study) return false;
  task = study.task;
  shown.said.paint = study.paint;
  show("result");
  load_report(shown);
  tell_run(shown);
  return true;
}

/** Options for the study that is shown. */
async function options_alone(file: Piece): Promise<void> {
  if (!task || !open_run()) throw new Refusal("lone_options", file.path.replace(/^in\//, ""));
  const { settings, options } = partSaid(await settings_of(task.subject, file.bytes));
  said = { options, paint: said.paint };
  panel.restore(settings, options);
  show("result");
  if (by_id("options").hidden) await show_options();
  tell_report();
}

const several_in = (pieces: Piece[]): Promise<Found[]> =>
  severalIn(pieces, (others, input) => {
    show("working");
    tell_progress("read 0/1", 0);
    return info(others, input);
  });

/** What `dynasurf info` tells; null: it could not read the files. */
async function info(files: Piece[], input: string, ...more: string[]): Promise<string | null> {
  const word = await runner.run({ files: copyOf(files), commands: [["info", input, "--json", ...more]], wanted: [] });
  return word.kind === "end" && word.code === 0 ? word.output : null;
}

const studies = new StudyList(
  by_id("study-list"),
  ({ result, files }) => void attempt(() => (result ? show_result(result) : begin_with_options(files))),
  (can_be_opened) => (by_id<HTMLButtonElement>("open-beside").disabled = !can_be_opened),
);

function show_studies(): void {
  by_id("studies-title").textContent = text("studies", { n: studies.studies.length });
  show("studies");
  tell_list();
  void studies.show(studies.studies, (study) => {
    const { files, inputs } = taskOf(study.files);
    return info(files, inputs[0]!, "--picture");
  });
}

/** The way back to the list stands wherever there is one. */
function tell_list(): void {
  for (const button of document.querySelectorAll<HTMLElement>(".to-list")) button.hidden = studies.studies.length === 0;
}

const side_by_side = new SideBySide(by_id("reports"), by_id<HTMLIFrameElement>("both"), by_id("beside-numbers"), by_id("beside-complaint"));

async function show_beside(): Promise<void> {
  const chosen = studies.chosen;
  if (!chosen) return;
  const word = await work(await besideJob(chosen), ({ files }) => hasAll(files, chosen));
  if (!word) return;
  show("beside");
  show_difference(false);
  side_by_side.show(chosen, word.files, word.complaint);
  by_id("show-difference").hidden = !side_by_side.has_difference;
}

function show_difference(on: boolean): void {
  by_id("both").hidden = !on;
  if (on) side_by_side.showDifference();
  for (const half of document.querySelectorAll<HTMLElement>("#beside .half")) half.hidden = on;
  by_id("show-difference").setAttribute("aria-pressed", String(on));
}

// ---- Options ----

const panel = new OptionPanel(by_id<HTMLFormElement>("controls"), (changed) => {
  by_id("changed").textContent = changed > 0 ? text("options_changed", { n: changed }) : "";
  if (JSON.stringify(panel.said()) !== JSON.stringify(said.options)) {
    said = { ...said, options: panel.said() };
    tell_report();
  }
  look();
});

async function show_options(): Promise<void> {
  const aside = by_id("options");
  aside.hidden = !aside.hidden;
  by_id("show-options").setAttribute("aria-expanded", String(!aside.hidden));
  if (aside.hidden || panel.is_described || !task) return;
  panel.describe(await answer(["options", task.subject, "--json"]));
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

/** What is shown, computed once more as objects of the patient's study: asking for them is asking for the name. */
async function save_dicom(): Promise<void> {
  const run = history.shown!;
  const job = jobOf(task!, settings_in(run), run.said);
  job.commands.at(-1)!.push("--dicom");
  const word = await work(job, is_finished);
  if (!word) return;
  show("result");
  const objects = word.files.filter(({ path }) => path.startsWith("result/dicom/"));
  save(as_zip(objects.map(({ path, bytes }) => ({ path: path.replace("result/", "dynasurf-"), bytes }))), "dynasurf-dicom.zip", "application/zip");
}

async function save_page(): Promise<void> {
  const run = history.shown!;
  save(await pageWith({ task: task!, run }), "dynasurf-study.html", "text/html");
}

/** The options of the next run, as a file. */
async function save_options(): Promise<void> {
  const settings = [...panel.settings(), ...Object.entries(said.options).map(([path, value]) => `${path}=${value}`)];
  save(await answer(["options", task!.subject, "--as-file", ...settings.flatMap((set) => ["--set", set])]), "options.json", "application/json");
}

function command_line(): string {
  const words = [...panel.settings().flatMap((set) => ["--set", set]), ...argumentsOf(said)].map(quoted);
  const input = task?.subject === "cloud" ? "CLOUD" : "STUDY";
  return ["dynasurf", task?.subject ?? "ventricle", input, "--out RESULT", ...words].join(" ");
}

function copy(): void {
  const button = by_id("copy");
  copyText(command_line(), by_id("options"));
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
  side_by_side.speak();
  panel.speak();
  if (history.shown) {
    load_report(history.shown);
    tell_run(history.shown);
  }
  if (document.documentElement.dataset.view === "studies") show_studies();
}

function connect(): void {
  const click = (id: string, work: () => unknown) => by_id(id).addEventListener("click", () => void attempt(work));
  click("pick-files", () => by_id("files").click());
  click("pick-folder", () => by_id("folder").click());
  for (const id of ["files", "folder"])
    by_id(id).addEventListener("change", (event) => {
      const input = event.target as HTMLInputElement;
      void take(picked(input.files!)).finally(() => (input.value = ""));
    });
  click("example-patient", () => begin(patient));
  click("example-vase", () => begin(vase, [["triangles", "5120,1280,320"]]));
  click("cancel", cancel);
  click("open-beside", show_beside);
  click("show-difference", () => show_difference(by_id("both").hidden !== false));
  click("save-beside", () => save(as_zip(side_by_side.files), "dynasurf-results.zip", "application/zip"));
  for (const button of document.querySelectorAll(".to-list")) button.addEventListener("click", show_studies);
  const saved = (name: string) => fileOf(history.shown?.result ?? [], name);
  click("save-report", () => save(saved("report.html"), "report.html", "text/html"));
  close_by_itself(by_id<HTMLDetailsElement>("save"));
  click("save-zip", save_zip);
  click("save-dicom", save_dicom);
  click("save-page", save_page);
  click("back", () => show("result")); // with what was chosen and said for the next run
  for (const [id, step] of [["undo", -1], ["redo", 1]] as const) click(id, () => history.go(history.at + step));
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
  click("save-options", save_options);
  by_id("search").addEventListener("input", (event) => panel.show((event.target as HTMLInputElement).value));
  for (const button of document.querySelectorAll(".other"))
    button.addEventListener("click", () => {
      studies.studies = [];
      tell_list();
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
shareTheme();
speak(language());
show("start");
if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") fail(() => text("old_browser" satisfies Key));
else
  void attempt(async () => {
    const given = await givenHere();
    return given === null ? warmUp(runner) : Array.isArray(given) ? open_given(given) : resume(given.task, given.run);
  });
document.documentElement.dataset.ready = "true";
