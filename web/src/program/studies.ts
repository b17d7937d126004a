// A folder of several studies, scans and results: a list with a picture of each, one to open, some to see side by side.
import { type Numbers, numbersOf, numbersText, taskOf } from "./history";
import type { Piece } from "./job";
import type { FoundResult } from "./results";
import { isScan } from "./scans";
import { text, told } from "./texts";

/** So many can be seen side by side: a browser draws some sixteen scenes, and a report has several. */
const most_beside = 4;

/** A study among the files that were given. */
export interface Found {
  /** The name of its file or folder. */
  place: string;
  /** "8 gates of 64 x 64 x 20, short axis, rest" */
  what: string;
  examination: number | null;
  files: Piece[];
  /** A result that was computed before. */
  result?: FoundResult;
  numbers?: Numbers | null;
}
interface Listed {
  studies?: { files: string[]; what: string; examination: number | null }[];
}
interface Pictured {
  picture?: { width: number; height: number; gray: string };
}

/** The studies that `dynasurf info /in --json` told of; none where the files make up one. */
function studiesOf(output: string, pieces: Piece[]): Found[] {
  const { studies } = JSON.parse(output) as Listed;
  const by_path = new Map(pieces.map((piece) => [piece.path, piece]));
  return (studies ?? []).map(({ files, what, examination }) => ({
    place: placeOf(files),
    what,
    examination,
    files: files.flatMap((file) => by_path.get(`in/${file}`) ?? []),
  }));
}

