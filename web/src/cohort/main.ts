// The page of a cohort: filters over everything, the list with the worst first, plots, triage by the keyboard.
import { byId, figure, html } from "../dom";
import { readCohort, recordedWords, type Statistic, type Study } from "./data";
import { markOf, StudyList } from "./list";
import { drawAgreement, drawHistogram, drawScatter, meansTable, normalRange, type Dot, type Ring } from "./plots";
import { curveThumb, polarThumb } from "./thumbs";
import { comment, decide, decisionOf, download } from "./triage";

const cohort = readCohort();
const list = new StudyList(cohort, (study) => choose(study));
let shown: number[] = [];
let rings: Ring[] = [];

// ---- Filters ----

interface Filter {
  passes(study: Study): boolean;
  clear(): void;
}
const filters: Filter[] = [];

function addSelect(name: string, values: string[], valuesOf: (study: Study) => string[]): void {
  if (values.length < 2 || values.length > 60) return;
  const select = html("select", { "aria-label": name }, html("option", { value: "" }, "all"), ...values.map((v) => html("option", { value: v }, v || "(not known)")));
  select.dataset["name"] = name;
  select.addEventListener("change", show);
  byId("filters").append(html("label", {}, `${name} `, select));
  // The first entry is no value: a group may be called "all".
  filters.push({
    passes: (study) => select.selectedIndex === 0 || valuesOf(study).includes(values[select.selectedIndex - 1]!),
    clear: () => (select.selectedIndex = 0),
  });
}

function different(values: string[]): string[] {
  return [...new Set(values)].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
}

/** Whether a column holds numbers that are no names of groups: truths, measures. */
function isMeasured(column: number): boolean {
  const values = different(cohort.studies.map((s) => s.groups[column] ?? ""));
  return values.length > 12 && values.every((v) => v === "" || !Number.isNaN(Number(v)));
}

/** A value of the table of studies with the digits that a reader wants. */
function shortened(value: string): string {
  return /^-?\d+\.\d{2,}$/.test(value) ? Number(value).toFixed(1) : value || "–";
}

/** What readers recorded in the results, apart from what is decided on this page. */
const decided = ["rejected", "accepted", "looked at", "nobody decided"];
const recordedOf = ({ manual }: Study): string => (manual ? manual.decision || "looked at" : "nobody decided");
const by_recorded: [string, string][] = cohort.studies.some(({ manual }) => manual) ? [["recorded", "recorded decision"]] : [];

function buildFilters(): void {
  const search = html("input", { type: "search", placeholder: "part of an id", "aria-label": "part of an id", size: 12 });
  search.addEventListener("input", show);
  byId("filters").append(html("label", {}, "Id ", search));
  filters.push({ passes: (study) => study.id.includes(search.value), clear: () => (search.value = "") });
  const stateOf = (study: Study) => (study.state === "done" ? study.verdict : study.state);
  addSelect("Verdict", different(cohort.studies.map(stateOf)), (study) => [stateOf(study)]);
  addSelect("Flag", different(cohort.studies.flatMap((s) => s.flags)), (study) => study.flags);
  cohort.groups.forEach((name, n) => isMeasured(n) || addSelect(name, different(cohort.studies.map((s) => s.groups[n] ?? "")), (study) => [study.groups[n] ?? ""]));
  if (by_recorded.length) addSelect("Recorded", different(cohort.studies.map(recordedOf)), (study) => [recordedOf(study)]);
  addSelect("Decision", ["accept", "reject", ""], (study) => [decisionOf(study.id).verdict]);
  const reset = html("button", { type: "button" }, "Show all");
  reset.addEventListener("click", () => {
    for (const filter of filters) filter.clear();
    show();
  });
  const save = html("button", { type: "button", id: "save", class: "end" }, "Download triage.tsv");
  save.addEventListener("click", () => download(cohort.studies.map((s) => s.id)));
  byId("filters").append(reset, save);
  byId("filters").addEventListener("submit", (event) => event.preventDefault());
}

// ---- Order and plots ----

