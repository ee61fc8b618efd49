/** How the worker answers: the contract on top of the WebAssembly module, which speaks JSON and arrays. */

import type {
  Brain,
  Case,
  Command,
  Engine,
  Fault,
  Film,
  Lesson,
  MapActivity,
  Progress,
  Registry,
  Scene,
  Setup,
  Sight,
  State,
} from "./contract";
import * as wasm from "./wasm/engine.js";

/** An association as the module gives it: activities come apart from it. */
type Bare<Map> = Omit<Map, "activity">;
export type BareBrain = Omit<Brain, "associations"> & {
  associations: (Omit<Brain["associations"][number], "input" | "output"> & {
    input: Bare<MapActivity>;
    output: Bare<MapActivity>;
  })[];
};

export type BareFilm = Omit<Film, "activities">;

function filled(brain: BareBrain, activities: Float32Array): Brain {
  let at = 0;
  const withActivity = (map: Bare<MapActivity>): MapActivity => {
    const size = map.shape.reduce((product, side) => product * side, 1);
    at += size;
    return { ...map, activity: activities.slice(at - size, at) };
  };
  const associations = brain.associations.map((one) => ({
    ...one,
    input: withActivity(one.input),
    output: withActivity(one.output),
  }));
  return { ...brain, associations };
}

/** What is thrown at somebody who asks before a session is open. */
const CLOSED: Fault = { kind: "ConfigError", field: null, problem: "no session is open" };

/** The engine in this thread. */
export class LocalEngine implements Engine {
  private open_: wasm.Session | null = null;
  private readonly policies = new wasm.Policies();

  private get session(): wasm.Session {
    if (this.open_ === null) throw JSON.stringify(CLOSED);
    return this.open_;
  }

  async registry(): Promise<Registry> {
    return JSON.parse(wasm.registry());
  }

  async lessons(): Promise<Lesson[]> {
    return JSON.parse(wasm.lessons());
  }

  async defaultSetup(env: string): Promise<Setup> {
    return JSON.parse(wasm.defaultSetup(env));
  }

  async open(setup: Setup): Promise<State> {
    const session = new wasm.Session(JSON.stringify(setup), this.policies);
    this.open_?.free();
    this.open_ = session;
    return this.state();
  }

  async apply(command: Command): Promise<State> {
    this.session.apply(JSON.stringify(command));
    return this.state();
  }

  async goOn(command: Command): Promise<State> {
    this.session.goOn(JSON.stringify(command));
    return this.state();
  }

  async film(agent: number, ahead: number): Promise<Film> {
    const film = this.session.film(agent, ahead);
    try {
      const told: BareFilm = JSON.parse(film.told());
      return { ...told, activities: film.activities() };
    } finally {
      film.free();
    }
  }

  async palmCase(fromWrist: number): Promise<Case> {
    return JSON.parse(this.session.palmCase(fromWrist));
  }

  async undo(): Promise<State> {
    this.session.undo();
    return this.state();
  }

  async state(): Promise<State> {
    return JSON.parse(this.session.state());
  }

  async scene(agent: number): Promise<Scene> {
    return JSON.parse(this.session.scene(agent));
  }

  async sight(agent: number): Promise<Sight> {
    return JSON.parse(this.session.sight(agent));
  }

  async picture(agent: number, view: string, width: number, height: number): Promise<Uint8ClampedArray> {
    const bytes = this.session.picture(agent, view, width, height);
    return new Uint8ClampedArray(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  async brain(agent: number): Promise<Brain | null> {
    const brain: BareBrain | null = JSON.parse(this.session.brain(agent));
    return brain && filled(brain, this.session.activities(agent));
  }

  async weights(
    agent: number,
    association: number,
    map: "input" | "output",
    neuron: number,
  ): Promise<MapActivity> {
    const bare: Bare<MapActivity> = JSON.parse(this.session.weightsMap(agent, association, map, neuron));
    return { ...bare, activity: this.session.weights(agent, association, map, neuron) };
  }

  async progress(lesson: string): Promise<Progress> {
    return JSON.parse(this.session.progress(lesson));
  }

  async addPolicy(name: string, bytes: Uint8Array): Promise<void> {
    this.policies.add(name, bytes);
    this.open_?.know(this.policies);
  }

  async saveAgent(agent: number): Promise<Uint8Array> {
    return this.session.saveAgent(agent);
  }

  async loadAgent(agent: number, bytes: Uint8Array): Promise<State> {
    this.session.loadAgent(agent, bytes);
    return this.state();
  }

  async python(agent: number): Promise<string> {
    return this.session.python(agent);
  }

  async record(lesson: string | null, name: string): Promise<string> {
    return this.session.record(lesson ?? undefined, name);
  }

  async checkRule(rule: string): Promise<{ problem: string; at: number } | null> {
    return JSON.parse(wasm.checkRule(rule));
  }
}

/** What a call threw, as a fault: the module throws JSON, and an error with a message after a panic. */
export function faultOf(thrown: unknown): Fault {
  if (typeof thrown === "string") return JSON.parse(thrown);
  const message = thrown instanceof Error ? thrown.message : String(thrown);
  return { kind: "InternalError", field: null, problem: `the engine failed, reload the page: ${message}` };
}

/** The buffers of a value that can change owner in place of being copied. */
export function transferable(value: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(value)) return [value.buffer as ArrayBuffer];
  const { activity, activities, associations } = (value ?? {}) as Partial<MapActivity & Film & Brain>;
  const maps = associations?.flatMap(({ input, output }) => [input.activity, output.activity]) ?? [];
  return [activity ?? [], activities ?? [], maps].flat().map((array) => array.buffer as ArrayBuffer);
}
