// Light or dark: what a reader chooses in one report holds for the page and for every report in it.
import type { FromPage, FromReport } from "../host";

export function shareTheme(): void {
  const { dataset } = document.documentElement;
  addEventListener("message", ({ source, data }: MessageEvent<FromReport>) => {
    if (data?.dynasurf !== "report" || data.word !== "theme") return;
    const reports = [...document.querySelectorAll("iframe")].map((frame) => frame.contentWindow);
    if (!reports.some((report) => report === source)) return;
    if (data.theme) dataset.theme = data.theme;
    const theme = dataset.theme;
    if (theme !== "light" && theme !== "dark") return; // as the system asks for
    const told: FromPage = { dynasurf: "page", word: "theme", theme };
    for (const report of reports) report?.postMessage(told, "*");
  });
}
