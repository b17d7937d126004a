// Short questions to the program, asked beside whatever it works on.
import { Runner } from "./engine";
import { Complaint, lineOfError, reasonOf } from "./failure";
import type { Task } from "./history";
import type { Piece } from "./job";
import { settingsBetween } from "./options";

const asked = new Runner();
let before: Promise<unknown> = Promise.resolve();

/** What a short command prints, after the ones before. Throws Complaint with the program's line. */
export function answer(command: string[], files: Piece[] = []): Promise<string> {
  const mine = before.then(() => ask(command, files));
  before = mine.catch(() => {});
  return mine;
}

async function ask(command: string[], files: Piece[]): Promise<string> {
  const lines: string[] = [];
  const word = await asked.run({ files, commands: [command], wanted: [] }, (line) => lines.push(line.text));
  if (word.kind === "end" && word.code === 0) return word.output;
  throw new Complaint(reasonOf(word, lineOfError(lines)));
}

/** What a file of options sets. Throws the program's line where it is none. */
export async function settings_of(subject: Task["subject"], bytes: Uint8Array): Promise<[string, string][]> {
  const files = [{ path: "options.json", bytes: bytes.slice() }];
  return settingsBetween(await answer(["options", subject, "--json"]), await answer(["options", subject, "--options", "options.json", "--json"], files));
}
