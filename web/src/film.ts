// A film of the beat as a file: the surfaces as they are turned, the slice and both cuts of the cursor.
import { byId, figure, html, saveFile } from "./dom";
import type { Results } from "./data";
import type { Player } from "./player";
import type { SurfaceScene } from "./scene";
import { webm } from "./webm";
import { say } from "./words";

const beats = 2;
const per_second = 30;
const [width, height, bar] = [1280, 720, 40];
const ground = "#0d1218";

type Box = [x: number, y: number, width: number, height: number];

/** As large as it fits, in the middle. */
function fit(context: CanvasRenderingContext2D, from: HTMLCanvasElement, [x, y, w, h]: Box): void {
  if (from.width === 0 || from.height === 0) return;
  const scale = Math.min(w / from.clientWidth, h / from.clientHeight);
  const [wide, high] = [from.clientWidth * scale, from.clientHeight * scale];
  context.drawImage(from, x + (w - wide) / 2, y + (h - high) / 2, wide, high);
}

export class Film {
  private readonly canvas = html("canvas", { width, height });
  private readonly context = this.canvas.getContext("2d")!;

  constructor(
    private readonly results: Results,
    private readonly player: Player,
    private readonly scene: SurfaceScene,
  ) {}

  /** Each picture is drawn, then compressed at its own time, however long that takes. `tell`: how much of it is done, 0 to 1. */
  async record(tell: (part: number) => void): Promise<Blob> {
    const { cycle_ms, gates } = this.player;
    const count = Math.max(Math.round((cycle_ms * per_second) / 1000), gates);
    const step_us = (1000 * cycle_ms) / count;
    const beat: EncodedVideoChunk[] = [];
    let failure: unknown;
    const encoder = new VideoEncoder({
      output: (chunk) => beat.push(chunk),
      error: (reason) => (failure = reason),
    });
    encoder.configure({ codec: "vp8", width, height, bitrate: 8e6, framerate: 1e6 / step_us });
    for (let n = 0; n < count && failure === undefined; ++n) {
      this.player.seek((n / count) * gates);
      this.draw();
      const picture = new VideoFrame(this.canvas, { timestamp: Math.round(n * step_us), duration: Math.round(step_us) });
      encoder.encode(picture, { keyFrame: n === 0 });
      picture.close();
      tell(n / count);
      // For the page to show it, and for the encoder to follow: each picture takes 4 MB.
      do await new Promise((done) => setTimeout(done));
      while (encoder.encodeQueueSize > 4 && failure === undefined);
    }
    if (failure === undefined) await encoder.flush().catch((reason: unknown) => (failure ??= reason));
    if (failure !== undefined) throw failure;
    encoder.close();
    return new Blob([webm(beat, { width, height, turns: beats, turn_ms: cycle_ms })], { type: "video/webm" });
  }

  private draw(): void {
    const { context } = this;
    context.fillStyle = ground;
    context.fillRect(0, 0, width, height);
    const [large, ...cuts] = [byId<HTMLCanvasElement>("slices").querySelector<HTMLCanvasElement>("canvas.large"), ...document.querySelectorAll<HTMLCanvasElement>("#slices canvas.cut")];
    const high = height - bar;
    fit(context, this.scene.drawn(), [0, 0, 0.55 * width, high]);
    if (large) fit(context, large, [0.56 * width, 8, 0.43 * width, 0.55 * high - 8]);
    cuts.forEach((cut, n) => fit(context, cut, [(0.56 + 0.22 * n) * width, 0.57 * high, 0.21 * width, 0.43 * high]));
    const gate = this.results.gates[this.player.gate];
    context.fillStyle = "#e8edf3";
    context.font = "600 20px system-ui, sans-serif";
    context.textBaseline = "middle";
    const { edv_ml, esv_ml, ef_percent } = this.results;
    context.fillText(`${say("Gate {gate} of {gates}", { gate: this.player.gate + 1, gates: this.player.gates })} · ${figure(gate?.endo_ml)} mL · EDV ${figure(edv_ml)} mL, ESV ${figure(esv_ml)} mL, EF ${figure(ef_percent)} %`, 16, height - bar / 2);
    context.textAlign = "right";
    context.font = "16px system-ui, sans-serif";
    context.fillText(say("Research use only. Not for diagnosis."), width - 16, height - bar / 2);
    context.textAlign = "left";
  }
}

/** The button that saves a film, where the browser can make one. */
export function buildFilm(results: Results, player: Player, scene: SurfaceScene | null): void {
  const button = byId<HTMLButtonElement>("film");
  const can = scene !== null && player.gates > 1 && "VideoEncoder" in window; // not over http
  button.hidden = !can;
  if (!can) return;
  const film = new Film(results, player, scene);
  const word = button.textContent;
  button.addEventListener("click", async () => {
    player.pause();
    button.disabled = true;
    try {
      saveFile(await film.record((part) => (button.textContent = `${Math.round(100 * part)} %`)), "dynasurf-beat.webm");
    } catch (reason) {
      alert(say("The film cannot be made: {reason}", { reason: reason instanceof Error ? reason.message : String(reason) }));
    } finally {
      button.disabled = false;
      button.textContent = word;
    }
  });
}
