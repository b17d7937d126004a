// A folder of several studies: a list with a picture of each, one to open, two to see side by side.
import type { Piece } from "./job";
import { text, told } from "./texts";

/** A study among the files that were given. */
export interface Found {
  /** The name of its file or folder. */
  place: string;
  /** "8 gates of 64 x 64 x 20, short axis, rest" */
  what: string;
  examination: number | null;
  files: Piece[];
}
interface Listed {
  studies?: { files: string[]; what: string; examination: number | null }[];
}
interface Pictured {
  picture?: { width: number; height: number; gray: string };
}

/** The studies that `dynasurf info /in --json` told of; none where the files make up one. */
export function studiesOf(output: string, pieces: Piece[]): Found[] {
  const { studies } = JSON.parse(output) as Listed;
  const by_path = new Map(pieces.map((piece) => [piece.path, piece]));
  return (studies ?? []).map(({ files, what, examination }) => ({
    place: placeOf(files),
    what,
    examination,
    files: files.flatMap((file) => by_path.get(`in/${file}`) ?? []),
  }));
}

/** The file, or the deepest folder that holds all of them. */
function placeOf(files: string[]): string {
  if (files.length === 1) return files[0]!;
  const folders = files.map((file) => file.split("/").slice(0, -1));
  const shared = folders[0]!.filter((part, n) => folders.every((folder) => folder[n] === part));
  return shared.join("/") || text("files_of", { n: files.length });
}

const says = (study: Found, word: string) => study.what.split(", ").includes(word);

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
    /** Two are chosen, or not. */
    private readonly on_choice: (is_pair: boolean) => void,
  ) {}

  /** `describe` asks the program for a study's `info --json --picture`; null: it could not be read. */
  async show(studies: Found[], describe: (study: Found) => Promise<string | null>): Promise<void> {
    this.studies = studies;
    this.boxes.length = 0;
    const items = studies.map((study) => this.entry(study));
    this.list.replaceChildren(...items.map(({ item }) => item));
    this.choosePair();
    for (const [n, study] of studies.entries()) {
      const output = await describe(study);
      if (this.studies !== studies) return;
      const picture = output === null ? undefined : (JSON.parse(output) as Pictured).picture;
      if (picture) draw(items[n]!.canvas, picture);
      items[n]!.item.dataset.drawn = String(picture !== undefined);
    }
  }

  /** The two that are chosen, rest before stress. */
  get pair(): [Found, Found] | null {
    const [a, b, ...more] = this.studies.filter((_, n) => this.boxes[n]!.checked);
    if (!a || !b || more.length > 0) return null;
    return restAndStress(a, b) ?? [a, b];
  }

  /** Chooses rest and stress of an examination, where there is one pair. */
  private choosePair(): void {
    const pairs = this.studies.flatMap((a, i) =>
      this.studies.slice(i + 1).filter((b) => restAndStress(a, b) && a.examination === b.examination).map((b) => [a, b]),
    );
    if (pairs.length === 1) this.studies.forEach((study, n) => (this.boxes[n]!.checked = pairs[0]!.includes(study)));
    this.on_choice(this.pair !== null);
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
    words.textContent = told(study.what);
    box.addEventListener("change", () => this.on_choice(this.pair !== null));
    open.setAttribute("aria-label", `${text("open")}: ${study.place}`);
    open.addEventListener("click", () => this.open(study));
    this.boxes.push(box);
    label.append(box, canvas, name, words);
    item.append(label, open);
    return { item, canvas };
  }
}
