/** Plays the episode on the stage at the chosen speed. */
import type { EpisodeState } from "../engine/contract";
import type { Session } from "./session";
import { pause, Slices } from "./work";

/** Shortest time between two pictures of an episode. */
const FRAME_MS = 33;
const CONTROL_MS = 50;
const MOST_STEPS = 1000;

/** Plays until the episode ends or someone stops it; begins one of the next case where none runs. */
export async function play(session: Session): Promise<void> {
  if (!runs(session.state.value.episode)) await session.recall(null);
  const work = session.begin("Playing", null, false);
  const slices = new Slices(FRAME_MS);
  let before = performance.now();
  try {
    while (!work.stopped && runs(session.state.value.episode)) {
      const n = stepsDue(session.speed.value, performance.now() - before) || slices.next(MOST_STEPS);
      before = performance.now();
      await session.apply({ do: "step", n }, work);
      const took = performance.now() - before;
      slices.took(n, took);
      work.report(session.state.value.episode?.step ?? 0);
      await pause(frameMs(session.speed.value) - took);
    }
  } finally {
    work.end();
  }
  sayOutcome(session);
}

/** One control step. */
export async function step(session: Session): Promise<void> {
  session.stop();
  await session.apply({ do: "step", n: 1 });
  sayOutcome(session);
}

export function runs(episode: EpisodeState | null): boolean {
  return episode?.running.some(Boolean) ?? false;
}

/** Control steps of the next slice, after so many milliseconds; 0 if it may take as many as it can. */
function stepsDue(speed: number, milliseconds: number): number {
  if (speed === Number.POSITIVE_INFINITY) return 0;
  return Math.min(MOST_STEPS, Math.max(1, Math.round((milliseconds * speed) / CONTROL_MS)));
}

/** How long a slice should last: at least as long as a picture of it can be seen. */
function frameMs(speed: number): number {
  return speed === Number.POSITIVE_INFINITY ? 0 : Math.max(FRAME_MS, CONTROL_MS / speed);
}

function sayOutcome(session: Session): void {
  const { episode, setup } = session.state.value;
  if (!episode || runs(episode)) return;
  const time = `after ${episode.seconds.toFixed(1)} s`;
  session.said.value =
    setup.agents.length === 1
      ? `The episode ended ${time}: ${plain(episode.outcome[0]!)}.`
      : `The episode ended ${time}: first agent ${plain(episode.outcome[0]!)}, second agent ${plain(episode.outcome[1]!)}.`;
}

/** An outcome's name as words. */
export function plain(name: string): string {
  return name.replaceAll("_", " ");
}
