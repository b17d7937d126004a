// The borders of one gate and the fields around them, computed again while a person still drags or chooses.
import { argumentsOf, type ByHand, type FoundBorders, isSame, maskFile, mask_name } from "../host";
import { Runner } from "./engine";
import { lineOfError, reasonOf } from "./failure";
import { filesOf, keepMade, type Task } from "./history";
import type { Piece } from "./job";
import { text } from "./texts";

export interface Wanted {
  task: Task;
  settings: string[];
  said: ByHand;
  gate: number; // from 1
}

/** Borders are the same whatever these are. */
const without_effect = /^(fit\.|measures\.|manual\.(endo_points|epi_points|base_shift_mm|decision|reader|comment)$)/;

/** The heart is found in the same place whatever these are. */
const after_location = /^(edges|labels|prepare|closure|edge_map|field|noise_fraction|useful_slices|manual\.(first_slice|last_slice|base_plane_mm|base_shift_mm))\b/;
const located_name = "located.json";

function without({ task, settings, said, gate }: Wanted, left_out: RegExp): Wanted {
  const options = Object.entries(said.options).filter(([path]) => !left_out.test(path));
  return { task, settings: settings.filter((set) => !left_out.test(set)), said: { options: Object.fromEntries(options), paint: said.paint }, gate };
}
const has_same = (a: Wanted, b: Wanted): boolean => JSON.stringify(a.settings) === JSON.stringify(b.settings) && isSame(a.said, b.said);

export class Preview {
  private readonly runner = new Runner({ ahead: true });
  /** Where the heart was found, as the program told it, and what for. */
  private located: { of: Wanted; heart: unknown } | null = null;
  private next: Wanted | null = null;
  private is_busy = false;
  /** What is shown, or on its way; null: the borders of the run. */
  private last: Wanted | null = null;

  constructor(private readonly show: (found: FoundBorders | null) => void) {}

  /** `shown`: what the run that is shown was made with; with the same there is nothing to preview. */
  ask(asked: Wanted, shown: Wanted): void {
    if (asked.task.subject !== "ventricle") return;
    const wanted = without(asked, without_effect);
    const next = has_same(wanted, without(shown, without_effect)) ? null : wanted;
    if (next === null ? this.last === null : this.last?.gate === next.gate && has_same(next, this.last)) return;
    this.last = this.next = next;
    if (!next) this.show(null);
    else if (!this.is_busy) void this.work();
  }

  stop(): void {
    this.runner.stop();
    this.last = this.next = null;
    this.is_busy = false;
  }

  private async work(): Promise<void> {
    this.is_busy = true;
    for (let wanted = this.next; wanted; wanted = this.next) {
      this.next = null;
      const found = await this.look(wanted).catch((reason: unknown) => ({ refusal: text("lost", { reason: String(reason) }) }));
      if (wanted === this.last) this.show(found);
    }
    this.is_busy = false;
  }

  private async look(wanted: Wanted): Promise<FoundBorders> {
    const files: Piece[] = (await this.files_of(wanted.task)).map(({ path, bytes }) => ({ path, bytes: bytes.slice() }));
    if (wanted.said.paint) files.push({ path: mask_name, bytes: maskFile(wanted.said.paint) });
    const words = [...wanted.settings.flatMap((set) => ["--set", set]), ...argumentsOf(wanted.said).map((word) => (word === mask_name ? `/${mask_name}` : word))];
    const place = without(wanted, after_location);
    if (this.located?.of.task === place.task && has_same(this.located.of, place)) {
      files.push({ path: located_name, bytes: new TextEncoder().encode(JSON.stringify({ heart: this.located.heart })) });
      words.push("--located", `/${located_name}`);
    }
    const begin = performance.now();
    const command = ["borders", ...wanted.task.inputs, "--json", "--gate", String(wanted.gate), ...words];
    const lines: string[] = [];
    const word = await this.runner.run({ files, commands: [command], wanted: [] }, (line) => lines.push(line.text));
    if (word.kind !== "end" || word.code !== 0) return { refusal: reasonOf(word, lineOfError(lines))() };
    const seconds = (performance.now() - begin) / 1000;
    this.located = { of: place, heart: (JSON.parse(word.output) as { heart: unknown }).heart };
    return { text: word.output, seconds };
  }

  /** Files that commands make are made once. */
  private async files_of(task: Task): Promise<Piece[]> {
    if (!filesOf(task)) {
      const word = await this.runner.run({ files: [], commands: task.make, wanted: ["made"] });
      if (word.kind === "end") keepMade(task, word.files);
    }
    return filesOf(task) ?? [];
  }
}