function fillSelect(id: string, entries: [string, string][]): HTMLSelectElement {
  const select = byId<HTMLSelectElement>(id);
  select.append(...entries.map(([value, title]) => html("option", { value }, title)));
  select.addEventListener("change", show);
  return select;
}

const titles = cohort.keys.map(([, title], n): [string, string] => [String(n), title]);
const order = fillSelect("order", [["concern", "worst first"], ["id", "id"], ...by_recorded, ...titles]);
const number = fillSelect("number", titles);
const few = cohort.groups.map((_, n) => n).filter((n) => different(cohort.studies.map((s) => s.groups[n] ?? "")).length <= 6);
const by = fillSelect("by", [["", "nothing"], ["verdict", "verdict"], ...by_recorded, ...few.map((n): [string, string] => [String(n), cohort.groups[n]!])]);
// Which studies are normal only the reader knows: those of a group, or all.
const normals = few.flatMap((n) => different(cohort.studies.map((s) => s.groups[n] ?? "")).map((value): [number, string] => [n, value]));
const normal = fillSelect("normal", [["", "not known"], ["all", "all studies"], ...normals.map(([n, value], at): [string, string] => [String(at), `${cohort.groups[n]} ${value || "(not known)"}`])]);
// Truths of the table of studies, and the same number in another cohort, can be compared with too.
const truths = cohort.groups.map((name, n): [string, string] => [`group ${n}`, name]).filter(([, name]) => name.includes("_true_"));
const others: [string, string][] = cohort.second ? [["other", "the same in the other cohort"]] : [];
const second = fillSelect("second", titles);
const first = fillSelect("first", [...others, ...truths, ...titles]);

function groupOf(study: Study): string {
  if (by.value === "") return "all shown";
  if (by.value === "recorded") return recordedOf(study);
  return by.value === "verdict" ? (study.verdict || study.state) : (study.groups[Number(by.value)] || "(not known)");
}

function compared(index: number, key: number): number | null {
  const study = cohort.studies[index]!;
  if (first.value === "other") return cohort.second?.[index]?.[key] ?? null;
  if (!first.value.startsWith("group ")) return study.numbers[Number(first.value)] ?? null;
  const text = study.groups[Number(first.value.slice(6))] ?? "";
  return text === "" || Number.isNaN(Number(text)) ? null : Number(text);
}

function sorted(indices: number[]): number[] {
  const down = byId<HTMLInputElement>("up").checked ? -1 : 1;
  const studies = cohort.studies;
  if (order.value === "id") return indices.sort((a, b) => -down * studies[b]!.id.localeCompare(studies[a]!.id, "en", { numeric: true }));
  if (order.value === "concern") return indices.sort((a, b) => down * (studies[b]!.concern - studies[a]!.concern) || a - b);
  if (order.value === "recorded") {
    const rank = (n: number) => decided.indexOf(recordedOf(studies[n]!));
    return indices.sort((a, b) => down * (rank(a) - rank(b)) || a - b);
  }
  const key = Number(order.value);
  const at = (n: number) => studies[n]!.numbers[key];
  // What has no number comes last.
  return indices.sort((a, b) => Number(at(a) === null) - Number(at(b) === null) || down * ((at(b) ?? 0) - (at(a) ?? 0)) || a - b);
}

/** The normal range of a number, which it says in words too. */
function showNormals(key: number): [number, number] | undefined {
  const chosen = normals[Number(normal.value)];
  const isNormal = (s: Study) => normal.value === "all" || (normal.value !== "" && s.groups[chosen![0]] === chosen![1]);
  const values = cohort.studies.filter((s) => s.state === "done" && s.verdict !== "fail" && isNormal(s)).map((s) => s.numbers[key]);
  const known = values.filter((v): v is number => v !== null && v !== undefined);
  const range = normalRange(known);
  const words = range ? `Green: their middle 95 %, ${figure(range[0])} to ${figure(range[1])} ${cohort.keys[key]![2]}, n = ${known.length}.` : `A range needs 20 of them; n = ${known.length}.`;
  byId("normal-words").textContent = normal.value === "" ? "" : words;
  return range;
}

