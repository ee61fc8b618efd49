/** Long work in slices: how far it is, the time it still takes, and how large the next slice may be. */
import type { Signal } from "@preact/signals";

export interface Job {
  label: string;
  done: number;
  total: number | null; // null if nobody knows
  /** Whether it is waited for, so that a bar shows that it goes on. */
  bar: boolean;
  seconds: number; // since it began
  secondsLeft: number | null;
}

export class Work {
  stopped = false;
  /** Whether some of it is done: undo takes the rest back together with that. */
  begun = false;
  private readonly began = performance.now();

  constructor(
    private readonly job: Signal<Job | null>,
    private readonly label: string,
    private readonly total: number | null,
    private readonly bar: boolean,
  ) {
    this.report(0);
  }

  report(done: number): void {
    if (this.stopped) return;
    const { label, total, bar } = this;
    const seconds = (performance.now() - this.began) / 1000;
    const secondsLeft = total === null || done === 0 ? null : (seconds * (total - done)) / done;
    this.job.value = { label, done, total, bar, seconds, secondsLeft };
  }

  end(): void {
    if (!this.stopped) this.job.value = null;
    this.stopped = true;
  }
}

/** Chooses slices of about `milliseconds`, from how long the last ones took. */
export class Slices {
  private size = 1;

  constructor(private readonly milliseconds = 50) {}

  next(left: number): number {
    return Math.max(1, Math.min(left, Math.round(this.size)));
  }

  /** A slice of n took so long. It grows fourfold at most, as the first ones are not typical. */
  took(n: number, milliseconds: number): void {
    const fitting = (n * this.milliseconds) / Math.max(milliseconds, 0.1);
    this.size = Math.min(Math.max(fitting, 1), 4 * n);
  }
}

/** Waits; a moment at least, so that the page is drawn. */
export function pause(milliseconds: number): Promise<void> {
  return new Promise((wake) => setTimeout(wake, Math.max(0, milliseconds)));
}
