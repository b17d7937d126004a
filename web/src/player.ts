// The one clock of the page. Everything that moves listens to it.

export class Player {
  /** In gates, 0 <= phase < gates. */
  phase = 0;
  playing = false;
  speed = 1;
  private readonly listeners: ((phase: number) => void)[] = [];
  private last = 0;

  constructor(
    readonly gates: number,
    readonly cycle_ms: number,
    private readonly onState: () => void,
  ) {}

  /** Nearest gate, from 0. */
  get gate(): number {
    return Math.round(this.phase) % this.gates;
  }

  listen(listener: (phase: number) => void): void {
    this.listeners.push(listener);
    listener(this.phase);
  }

  seek(phase: number): void {
    this.phase = ((phase % this.gates) + this.gates) % this.gates;
    for (const listener of this.listeners) listener(this.phase);
  }

  /** To a neighbouring gate; a beat that runs stops there. */
  step(by: number): void {
    this.pause();
    this.seek(this.gate + by);
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing || this.gates < 2) return;
    this.playing = true;
    this.last = performance.now();
    this.onState();
    requestAnimationFrame(this.tick);
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    this.onState();
  }

  private readonly tick = (now: number): void => {
    if (!this.playing) return;
    // A page that slept must not jump.
    const passed = Math.min(Math.max(now - this.last, 0), 100);
    this.last = now;
    this.seek(this.phase + (passed / this.cycle_ms) * this.gates * this.speed);
    requestAnimationFrame(this.tick);
  };
}
