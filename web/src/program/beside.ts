// Studies side by side: a report each, beats that go together; of two the difference of their numbers, of rest and stress
// that of their maps.
import type { FromPage, FromReport } from "../host";
import { load } from "./frames";
import { figure, fileOf, numbersOf, taskOf } from "./history";
import type { Job, Piece } from "./job";
import { openResult } from "./results";
import { type Found, restAndStress, wordsOf } from "./studies";
import { spoken, text, told, translated } from "./texts";

/** Folders of the results, one for each study. */
const folders = ["first", "second", "third", "fourth"] as const;
type Folder = (typeof folders)[number];

/** All studies are read, unless they are results already; two of rest and stress are compared. */
export async function besideJob(studies: Found[]): Promise<Job> {
  const below = (path: string, folder: string) => path.replace(/^(\/?)in\b/, `$1of-${folder}`);
  const files: Piece[] = [];
  const commands: string[][] = [];
  for (const [n, study] of studies.entries()) {
    const folder = folders[n]!;
    if (study.result) {
      const { result } = await openResult(study.result, []);
      files.push(...result.map(({ path, bytes }) => ({ path: path.replace(/^dynasurf-result/, folder), bytes })));
      continue;
    }
    for (const { path, bytes } of study.files) files.push({ path: below(path, folder), bytes: bytes.slice() });
    commands.push(["ventricle", ...taskOf(study.files).inputs.map((input) => below(input, folder)), "--out", `/${folder}`]);
  }
  const [a, b, ...more] = studies;
  if (more.length === 0 && restAndStress(a!, b!)) commands.push(["perfusion", "compare", "/first", "/second", "--out", "/both"]);
  return { files, commands, wanted: [...folders, "both"] };
}

/** Whether the job made a report of each study. */
export const hasAll = (files: Piece[], studies: Found[]): boolean =>
  studies.every((_, n) => files.some(({ path }) => path === `${folders[n]}/report.html`));

const partOf = (result: Piece[], folder: string) =>
  result.filter(({ path }) => path.startsWith(`${folder}/`)).map(({ path, bytes }) => ({ path: path.replace(`${folder}/`, "dynasurf-result/"), bytes }));

export class SideBySide {
  private frames: HTMLIFrameElement[] = [];
  private leader = 0;
  private result: Piece[] = [];
  private difference = "";
  /** The last error that the program told. */
  private line = "";
  private shown: Found[] = [];

  constructor(
    /** Holds the reports, and after them the page of the difference. */
    private readonly stand: HTMLElement,
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
    const reason = this.line.replace(/\/?\b(first|second|third|fourth)\b/, (_, folder: Folder) => this.shown[folders.indexOf(folder)]!.place);
    const is_told = !this.difference && reason !== "";
    this.complaint.textContent = is_told ? text("not_compared", { reason: told(reason) }) : "";
    this.complaint.title = is_told && told(reason) !== reason ? reason : "";
  }

  /** Again in the language of the page. */
  speak(): void {
    if (this.shown.length === 0) return;
    const is_compared = this.both.srcdoc === this.difference;
    this.show(this.shown, this.result, this.line);
    if (is_compared) this.showDifference();
  }

  show(studies: Found[], result: Piece[], line = ""): void {
    this.shown = studies;
    this.line = line;
    this.result = result;
    this.leader = 0;
    const page = (folder: string, name: string, in_words: (page: Uint8Array) => string) => in_words(fileOf(partOf(result, folder), name));
    for (const half of this.stand.querySelectorAll(".half")) half.remove();
    this.frames = studies.map((study, n) => {
      const half = document.createElement("div");
      const title = document.createElement("h2");
      const frame = Object.assign(document.createElement("iframe"), { id: folders[n]!, allow: "fullscreen *", title: `${text("report")}: ${study.place}` });
      half.className = "half";
      title.id = `${folders[n]}-title`;
      title.textContent = `${study.place} · ${wordsOf(study)}`;
      half.append(title, frame);
      this.both.before(half);
      return load(frame, page(folders[n]!, "report.html", spoken));
    });
    const is_compared = result.some(({ path }) => path === "both/comparison.html");
    this.difference = is_compared ? page("both", "comparison.html", translated) : "";
    this.tellComplaint();
    const all = studies.map((_, n) => numbersOf(partOf(result, folders[n]!))!);
    this.numbers.textContent = (["edv_ml", "esv_ml", "ef_percent"] as const)
      .map((key) => {
        const [first = null, ...others] = all.map((numbers) => numbers[key]);
        const other = others.length === 1 ? others[0]! : null;
        const change = first === null || other === null ? "" : ` (${other < first ? "−" : "+"}${figure(Math.abs(other - first))})`;
        return text(`beside_${key}`, { a: figure(first), b: others.map(figure).join(" → ") }) + change;
      })
      .join(" · ");
  }

  /** Loads the page of the difference, once it is seen. */
  showDifference(): void {
    if (this.difference && this.both.srcdoc !== this.difference) this.both = load(this.both, this.difference);
  }

  /** The report that was touched last leads; the others follow its beat. */
  private hear({ source, data }: MessageEvent<FromReport>): void {
    const from = this.frames.findIndex((frame) => frame.contentWindow === source);
    if (from < 0 || data?.dynasurf !== "report") return;
    const tell = (frame: HTMLIFrameElement | undefined, words: FromPage) => frame?.contentWindow?.postMessage(words, "*");
    if (data.word === "ready") tell(this.frames[from], { dynasurf: "page", word: "share" });
    if (data.word === "touched") this.leader = from;
    if (data.word !== "beat" || from !== this.leader) return;
    for (const [to, frame] of this.frames.entries()) if (to !== from) tell(frame, { dynasurf: "page", word: "beat", share: data.share });
  }
}
