// What a reader decides of each study, and the table that carries it out of the page.

export interface Decision {
  verdict: "" | "accept" | "reject";
  comment: string;
}

const decisions = new Map<string, Decision>();
let unsaved = false;

export function decisionOf(id: string): Decision {
  return decisions.get(id) ?? { verdict: "", comment: "" };
}

/** Says the same a second time: takes it back. */
export function decide(id: string, verdict: "accept" | "reject"): void {
  const before = decisionOf(id);
  decisions.set(id, { ...before, verdict: before.verdict === verdict ? "" : verdict });
  unsaved = true;
}

export function comment(id: string, text: string): void {
  decisions.set(id, { ...decisionOf(id), comment: text });
  unsaved = true;
}

/** The table, studies in the order of the cohort; a tab or line break in a comment becomes a blank. */
export function triageText(ids: string[]): string {
  const rows = ids
    .map((id) => ({ id, ...decisionOf(id) }))
    .filter((row) => row.verdict || row.comment)
    .map((row) => `${row.id}\t${row.verdict}\t${row.comment.replace(/\s/g, " ")}\n`);
  return `id\tdecision\tcomment\n${rows.join("")}`;
}

export function download(ids: string[]): void {
  const address = URL.createObjectURL(new Blob([triageText(ids)], { type: "text/tab-separated-values" }));
  const link = document.createElement("a");
  link.href = address;
  link.download = "triage.tsv";
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
  unsaved = false;
}

addEventListener("beforeunload", (event) => {
  if (unsaved) event.preventDefault();
});
