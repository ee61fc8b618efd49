/**
 * The state of the page as the readable part of its address after "#": `env=BabbleReach-v0&agent=conjunctive`.
 *
 * A link holds what differs from the lesson's setup, or from the environment's default without a lesson.
 * Nested numbers are dotted (`config.task.timing.duration=4`); values are JSON, or bare text where that cannot be
 * taken for JSON. An agent is the variant of a Hebb agent, or `random`, `scripted`, `oracle`, `approach`,
 * `policy:NAME`.
 */
import type { AgentSetup, Lesson, Setup } from "./engine/contract";
import { type Fail, flat, type LinkFault, readTree, same, split, written } from "./link-values";
import { CONTROLS, type Control, isControl, isView, type View } from "./page-state";

export interface Link {
  setup: Setup;
  lesson: string | null;
  view: View;
  hidden: Control[];
}

/** What a link is read against. */
export interface LinkDefaults {
  /** The default setup of each environment; the first one is for a link that names none. */
  setups: Setup[];
  lessons: Lesson[];
}

const KINDS = ["random", "scripted", "oracle", "approach"] as const;

/** The address of a state, without its "#"; empty for the default. */
export function writeLink(link: Link, defaults: LinkDefaults): string {
  const base = baseOf(link.lesson, link.setup.env, defaults);
  const { setup } = link;
  const entries: [string, string][] = [];
  if (link.lesson !== null) entries.push(["lesson", link.lesson]);
  if (setup.env !== base.linkEnv) entries.push(["env", setup.env]);
  if (setup.profile !== base.setup.profile) entries.push(["profile", setup.profile]);
  if (setup.seed !== base.setup.seed) entries.push(["seed", String(setup.seed)]);
  for (const place of [0, 1]) {
    entries.push(...agentEntries(setup.agents[place] ?? null, base.setup.agents[place] ?? null, place));
  }
  for (const name of ["options", "config"] as const) {
    if (!same(setup[name], base.setup[name])) entries.push(...flat(name, setup[name]));
  }
  if (link.view !== base.view) entries.push(["view", link.view]);
  if (!same([...link.hidden].sort(), [...base.hidden].sort())) entries.push(["hide", link.hidden.join(",")]);
  return entries.map(([key, value]) => `${written(key)}=${written(value)}`).join("&");
}

/** The state that an address stands for. What is wrong in it is left out, and named. */
export function readLink(hash: string, defaults: LinkDefaults): { link: Link; faults: LinkFault[] } {
  const { entries, faults } = split(hash);
  const fail = (key: string, problem: string) => faults.push({ key, problem });
  const take = (key: string) => {
    const value = entries.get(key);
    entries.delete(key);
    return value;
  };

  const lesson =
    known(
      take("lesson"),
      "lesson",
      defaults.lessons.map((one) => one.id),
      fail,
    ) ?? null;
  const env = known(
    take("env"),
    "env",
    defaults.setups.map((one) => one.env),
    fail,
  );
  const base = baseOf(lesson, env ?? null, defaults);
  const setup: Setup = {
    ...base.setup,
    profile: take("profile") ?? base.setup.profile,
    seed: readSeed(take("seed"), base.setup.seed, fail),
    agents: readAgents(take, entries, base.setup, fail),
    options: readTree("options", entries, base.setup.options, fail),
    config: readTree("config", entries, base.setup.config, fail),
  };
  const view = readView(take("view"), base.view, fail);
  const hidden = readHidden(take("hide"), base.hidden, fail);
  for (const key of entries.keys()) fail(key, "no such key");
  return { link: { setup, lesson, view, hidden }, faults };
}

interface Base {
  setup: Setup;
  /** The environment of a link that names none. */
  linkEnv: string;
  view: View;
  hidden: Control[];
}

function baseOf(lessonId: string | null, env: string | null, defaults: LinkDefaults): Base {
  const lesson = defaults.lessons.find((one) => one.id === lessonId);
  const first = lesson?.setup ?? defaults.setups[0]!;
  const wanted = env ?? first.env;
  const setup = wanted === first.env ? first : (defaults.setups.find((one) => one.env === wanted) ?? first);
  const view = lesson && isView(lesson.view) ? lesson.view : "all";
  return { setup, linkEnv: first.env, view, hidden: lesson?.hidden.filter(isControl) ?? [] };
}

