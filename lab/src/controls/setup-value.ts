/** Reads and writes one value of a setup, by the path that a slider names. */
import type { Json, Setup, Slider } from "../engine/contract";

type Tree = { [name: string]: Json };

/** Agents that have the slider's number, by place; any place for one of body or environment. */
export function agentsWith(setup: Setup, slider: Slider): number[] {
  if (slider.where !== "brain") return [0];
  return setup.agents.flatMap((agent, place) =>
    agent.kind === "hebb" && Object.hasOwn(slider.defaults, agent.variant) ? [place] : [],
  );
}

/** The value where a setup says nothing: that of the agent's variant, or of the profile. */
export function sliderDefault(setup: Setup, slider: Slider, agent: number): number | string | boolean {
  const one = setup.agents[agent];
  const name = slider.where === "brain" && one?.kind === "hebb" ? one.variant : setup.profile;
  return slider.defaults[name]!;
}

export function sliderValue(setup: Setup, slider: Slider, agent: number): Json {
  let value: Json | undefined = root(setup, slider, agent);
  for (const name of slider.path) value = isTree(value) ? value[name] : undefined;
  if (value === undefined) return sliderDefault(setup, slider, agent);
  return slider.list && Array.isArray(value) ? value[0]! : value;
}

/** The setup with another value; the slider's default is left out. */
export function withValue(setup: Setup, slider: Slider, agent: number, value: Json): Setup {
  const stored = value === sliderDefault(setup, slider, agent) ? undefined : slider.list ? [value] : value;
  const changed = put(root(setup, slider, agent), slider.path, stored);
  if (slider.where !== "brain") return { ...setup, [slider.where]: changed };
  const agents = setup.agents.map((one, place) =>
    place === agent && one.kind === "hebb" ? { ...one, brain: changed } : one,
  );
  return { ...setup, agents };
}

function root(setup: Setup, slider: Slider, agent: number): Tree {
  if (slider.where !== "brain") return setup[slider.where];
  const one = setup.agents[agent];
  return one?.kind === "hebb" ? one.brain : {};
}

function put(tree: Tree, path: string[], value: Json | undefined): Tree {
  const [name, ...rest] = path as [string, ...string[]];
  const { [name]: old, ...others } = tree;
  if (rest.length === 0) return value === undefined ? others : { ...tree, [name]: value };
  const inside = put(isTree(old) ? old : {}, rest, value);
  return Object.keys(inside).length === 0 ? others : { ...tree, [name]: inside };
}

function isTree(value: Json | undefined): value is Tree {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
