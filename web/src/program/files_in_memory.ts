// Files in memory, as the program finds them: the library of WASI with what the program asks beyond it.
import { Directory, File, type Inode, OpenFile } from "@bjorn3/browser_wasi_shim";
import type { Piece } from "./job";

// A file that has a name has a link; the library tells none, and the program takes such a file for removed.
for (const kind of [File, Directory]) {
  const plain = kind.prototype.stat;
  kind.prototype.stat = function (this: File & Directory) {
    const facts = plain.call(this);
    facts.nlink = 1n;
    return facts;
  };
}

// The library copies a file for every write that makes it longer; room that doubles makes a long file linear in time.
const rooms = new WeakMap<File, ArrayBufferLike>();
const write_in_place = OpenFile.prototype.fd_write;
OpenFile.prototype.fd_write = function (this: OpenFile, bytes: Uint8Array) {
  const { file } = this;
  const length = Number(this.file_pos) + bytes.byteLength;
  if (!file.readonly && length > file.data.byteLength) {
    let room = rooms.get(file);
    if (room !== file.data.buffer || length > room.byteLength) {
      const wider = new Uint8Array(Math.max(length, 2 * file.data.byteLength, 4096));
      wider.set(file.data);
      rooms.set(file, (room = wider.buffer));
    }
    file.data = new Uint8Array(room as ArrayBuffer, 0, length);
  }
  return write_in_place.call(this, bytes);
};

export function tree_of(files: Piece[]): Map<string, Inode> {
  const root = new Map<string, Inode>([["tmp", new Directory(new Map())]]);
  for (const { path, bytes } of files) {
    const parts = path.split("/");
    const name = parts.pop()!;
    let folder = root;
    for (const part of parts) {
      let inner = folder.get(part);
      if (!(inner instanceof Directory)) folder.set(part, (inner = new Directory(new Map())));
      folder = (inner as Directory).contents;
    }
    const file = new File([]);
    file.data = bytes; // not copied
    folder.set(name, file);
  }
  return root;
}

export function files_in(folder: Map<string, Inode>, at: string, found: Piece[] = []): Piece[] {
  for (const [name, entry] of folder)
    if (entry instanceof Directory) files_in(entry.contents, `${at}${name}/`, found);
    else if (entry instanceof File) found.push({ path: at + name, bytes: rooms.has(entry) ? entry.data.slice() : entry.data });
  return found;
}

/** An empty file that has no name. */
export const nothing = () => new OpenFile(new File([]));
