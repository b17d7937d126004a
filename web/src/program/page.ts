// The views of the page, of which one is shown, its progress, and why something could not be done.
import { Complaint, mb } from "./failure";
import { Refusal } from "./files";
import { stage_name, text } from "./texts";

export const by_id = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const views = ["start", "studies", "working", "failure", "result", "beside"] as const;

/** Says again why something failed. */
let say_reason = (): void => {};
/** Again in the language of the page. */
export const tell_reason = (): void => say_reason();

export function show(view: (typeof views)[number]): void {
  for (const name of views) by_id(name).hidden = name !== view;
  // Where a report has its own header the page's is hidden, but for the choice of language.
  const [choice, bar] = [document.querySelector(".language")!, by_id(view).querySelector(".bar p")];
  if (bar) bar.after(choice);
  else document.querySelector("header")!.append(choice);
  document.documentElement.dataset.view = view;
}

/** `say`: the reason in the language of the page; `own`: the program's line that it is a translation of; one searches for it. */
export function fail(say: () => string, own = ""): void {
  say_reason = () => {
    by_id("reason").textContent = say();
    by_id("reason").title = own === say() ? "" : own;
  };
  say_reason();
  show("failure");
  by_id("failure").querySelector("button")?.focus();
}

function fail_by(error: unknown): void {
  if (error instanceof Complaint) fail(error.say);
  else fail(() => (error instanceof Refusal ? text(error.code, { about: error.about }) : text("lost", { reason: String(error) })));
}

/** A menu that closes after a choice, and when one goes elsewhere. */
export function close_by_itself(menu: HTMLDetailsElement): void {
  const close = () => (menu.open = false);
  menu.addEventListener("click", (event) => (event.target as HTMLElement).closest("button") && close());
  document.addEventListener("pointerdown", (event) => menu.contains(event.target as Node) || close());
  window.addEventListener("blur", close); // into the report
  menu.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    close();
    menu.querySelector("summary")!.focus();
  });
}

/** Does something, and tells why it could not be done. */
export async function attempt(work: () => unknown): Promise<void> {
  try {
    await work();
  } catch (error) {
    fail_by(error);
  }
}

export function tell_progress(line: string, memory: number): void {
  by_id("memory").textContent = text("memory", { mb: mb(memory) });
  const words = /^(\w+) (\d+)\/(\d+)$/.exec(line);
  if (!words) return;
  const [, stage, done, total] = words;
  const bar = by_id<HTMLProgressElement>("progress");
  by_id("stage").textContent = `${stage_name(stage!)} ${Number(total) > 1 ? `${done}/${total}` : ""}`;
  if (Number(total) > 1) bar.value = Number(done) / Number(total);
  else bar.removeAttribute("value");
}
