/** Sentences that follow what happens on the stage, for screen readers and for the status line. */

import type { EpisodeState, Scene, Solid } from "../engine/contract";

/** Distances below this are not told apart [m]. */
const NEAR = 0.005;

const OUTCOMES: Record<string, string> = {
  success: "success",
  collision: "it touched the obstacle",
  joint_limit: "the movement asked for a posture beyond a joint's range",
  timeout: "time is over",
  lost: "the object is out of reach",
};

/** How an episode ended, in words. */
export function outcomeWords(outcome: string): string {
  return OUTCOMES[outcome] ?? outcome.replaceAll("_", " ");
}

/** What is to be seen now, a sentence for each agent, and the step. */
export function whatIsSeen(scenes: Scene[], episode: EpisodeState | null): string {
  if (scenes.length === 0) return "The stage is empty.";
  const sentences = scenes.map((scene, agent) => {
    const whose = scenes.length > 1 ? `Agent ${agent + 1}: the` : "The";
    return `${whose} ${state(scene)}${ending(episode, agent)}.`;
  });
  if (episode !== null) sentences.push(`Step ${episode.step}.`);
  return sentences.join(" ");
}

function ending(episode: EpisodeState | null, agent: number): string {
  if (episode === null || episode.running[agent]) return "";
  return `; the episode has ended: ${outcomeWords(episode.outcome[agent] ?? "unknown")}`;
}

function state(scene: Scene): string {
  const object = centreOf(scene.solids, "object");
  const goal = object ?? centreOf(scene.solids, "target");
  if (goal === null) return "hand moves freely";
  const name = object === null ? "target" : "object";
  const hand = (object && centreOf(scene.solids, "palm")) ?? scene.fingertip;
  const what = object === null ? "fingertip" : "palm";
  return `${what} is ${placed(hand, goal, name)}${obstacle(scene.solids, hand, goal)}`;
}

/** "12 cm left of the target and 3 cm nearer to the body". */
function placed(hand: number[], goal: number[], name: string): string {
  const right = (hand[0] ?? 0) - (goal[0] ?? 0);
  const ahead = (hand[1] ?? 0) - (goal[1] ?? 0);
  const parts = [
    Math.abs(right) < NEAR ? null : `${centimetres(right)} ${right < 0 ? "left" : "right"} of the ${name}`,
    Math.abs(ahead) < NEAR
      ? null
      : `${centimetres(ahead)} ${ahead < 0 ? "nearer to" : "farther from"} the body`,
  ].filter((part) => part !== null);
  if (parts.length === 0) return `at the ${name}`;
  if (parts.length === 1 && Math.abs(right) < NEAR) return `${parts[0]} than the ${name}`;
  return parts.join(" and ");
}

function obstacle(solids: Solid[], hand: number[], goal: number[]): string {
  const solid = solids.find((each) => each.part === "obstacle");
  if (solid === undefined || solid.shape.kind !== "cylinder") return "";
  const between = distanceToSegment(solid.shape.a, hand, goal) < solid.shape.radius;
  return between ? ", with the obstacle between them" : "";
}

/** Distance in the plane from a point to the segment from `a` to `b` [m]. */
export function distanceToSegment(point: number[], a: number[], b: number[]): number {
  const [px = 0, py = 0] = point;
  const [ax = 0, ay = 0] = a;
  const [bx = 0, by = 0] = b;
  const length = (bx - ax) ** 2 + (by - ay) ** 2;
  const along = length === 0 ? 0 : ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / length;
  const t = Math.min(1, Math.max(0, along));
  return Math.hypot(px - ax - t * (bx - ax), py - ay - t * (by - ay));
}

/** Middle of the first solid of that part, none if there is no such part. */
export function centreOf(solids: Solid[], part: string): number[] | null {
  const shape = solids.find((solid) => solid.part === part)?.shape;
  if (shape === undefined) return null;
  if ("centre" in shape) return shape.centre;
  return shape.a.map((x, i) => (x + (shape.b[i] ?? 0)) / 2);
}

/** A length in whole centimetres. */
export function centimetres(metres: number): string {
  return `${Math.round(Math.abs(metres) * 100)} cm`;
}
