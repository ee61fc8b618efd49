import fc from "fast-check";
import { describe, expect, it } from "vitest";
import type { Case, EpisodeState, Scene, Solid } from "../../src/engine/contract";
import { distanceToSegment, whatIsSeen } from "../../src/scene/describe";
import { type Arm, handAt, moved, type Parts, placeOf, postureAt } from "../../src/scene/placing";
import { formOf, poseOf } from "../../src/scene/shapes";

fc.configureGlobal({ seed: 15, numRuns: 300 });

const ARM: Arm = { shoulder: [0, 0], upper: 0.15, fore: 0.13 };
const part = (name: string, unit: string): Parts[number] => ({ name, doc: "", unit, low: null, high: null });
const REACH: Parts = [part("start", "m"), part("target", "m"), part("obstacle", "m")];
const GRASP: Parts = [part("start", "rad"), part("object", "m"), part("in_hand", "")];

const angle = (low: number, high: number) => fc.double({ min: low, max: high, noNaN: true });
const metres = fc.double({ min: -0.5, max: 0.5, noNaN: true });

describe("placing", () => {
  it("finds the posture again from where it brings the hand", () => {
    fc.assert(
      fc.property(angle(-3, 3), angle(0.01, 3), (shoulder, elbow) => {
        const found = postureAt(ARM, handAt(ARM, [shoulder, elbow]));
        expect(found?.[0]).toBeCloseTo(shoulder, 5);
        expect(found?.[1]).toBeCloseTo(elbow, 5);
      }),
    );
  });

  it("changes the part that was moved, and nothing else", () => {
    const given: Case = { start: [0.2, 0.1], target: [0, 0.3], obstacle: [0.1, 0.2, 0.035] };
    fc.assert(
      fc.property(fc.constantFrom("start", "target", "obstacle"), metres, metres, (name, x, y) => {
        const next = moved(name, [x, y], given, REACH, ARM) as Case;
        expect(placeOf(name, next, REACH, ARM)).toEqual([x, y]);
        for (const other of Object.keys(given).filter((each) => each !== name)) {
          expect(next[other]).toEqual(given[other]);
        }
      }),
    );
    expect(moved("obstacle", [0, 0], given, REACH, ARM)).toMatchObject({ obstacle: [0, 0, 0.035] });
  });

  it("turns the hand's place into a posture where the task wants one, and says where it cannot be", () => {
    const given: Case = { start: [0, 1], object: [0, 0.2], in_hand: true };
    const next = moved("start", [0.1, 0.2], given, GRASP, ARM) as Case;
    expect(placeOf("start", next, GRASP, ARM)?.map((x) => Math.round(1e6 * x))).toEqual([1e5, 2e5]);
    expect(moved("start", [0.1, 0.4], given, GRASP, ARM)).toMatch(/out of the arm's reach/);
    expect(moved("object", [0.1, 0.1], given, GRASP, ARM)).toMatchObject({ in_hand: false });
  });

  it("keeps to the bounds of a part", () => {
    const bounded: Parts = [{ ...part("target", "m"), low: [-0.1, 0], high: [0.1, 0.3] }];
    expect(moved("target", [0.4, -0.4], {}, bounded, ARM)).toEqual({ target: [0.1, 0] });
  });
});

describe("what is seen", () => {
  const sphere = (name: string, centre: number[]): Solid => ({
    part: name,
    colour: [0, 0, 0],
    shape: { kind: "sphere", centre, radius: 0.012 },
  });
  const post = (x: number, y: number): Solid => ({
    part: "obstacle",
    colour: [0, 0, 0],
    shape: { kind: "cylinder", a: [x, y, 0], b: [x, y, 1], radius: 0.035 },
  });
  const scene = (tip: number[], ...solids: Solid[]): Scene => ({
    solids,
    gaze: { eye: [0, 0.1, 0.25], at: [0, 0, 0] },
    cameraFrame: [],
    fieldOfView: 2,
    fingertip: tip,
  });
  const episode = (outcome: string): EpisodeState => ({
    case: {},
    palm: null,
    step: 14,
    seconds: 0.7,
    running: [outcome === "running"],
    outcome: [outcome],
    reward: [0],
  });

  it("says where the hand is, what is between, and the step", () => {
    const world = scene([-0.12, 0.2, 0], sphere("target", [0, 0.2, 0]), post(-0.06, 0.2));
    expect(whatIsSeen([world], episode("running"))).toBe(
      "The fingertip is 12 cm left of the target, with the obstacle between them. Step 14.",
    );
  });

  it("says how an episode ended, and whose hand it is", () => {
    const world = scene([0.001, 0.2, 0], sphere("target", [0, 0.2, 0]));
    expect(whatIsSeen([world], episode("success"))).toContain(
      "at the target; the episode has ended: success",
    );
    expect(whatIsSeen([world, world], null)).toMatch(/^Agent 1: .* Agent 2: /);
    expect(whatIsSeen([], null)).toBe("The stage is empty.");
  });

  it("measures to a segment no more than to its ends", () => {
    fc.assert(
      fc.property(fc.array(metres, { minLength: 6, maxLength: 6 }), ([px, py, ax, ay, bx, by]) => {
        const p = [px!, py!];
        const [a, b] = [
          [ax!, ay!],
          [bx!, by!],
        ];
        const to = (end: number[]) => Math.hypot(p[0]! - end[0]!, p[1]! - end[1]!);
        expect(distanceToSegment(p, a!, b!)).toBeLessThanOrEqual(Math.min(to(a!), to(b!)) + 1e-9);
      }),
    );
  });

  it("moves a solid without making it anew", () => {
    const before = post(0, 0);
    const after = post(0.1, 0.2);
    expect(formOf(after)).toBe(formOf(before));
    expect(poseOf(after.shape).position.toArray()).toEqual([0.1, 0.2, 0.5]);
  });
});
