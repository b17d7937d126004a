// The list of studies: only the rows in view are in the page, so that ten thousand scroll smoothly.
import { byId, figure, html } from "../dom";
import { type Cohort, recordedWords, type Study } from "./data";
import { curveThumb, polarThumb, sliceThumb } from "./thumbs";
import { decisionOf } from "./triage";

const rowHeight = 72;
const spare = 4; // rows above and below those in view

export function markOf(study: Study): HTMLElement {
  const word = study.state === "done" ? study.verdict : study.state.replace("_", " ");
  return html("span", { class: `mark ${study.state === "done" ? study.verdict : study.state}` }, word);
}

export class StudyList {
  private readonly view = byId<HTMLDivElement>("list");
  private readonly space = byId<HTMLDivElement>("space");
  private readonly rows = new Map<number, HTMLElement>();
  private order: number[] = [];
  private due = false;
  chosen = -1;

  constructor(
    private readonly cohort: Cohort,
    private readonly choose: (study: number) => void,
  ) {
    this.view.addEventListener("scroll", () => this.later());
    addEventListener("resize", () => this.later());
  }

  show(order: number[]): void {
    this.order = order;
    this.space.style.height = `${order.length * rowHeight}px`;
    this.forget();
  }

  /** Draws the rows anew. */
  forget(): void {
    for (const row of this.rows.values()) row.remove();
    this.rows.clear();
    this.draw();
  }

  /** The study that is `steps` further down than the chosen one. */
  beside(steps: number): number | undefined {
    const at = this.order.indexOf(this.chosen);
    return this.order[at < 0 ? 0 : Math.min(Math.max(at + steps, 0), this.order.length - 1)];
  }

  /** Chooses, and brings into view. */
  mark(study: number): void {
    this.renew(this.chosen);
    this.renew(study);
    this.chosen = study;
    const at = this.order.indexOf(study);
    if (at >= 0) {
      const top = at * rowHeight;
      if (top < this.view.scrollTop) this.view.scrollTop = top;
      if (top + rowHeight > this.view.scrollTop + this.view.clientHeight) this.view.scrollTop = top + rowHeight - this.view.clientHeight;
    }
    this.draw();
  }

  /** Takes the row of a study out, to be drawn anew. */
  private renew(study: number): void {
    const at = this.order.indexOf(study);
    this.rows.get(at)?.remove();
    this.rows.delete(at);
  }

  private later(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  private draw(): void {
    const from = Math.max(0, Math.floor(this.view.scrollTop / rowHeight) - spare);
    const to = Math.min(this.order.length, Math.ceil((this.view.scrollTop + this.view.clientHeight) / rowHeight) + spare);
    for (const [at, row] of this.rows)
      if (at < from || at >= to) {
        row.remove();
        this.rows.delete(at);
      }
    for (let at = from; at < to; ++at) {
      if (this.rows.has(at)) continue;
      const row = this.rowOf(this.order[at]!);
      row.style.top = `${at * rowHeight}px`;
      this.rows.set(at, row);
      this.space.append(row);
    }
  }

  private rowOf(index: number): HTMLElement {
    const study = this.cohort.studies[index]!;
    const decision = decisionOf(study.id);
    const recorded = recordedWords(study);
    const row = html(
      "div",
      { class: index === this.chosen ? "row chosen" : "row", role: "option", "aria-selected": String(index === this.chosen) },
      html("div", {}, html("b", { title: study.id }, study.id), markOf(study), html("span", { class: "decision" }, decision.verdict ? ` ${decision.verdict}ed` : ""), html("small", { class: "recorded", title: recorded }, recorded)),
      html("div", {}, html("span", { class: "big" }, `${figure(study.numbers[0], 0)} %`), html("br"), html("small", {}, `${figure(study.numbers[1], 0)} / ${figure(study.numbers[2], 0)} mL`)),
      sliceThumb(this.cohort.pictures[study.id], 58),
      polarThumb(study.perfusion, 58),
      curveThumb(study.curve, 96, 52),
      html("div", { class: "words" }, study.state === "failed" ? study.reason : study.flags.join(", ")),
    );
    row.addEventListener("click", () => this.choose(index));
    return row;
  }
}
