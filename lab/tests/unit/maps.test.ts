import fc from "fast-check";
import { describe, expect, it } from "vitest";
import type { Brain } from "../../src/engine/contract";
import { ACTIVITY, colourOf, WEIGHTS } from "../../src/maps/colours";
import { axisText, placeText } from "../../src/maps/heat-map";
import { layoutOf } from "../../src/maps/layout";
import { endWords, mapsAt } from "../../src/session/watching";

describe("the layout of a map", () => {
  it("shows each neuron once, and finds it again", () => {
    const shapes = fc.array(fc.integer({ min: 1, max: 6 }), { minLength: 1, maxLength: 4 });
    fc.assert(
      fc.property(shapes, fc.boolean(), (shape, fromTop) => {
        const layout = layoutOf(shape, fromTop);
        const neurons = shape.reduce((product, n) => product * n, 1);
        const seen = new Set<number>();
        for (let row = 0; row < layout.rows; row += 1) {
          for (let column = 0; column < layout.columns; column += 1) {
            const neuron = layout.neuronAt(row, column);
            expect(layout.placeOf(neuron)).toEqual({ row, column });
            seen.add(neuron);
          }
        }
        expect(seen.size).toBe(neurons);
        expect(Math.max(...seen)).toBe(neurons - 1);
      }),
      { seed: 15 },
    );
  });

  it("has the first axis upwards, but in the fovea downwards", () => {
    expect(layoutOf([2, 3], false).neuronAt(0, 0)).toBe(3);
    expect(layoutOf([2, 3], true).neuronAt(0, 0)).toBe(0);
  });

  it("has maps in a map for four axes", () => {
    // Outer place (0, 1), inner place (1, 0) of shape (2, 2, 2, 2).
    expect(layoutOf([2, 2, 2, 2], true).neuronAt(1, 2)).toBe(0b0110);
  });
});

describe("colours", () => {
  const light = (rgb: readonly number[]) => 0.2126 * rgb[0]! + 0.7152 * rgb[1]! + 0.0722 * rgb[2]!;

  it("of activities get lighter all the way, for any colour vision", () => {
    for (let step = 1; step < 256; step += 1) {
      expect(light(ACTIVITY[step]!)).toBeGreaterThanOrEqual(light(ACTIVITY[step - 1]!) - 0.5);
    }
  });

  it("of weights are lightest at zero", () => {
    const zero = light(colourOf(0, -1, 1, WEIGHTS));
    expect(zero).toBeGreaterThan(light(colourOf(0.5, -1, 1, WEIGHTS)));
    expect(zero).toBeGreaterThan(light(colourOf(-0.5, -1, 1, WEIGHTS)));
  });

  it("exist for any number", () => {
    for (const value of [Number.NaN, -1e9, 1e9, Number.POSITIVE_INFINITY]) {
      expect(colourOf(value, 0, 1, ACTIVITY)).toHaveLength(3);
      expect(colourOf(value, 0, 0, ACTIVITY)).toHaveLength(3);
    }
  });
});

describe("words for maps", () => {
  const axes = [
    { name: "tilt", unit: "deg", range: [-60, 60] },
    { name: "pan", unit: "share of range", range: [0, 1] },
  ];
  const map = { name: "eye", shape: [21, 11], axes, activity: new Float32Array(231) };

  it("say what the axes stand for, and what a neuron prefers", () => {
    expect(axes.map(axisText)).toEqual(["tilt [deg], −60 to 60", "pan [share of range], 0 to 1"]);
    expect(placeText(0, map)).toBe("pan 0 % of range, tilt −60°");
    expect(placeText(230, map)).toBe("pan 100 % of range, tilt 60°");
  });
});

describe("maps of a film", () => {
  const map = (name: string, size: number) => ({
    name,
    shape: [1, size],
    axes: [],
    activity: new Float32Array(size),
  });
  const one = { name: "movement", silencedInputs: [], silencedOutputs: [] };
  const brain: Brain = {
    associations: [
      { ...one, input: map("a", 2), output: map("b", 3) },
      { ...one, input: map("c", 1), output: map("d", 2) },
    ],
    decided: [],
  };
  const film = {
    number: 1,
    period: 0.05,
    frames: [],
    moments: [4, 9],
    learnable: true,
    outcome: "success",
    activities: Float32Array.from({ length: 16 }, (_, at) => at),
  };
  const shown = (frame: number) =>
    mapsAt(film, frame, brain)?.associations.map(({ input, output }) => [
      [...input.activity],
      [...output.activity],
    ]);

  it("are those of the last moment, each part in its map", () => {
    expect(shown(3)).toBeUndefined();
    expect(shown(8)).toEqual([
      [
        [0, 1],
        [2, 3, 4],
      ],
      [[5], [6, 7]],
    ]);
    expect(shown(9)).toEqual([
      [
        [8, 9],
        [10, 11, 12],
      ],
      [[13], [14, 15]],
    ]);
    expect(mapsAt(film, 9, null)).toBeNull();
  });

  it("say why nothing is learnt", () => {
    expect(endWords({ ...film, learnable: false, outcome: "collision" }, "reach")).toContain("obstacle");
    expect(endWords(film, "grasp")).toBe("Babble 1: the hand kept the object, so it is learnt from.");
  });
});
