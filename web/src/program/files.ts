// Files that a user gives: picked, dropped, in folders, in zip archives.
import { unzip, zipSync } from "fflate";
import type { Piece } from "./job";

/** Most bytes that are taken into memory: the program's address space has 4 GB, and needs room to work. */
const most_bytes = 2 ** 30;

/** `code` names a text of texts.ts. */
export class Refusal extends Error {
  constructor(
    readonly code: "too_large" | "no_zip" | "empty" | "other_version" | "lone_options",
    readonly about: string,
  ) {
    super(code);
  }
}

/** Names as the program gets them: any character it may meet in a path becomes one that needs no encoding. */
const plain = (path: string) =>
  path
    .split("/")
    .filter((part) => part !== "" && part !== "." && part !== "..")
    .map((part) => part.replace(/[^\w.\- ]/g, "_"))
    .join("/");

const is_zip = (bytes: Uint8Array) => bytes[0] === 0x50 && bytes[1] === 0x4b && bytes[2] === 3 && bytes[3] === 4;

/** The files of an archive. What its directory declares is counted before anything is unpacked. */
function unpacked(archive: Piece): Promise<Piece[]> {
  let declared = 0;
  return new Promise((done, fail) =>
    unzip(archive.bytes, { filter: (entry) => (declared += entry.originalSize) <= most_bytes }, (error, entries) => {
      if (error) fail(new Refusal("no_zip", archive.path));
      else if (declared > most_bytes) fail(new Refusal("too_large", archive.path));
      else
        done(
          Object.entries(entries)
            .filter(([path]) => !path.endsWith("/") && !path.startsWith("__MACOSX/"))
            .map(([path, bytes]) => ({ path, bytes })),
        );
    }),
  );
}

export interface Given {
  path: string;
  file: File;
}

/** Reads what was given, with archives unpacked, below the folder "in", each path once. */
export async function read_given(given: Given[]): Promise<Piece[]> {
  if (given.reduce((sum, { file }) => sum + file.size, 0) > most_bytes) throw new Refusal("too_large", given[0]!.path);
  const pieces: Piece[] = [];
  for (const { path, file } of given) {
    const piece = { path, bytes: new Uint8Array(await file.arrayBuffer()) };
    if (is_zip(piece.bytes)) pieces.push(...(await unpacked(piece)));
    else pieces.push(piece);
  }
  if (pieces.length === 0) throw new Refusal("empty", given[0]?.path ?? "");
  return named(pieces);
}

/** The pieces below the folder "in", each path once. */
export function named(pieces: Piece[]): Piece[] {
  const taken = new Set<string>();
  return pieces.map(({ path, bytes }) => {
    let name = `in/${plain(path) || "file"}`;
    while (taken.has(name)) name = name.replace(/([^/]*)$/, "_$1");
    taken.add(name);
    return { path: name, bytes };
  });
}

async function entries_in(entry: FileSystemEntry, at: string): Promise<Given[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((done, fail) => (entry as FileSystemFileEntry).file(done, fail));
    return [{ path: at + entry.name, file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: Given[] = [];
  for (;;) {
    // A browser gives the entries of a folder in portions, and an empty one at the end.
    const some = await new Promise<FileSystemEntry[]>((done, fail) => reader.readEntries(done, fail));
    if (some.length === 0) return found;
    for (const inner of some) found.push(...(await entries_in(inner, `${at}${entry.name}/`)));
  }
}

/** A folder as Chromium hands it over beside its entry. */
interface Folder {
  kind: "directory";
  name: string;
  values(): AsyncIterable<Folder | { kind: "file"; name: string; getFile(): Promise<File> }>;
}

async function files_of(folder: Folder, at: string): Promise<Given[]> {
  const found: Given[] = [];
  for await (const inner of folder.values()) {
    const path = `${at}/${inner.name}`;
    if (inner.kind === "directory") found.push(...(await files_of(inner, path)));
    else found.push({ path, file: await inner.getFile() });
  }
  return found;
}

type Item = DataTransferItem & { getAsFileSystemHandle?(): Promise<Folder | null> };

/** To a page that was opened from a disk Chromium gives files and handles of folders, and refuses the files of entries. */
export async function dropped(transfer: DataTransfer): Promise<Given[]> {
  // All of it is asked for at once: after the event the items are empty.
  const items = ([...transfer.items] as Item[])
    .filter(({ kind }) => kind === "file")
    .map((item) => {
      const entry = item.webkitGetAsEntry();
      return { entry, file: item.getAsFile(), folder: entry?.isDirectory ? item.getAsFileSystemHandle?.() : undefined };
    });
  const found = await Promise.all(
    items.map(async ({ entry, file, folder }) => {
      if (!entry?.isDirectory) return file ? [{ path: file.name, file }] : [];
      const handle = await folder;
      return handle ? files_of(handle, handle.name) : entries_in(entry, "");
    }),
  );
  return found.flat();
}

export const picked = (list: FileList): Given[] =>
  [...list].map((file) => ({ path: file.webkitRelativePath || file.name, file }));

/** Offers bytes as a file to save. */
export function save(bytes: Uint8Array | string, name: string, type: string): void {
  const url = URL.createObjectURL(new Blob([bytes as BlobPart], { type }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

export function as_zip(pieces: Piece[]): Uint8Array {
  return zipSync(Object.fromEntries(pieces.map(({ path, bytes }) => [path, bytes])), { level: 6 });
}
