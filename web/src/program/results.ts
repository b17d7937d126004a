// Results among what is given: folders that hold a report.html and a results.json. They are shown without a run, and run
// again where their study is given too.
import { type Paint, paintOf } from "../host";
import { type Given, Refusal } from "./files";
import { fileOf, type Task, taskOf } from "./history";
import type { Piece } from "./job";

/** The folder of a result; its files are read once somebody opens it. */
export interface FoundResult {
  place: string;
  given: Given[];
}

interface ResultRecord {
  schema?: string;
  provenance?: {
    inputs?: { bytes?: number; sha256?: string }[];
    given?: { mask_sha256?: string | null; start_mesh_sha256?: string | null };
  };
}

/** A result in memory, and what is needed to run it again. */
export interface Opened {
  place: string;
  result: Piece[];
  /** Null: its study or its mask is not among what was given. */
  task: Task | null;
  paint: Paint | null;
}

const folderOf = (path: string) => path.slice(0, path.lastIndexOf("/") + 1);

/** What a result holds beside its folders. Files that were given without a folder may hold its study as well. */
const own_files = /^(report\.(html|pdf)|results\.(json|csv)|options\.json|manifest\.txt|live\.html|cycle\.(glb|pvd)|levels\.glb)$/;
const belongs = (path: string, folder: string) =>
  path.startsWith(folder) && (!["", "in/"].includes(folder) || path.slice(folder.length).includes("/") || own_files.test(path.slice(folder.length)));

/** Parts what is given into results and the rest. */
export function partResults<T extends { path: string }>(given: T[]): { results: { place: string; given: T[] }[]; rest: T[] } {
  const paths = new Set(given.map(({ path }) => path));
  const folders = given.flatMap(({ path }) => (/(^|\/)results\.json$/.test(path) && paths.has(`${folderOf(path)}report.html`) ? [folderOf(path)] : []));
  const owner = ({ path }: T) => folders.filter((folder) => belongs(path, folder)).sort((a, b) => b.length - a.length)[0];
  const results = folders.map((folder) => ({ place: folder === "in/" ? "result" : (folder.split("/").at(-2) ?? "result"), given: given.filter((file) => owner(file) === folder) }));
  return { results, rest: given.filter((file) => owner(file) === undefined) };
}

export const isOptions = ({ path }: Piece): boolean => /(^|\/)options\.json$/i.test(path);

/** A file of an archive as if it was given by itself. */
export const asGiven = ({ path, bytes }: Piece): Given => ({ path, file: new File([bytes as BlobPart], path) });

async function hashOf(bytes: Uint8Array): Promise<string> {
  const hash = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes as BufferSource));
  return [...hash].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** The files with these hashes, in their order; null where one is missing. */
async function filesWith(wanted: { bytes?: number; sha256?: string }[], pieces: Piece[]): Promise<Piece[] | null> {
  const sizes = new Set(wanted.map(({ bytes }) => bytes));
  const by_hash = new Map<string, Piece>();
  for (const piece of pieces) if (sizes.has(undefined) || sizes.has(piece.bytes.length)) by_hash.set(await hashOf(piece.bytes), piece);
  const found = wanted.flatMap(({ sha256 }) => by_hash.get(sha256 ?? "") ?? []);
  return found.length === wanted.length && found.length > 0 ? found : null;
}

export const recordOf = (result: Piece[]): ResultRecord => JSON.parse(new TextDecoder().decode(fileOf(result, "results.json")) || "{}") as ResultRecord;

/** The study that a result was made from, ready to be run again; null where not all of it is among the pieces. */
export async function studyOf(result: Piece[], pieces: Piece[]): Promise<{ task: Task; paint: Paint | null } | null> {
  const { inputs = [], given = {} } = recordOf(result).provenance ?? {};
  const can_hash = crypto.subtle !== undefined; // only where the browser takes a page from a disk for secure
  const files = can_hash && !given.start_mesh_sha256 ? await filesWith(inputs, pieces) : null;
  if (!files) return null;
  const mask = given.mask_sha256 ? await filesWith([{ sha256: given.mask_sha256 }], pieces) : null;
  const paint = mask && paintOf(mask[0]!.bytes);
  return given.mask_sha256 && !paint ? null : { task: taskOf(files), paint };
}

/** Reads a result. Throws Refusal for one whose report this page cannot show. `beside`: what else was given. */
export async function openResult({ place, given }: FoundResult, beside: Piece[]): Promise<Opened> {
  const root = folderOf(given.find(({ path }) => path.endsWith("results.json"))!.path);
  const result = await Promise.all(
    given.map(async ({ path, file }) => ({ path: `dynasurf-result/${path.slice(root.length)}`, bytes: new Uint8Array(await file.arrayBuffer()) })),
  );
  if (!isOfThisVersion(new TextDecoder().decode(fileOf(result, "report.html")))) throw new Refusal("other_version", place);
  const study = await studyOf(result, beside);
  return { place, result, task: study?.task ?? null, paint: study?.paint ?? null };
}

/** Whether this page lets the scripts of a report run: they are those of its own version. */
function isOfThisVersion(report: string): boolean {
  const policy = document.querySelector<HTMLMetaElement>('meta[http-equiv="Content-Security-Policy"]')!.content;
  const hash = /script-src ('sha256-[^']+')/.exec(report)?.[1];
  return hash !== undefined && policy.includes(hash);
}
