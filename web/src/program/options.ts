// Every option of the program as a control, made from what `dynasurf options --json` tells.
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

/** The options of one subject and what the user made of them. */
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

  /** What is changed, to be taken up again by `restore`. */
  snapshot(): [string, string][] {
    return this.settings().map((set) => [set.slice(0, set.indexOf("=")), set.slice(set.indexOf("=") + 1)]);
  }

  restore(values: [string, string][]): void {
    this.values = new Map(values);
    this.bad.clear();
    this.show(this.wanted);
    this.on_change(this.values.size);
  }

  /** As `--set` takes them, in the order of the description: a choice comes before what depends on it. */
  settings(): string[] {
    const paths = this.is_described ? [...new Set(this.rows.map(({ path }) => path))] : [...this.values.keys()];
    return paths.filter((path) => this.values.has(path)).map((path) => `${path}=${this.values.get(path)}`);
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
    const shown = this.rows.filter((row) => this.is_alive(row)).filter((row) => {
      const hay = `${row.path} ${row.meaning} ${described(row.meaning)}`.toLowerCase();
      return words.every((word) => hay.includes(word));
    });
    this.form.replaceChildren(...shown.map((row) => this.control(row)));
  }

  /** An option of a method that is not chosen has no effect and is not offered. */
  private is_alive(row: Row): boolean {
    if (row.method === null) return true;
    const choices = this.rows.filter(
      (other) => other !== row && other.choices.split(" | ").includes(row.method!) && row.path.startsWith(`${other.path}.`),
    );
    const owner = choices.sort((a, b) => b.path.length - a.path.length)[0];
    return !owner || this.value(owner) === row.method;
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
    const value = this.value(row);
    const is_list = row.default.includes(",");
    const is_number = !is_list && (limits !== null || (row.default !== "" && Number.isFinite(Number(row.default))));
    if (is_number) Object.assign(field, { type: "number", step: "any" });
    if (limits) Object.assign(field, { min: limits[1], max: limits[2] });
    field.placeholder = row.default === unset ? text("unset") : row.default;
    field.value = value === unset ? "" : value;
    return field;
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
