// Two studies side by side: a report each, beats that go together, the difference of their numbers and maps.
import type { FromPage, FromReport } from "../host";
import { load } from "./frames";
import { figure, fileOf, numbersOf, taskOf } from "./history";
import type { Job, Piece } from "./job";
import { openResult } from "./results";
import { type Found, restAndStress, wordsOf } from "./studies";
import { spoken, text, told, translated } from "./texts";

const folders = ["first", "second"] as const;

/** Both studies are read, unless they are results already, then compared where they are of rest and stress. */
export async function pairJob(pair: [Found, Found]): Promise<Job> {
  const below = (path: string, folder: string) => path.replace(/^(\/?)in\b/, `$1of-${folder}`);
  const files: Piece[] = [];
  const commands: string[][] = [];
  for (const [n, study] of pair.entries()) {
    const folder = folders[n]!;
    if (study.result) {
      const { result } = await openResult(study.result, []);
      files.push(...result.map(({ path, bytes }) => ({ path: path.replace(/^dynasurf-result/, folder), bytes })));
      continue;
    }
    for (const { path, bytes } of study.files) files.push({ path: below(path, folder), bytes: bytes.slice() });
    commands.push(["ventricle", ...taskOf(study.files).inputs.map((input) => below(input, folder)), "--out", `/${folder}`]);
  }
  if (restAndStress(...pair)) commands.push(["perfusion", "compare", "/first", "/second", "--out", "/both"]);
  return { files, commands, wanted: [...folders, "both"] };
}

const partOf = (result: Piece[], folder: string) =>
  result.filter(({ path }) => path.startsWith(`${folder}/`)).map(({ path, bytes }) => ({ path: path.replace(`${folder}/`, "dynasurf-result/"), bytes }));

export class Pair {
  private leader = 0;
  private result: Piece[] = [];
  private difference = "";
  /** The last error that the program told. */
  private line = "";
  private shown: [Found, Found] | null = null;

  constructor(
    private readonly frames: [HTMLIFrameElement, HTMLIFrameElement],
    private readonly titles: [HTMLElement, HTMLElement],
    private both: HTMLIFrameElement,
    private readonly numbers: HTMLElement,
    private readonly complaint: HTMLElement,
  ) {
    addEventListener("message", (event: MessageEvent<FromReport>) => this.hear(event));
  }

  /** Whether the difference of the maps can be shown. */
  get has_difference(): boolean {
    return this.difference !== "";
  }

  get files(): Piece[] {
    return this.result;
  }

  /** Why there is no difference, in the program's words; its folders are called by where the studies came from. */
  private tellComplaint(): void {
    const reason = this.line.replace(/\/?\b(first|second)\b/, (_, folder: "first" | "second") => this.shown![folders.indexOf(folder)]!.place);
    const is_told = !this.difference && reason !== "";
    this.complaint.textContent = is_told ? text("not_compared", { reason: told(reason) }) : "";
    this.complaint.title = is_told && told(reason) !== reason ? reason : "";
  }

  /** Again in the language of the page. */
  speak(): void {
    if (!this.shown) return;
    const is_compared = this.both.srcdoc === this.difference;
    this.show(this.shown, this.result, this.line);
    if (is_compared) this.showDifference();
  }

  show(pair: [Found, Found], result: Piece[], line = ""): void {
    this.shown = pair;
    this.line = line;
    this.result = result;
    this.leader = 0;
    const page = (folder: string, name: string, in_words: (page: Uint8Array) => string) => in_words(fileOf(partOf(result, folder), name));
    folders.forEach((folder, n) => {
      this.frames[n] = load(this.frames[n]!, page(folder, "report.html", spoken));
      this.titles[n]!.textContent = `${pair[n]!.place} · ${wordsOf(pair[n]!)}`;
    });
    const is_compared = result.some(({ path }) => path === "both/comparison.html");
    this.difference = is_compared ? page("both", "comparison.html", translated) : "";
    this.tellComplaint();
    const [a, b] = folders.map((folder) => numbersOf(partOf(result, folder)));
    this.numbers.textContent = (["edv_ml", "esv_ml", "ef_percent"] as const)
      .map((key) => {
        const [left, right] = [a![key], b![key]];
        const change = left === null || right === null ? "" : ` (${right < left ? "−" : "+"}${figure(Math.abs(right - left))})`;
        return text(`pair_${key}`, { a: figure(left), b: figure(right) }) + change;
      })
      .join(" · ");
  }

  /** Loads the page of the difference, once it is seen. */
  showDifference(): void {
    if (this.difference && this.both.srcdoc !== this.difference) this.both = load(this.both, this.difference);
  }

  /** The report that was touched last leads; the other follows its beat. */
  private hear({ source, data }: MessageEvent<FromReport>): void {
    const from = this.frames.findIndex((frame) => frame.contentWindow === source);
    if (from < 0 || data?.dynasurf !== "report") return;
    const tell = (to: number, words: FromPage) => this.frames[to]!.contentWindow?.postMessage(words, "*");
    if (data.word === "ready") tell(from, { dynasurf: "page", word: "share" });
    if (data.word === "touched") this.leader = from;
    if (data.word !== "beat" || from !== this.leader) return;
    tell(1 - from, { dynasurf: "page", word: "beat", share: data.share });
  }
}
