// All texts of the page, one table: a language is a column. English is complete by its type, the others by theirs.
const english = {
  title: "Dynasurf in this browser",
  research: "Research use only. Not for diagnosis.",
  lead: "Left ventricle from a gated study, light meshes from a scan.",
  drop: "Drop a study or a scan here",
  kinds: "DICOM files, folders or a zip; NIfTI, NRRD; points and surfaces as PLY, XYZ, OBJ, STL, LAS",
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
  studies_words: "Open one, or choose two to see them side by side.",
  open: "Open",
  open_pair: "Side by side",
  to_list: "All studies",
  files_of: "{n} files",
  difference: "Difference of the maps",
  pair_edv_ml: "EDV {a} → {b} mL",
  pair_esv_ml: "ESV {a} → {b} mL",
  pair_ef_percent: "EF {a} → {b} %",
  working: "Working",
  cancel: "Cancel",
  cancelled: "Cancelled. Nothing was kept.",
  memory: "{mb} MB of memory",
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
  save_page: "Save as one page",
  save_page_title: "This page with the study inside, as it is, names too",
  back: "Back to the result",
  save_zip: "Save all as zip",
  save_report: "Save the report",
  report: "Report",
  failed: "This could not be done",
  lost: "The program stopped unexpectedly ({reason}).",
  out_of_memory: "Out of memory: {mb} MB were in use. A smaller study or fewer points need less.",
  too_large: "{about}: more than 1 GB; expected less",
  no_zip: "{about}: the zip archive is damaged; expected one that can be unpacked",
  empty: "Nothing was given; expected at least one file",
  old_browser: "This browser is too old. Expected Chrome or Edge 95, Firefox 113, Safari 16.4 or later.",
  language: "Language",
  stage_start: "Start",
  stage_read: "Reading",
  stage_borders: "Borders",
  stage_surfaces: "Surfaces",
  stage_points: "Points",
  stage_inside: "Inside and outside",
  stage_levels: "Levels of detail",
  stage_write: "Writing",
};
export type Key = keyof typeof english;
type Table = Record<Key, string>;

const german: Table = {
  title: "Dynasurf in diesem Browser",
  research: "Nur für die Forschung. Nicht zur Diagnose.",
  lead: "Der linke Ventrikel aus einer getriggerten Studie, leichte Netze aus einem Scan.",
  drop: "Studie oder Scan hierher ziehen",
  kinds: "DICOM-Dateien, Ordner oder ein Zip; NIfTI, NRRD; Punkte und Flächen als PLY, XYZ, OBJ, STL, LAS",
  files: "Dateien wählen",
  folder: "Ordner wählen",
  or_try: "Oder ein Beispiel",
  example_patient: "Virtueller Patient",
  example_vase: "Scan einer Vase",
  promise: "Nichts verlässt diesen Rechner. Die Seite erreicht kein Netz:",
  promise_check: "Netz trennen oder connect-src 'none' im Quelltext nachlesen.",
  options: "Optionen",
  options_head: "Optionen des nächsten Laufs",
  options_search: "Optionen suchen",
  options_changed: "{n} geändert",
  reset: "Zurücksetzen",
  copy: "Als Befehlszeile kopieren",
  copied: "Kopiert",
  save_options: "options.json sichern",
  run_again: "Noch einmal rechnen",
  unset: "nicht gesetzt",
  studies: "{n} Studien",
  studies_words: "Öffnen Sie eine, oder wählen Sie zwei, um sie nebeneinander zu sehen.",
  open: "Öffnen",
  open_pair: "Nebeneinander",
  to_list: "Alle Studien",
  files_of: "{n} Dateien",
  difference: "Unterschied der Karten",
  pair_edv_ml: "EDV {a} → {b} mL",
  pair_esv_ml: "ESV {a} → {b} mL",
  pair_ef_percent: "EF {a} → {b} %",
  working: "Rechnet",
  cancel: "Abbrechen",
  cancelled: "Abgebrochen. Nichts wurde behalten.",
  memory: "{mb} MB Speicher",
  done: "Fertig in {s} s, {mb} MB Speicher",
  done_check: "Fertig in {s} s, {mb} MB Speicher. Nach eigener Prüfung nicht vertrauenswürdig: siehe Urteil.",
  other: "Andere öffnen",
  undo: "Rückgängig",
  redo: "Wiederholen",
  history: "Verlauf",
  history_head: "Läufe dieser Studie",
  history_words: "Wählen Sie, welcher gezeigt und mit welchem er verglichen wird.",
  as_found: "Wie gefunden",
  run_name: "Name von Lauf {n}",
  shown: "Gezeigt",
  compared_with: "Verglichen mit",
  numbers: "EDV {edv} mL, ESV {esv} mL, EF {ef} %",
  before: "EDV {edv} mL (vorher {edv0}), EF {ef} % ({ef0})",
  verdict_ok: "Prüfungen bestanden",
  verdict_check: "dieses Ergebnis prüfen",
  verdict_fail: "gescheitert",
  save_page: "Als eine Seite sichern",
  save_page_title: "Diese Seite mit der Studie darin, wie sie ist, mit Namen",
  back: "Zurück zum Ergebnis",
  save_zip: "Alles als Zip sichern",
  save_report: "Bericht sichern",
  report: "Bericht",
  failed: "Das ging nicht",
  lost: "Das Programm hielt unerwartet an ({reason}).",
  out_of_memory: "Zu wenig Speicher: {mb} MB waren belegt. Eine kleinere Studie oder weniger Punkte brauchen weniger.",
  too_large: "{about}: mehr als 1 GB; erwartet wurde weniger",
  no_zip: "{about}: das Zip-Archiv ist beschädigt; erwartet wurde eines, das sich auspacken lässt",
  empty: "Nichts wurde übergeben; erwartet wurde mindestens eine Datei",
  old_browser: "Dieser Browser ist zu alt. Erwartet: Chrome oder Edge 95, Firefox 113, Safari 16.4 oder neuer.",
  language: "Sprache",
  stage_start: "Start",
  stage_read: "Lesen",
  stage_borders: "Ränder",
  stage_surfaces: "Flächen",
  stage_points: "Punkte",
  stage_inside: "Innen und außen",
  stage_levels: "Detailstufen",
  stage_write: "Schreiben",
};

export const languages = { en: english, de: german };
export type Language = keyof typeof languages;

let chosen: Language = navigator.language.startsWith("de") ? "de" : "en";
export const language = () => chosen;

/** The text with its {places} filled. */
export function text(key: Key, values: Record<string, string | number> = {}): string {
  return languages[chosen][key].replace(/{(\w+)}/g, (place, name) => String(values[name] ?? place));
}

/** A stage of the program by its name in the table, else as the program calls it. */
export function stage_name(stage: string): string {
  const key = `stage_${stage}`;
  return key in english ? text(key as Key) : stage;
}

/** Writes the texts of a language into all elements that name one. */
export function speak(next: Language): void {
  chosen = next;
  document.documentElement.lang = next;
  document.title = `${text("title")} – Dynasurf`;
  for (const element of document.querySelectorAll<HTMLElement>("[data-text]"))
    element.textContent = text(element.dataset.text as Key);
  for (const element of document.querySelectorAll<HTMLElement>("[data-title]"))
    element.title = text(element.dataset.title as Key);
  for (const element of document.querySelectorAll<HTMLElement>("[data-label]"))
    element.setAttribute("aria-label", text(element.dataset.label as Key));
}