function drawPlots(): void {
  const key = Number(number.value);
  const unit = (n: number) => (cohort.keys[n]![2] ? `, ${cohort.keys[n]![2]}` : "");
  const groups = new Map<string, number[]>();
  for (const n of shown) {
    const value = cohort.studies[n]!.numbers[key];
    if (value === null || value === undefined) continue;
    const name = groupOf(cohort.studies[n]!);
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name)!.push(value);
  }
  const inOrder = new Map([...groups].sort(([a], [b]) => a.localeCompare(b)));
  const inkOf = new Map([...inOrder.keys()].map((name, n) => [name, n]));
  drawHistogram(byId("histogram"), inOrder, cohort.keys[key]![1] + unit(key), showNormals(key));
  byId("means").replaceChildren(...meansTable(inOrder));
  const dots: Dot[] = [];
  const differences: Dot[] = [];
  const wanted = Number(second.value);
  for (const n of shown) {
    const study = cohort.studies[n]!;
    const ink = inkOf.get(groupOf(study)) ?? 0;
    const [ef, edv] = study.numbers;
    if (ef != null && edv != null) dots.push({ x: edv, y: ef, study: n, ink });
    const [a, b] = [compared(n, wanted), study.numbers[wanted]];
    if (a != null && b != null) differences.push({ x: (a + b) / 2, y: first.value === "other" ? a - b : b - a, study: n, ink });
  }
  const [agreementRing, words] = drawAgreement(byId("agreement"), differences, cohort.keys[wanted]![2], choose);
  byId("agreement-words").textContent = words;
  rings = [drawScatter(byId("scatter"), dots, ["EDV, mL", "EF, %"], choose), agreementRing];
  for (const ring of rings) ring(list.chosen);
}

function show(): void {
  shown = sorted(cohort.studies.map((_, n) => n).filter((n) => filters.every((filter) => filter.passes(cohort.studies[n]!))));
  byId("shown").textContent = `${shown.length} of ${cohort.studies.length} studies`;
  list.show(shown);
  drawPlots();
}

// ---- One study ----

function act(verdict: "accept" | "reject"): void {
  const study = cohort.studies[list.chosen];
  if (!study) return;
  decide(study.id, verdict);
  const next = list.beside(1);
  if (next !== undefined && decisionOf(study.id).verdict) choose(next);
  else choose(list.chosen);
}

function openReport(): void {
  const address = cohort.studies[list.chosen]?.report;
  if (address) window.open(address, "_blank", "noopener");
}

function pictureOf(study: Study): HTMLElement {
  const png = cohort.pictures[study.id];
  if (png) return html("img", { src: `data:image/png;base64,${png}`, alt: "Slices of the heart at end diastole and end systole with both walls" });
  return html("div", { class: "none" }, study.state === "done" ? "Its slices are in its report." : study.state === "failed" ? "It has no result." : "It has not been run.");
}

function wordsOf(study: Study): HTMLElement {
  const groups = cohort.groups.map((name, n) => `${name} ${shortened(study.groups[n] ?? "")}`).join(" · ");
  const numbers = `EF ${figure(study.numbers[0])} %, EDV ${figure(study.numbers[1])} mL, ESV ${figure(study.numbers[2])} mL, muscle ${figure(study.numbers[4])} mL`;
  const said = study.state === "failed" ? study.reason : study.flags.length ? study.flags.join(", ") : "no flags";
  const recorded = [recordedWords(study), study.manual?.comment].filter(Boolean).join(": ");
  return html("div", {}, html("b", {}, study.id), " ", markOf(study), html("div", {}, study.state === "done" ? numbers : ""), html("div", { class: "recorded" }, recorded), html("div", { class: "words" }, said), html("small", { class: "dim" }, groups));
}

