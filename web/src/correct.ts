// Corrections by hand in the report: handles on its slices, and the page around it that runs the study again.
import { HandTool } from "./byhand";
import { Wall } from "./cycle";
import { readPreview, readReport, toVoxels, walls as wall_names, type Mesh, type Preview, type Results } from "./data";
import { byId, figure } from "./dom";
import type { FieldView } from "./field";
import type { FoundBorders, FromPage, FromReport } from "./host";
import type { Painter } from "./painter";
import type { Player } from "./player";
import type { Slices } from "./slices";
import { say, told } from "./words";

/** Handles on the slices, and their bar above them. */
export function buildHand(painter: Painter | null, slices: Slices | null, results: Results, player: Player): HandTool | null {
  const button = byId<HTMLButtonElement>("toggle-hand");
  button.disabled = !painter || !slices;
  if (!painter || !slices) return null;
  const hand = new HandTool(byId("hand"), painter, results, () => slices.draw());
  slices.tool = hand;
  button.addEventListener("click", () => {
    player.pause();
    hand.toggle();
    button.setAttribute("aria-pressed", String(hand.on));
    slices.layOut();
  });
  document.addEventListener("keydown", (event) => {
    if (!hand.on || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || (event.target as HTMLElement).closest("input")) return;
    event.preventDefault();
    hand.undo();
  });
  player.listen(() => {
    if (player.gate === hand.gate) return;
    hand.gate = player.gate;
    if (hand.on) hand.refresh();
  });
  return hand;
}

/** A page around the report may run the study again; it tells what was said before, and which result to compare with. */
export function joinHost(hand: HandTool | null, painter: Painter | null, slices: Slices | null, field: FieldView | null, player: Player): void {
  if (parent === window) return;
  const tell = (word: FromReport) => parent.postMessage(word, "*");
  addEventListener("message", (event: MessageEvent<FromPage>) => {
    if (event.source !== parent || event.data?.dynasurf !== "page") return;
    if (event.data.word === "borders") return void preview(event.data.found, painter, slices, field, player);
    if (event.data.word !== "study") return;
    hand?.serve((said, run, gate, at_once) => tell({ dynasurf: "report", word: "by hand", said, run, gate, at_once }), event.data.said, event.data.at_once);
    void compareWith(event.data.before, painter, slices);
    offerRecords();
    if (event.data.panel) document.getElementById(event.data.panel)?.scrollIntoView({ block: "start" });
    if (!event.data.correcting || !hand || hand.on) return;
    byId("toggle-hand").click();
    byId("toggle-hand").scrollIntoView({ block: "center" });
  });
  for (const [name, setting] of Object.entries(records))
    byId(`record-${name}`).addEventListener("click", () => tell({ dynasurf: "report", word: "run with", settings: [setting], panel: `${name}-panel` }));
  tell({ dynasurf: "report", word: "ready" });
}

/** What a run can record to be understood. */
const records: { [name: string]: [string, string] } = { motion: ["evolution.trajectory_every", "5"], contours: ["pipeline", "contour"] };

/** Offers what this run has not recorded. */
function offerRecords(): void {
  const has = (name: string) => document.getElementById(`${name}-panel`) !== null;
  byId("record-panel").hidden = has("contours"); // which have no meshes on their way
  for (const name of Object.keys(records)) byId(`record-${name}`).hidden = has(name);
}

function wordsOf(found: FoundBorders | null, preview: Preview | null): string {
  if (!found) return "";
  if ("refusal" in found) return say("No preview: {reason}", { reason: found.refusal });
  if (!preview) return say("The stack would be cut anew: run again to see its borders");
  return [say("Borders of gate {n} as they would be found ({s} s)", { n: preview.gate + 1, s: figure(found.seconds, 2) }), ...preview.warnings.map(told)].join(" · ");
}

/** Shows the borders and the field of one gate as they would be found; null: those of the run again. */
async function preview(found: FoundBorders | null, painter: Painter | null, slices: Slices | null, field: FieldView | null, player: Player): Promise<void> {
  if (!painter || !slices) return;
  painter.preview = found && "text" in found ? await readPreview(found.text, painter.pictures) : null;
  byId("preview").textContent = wordsOf(found, painter.preview);
  field?.preview(painter.preview);
  if (painter.preview && player.gate !== painter.preview.gate) {
    player.pause();
    player.seek(painter.preview.gate);
  }
  slices.draw();
}

/** Outlines of another result of the study, dashed. */
async function compareWith(data: string | null, painter: Painter | null, slices: Slices | null): Promise<void> {
  if (!painter || !slices) return;
  const surfaces = data ? (await readReport(data)).surfaces : null;
  const here = (mesh: Mesh | null) => mesh && { ...mesh, voxel: toVoxels(painter.grid, mesh.world) };
  const moved = surfaces && { ...surfaces, endo: surfaces.endo.map(here), epi: surfaces.epi.map(here) };
  painter.before = moved ? wall_names.map((name) => new Wall(name, moved)) : [];
  byId("before-legend").hidden = !moved;
  slices.draw();
}
