import fc from "fast-check";
import { describe, expect, it } from "vitest";
import type { AgentSetup, Json, Lesson, Setup } from "../../src/engine/contract";
import { type Link, type LinkDefaults, readLink, writeLink } from "../../src/link";
import { CONTROLS, VIEWS } from "../../src/page-state";

fc.configureGlobal({ seed: 15, numRuns: 500 });

const setup = (env: string, change: Partial<Setup> = {}): Setup => ({
  env,
  options: {},
  profile: "paper",
  config: {},
  seed: 0,
  agents: [{ kind: "hebb", variant: "paper", brain: {}, rule: null }],
  ...change,
});

const lesson = (id: string, of: Setup): Lesson => ({
  id,
  number: 1,
  title: id,
  minutes: 10,
  background: "",
  equation: { text: "", name: "", means: "" },
  tasks: [],
  questions: [],
  references: [],
  setup: of,
  view: "brain",
  hidden: ["sliders"],
});

const defaults: LinkDefaults = {
  setups: [setup("BabbleReach-v0"), setup("BabbleGrasp-v0")],
  lessons: [
    lesson(
      "chain",
      setup("BabbleGrasp-v0", {
        options: { region: "palm_side" },
        agents: [
          { kind: "hebb", variant: "chain", brain: { sigma: 1 }, rule: "eta*a*g" },
          { kind: "random" },
        ],
      }),
    ),
  ],
};

const number = fc.double({ noNaN: true, noDefaultInfinity: true }).map((x) => (x === 0 ? 0 : x));
const name = fc.string({ maxLength: 8 }).filter((text) => text !== "__proto__");
const identifier = fc.constantFrom("body", "arm", "k_p", "sigma", "rule", "eta", "x1");
const json: fc.Arbitrary<Json> = fc.letrec((tie) => ({
  value: fc.oneof(
    { depthSize: "small" },
    fc.constant(null),
    fc.boolean(),
    number,
    fc.string(),
    fc.array(tie("value"), { maxLength: 3 }),
    fc.dictionary(fc.oneof(identifier, name), tie("value"), { maxKeys: 3, noNullPrototype: true }),
  ),
})).value as fc.Arbitrary<Json>;
const tree = fc.dictionary(fc.oneof(identifier, name), json, { maxKeys: 4, noNullPrototype: true });
const agent: fc.Arbitrary<AgentSetup> = fc.oneof(
  fc.record({
    kind: fc.constant("hebb" as const),
    variant: fc.oneof(fc.constantFrom("paper", "chain", "random", "none", "hebb:x"), name),
    brain: tree,
    rule: fc.oneof(fc.constant(null), fc.string({ minLength: 1 })),
  }),
  fc.constantFrom({ kind: "random" as const }, { kind: "scripted" as const }, { kind: "oracle" as const }),
  name.map((text) => ({ kind: "policy" as const, name: text })),
);
const link: fc.Arbitrary<Link> = fc.record({
  setup: fc.record({
    env: fc.constantFrom("BabbleReach-v0", "BabbleGrasp-v0"),
    options: tree,
    profile: name,
    config: tree,
    seed: fc.maxSafeNat(),
    agents: fc.array(agent, { minLength: 1, maxLength: 2 }),
  }),
  lesson: fc.constantFrom(null, "chain"),
  view: fc.constantFrom(...VIEWS),
  hidden: fc.subarray([...CONTROLS]),
});

describe("a link", () => {
  it("gives every state back", () => {
    fc.assert(
      fc.property(link, (state) => {
        expect(readLink(writeLink(state, defaults), defaults)).toEqual({ link: state, faults: [] });
      }),
    );
  });

  it("is empty for the default, and only a name for a lesson's setup", () => {
    const plain = readLink("", defaults).link;
    expect(writeLink(plain, defaults)).toBe("");
    const opened = readLink("lesson=chain", defaults).link;
    expect(opened.setup).toEqual(defaults.lessons[0]!.setup);
    expect(opened.view).toBe("brain");
    expect(writeLink(opened, defaults)).toBe("lesson=chain");
  });

  it("can be read by people", () => {
    const state = readLink("", defaults).link;
    state.setup = setup("BabbleReach-v0", {
      config: { body: { stiffness: [50, 50] }, task: { frame: "fick" } },
      agents: [
        { kind: "hebb", variant: "conjunctive", brain: { sigma: 1.5 }, rule: "eta*(a-a_mean)*g" },
        { kind: "policy", name: "reach" },
      ],
    });
    expect(writeLink(state, defaults)).toBe(
      "agent=conjunctive&rule=eta*(a-a_mean)*g&brain.sigma=1.5&agent2=policy:reach" +
        "&config.body.stiffness=%5B50,50%5D&config.task.frame=fick",
    );
  });

  it("never fails, whatever it holds", () => {
    const part = fc.oneof(
      fc.string(),
      fc.constantFrom("env", "seed", "config.a", "config", "agent", "brain.__proto__"),
    );
    const text = fc.array(fc.tuple(part, fc.string()), { maxLength: 6 });
    fc.assert(
      fc.property(text, (pairs) => {
        const hash = pairs.map(([key, value]) => `${key}=${value}`).join("&");
        const { link: found } = readLink(hash, defaults);
        expect(defaults.setups.map((one) => one.env)).toContain(found.setup.env);
        expect(Number.isSafeInteger(found.setup.seed)).toBe(true);
        expect(found.setup.agents.length).toBeGreaterThan(0);
      }),
    );
  });

  it.each([
    ["env=BabbleSwim-v0", "env"],
    ["seed=-1", "seed"],
    ["seed=1e3", "seed"],
    ["seed=1&seed=2", "seed"],
    ["seed", "seed"],
    ["lesson=knitting", "lesson"],
    ["view=ear", "view"],
    ["hide=babble,everything", "hide"],
    ["agent=none", "agent"],
    ["agent=random&rule=a", "rule"],
    ["agent=random&brain.sigma=1", "brain.sigma"],
    ["config=7", "config"],
    ["config.a=1&config.a.b=2", "config.a.b"],
    ["config.__proto__.polluted=1", "config.__proto__.polluted"],
    ["speling=1", "speling"],
    ["%E0%A4%A=1", "%E0%A4%A=1"],
    ["x".repeat(30_000), "link"],
  ])("names what is wrong in %s", (hash, key) => {
    const { link: found, faults } = readLink(hash, defaults);
    expect(faults.map((fault) => fault.key)).toEqual([key]);
    expect(found.setup.env).toBe("BabbleReach-v0");
    expect(({} as Record<string, unknown>).polluted).toBeUndefined();
  });
});
