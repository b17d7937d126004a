// Light or dark, as the system asks for, until a reader chooses: `data-theme` of the root holds the choice.
import type { FromPage, FromReport, Theme } from "./host";

/** Lets a button change between light and dark, here and in the page around. Returns what its key does. */
export function buildTheme(button: HTMLElement): () => void {
  const { dataset } = document.documentElement;
  const asked = matchMedia("(prefers-color-scheme: light)");
  const isLight = () => (dataset.theme ? dataset.theme === "light" : asked.matches);
  const tell = (theme: Theme | null) => {
    if (parent !== window) parent.postMessage({ dynasurf: "report", word: "theme", theme } satisfies FromReport, "*");
  };
  const show = (theme?: Theme) => {
    if (theme) dataset.theme = theme;
    button.setAttribute("aria-pressed", String(isLight()));
  };
  const toggle = () => {
    const theme = isLight() ? "dark" : "light";
    show(theme);
    tell(theme);
  };
  asked.addEventListener("change", () => show());
  addEventListener("message", ({ source, data }: MessageEvent<FromPage>) => {
    if (source === parent && data?.dynasurf === "page" && data.word === "theme") show(data.theme);
  });
  button.addEventListener("click", toggle);
  show();
  tell(null);
  return toggle;
}
