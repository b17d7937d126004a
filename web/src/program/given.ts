// A copy of this page with a study and its result inside: what `Save as one page` writes, and what such a page starts with.
import { type Grid, unpack } from "../data";
import type { Given } from "./files";
import type { Run, Task } from "./history";
import type { Piece } from "./job";

/** A run and what it is of: `run` is shown at once. */
export interface Saved {
  task: Task;
  run: Run;
}
type PackedPiece = { path: string; deflated: string };
type PackedRun = Omit<Run, "result" | "said"> & { result: PackedPiece[]; options: Record<string, string>; paint: { grid: Grid; voxels: string } | null };
/** `dynasurf view` writes files alone, as if they were dropped; a saved page tells of its run. */
interface Packed {
  files: PackedPiece[];
  task?: Omit<Task, "files">;
  run?: PackedRun;
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

const packedPieces = (pieces: Piece[]): Promise<PackedPiece[]> =>
  Promise.all(pieces.map(async ({ path, bytes }) => ({ path, deflated: await deflated(bytes) })));
const unpackedPieces = (pieces: PackedPiece[]): Promise<Piece[]> =>
  Promise.all(pieces.map(async ({ path, deflated }) => ({ path, bytes: await unpack(deflated) })));

/** This page with a study and its result in it, as a file. */
export async function pageWith({ task: { files, ...task }, run: { said, result, ...run } }: Saved): Promise<string> {
  const packed: Packed = {
    files: await packedPieces(files),
    task,
    run: {
      ...run,
      result: await packedPieces(result),
      options: said.options,
      paint: said.paint && { grid: said.paint.grid, voxels: await deflated(said.paint.voxels) },
    },
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

/** What stands in this page: a saved run, or files as if they were dropped; null: nothing. Throws where it is damaged. */
export async function givenHere(): Promise<Saved | Given[] | null> {
  const text = document.getElementById("given")!.textContent!.trim();
  if (text === "") return null;
  const { files, task, run } = JSON.parse(text) as Packed;
  const pieces = await unpackedPieces(files);
  if (!task || !run) return pieces.map(({ path, bytes }) => ({ path, file: new File([bytes as BlobPart], path) }));
  const { options, paint, result, ...rest } = run;
  const said = { options, paint: paint && { grid: paint.grid, voxels: await unpack(paint.voxels) } };
  return { task: { ...task, files: pieces }, run: { ...rest, said, result: await unpackedPieces(result) } };
}
