/** Where the parts of a case stand in the plane, and the case with one of them elsewhere. */

import type { Case, Registry, Scene } from "../engine/contract";

export type Parts = Registry["caseParts"][string];
export type Point = [number, number];

/** The arm in its plane: where the shoulder is, and the lengths from it to the elbow and on to the hand [m]. */
export interface Arm {
  shoulder: Point;
  upper: number;
  fore: number;
}

/** What a person can put elsewhere: a part of the case, with the word for it. */
const DRAGGABLE: Record<string, string> = {
  start: "Hand at the start",
  target: "Target",
  object: "Object",
  obstacle: "Obstacle",
  goal: "Goal",
};

/** Names of the parts that can be dragged, and what they are called. */
export function draggable(parts: Parts): { part: string; label: string }[] {
  return parts
    .filter(({ name }) => name in DRAGGABLE)
    .map(({ name }) => ({ part: name, label: DRAGGABLE[name] ?? name }));
}

/** The arm of a scene, from its first pose; none if the scene has no arm. */
export function armOf(scene: Scene, handPart: "palm" | "fingertip"): Arm | null {
  const bone = scene.solids.find(({ part }) => part === "upper_arm")?.shape;
  if (bone === undefined || bone.kind !== "capsule") return null;
  const palm = scene.solids.find(({ part }) => part === "palm")?.shape;
  const hand = handPart === "palm" && palm !== undefined && "centre" in palm ? palm.centre : scene.fingertip;
  const [shoulder, elbow] = [flat(bone.a), flat(bone.b)];
  return { shoulder, upper: distance(shoulder, elbow), fore: distance(elbow, flat(hand)) };
}

/** Whether a start is given by joint angles, as in grasping, and not by a place. */
export function startIsPosture(parts: Parts): boolean {
  return parts.some(({ name, unit }) => name === "start" && unit === "rad");
}

/** Where a part of a case stands in the plane; none where the case has no such part. */
export function placeOf(part: string, given: Case, parts: Parts, arm: Arm | null): Point | null {
  const value = given[part];
  if (!Array.isArray(value) || value.length < 2) return null;
  const [first, second] = value as Point;
  if (part !== "start" || !startIsPosture(parts)) return [first, second];
  return arm === null ? null : handAt(arm, [first, second]);
}

/** The case with one part at another place; a sentence where the arm cannot be there. */
export function moved(part: string, to: Point, given: Case, parts: Parts, arm: Arm | null): Case | string {
  const place = within(part, to, parts);
  if (part === "start" && startIsPosture(parts)) {
    const posture = arm === null ? null : postureAt(arm, to);
    return posture === null
      ? "The hand cannot be there: it is out of the arm's reach."
      : { ...given, start: posture };
  }
  const before = given[part];
  const radius = part === "obstacle" && Array.isArray(before) ? before.slice(2) : [];
  const next: Case = { ...given, [part]: [...place, ...radius] };
  // An object in the hand stays there, wherever it was put.
  if (part === "object" && "in_hand" in given) next.in_hand = false;
  return next;
}

function within(part: string, to: Point, parts: Parts): Point {
  const found = parts.find(({ name }) => name === part);
  const clip = (x: number, i: 0 | 1): number => {
    const [low, high] = [found?.low?.[i] ?? -Infinity, found?.high?.[i] ?? Infinity];
    return Math.min(high, Math.max(low, x));
  };
  return [clip(to[0], 0), clip(to[1], 1)];
}

/** The hand's place for shoulder and elbow [rad]; both turn counter-clockwise. */
export function handAt(arm: Arm, [shoulder, elbow]: Point): Point {
  const x = arm.upper * Math.cos(shoulder) + arm.fore * Math.cos(shoulder + elbow);
  const y = arm.upper * Math.sin(shoulder) + arm.fore * Math.sin(shoulder + elbow);
  return [arm.shoulder[0] + x, arm.shoulder[1] + y];
}

/** Shoulder and elbow with the hand at a place, the elbow not negative; none out of reach. */
export function postureAt(arm: Arm, hand: Point): Point | null {
  const [x, y] = [hand[0] - arm.shoulder[0], hand[1] - arm.shoulder[1]];
  const cosine = (x * x + y * y - arm.upper ** 2 - arm.fore ** 2) / (2 * arm.upper * arm.fore);
  if (Math.abs(cosine) > 1) return null;
  const elbow = Math.acos(cosine);
  const shoulder =
    Math.atan2(y, x) - Math.atan2(arm.fore * Math.sin(elbow), arm.upper + arm.fore * Math.cos(elbow));
  // Joint angles are those of the ranges, −180° to 180°.
  return [Math.atan2(Math.sin(shoulder), Math.cos(shoulder)), elbow];
}

function flat(point: number[]): Point {
  return [point[0] ?? 0, point[1] ?? 0];
}

function distance(a: Point, b: Point): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
