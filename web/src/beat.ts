// A page that shows two reports keeps their beats together: the one that is touched leads.
import type { FromPage, FromReport } from "./host";
import type { Player } from "./player";

export function shareBeat(player: Player): void {
  if (parent === window) return;
  const tell = (word: FromReport) => parent.postMessage(word, "*");
  let shared = false;
  let follows = false;
  player.listen((phase) => {
    if (shared && !follows) tell({ dynasurf: "report", word: "beat", share: phase / player.gates });
  });
  for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, () => shared && tell({ dynasurf: "report", word: "touched" }), { capture: true });
  addEventListener("message", ({ source, data }: MessageEvent<FromPage>) => {
    if (source !== parent || data?.dynasurf !== "page") return;
    if (data.word === "share") shared = true;
    if (data.word !== "beat") return;
    follows = true;
    player.pause();
    player.seek(data.share * player.gates);
    follows = false;
  });
}
