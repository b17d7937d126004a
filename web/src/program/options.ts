// Every option of the program as a control, made from what `dynasurf options --json` tells.
import { hand_keys, is_by_hand } from "../host";
import { described, text } from "./texts";

interface Row {
  path: string;
  method: string | null;
  default: string;
  unit: string;
  range: string;
  choices: string;
  meaning: string;
}

const unset = "unset";
const between = /^(\S+) to (\S+)$/;

function rangeOf({ range }: Row): string {
  const [, low, high] = between.exec(range) ?? [];
  return low && high ? text("range", { low, high }) : range;
}

/** An option of a method that is not chosen has no effect. `value`: what an option is set to. */
function isAlive(rows: Row[], row: Row, value: (row: Row) => string): boolean {
  if (row.method === null) return true;
  const choices = rows.filter((other) => other !== row && other.choices.split(" | ").includes(row.method!) && row.path.startsWith(`${other.path}.`));
  const owner = choices.sort((a, b) => b.path.length - a.path.length)[0];
  return !owner || value(owner) === row.method;
}

/** What a file of options sets otherwise than the defaults; both as `dynasurf options --json` tells them. */
export function settingsBetween(usual: string, of_file: string): [string, string][] {
  const key = ({ path, method }: Row) => `${path} ${method}`;
  const defaults = new Map((JSON.parse(usual) as Row[]).map((row) => [key(row), row.default]));
  const rows = JSON.parse(of_file) as Row[];
  return rows.filter((row) => isAlive(rows, row, (of) => of.default) && defaults.get(key(row)) !== row.default).map((row) => [row.path, row.default]);
}

/** Settings of options, parted into those of the panel and those that the report says by hand. */
export function partSaid(settings: [string, string][]): { settings: [string, string][]; options: { [path: string]: string } } {
  return { settings: settings.filter(([path]) => !is_by_hand(path)), options: Object.fromEntries(settings.filter(([path]) => is_by_hand(path))) };
}

/** So many numbers, or some multiple of them, with commas or spaces between them. */
const numbers = (count: number, many: boolean): string => {
  const group = `[\\d.+\\-e]+(\\s*[, ]\\s*[\\d.+\\-e]+){${count - 1}}`;
  return `\\s*${group}${many ? `(\\s*[, ]\\s*${group})*` : ""}\\s*`;
};
/** What an option that is said by hand may be; others have ranges, or are words. */
const patterns: { [path: string]: string } = {
  "manual.center_mm": numbers(3, false),
  "manual.axis": numbers(3, false),
  "manual.exclude_gates": numbers(1, true),
  "manual.endo_points": numbers(4, true),
  "manual.epi_points": numbers(4, true),
};

/** The options of one subject and what the user made of them, what is said by hand in the report too. */
export class OptionPanel {
  private rows: Row[] = [];
  private values = new Map<string, string>();
  private wanted = "";
  /** What was typed and can be no value, also where a search hides it. */
  private readonly bad = new Set<string>();

  constructor(
    private readonly form: HTMLFormElement,
    private readonly on_change: (changed: number) => void,
  ) {
    form.addEventListener("submit", (event) => event.preventDefault());
  }

  /** Takes another description. What was changed stays where the option still exists. */
  describe(json: string): void {
    this.rows = JSON.parse(json) as Row[];
    this.show("");
  }

  get is_described(): boolean {
    return this.rows.length > 0;
  }

  clear(): void {
    this.rows = [];
    this.wanted = "";
    this.values.clear();
    this.bad.clear();
    this.form.replaceChildren();
    this.on_change(0);
  }

  reset(): void {
    this.values.clear();
    this.bad.clear();
    this.show(this.wanted);
    this.on_change(0);
  }

  /** What is changed, to be taken up again by `restore`, in the order of the description: a choice comes before what depends on it. */
  snapshot(): [string, string][] {
    const paths = this.is_described ? [...new Set(this.rows.map(({ path }) => path))] : [...this.values.keys()];
    return paths.filter((path) => this.values.has(path) && !is_by_hand(path)).map((path) => [path, this.values.get(path)!]);
  }

  restore(values: [string, string][], said: Record<string, string>): void {
    this.values = new Map([...values, ...Object.entries(said)]);
    this.bad.clear();
    this.show(this.wanted);
    this.on_change(this.values.size);
  }

  /** Sets some, and leaves the others. */
  set(settings: [string, string][]): void {
    this.restore([...this.snapshot().filter(([path]) => !settings.some(([of]) => of === path)), ...settings], this.said());
  }

