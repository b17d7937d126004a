// The runs of a study, in the order in which they were made: which one is shown, and which one it is compared with.
import { argumentsOf, type ByHand, maskFile, mask_name } from "../host";
import { copyOf, type Job, type Piece } from "./job";
import { isScan } from "./scans";
import { number, text } from "./texts";

/** What a run is of. The command line names no path: only the user knows where the files are. */
export interface Task {
  subject: "ventricle" | "cloud";
  files: Piece[];
  make: string[][]; // commands that make the files first
  inputs: string[];
}

/** What files are taken for. */
export function taskOf(files: Piece[]): Task {
  const are_scans = files.every(({ path }) => isScan(path));
  const all = files.map(({ path }) => `/${path}`);
  const header = all.find((path) => /\.n?hdr$/i.test(path)); // its voxels are in another file
  const inputs = are_scans || all.length === 1 ? all : [header ?? "/in"];
  return { subject: are_scans ? "cloud" : "ventricle", files, make: [], inputs };
}

const made = new WeakMap<Task, Piece[]>();

/** The files of a task; null: its commands have not made them yet. */
export const filesOf = (task: Task): Piece[] | null => (task.make.length === 0 ? task.files : made.get(task) ?? null);

/** The inputs among files that the commands of a task made are at hand from now on. */
export function keepMade(task: Task, files: Piece[]): void {
  const inputs = files.filter(({ path }) => task.inputs.includes(`/${path}`));
  if (inputs.length > 0) made.set(task, inputs);
}

/** The job that runs a task, with settings of the options and what is said by hand; its result is the folder "result". */
export function jobOf(task: Task, settings: string[], said: ByHand): Job {
  const files = filesOf(task);
  const by_hand = argumentsOf(said).map((word) => (word === mask_name ? `/${mask_name}` : word));
  return {
    files: [...copyOf(files ?? task.files), ...(said.paint ? [{ path: mask_name, bytes: maskFile(said.paint) }] : [])],
    commands: [...(files ? [] : task.make), [task.subject, ...task.inputs, "--out", "/result", ...settings.flatMap((set) => ["--set", set]), ...by_hand]],
    wanted: files ? ["result"] : ["made", "result"],
  };
}

export interface Run {
  name: string; // empty: by what it changed
  settings: [string, string][];
  said: ByHand;
  result: Piece[];
  code: number;
  seconds: number;
  memory: number;
  /** Where a result that was given lay; it was not computed here. */
  place?: string;
}

export interface Numbers {
  edv_ml: number | null;
  esv_ml: number | null;
  ef_percent: number | null;
  quality?: { verdict: "ok" | "check" | "fail" };
}

/** So many results are kept; those of the oldest runs go. */
const most_runs = 12;

export const fileOf = (result: Piece[], name: string): Uint8Array =>
  result.find(({ path }) => path === `dynasurf-result/${name}`)?.bytes ?? new Uint8Array();

/** The numbers of a heart; null: the result has none. */
export function numbersOf(result: Piece[]): Numbers | null {
  const json = JSON.parse(new TextDecoder().decode(fileOf(result, "results.json")) || "null") as Numbers | null;
  return json && "ef_percent" in json ? json : null;
}

/** The data that a report draws itself from. */
export function dataOf(run: Run): string | null {
  const page = new TextDecoder().decode(fileOf(run.result, "report.html"));
  return /<script type="application\/json" id="data">([^<]*)<\/script>/.exec(page)?.[1] ?? null;
}

export const figure = (value: number | null) => (value === null ? "–" : number(value, 1));

/** "EDV 110.4 mL, ESV 44.4 mL, EF 59.8 %, checks passed" */
export function numbersText({ edv_ml, esv_ml, ef_percent, quality }: Numbers): string {
  const words = text("numbers", { edv: figure(edv_ml), esv: figure(esv_ml), ef: figure(ef_percent) });
  return quality ? `${words}, ${text(`verdict_${quality.verdict}`)}` : words;
}

export class History {
  runs: Run[] = [];
  at = -1;
  /** Compared with this run, -1: none. */
  other = -1;

  /** `on_show` is called after another run or comparison was chosen. */
  /** What the others are named by, also after it went. */
  private first: Run | null = null;

  constructor(
    private readonly list: HTMLElement,
    private readonly on_show: (is_other_run: boolean) => void,
  ) {}

  clear(): void {
    this.runs = [];
    this.first = null;
    this.at = this.other = -1;
  }

  get shown(): Run | undefined {
    return this.runs[this.at];
  }

  get compared(): Run | undefined {
    return this.runs[this.other];
  }

  add(run: Run): void {
    const before = this.at;
    this.first ??= run;
    this.runs.push(run);
    this.at = this.runs.length - 1;
    this.other = before;
    if (this.runs.length > most_runs) {
      this.runs.shift();
      --this.at;
      --this.other;
    }
    this.on_show(true);
  }

  go(to: number): void {
    if (to < 0 || to >= this.runs.length || to === this.at) return;
    if (this.other === to) this.other = this.at;
    this.at = to;
    this.on_show(true);
  }

  private compare(to: number): void {
    this.other = to;
    this.on_show(false);
  }

  nameOf(n: number): string {
    const run = this.runs[n]!;
    if (run.name) return run.name;
    if (run.place) return run.place;
    const words = ({ settings, said: { options, paint } }: Run) => [
      ...settings.map(([path, value]) => `${path}=${value}`),
      ...Object.entries(options).map(([path, value]) => `${path.replace("manual.", "")}=${value}`),
      ...(paint ? ["mask"] : []),
    ];
    const before = new Set(run === this.first ? [] : words(this.first!));
    return words(run).filter((word) => !before.has(word)).join(", ") || text("as_found");
  }

  /** The numbers shown beside those they are compared with; empty: nothing to compare. */
  comparison(): string {
    const now = this.shown && numbersOf(this.shown.result);
    const before = this.compared && numbersOf(this.compared.result);
    if (!now || !before) return "";
    return text("before", { edv: figure(now.edv_ml), edv0: figure(before.edv_ml), ef: figure(now.ef_percent), ef0: figure(before.ef_percent) });
  }

  draw(): void {
    this.list.replaceChildren(...this.runs.map((run, n) => this.entry(run, n)));
  }

  private entry(run: Run, n: number): HTMLElement {
    const item = document.createElement("li");
    if (n === this.at) item.setAttribute("aria-current", "true");
    const name = Object.assign(document.createElement("input"), { type: "text", value: this.nameOf(n) });
    name.setAttribute("aria-label", text("run_name", { n: n + 1 }));
    name.addEventListener("change", () => (run.name = name.value.trim()));
    const words = document.createElement("p");
    const numbers = numbersOf(run.result);
    words.textContent = numbers ? numbersText(numbers) : "";
    const choices = document.createElement("div");
    choices.append(
      this.choice("shown", text("shown"), n === this.at, () => this.go(n)),
      this.choice("compared", text("compared_with"), n === this.other, () => this.compare(n === this.other ? -1 : n), n === this.at),
    );
    item.append(name, words, choices);
    return item;
  }

  private choice(group: string, word: string, chosen: boolean, choose: () => void, disabled = false): HTMLElement {
    const label = document.createElement("label");
    const input = Object.assign(document.createElement("input"), { type: group === "shown" ? "radio" : "checkbox", name: group, checked: chosen, disabled });
    input.addEventListener("change", choose);
    label.append(input, word);
    return label;
  }
}
