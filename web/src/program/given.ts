// A copy of this page with a study inside: what `Save as one page` writes, and what such a page starts with.
import { type Grid, unpack } from "../data";
import type { ByHand } from "../host";
import { named } from "./files";
import { type Task, taskOf } from "./history";

export interface Given {
  task: Task;
  settings: [string, string][];
  said: ByHand;
}
/** `dynasurf view` writes files alone; a saved page tells the rest. */
interface Packed extends Partial<Omit<Task, "files">> {
  files: { path: string; deflated: string }[];
  settings?: [string, string][];
  options?: Record<string, string>;
  /** The options of a former run, as its options.json has them. */
  options_json?: string;
  paint?: { grid: Grid; voxels: string } | null;
}

/** The page as it was when its script began: nothing of a run is in it. */
const untouched = document.body.innerHTML;

function base64Of(bytes: Uint8Array): string {
  let text = "";
  for (let n = 0; n < bytes.length; n += 0x8000) text += String.fromCharCode(...bytes.subarray(n, n + 0x8000));
  return btoa(text);
}

async function deflated(bytes: Uint8Array): Promise<string> {
  const stream = new Blob([bytes as BlobPart]).stream().pipeThrough(new CompressionStream("deflate"));
  return base64Of(new Uint8Array(await new Response(stream).arrayBuffer()));
}

/** This page with a study in it, as a file. */
export async function pageWith({ task, settings, said }: Given): Promise<string> {
  const { files, ...rest } = task;
  const packed: Packed = {
    ...rest,
    files: await Promise.all(files.map(async ({ path, bytes }) => ({ path, deflated: await deflated(bytes) }))),
    settings,
    options: said.options,
    paint: said.paint && { grid: said.paint.grid, voxels: await deflated(said.paint.voxels) },
  };
  const page = document.documentElement.cloneNode(true) as HTMLElement;
  for (const name of Object.keys(page.dataset)) delete page.dataset[name];
  const body = page.querySelector("body")!;
  body.innerHTML = untouched;
  // In a script "<" could begin a word that ends it.
  body.querySelector("#given")!.textContent = JSON.stringify(packed).replaceAll("<", "\\u003c");
  body.append(document.getElementById("engine")!.cloneNode(true));
  return `<!doctype html>\n${page.outerHTML}`;
}

/** What stands in this page; null: nothing. Throws where it is damaged. */
export async function givenHere(): Promise<Given | null> {
  const text = document.getElementById("given")!.textContent!.trim();
  if (text === "") return null;
  const packed = JSON.parse(text) as Packed;
  const files = await Promise.all(packed.files.map(async ({ path, deflated }) => ({ path, bytes: await unpack(deflated) })));
  const { subject, make, inputs, more } = packed;
  const task = subject && make && inputs && more ? { subject, make, inputs, more, files } : taskOf(named(files));
  if (packed.options_json) {
    task.files.push({ path: "options.json", bytes: new TextEncoder().encode(packed.options_json) });
    task.more.push("--options", "/options.json");
  }
  return {
    task,
    settings: packed.settings ?? [],
    said: { options: packed.options ?? {}, paint: packed.paint ? { grid: packed.paint.grid, voxels: await unpack(packed.paint.voxels) } : null },
  };
}