/** Each scan by itself. Plain text beside a study is no scan. */
const scansIn = (pieces: Piece[]): Found[] =>
  pieces.filter(({ path }) => isScan(path) && !/\.(txt|csv|asc)$/i.test(path)).map((piece) => ({ place: piece.path.replace(/^in\//, ""), what: "", examination: null, files: [piece] }));

/** The studies and scans of what was given, where it holds more than one. `list`: what `dynasurf info --json` tells of files. */
export async function severalIn(pieces: Piece[], list: (files: Piece[], input: string) => Promise<string | null>): Promise<Found[]> {
  const scans = scansIn(pieces);
  const others = pieces.filter((piece) => !scans.some(({ files }) => files[0] === piece));
  if (others.every(({ path }) => isScan(path))) return []; // the files of one scan
  const input = taskOf(others).inputs[0]!;
  if (scans.length === 0 && input !== "/in") return [];
  const output = await list(others, input);
  const found = output === null ? [] : studiesOf(output, others);
  if (scans.length === 0) return found;
  const one = { place: placeOf(others.map(({ path }) => path.replace(/^in\//, ""))), what: "", examination: null, files: others };
  return [...(found.length > 0 ? found : [one]), ...scans];
}

/** The numbers of a result; null: it is no heart's, or damaged. */
async function numbersIn({ given }: FoundResult): Promise<Numbers | null> {
  const file = given.find(({ path }) => path.endsWith("results.json"))!.file;
  return numbersOf([{ path: "dynasurf-result/results.json", bytes: new Uint8Array(await file.arrayBuffer()) }]);
}

/** By name, since a folder that is dropped tells its files in any order. */
export async function resultsIn(results: FoundResult[]): Promise<Found[]> {
  const found = await Promise.all(results.map(async (result) => ({ place: result.place, what: "", examination: null, files: [], result, numbers: await numbersIn(result).catch(() => null) })));
  return found.sort((a, b) => a.place.localeCompare(b.place, undefined, { numeric: true }));
}

/** What a study or a result is, in the language of the page. */
export function wordsOf({ what, files, result, numbers }: Found): string {
  if (!result) return files.every(({ path }) => isScan(path)) ? text("scan") : told(what);
  return numbers ? numbersText(numbers) : text("result");
}
const is_heart = ({ files, result, numbers }: Found) => (result ? Boolean(numbers) : !files.every(({ path }) => isScan(path)));

/** The map of the wall's brightness or thickness, as a picture; null: the result has none. */
async function mapOf({ given }: FoundResult): Promise<string | null> {
  const map = ["perfusion_percent", "thickness_ed_mm"].flatMap((name) => given.find(({ path }) => path.endsWith(`measures/polar_${name}.svg`)) ?? [])[0];
  return map ? `data:image/svg+xml,${encodeURIComponent(await map.file.text())}` : null;
}

/** The file, or the deepest folder that holds all of them. */
function placeOf(files: string[]): string {
  if (files.length === 1) return files[0]!;
  const folders = files.map((file) => file.split("/").slice(0, -1));
  const shared = folders[0]!.filter((part, n) => folders.every((folder) => folder[n] === part));
  return shared.join("/") || text("files_of", { n: files.length });
}

/** A result tells of rest and stress by its name alone. */
const says = ({ what, place, result }: Found, word: "rest" | "stress") =>
  result ? new RegExp(`(^|[^a-z])${word}([^a-z]|$)`, "i").test(place) : what.split(", ").includes(word);

/** Two studies of which one is of rest and one of stress, in this order; else null. */
export function restAndStress(a: Found, b: Found): [Found, Found] | null {
  if (says(a, "rest") && says(b, "stress")) return [a, b];
  return says(b, "rest") && says(a, "stress") ? [b, a] : null;
}

function draw(canvas: HTMLCanvasElement, { width, height, gray }: NonNullable<Pictured["picture"]>): void {
  Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(width, height);
  const bytes = atob(gray);
  for (let n = 0; n < width * height; ++n) {
    const value = 255 * Math.sqrt(bytes.charCodeAt(n) / 255); // lifts the dark greys
    image.data.set([value, value, value, 255], 4 * n);
  }
  context.putImageData(image, 0, 0);
}

export class StudyList {
  studies: Found[] = [];
  private readonly boxes: HTMLInputElement[] = [];

  constructor(
    private readonly list: HTMLElement,
    private readonly open: (study: Found) => void,
    /** So many are chosen as can be seen side by side, or not. */
    private readonly on_choice: (can_be_opened: boolean) => void,
  ) {}

  /** `describe` asks the program for a study's `info --json --picture`; null: it could not be read. */
  async show(studies: Found[], describe: (study: Found) => Promise<string | null>): Promise<void> {
    this.studies = studies;
    this.boxes.length = 0;
    const items = studies.map((study) => this.entry(study));
    this.list.replaceChildren(...items.map(({ item }) => item));
    this.choosePair();
    for (const [n, study] of studies.entries()) {
      if (study.result) {
        const map = await mapOf(study.result);
        if (map) items[n]!.canvas.replaceWith(Object.assign(new Image(), { src: map, alt: "" }));
        items[n]!.item.dataset.drawn = String(map !== null);
        continue;
      }
      const output = is_heart(study) ? await describe(study) : null;
      if (this.studies !== studies) return;
      const picture = output === null ? undefined : (JSON.parse(output) as Pictured).picture;
      if (picture) draw(items[n]!.canvas, picture);
      items[n]!.item.dataset.drawn = String(picture !== undefined);
    }
  }

  /** Those that are chosen, of two rest before stress; null: they cannot be seen side by side. */
  get chosen(): Found[] | null {
    const all = this.studies.filter((_, n) => this.boxes[n]!.checked);
    if (all.length < 2 || all.length > most_beside || !all.every(is_heart)) return null;
    return (all.length === 2 ? restAndStress(all[0]!, all[1]!) : null) ?? all;
  }

  /** Chooses rest and stress of an examination, where there is one pair. */
  private choosePair(): void {
    const pairs = this.studies.flatMap((a, i) =>
      this.studies.slice(i + 1).filter((b) => restAndStress(a, b) && a.examination === b.examination).map((b) => [a, b]),
    );
    if (pairs.length === 1) this.studies.forEach((study, n) => (this.boxes[n]!.checked = pairs[0]!.includes(study)));
    this.on_choice(this.chosen !== null);
  }

  private entry(study: Found): { item: HTMLElement; canvas: HTMLCanvasElement } {
    const item = document.createElement("li");
    const canvas = document.createElement("canvas");
    const box = Object.assign(document.createElement("input"), { type: "checkbox" });
    const label = document.createElement("label");
    const name = document.createElement("b");
    const words = document.createElement("span");
    const open = Object.assign(document.createElement("button"), { textContent: text("open") });
    canvas.setAttribute("aria-hidden", "true");
    name.textContent = study.place;
    words.textContent = wordsOf(study);
    box.addEventListener("change", () => this.on_choice(this.chosen !== null));
    open.setAttribute("aria-label", `${text("open")}: ${study.place}`);
    open.addEventListener("click", () => this.open(study));
    this.boxes.push(box);
    label.append(box, canvas, name, words);
    item.append(label, open);
    return { item, canvas };
  }
}
