import fc from "fast-check";
import { describe, expect, it } from "vitest";
import { ACTIVITY, colourOf, WEIGHTS } from "../../src/maps/colours";
import { layoutOf } from "../../src/maps/layout";

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
