// Why a job failed, in the language of the page.
import type { Word } from "./job";
import { text, told } from "./texts";

/** The program's own line, without its name. */
export const lineOfError = (lines: readonly string[]): string | undefined =>
  lines.filter((line) => line.includes("error: ")).at(-1)?.replace(/^.*?error: /, "").replaceAll("/in/", "").replace(/^\/in: /, `${text("given")}: `);

export const mb = (bytes: number): number => Math.round(bytes / 1e6);

/** `complaint`: the last error that the program told. The answer speaks the language of the moment when it is asked. */
export function reasonOf(word: Word, complaint: string | undefined): () => string {
  const is_memory = complaint === "out of memory" || (word.kind === "lost" && /memory|allocation/i.test(word.reason));
  if (is_memory) return () => text("out_of_memory", { mb: mb(word.memory) });
  if (word.kind === "lost") return () => text("lost", { reason: word.reason });
  return complaint ? () => told(complaint) : () => text("failed");
}

/** A command that answers a question was refused. */
export class Complaint extends Error {
  constructor(readonly say: () => string) {
    super(say());
  }
}