function choose(index: number): void {
  const study = cohort.studies[index];
  if (!study) return;
  list.mark(index);
  const decision = decisionOf(study.id);
  const button = (text: string, verdict: "accept" | "reject") => {
    const made = html("button", { type: "button", "aria-pressed": String(decision.verdict === verdict) }, text);
    made.addEventListener("click", () => act(verdict));
    return made;
  };
  const note = html("input", { id: "note", placeholder: "comment (C)", "aria-label": "comment", value: decision.comment });
  note.addEventListener("input", () => comment(study.id, note.value));
  const words = wordsOf(study);
  const actions = html("div", { class: "act" }, button("Accept (A)", "accept"), button("Reject (R)", "reject"));
  if (study.report) actions.append(html("a", { href: study.report, target: "_blank", rel: "noopener" }, "Report (Enter)"));
  words.append(actions, note);
  byId("one").replaceChildren(pictureOf(study), html("div", {}, polarThumb(study.perfusion, 112), curveThumb(study.curve, 112, 50)), words);
  for (const ring of rings) ring(index);
}

function onKey(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (target.id === "note" && (event.key === "Enter" || event.key === "Escape")) byId("list").focus();
  if (target.closest("input, select, textarea, button, a") || event.ctrlKey || event.metaKey || event.altKey) return;
  const page = Math.max(1, Math.floor(byId("list").clientHeight / 72) - 1);
  const steps: Record<string, number> = { ArrowDown: 1, j: 1, ArrowUp: -1, k: -1, PageDown: page, PageUp: -page, Home: -1e9, End: 1e9 };
  const step = steps[event.key];
  if (step !== undefined) {
    const next = list.beside(step);
    if (next !== undefined) choose(next);
  } else if (event.key === "a" || event.key === "A") act("accept");
  else if (event.key === "r" || event.key === "R") act("reject");
  else if (event.key === "c" || event.key === "C") byId("note")?.focus();
  else if (event.key === "Enter") openReport();
  else return;
  event.preventDefault();
}

// ---- Statistics ----

function intervalOf([, , , , , , , low, high]: Statistic): string {
  return low === null || high === null ? "" : `${figure(low, 2)} to ${figure(high, 2)}`;
}

function buildStatistics(): void {
  const head = ["statistic", "of", "against or in", "n", "left out", "value", "95 %"];
  const rows = cohort.statistics.map((s) => {
    const [statistic, of, against, group, n, out, value] = s;
    const small = statistic === "welch_p" && value !== null && value < 0.001;
    const cells = [statistic.replaceAll("_", " "), of, [against, group].filter(Boolean).join(", "), n, out, small ? "< 0.001" : figure(value, 3), intervalOf(s)];
    return html("tr", {}, ...cells.map((cell, c) => html("td", c > 2 ? { class: "number" } : {}, String(cell))));
  });
  const select = html("select", { "aria-label": "number" }, html("option", { value: "" }, "all numbers"), ...different(cohort.statistics.map((s) => s[1])).map((v) => html("option", { value: v }, v)));
  const body = html("tbody", {});
  const fill = () => body.replaceChildren(...rows.filter((_, n) => !select.value || cohort.statistics[n]![1] === select.value));
  if (cohort.statistics.some((s) => s[1] === "ef_percent")) select.value = "ef_percent";
  select.addEventListener("change", fill);
  fill();
  byId("statistics").append(select, html("table", {}, html("thead", {}, html("tr", {}, ...head.map((t, n) => html("th", n > 2 ? { class: "number" } : {}, t)))), body));
}

function start(): void {
  const count = (test: (study: Study) => boolean) => cohort.studies.filter(test).length;
  const parts = [
    `${cohort.studies.length} studies`,
    `${count((s) => s.verdict === "ok")} ok`,
    `${count((s) => s.verdict === "check")} to check`,
    `${count((s) => s.verdict === "fail")} not trustworthy`,
    `${count((s) => s.state === "failed")} failed`,
  ];
  const left = count((s) => s.state === "not_run");
  if (left) parts.push(`${left} not run`);
  byId("counts").textContent = parts.join(" · ");
  const edge = cohort.keys.findIndex(([name]) => name === "readings_edge_ef_percent");
  second.value = cohort.second || truths.length ? "0" : String(Math.max(edge, 0));
  first.value = cohort.second ? "other" : (truths.find(([, name]) => name === "ef_true_percent")?.[0] ?? "0");
  byId("up").addEventListener("change", show);
  buildFilters();
  buildStatistics();
  show();
  if (shown[0] !== undefined) choose(shown[0]);
  addEventListener("keydown", onKey);
  byId("list").focus();
}

start();
