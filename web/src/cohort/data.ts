// What the program puts into the page of a cohort.

export interface Study {
  id: string;
  groups: string[];
  state: "done" | "failed" | "not_run";
  verdict: string;
  reason: string;
  flags: string[];
  /** What a reader recorded of the result before; absent where nobody did. */
  manual?: { decision: "" | "accepted" | "rejected"; reader: string; comment: string };
  /** How much it asks to be looked at; the largest first. */
  concern: number;
  wall_s: number | null;
  /** One a key number. */
  numbers: (number | null)[];
  /** Percent, one a segment. */
  perfusion: (number | null)[];
  /** Volume of the cavity, mL, one a gate. */
  curve: (number | null)[];
  /** Address of its report; empty without one. */
  report: string;
}

/** Statistic, of what, against what, group, n, left out, value, low and high end of its 95 % interval. */
export type Statistic = [string, string, string, string, number, number, number | null, number | null, number | null];

export interface Cohort {
  groups: string[];
  /** Name, title, unit. */
  keys: [string, string, string][];
  studies: Study[];
  /** Slices as PNG in base64, of the worst studies, by id. */
  pictures: Record<string, string>;
  statistics: Statistic[];
  /** Key numbers of the same studies in another cohort; empty lists for those it has not. */
  second: (number | null)[][] | null;
}

/** The recorded decision in words: "accepted by A. Reader"; empty: nobody decided. */
export function recordedWords({ manual }: Study): string {
  return manual ? `${manual.decision || "looked at"}${manual.reader && ` by ${manual.reader}`}` : "";
}

export function readCohort(): Cohort {
  return JSON.parse(document.getElementById("data")!.textContent!) as Cohort;
}
