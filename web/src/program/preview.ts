// The borders of one gate and the fields around them, computed again while a person still drags or chooses.
import { argumentsOf, type ByHand, maskFile, mask_name } from "../host";
import { Runner } from "./engine";
import type { Task } from "./history";
import type { Piece } from "./job";

export interface Wanted {
  task: Task;
  settings: string[];
  said: ByHand;
  gate: number; // from 1
}
export type Found = { text: string; seconds: number };

/** The fit and the reader are told of these, and borders are the same without. */
const without_effect = /^(fit\.|measures\.|manual\.(endo_points|epi_points|base_shift_mm|decision|reader|comment)$)/;

/** What a look at the borders depends on. */
function words_of({ settings, said }: Wanted): string[] {
  const options = Object.fromEntries(Object.entries(said.options).filter(([path]) => !without_effect.test(path)));
  return [...settings.filter((set) => !without_effect.test(set)).flatMap((set) => ["--set", set]), ...argumentsOf({ options, paint: said.paint })];
}
const key_of = (wanted: Wanted): string => JSON.stringify([words_of(wanted), wanted.said.paint && [...wanted.said.paint.voxels].join("")]);

export class Preview {
  private readonly runner = new Runner();
  private made: { task: Task; files: Piece[] } | null = null;
  private next: Wanted | null = null;
  private is_busy = false;
  /** What is shown, or on its way. */
  private last = "";

  constructor(private readonly show: (found: Found | null) => void) {}

  /** `shown`: what the run that is shown was made with; with the same there is nothing to preview. */
  ask(wanted: Wanted, shown: Wanted): void {
    const key = key_of(wanted) === key_of(shown) ? "" : key_of(wanted) + String(wanted.gate);
    if (key === this.last || wanted.task.subject !== "ventricle") return;
    this.last = key;
    this.next = key === "" ? null : wanted;
    if (key === "") return this.show(null);
    if (!this.is_busy) void this.work();
  }

  stop(): void {
    this.runner.stop();
    this.next = null;
    this.is_busy = false;
    this.last = "";
  }

  private async work(): Promise<void> {
    this.is_busy = true;
    for (let wanted = this.next; wanted; wanted = this.next) {
      this.next = null;
      const key = this.last;
      const found = await this.look(wanted);
      if (key === this.last) this.show(found);
    }
    this.is_busy = false;
  }

  /** Null: nothing is found, or what is said is no sense; the run tells why. */
  private async look(wanted: Wanted): Promise<Found | null> {
    const files: Piece[] = (await this.files_of(wanted.task)).map(({ path, bytes }) => ({ path, bytes: bytes.slice() }));
    if (wanted.said.paint) files.push({ path: mask_name, bytes: maskFile(wanted.said.paint) });
    const words = words_of(wanted).map((word) => (word === mask_name ? `/${mask_name}` : word));
    const begin = performance.now();
    const command = ["borders", ...wanted.task.inputs, ...wanted.task.more, "--json", "--gate", String(wanted.gate), ...words];
    const word = await this.runner.run({ files, commands: [command], wanted: [] });
    return word.kind === "end" && word.code === 0 ? { text: word.output, seconds: (performance.now() - begin) / 1000 } : null;
  }

  /** Files that commands make are made once. */
  private async files_of(task: Task): Promise<Piece[]> {
    if (task.make.length === 0) return task.files;
    if (this.made?.task !== task) {
      const word = await this.runner.run({ files: [], commands: task.make, wanted: ["made"] });
      this.made = { task, files: word.kind === "end" ? word.files : [] };
    }
    return this.made.files;
  }
}