// Agents: keys of the second one end in 2.

const suffix = (place: number) => (place === 0 ? "" : "2");

function agentEntries(agent: AgentSetup | null, base: AgentSetup | null, place: number): [string, string][] {
  if (same(agent, base)) return [];
  const end = suffix(place);
  const name = agent ? agentName(agent) : "none";
  const entries: [string, string][] = [];
  const renamed = name !== (base ? agentName(base) : "none");
  if (renamed) entries.push([`agent${end}`, name]);
  if (agent?.kind !== "hebb") return entries;
  const from = !renamed && base?.kind === "hebb" ? base : { brain: {}, rule: null };
  if (agent.rule !== from.rule) entries.push([`rule${end}`, agent.rule ?? ""]);
  if (!same(agent.brain, from.brain)) entries.push(...flat(`brain${end}`, agent.brain));
  return entries;
}

function agentName(agent: AgentSetup): string {
  if (agent.kind === "policy") return `policy:${agent.name}`;
  if (agent.kind !== "hebb") return agent.kind;
  const bare = agent.variant;
  const taken = bare === "none" || bare.includes(":") || (KINDS as readonly string[]).includes(bare);
  return taken || bare === "" ? `hebb:${bare}` : bare;
}

function agentOf(name: string): AgentSetup | null {
  const kind = KINDS.find((one) => one === name);
  if (kind) return { kind };
  if (name === "none") return null;
  if (name.startsWith("policy:")) return { kind: "policy", name: name.slice(7) };
  const variant = name.startsWith("hebb:") ? name.slice(5) : name;
  return { kind: "hebb", variant, brain: {}, rule: null };
}

type Take = (key: string) => string | undefined;

function readAgents(take: Take, entries: Map<string, string>, base: Setup, fail: Fail): AgentSetup[] {
  const agents: AgentSetup[] = [];
  for (const place of [0, 1]) {
    const key = `agent${suffix(place)}`;
    const name = take(key);
    if (name === "none" && place === 0) fail(key, "the first agent cannot be none");
    const named = name === undefined || (name === "none" && place === 0) ? undefined : agentOf(name);
    const agent = named === undefined ? (base.agents[place] ?? null) : named;
    const rule = take(`rule${suffix(place)}`);
    if (agent?.kind === "hebb") {
      const brain = readTree(`brain${suffix(place)}`, entries, agent.brain, fail);
      agents.push({ ...agent, brain, rule: rule === undefined ? agent.rule : rule || null });
      continue;
    }
    if (rule !== undefined) fail(`rule${suffix(place)}`, "only an agent that learns by a Hebb rule has one");
    if (agent) agents.push(agent);
  }
  return agents;
}

function known(value: string | undefined, key: string, choices: string[], fail: Fail): string | undefined {
  if (value === undefined || choices.includes(value)) return value;
  fail(key, `“${value}” is none of ${choices.join(", ")}`);
  return undefined;
}

function readSeed(value: string | undefined, base: number, fail: Fail): number {
  if (value === undefined) return base;
  const seed = /^\d+$/.test(value) ? Number(value) : Number.NaN;
  if (Number.isSafeInteger(seed)) return seed;
  fail("seed", `“${value}” is no whole number from 0 to ${Number.MAX_SAFE_INTEGER}`);
  return base;
}

function readView(value: string | undefined, base: View, fail: Fail): View {
  if (value === undefined || isView(value)) return value ?? base;
  fail("view", `“${value}” is none of all, scene, eye, brain`);
  return base;
}

function readHidden(value: string | undefined, base: Control[], fail: Fail): Control[] {
  if (value === undefined) return base;
  const names = value === "" ? [] : value.split(",");
  const unknown = names.filter((name) => !isControl(name));
  if (unknown.length > 0) fail("hide", `“${unknown.join(", ")}” is none of ${CONTROLS.join(", ")}`);
  return names.filter(isControl);
}
