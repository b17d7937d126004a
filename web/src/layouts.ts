// Which panels are on the screen: all of them, or those for one question, as large as the window allows.
import { byId, html } from "./dom";
import { say } from "./words";

const layouts = [say("Everything"), say("Surfaces"), say("Slices"), say("Surfaces and slices"), say("Polar map"), say("Curve and gates")];

function toggleFullScreen(): void {
  if (document.fullscreenElement) void document.exitFullscreen();
  else document.documentElement.requestFullscreen().catch(() => (byId<HTMLButtonElement>("full-screen").disabled = true));
}

/** Fills the control of the toolbar; returns what the keys 1 to 6 and X do. */
export function buildLayouts(): Record<string, () => void> {
  const control = byId<HTMLSelectElement>("layout");
  control.replaceChildren(...layouts.map((name, n) => html("option", { value: n + 1 }, `${n + 1} ${name}`)));
  const show = (layout: string) => {
    control.value = layout;
    document.querySelector("main")!.dataset.layout = layout;
    // What was asked for starts below the toolbar; everything starts with the verdict.
    if (layout === "1") scrollTo({ top: 0 });
    else byId("toolbar").scrollIntoView();
  };
  control.addEventListener("change", () => show(control.value));
  const keys: Record<string, () => void> = {};
  layouts.forEach((_, n) => (keys[String(n + 1)] = () => show(String(n + 1))));
  const button = byId<HTMLButtonElement>("full-screen");
  button.disabled = !document.fullscreenEnabled;
  button.addEventListener("click", toggleFullScreen);
  document.addEventListener("fullscreenchange", () => button.setAttribute("aria-pressed", String(document.fullscreenElement !== null)));
  if (!button.disabled) keys.x = toggleFullScreen;
  return keys;
}
