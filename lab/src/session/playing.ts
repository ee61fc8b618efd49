/** Plays the episode on the stage at the chosen speed. */
import type { EpisodeState } from "../engine/contract";
import type { Session } from "./session";
import { Slices } from "./work";

/** Shortest time between two pictures of an episode. */
const FRAME_MS = 33;
const CONTROL_MS = 50;

/** Plays until the episode ends or someone stops it; begins one of the next case where none runs. */
export async function play(session: Session): Promise<void> {
  if (!runs(session.state.value.episode)) await session.recall(null);
  const work = session.begin("Playing", null);
  const slices = new Slices(FRAME_MS);
  try {
    while (!work.stopped && runs(session.state.value.episode)) {
      const began = performance.now();
      const [n, lasts] = slice(session.speed.value, slices);
      await session.apply({ do: "step", n });
      const took = performance.now() - began;
      slices.took(n, took);
      work.report(session.state.value.episode?.step ?? 0);
      if (took < lasts) await new Promise((wake) => setTimeout(wake, lasts - took));
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

/** Control steps of the next slice, and how long it should last [ms]. */
function slice(speed: number, slices: Slices): [number, number] {
  if (speed === Number.POSITIVE_INFINITY) return [slices.next(Number.POSITIVE_INFINITY), 0];
  const n = Math.max(1, Math.round((FRAME_MS * speed) / CONTROL_MS));
  return [n, (n * CONTROL_MS) / speed];
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
