/** What the views show of the engine's state, asked for together. */
import type { Brain, Engine, Progress, Scene, Sight } from "../engine/contract";

export interface Shown {
  scenes: Scene[]; // one for each agent
  sight: Sight | null;
  pictures: Record<string, Uint8ClampedArray>; // of the eye, by view: RGBA rows of PICTURE × PICTURE pixels
  brain: Brain | null;
  progress: Progress | null; // of the lesson
}

export const PICTURE = 210;
const PICTURES = ["eye", "fovea", "edges"] as const;

export async function shownOf(
  engine: Engine,
  wanted: { agents: number; agent: number; eye: boolean; lesson: string | null },
): Promise<Shown> {
  const { agent } = wanted;
  const scenes = Array.from({ length: wanted.agents }, (_, place) => engine.scene(place));
  const pictures = wanted.eye ? PICTURES.map((name) => engine.picture(agent, name, PICTURE, PICTURE)) : [];
  const [sight, brain, progress] = await Promise.all([
    wanted.eye ? engine.sight(agent) : null,
    engine.brain(agent),
    wanted.lesson === null ? null : engine.progress(wanted.lesson),
  ]);
  const pixels = await Promise.all(pictures);
  return {
    scenes: await Promise.all(scenes),
    sight,
    pictures: Object.fromEntries(pixels.map((picture, at) => [PICTURES[at]!, picture])),
    brain,
    progress,
  };
}
