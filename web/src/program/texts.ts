// All texts of the page by name, in English. The other languages are the files of translations/, packed into the page;
// a report gets its table when it is shown, so that what is saved stays English.
import { inflateSync, strFromU8 } from "fflate";

import { bytesOf } from "../data";
import { type Translation, type Values, Words } from "../words";

/** Each file of translations/ by its name: deflated, in base64. */
declare const TRANSLATIONS: Record<string, string>;

const english = {
  title: "Dynasurf in this browser",
  research: "Research use only. Not for diagnosis.",
  lead: "Left ventricle from a gated study, light meshes from a scan.",
  drop: "Drop a study or a scan here",
  kinds: "DICOM files, folders or a zip; NIfTI, NRRD; points and surfaces as PLY, XYZ, OBJ, STL, LAS, E57",
  files: "Choose files",
  folder: "Choose a folder",
  or_try: "Or try an example",
  example_patient: "Virtual patient",
  example_vase: "Scan of a vase",
  promise: "Nothing leaves this computer. The page has no access to any network:",
  promise_check: "disconnect, or read connect-src 'none' in its source.",
  options: "Options",
  options_head: "Options of the next run",
  options_search: "Search options",
  options_changed: "{n} changed",
  reset: "Reset",
  copy: "Copy as command line",
  copied: "Copied",
  save_options: "Save options.json",
  run_again: "Run again",
  unset: "unset",
  studies: "{n} studies",
  studies_words: "Open one, or choose two to four to see them side by side.",
  open: "Open",
  open_beside: "Side by side",
  to_list: "All studies",
  files_of: "{n} files",
  difference: "Difference of the maps",
  beside_edv_ml: "EDV {a} → {b} mL",
  beside_esv_ml: "ESV {a} → {b} mL",
  beside_ef_percent: "EF {a} → {b} %",
  working: "Working",
  cancel: "Cancel",
  cancelled: "Cancelled. Nothing of this run was kept.",
  memory: "{mb} MB of memory, at most 4,096",
  done: "Done in {s} s, {mb} MB of memory",
  done_check: "Done in {s} s, {mb} MB of memory. Not trustworthy by its own checks: read the verdict.",
  other: "Open another",
  undo: "Undo",
  redo: "Redo",
  history: "History",
  history_head: "Runs of this study",
  history_words: "Choose which one is shown, and which one it is compared with.",
  as_found: "As found",
  run_name: "Name of run {n}",
  shown: "Shown",
  compared_with: "Compared with",
  numbers: "EDV {edv} mL, ESV {esv} mL, EF {ef} %",
  before: "EDV {edv} mL (before {edv0}), EF {ef} % ({ef0})",
  verdict_ok: "checks passed",
  verdict_check: "check this result",
  verdict_fail: "failed",
  save: "Save",
  save_dicom: "Save as DICOM",
  save_dicom_title: "Measurements, segmentations and surfaces as objects of the patient's study, with name and id",
  save_page: "Save as one page",
  save_page_title: "This page with the study inside, as it is, names too",
  back: "Back to the result",
  save_zip: "Save all as zip",
  save_report: "Save the report",
  report: "Report",
  given: "folder",
  failed: "This could not be done",
  lost: "The program stopped unexpectedly ({reason}).",
  out_of_memory: "Out of memory: {mb} MB were in use. A smaller study or fewer points need less.",
  too_large: "{about}: more than 1 GB; expected less",
  no_zip: "{about}: the zip archive is damaged; expected one that can be unpacked",
  empty: "Nothing was given; expected at least one file",
  other_version: "{about}: made by another version of the program; open its report.html, or drop its study here",
  lone_options: "{about}: options without a study; drop both together, or first the study",
  opened: "Opened: {place}",
  opened_alone: "Opened: {place}. To run it again, drop its study here too.",
  scan: "scan",
  result: "result",
  old_browser: "This browser is too old. Expected Chrome or Edge 95, Firefox 113, Safari 16.4 or later.",
  not_compared: "Not compared: {reason}",
  language: "Language",
  range: "{low} to {high}",
  language_waits: "First run again what was changed by hand, or reset it",
  stage_start: "Start",
  stage_read: "Reading files",
  stage_borders: "Borders",
  stage_surfaces: "Surfaces",
  stage_points: "Points",
  stage_inside: "Inside and outside",
  stage_levels: "Levels of detail",
  stage_write: "Writing",
};
export type Key = keyof typeof english;

export const languages = ["en", ...Object.keys(TRANSLATIONS)];

const tables = new Map<string, Translation>();

/** The table of a language; null: English. */
function tableOf(name: string): Translation | null {
  const packed = TRANSLATIONS[name];
  if (packed === undefined) return null;
  const table = tables.get(name) ?? (JSON.parse(strFromU8(inflateSync(bytesOf(packed)))) as Translation);
  tables.set(name, table);
  return table;
}

const wished = navigator.language.split("-")[0]!;
let chosen = languages.includes(wished) ? wished : "en";
let words = new Words(tableOf(chosen));
export const language = () => chosen;
export const name_of = (name: string): string => tableOf(name)?.name ?? "English";

/** The text with its {places} filled. */
export const text = (key: Key, values: Values = {}): string => words.say(english[key], values);

export const number = (value: number, decimals: number): string => words.number(value, decimals);

/** What the program says of a study. */
export const told = (sentence: string): string => words.told(sentence);

/** The description of an option or its unit. */
export const described = (english: string): string => words.described(english);

/** A stage of the program by its name in the table, else as the program calls it. */
export function stage_name(stage: string): string {
  const key = `stage_${stage}`;
  return key in english ? text(key as Key) : stage;
}

/** A report that the program wrote, with the table that it speaks by. */
export function spoken(report: Uint8Array): string {
  const page = new TextDecoder().decode(report);
  const data = page.indexOf('<script type="application/json" id="data">');
  const table = tableOf(chosen);
  if (!table || data < 0) return page;
  const json = JSON.stringify(table).replaceAll("<", "\\u003c"); // in a script "<" could begin a word that ends it
  const head = page.slice(0, data).replace('<html lang="en">', `<html lang="${chosen}">`);
  return `${head}<script type="application/json" id="words">${json}</script>\n${page.slice(data)}`;
}

/** A page of the program that has no script. */
export function translated(plain: Uint8Array): string {
  const page = new DOMParser().parseFromString(new TextDecoder().decode(plain), "text/html");
  words.translate(page, true);
  page.documentElement.lang = chosen;
  return `<!doctype html>\n${page.documentElement.outerHTML}`;
}

/** Writes the texts of a language into all elements that name one. */
export function speak(next: string): void {
  chosen = next;
  words = new Words(tableOf(next));
  document.documentElement.lang = next;
  document.title = `${text("title")} – Dynasurf`;
  for (const element of document.querySelectorAll<HTMLElement>("[data-text]"))
    element.textContent = text(element.dataset.text as Key);
  for (const element of document.querySelectorAll<HTMLElement>("[data-title]"))
    element.title = text(element.dataset.title as Key);
  for (const element of document.querySelectorAll<HTMLElement>("[data-label]")) {
    element.setAttribute("aria-label", text(element.dataset.label as Key));
    if (element instanceof HTMLInputElement) element.placeholder = text(element.dataset.label as Key);
  }
}