  /** As `--set` takes them, without what is said by hand. */
  settings(): string[] {
    return this.snapshot().map(([path, value]) => `${path}=${value}`);
  }

  /** What is said by hand and can be, in the order in which the report says it. */
  said(): Record<string, string> {
    return Object.fromEntries(hand_keys.map((key) => `manual.${key}`).filter((path) => this.values.has(path) && !this.bad.has(path)).map((path) => [path, this.values.get(path)!]));
  }

  /** Takes what the report says by hand: while a pointer moves, so no more than that is drawn anew. */
  hear(said: Record<string, string>): void {
    for (const path of hand_keys.map((key) => `manual.${key}`)) {
      if (this.bad.has(path)) continue; // the report never heard of it
      if (path in said) this.values.set(path, said[path]!);
      else this.values.delete(path);
      const [row, field] = [this.rows.find((of) => of.path === path), document.getElementById(`option-${path}`)];
      if (!row || !field) continue;
      (field as HTMLInputElement).value = this.shown(row);
      field.parentElement!.classList.toggle("changed", this.values.has(path));
    }
    this.on_change(this.values.size);
  }

  /** Whether all that was typed can be a value. */
  get is_valid(): boolean {
    return this.bad.size === 0;
  }

  /** Shows the first that cannot. */
  tell_bad(): void {
    if (this.form.checkValidity()) this.show("");
    this.form.reportValidity();
  }

  /** Again in the language of the page. */
  speak(): void {
    this.show(this.wanted);
  }

  show(wanted: string): void {
    this.wanted = wanted;
    const words = wanted.toLowerCase().split(/\s+/);
    const shown = this.rows.filter((row) => isAlive(this.rows, row, (of) => this.value(of))).filter((row) => {
      const hay = `${row.path} ${row.meaning} ${described(row.meaning)}`.toLowerCase();
      return words.every((word) => hay.includes(word));
    });
    this.form.replaceChildren(...shown.map((row) => this.control(row)));
  }

  private value(row: Row): string {
    return this.values.get(row.path) ?? row.default;
  }

  private control(row: Row): HTMLElement {
    const box = document.createElement("div");
    const label = document.createElement("label");
    const meaning = document.createElement("p");
    const field = row.choices ? this.list(row) : this.entry(row);
    box.className = "control";
    box.dataset.path = row.path;
    box.classList.toggle("changed", this.values.has(row.path));
    field.id = label.htmlFor = `option-${row.path}`;
    meaning.id = `${field.id}-meaning`;
    field.setAttribute("aria-describedby", meaning.id);
    label.textContent = row.path + (row.unit ? ` [${described(row.unit)}]` : "");
    meaning.textContent = described(row.meaning) + (row.range ? ` (${rangeOf(row)})` : "");
    if (field.checkValidity()) this.bad.delete(row.path); // what was no number is not kept
    field.addEventListener("change", () => this.take(row, field, box));
    box.append(label, field, meaning);
    return box;
  }

  private list(row: Row): HTMLSelectElement {
    const field = document.createElement("select");
    for (const choice of row.choices.split(" | ")) field.add(new Option(choice, choice));
    field.value = this.value(row);
    return field;
  }

  private entry(row: Row): HTMLInputElement {
    const field = document.createElement("input");
    const limits = between.exec(row.range);
    const is_list = row.default.includes(",");
    const is_number = !is_list && (limits !== null || (row.default !== "" && Number.isFinite(Number(row.default))));
    if (is_number) Object.assign(field, { type: "number", step: "any" });
    if (limits) Object.assign(field, { min: limits[1], max: limits[2] });
    if (patterns[row.path]) field.pattern = patterns[row.path]!;
    field.placeholder = row.default === unset ? text("unset") : row.default;
    field.value = this.shown(row);
    return field;
  }

  private shown(row: Row): string {
    const value = this.value(row);
    return value === unset ? "" : value;
  }

  private take(row: Row, field: HTMLInputElement | HTMLSelectElement, box: HTMLElement): void {
    const value = field.value === "" ? row.default : field.value;
    if (value === row.default) this.values.delete(row.path);
    else this.values.set(row.path, value);
    if (field.checkValidity()) this.bad.delete(row.path);
    else this.bad.add(row.path);
    box.classList.toggle("changed", this.values.has(row.path));
    this.on_change(this.values.size);
    if (row.choices && this.rows.some(({ method }) => method !== null && row.choices.includes(method))) {
      this.show("");
      document.getElementById(field.id)?.focus();
    }
  }
}
