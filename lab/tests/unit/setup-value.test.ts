import { describe, expect, it } from "vitest";
import { agentsWith, sliderValue, withValue } from "../../src/controls/setup-value";
import type { Slider } from "../../src/engine/contract";
import { SETUP } from "./fake-engine";

const slider = (change: Partial<Slider>): Slider => ({
  id: "kp",
  where: "config",
  path: ["body", "muscles", "kp"],
  symbol: "K_P",
  label: "stiffness",
  unit: "N·m/rad",
  low: 5,
  high: 500,
  step: 1,
  logarithmic: true,
  list: false,
  defaults: { paper: 50, icub: 60 },
  choices: null,
  ...change,
});

describe("a slider", () => {
  it("writes what it reads, and leaves nothing behind at its default", () => {
    for (const one of [
      slider({}),
      slider({ list: true }),
      slider({ where: "options", path: ["reflex"], defaults: { paper: true } }),
      slider({ where: "brain", path: ["rule", "eta"], defaults: { paper: 1 } }),
    ]) {
      const changed = withValue(SETUP, one, 0, 7);
      expect(sliderValue(changed, one, 0)).toBe(7);
      expect(sliderValue(SETUP, one, 0)).toBe(one.defaults.paper);
      expect(withValue(changed, one, 0, one.defaults.paper!)).toEqual(SETUP);
    }
  });

  it("leaves its neighbours alone", () => {
    const both = withValue(
      withValue(SETUP, slider({}), 0, 7),
      slider({ path: ["body", "muscles", "kd"] }),
      0,
      8,
    );
    expect(both.config).toEqual({ body: { muscles: { kp: 7, kd: 8 } } });
    expect(withValue(both, slider({}), 0, 50).config).toEqual({ body: { muscles: { kd: 8 } } });
  });

  it("knows the values of another profile", () => {
    const icub = { ...SETUP, profile: "icub" };
    expect(sliderValue(icub, slider({}), 0)).toBe(60);
    expect(withValue(icub, slider({}), 0, 50).config).toEqual({ body: { muscles: { kp: 50 } } });
  });

  it("of a brain belongs to the agents whose variant has it", () => {
    const eta = slider({ where: "brain", path: ["eta"], defaults: { chain: 1 } });
    expect(agentsWith(SETUP, eta)).toEqual([]);
    const { agents } = SETUP;
    const chain = { kind: "hebb", variant: "chain", brain: {}, rule: null } as const;
    expect(agentsWith({ ...SETUP, agents: [...agents, chain] }, eta)).toEqual([1]);
  });
});
