/**
 * What the lab's engine (Rust, in a worker) does for the page. The page knows nothing else of it.
 *
 * All lengths are in metres, all angles in radians, maps are rows of activities with the last axis fastest
 * unless stated. A call that fails rejects with a LabError, and the engine is then as it was before.
 */

export type Json = null | boolean | number | string | Json[] | { [name: string]: Json };

/** What is wrong: `field` names what the user can mend, if it is one thing. */
export interface Fault {
  kind: string; // "ConfigError", "ActionError", "ScenarioError", ...: as in Python
  field: string | null;
  problem: string; // a sentence for people, with value and bound
}

/** All that decides what happens: what a link holds, and a record begins with. */
export interface Setup {
  env: string; // id in the registry, "BabbleReach-v0"
  options: Record<string, Json>; // options of the environment that differ from its defaults
  profile: string; // profile of the config, "paper"
  config: Record<string, Json>; // what differs from the profile, nested as in config files
  seed: number; // of babbling, cases and choices; 0 to 2^53 - 1
  agents: AgentSetup[]; // one, or two side by side
}

export type AgentSetup =
  /** Learns by babbling. `brain` is what differs from the variant's numbers; `rule` an expression for Δw. */
  | { kind: "hebb"; variant: string; brain: Record<string, Json>; rule: string | null }
  /** Needs no learning. */
  | { kind: "random" }
  | { kind: "scripted" }
  | { kind: "oracle" }
  /** In grasping: bends the elbow until the palm touches, and closes the hand. */
  | { kind: "approach" }
  /** A network trained elsewhere, given to the engine by addPolicy. */
  | { kind: "policy"; name: string };

/** Parts of a case by name, as in the registry: {"target": [x, y], "obstacle": null, ...}. */
export type Case = Record<string, null | boolean | number | number[]>;

/** What a user does. The engine's record is the setup and a list of these; the same list gives the same bits. */
export type Command =
  /** Babble until each learning agent has learnt from n more babbles. The page asks in slices. */
  | { do: "babble"; n: number }
  /** Begin an episode of the same case for each agent; null draws the next case of the seed. */
  | { do: "recall"; case: Case | null }
  /** n control steps of the running episode, or fewer if it ends. */
  | { do: "step"; n: number }
  /** Play n test cases to their ends (the same ones each time), which is a point of the learning curve. */
  | { do: "test"; n: number }
  /** Silence neurons of an agent's map for good. */
  | { do: "lesion"; agent: number; map: "input" | "output"; association: number; neurons: number[] }
  /** Go on with another setup: agents whose part of it stays keep what they have learnt, others begin anew. */
  | { do: "change"; setup: Setup }
  /** What a student says to a question of a lesson. */
  | { do: "answer"; question: string; value: string | number };

export interface State {
  setup: Setup;
  agents: AgentState[];
  episode: EpisodeState | null;
  curve: CurvePoint[];
  commands: number; // length of the record
  undoable: number; // how many times undo can take something back
  hash: string; // of all that commands changed, 16 hex digits
}

export interface AgentState {
  learns: boolean;
  babbled: number; // babbles made
  learnt: number; // those learnt from
  babbleOutcomes: Record<string, number>; // "legal" and "illegal" in reaching, "kept" and "lost" in grasping
  silenced: number; // neurons
  recalls: Record<string, number>; // how episodes on the stage ended, by outcome
}

export interface EpisodeState {
  case: Case;
  palm: number | null; // how far from the wrist the ball meets the palm when the elbow alone bends, if it does
  step: number;
  seconds: number; // simulated
  /** For each agent. */
  running: boolean[];
  outcome: string[];
  reward: number[]; // return so far
}

export interface CurvePoint {
  learnt: number[]; // of each agent at the time
  cases: number;
  successes: number[]; // of each agent
  outcomes: Record<string, number>[];
}

/** The world of one agent's episode, in world coordinates: x right, y ahead, z up. */
export interface Scene {
  solids: Solid[]; // the same solids in the same order during an episode; only poses change
  gaze: { eye: number[]; at: number[] }; // the line of sight
  cameraFrame: number[][]; // axes of the eye's image plane, right and down, for the frustum
  fieldOfView: number; // radians
  fingertip: number[]; // what the trail follows
}

export interface Solid {
  /** What it is: "ground", "upper_arm", "forearm", "palm", "thumb", "finger", "target", "obstacle", "object", "goal", "eye". */
  part: string;
  colour: number[]; // red, green, blue, 0 to 255
  shape:
    | { kind: "sphere"; centre: number[]; radius: number }
    | { kind: "capsule" | "cylinder"; a: number[]; b: number[]; radius: number }
    | { kind: "cuboid"; centre: number[]; rotation: number[][]; halfExtents: number[] } // rows of the matrix
    | { kind: "ground"; height: number; centre: number[]; halfExtents: number[]; cell: number };
}

/** What the eye has to do with Eq. 1. */
export interface Sight {
  pan: number;
  tilt: number;
  centroid: number[] | null; // (cx, cy) of the red pixels as shares of the image's half edge, null if none
  redPixels: number;
  senses: Record<string, number[]>; // the observation by name
}

/** What the neurons along an axis of a map stand for. */
export interface Axis {
  name: string;
  unit: string; // empty if it has none
  range: number[]; // what the first and the last neuron prefer
}

export interface MapActivity {
  name: string;
  shape: number[]; // neurons along the axes
  axes: Axis[];
  activity: Float32Array; // last axis fastest, for both kinds of map
}

/** The maps of a learning agent for what it senses now. */
export interface Brain {
  associations: {
    name: string;
    input: MapActivity;
    output: MapActivity;
    silencedInputs: number[];
    silencedOutputs: number[];
  }[];
  decided: { name: string; value: number; unit: string }[]; // what the output maps are read out as
}

/** A babble to look at, before it is learnt from. */
export interface Film {
  number: number; // of the babble, from 1 on
  period: number; // time from one frame to the next [s]
  frames: Scene[];
  moments: number[]; // numbers of the frames in which the agent learns, if it can learn from this babble
  learnable: boolean;
  outcome: string;
  /** For each moment, of each association the input map's, for what was seen, then the output map's, for what was done. */
  activities: Float32Array;
}

export interface Lesson {
  id: string; // "equilibrium"
  number: number;
  title: string;
  minutes: number;
  background: string; // Markdown: paragraphs, emphasis, code, links within the lab
  equation: { text: string; name: string; means: string }; // MathML-free: Unicode, e.g. "τ = K_P (θ_eq − θ) − K_D θ̇", "Eq. 2"
  tasks: { id: string; text: string; setup: Setup | null }[]; // things to do; `setup` is what its button sets
  questions: { id: string; text: string; choices: string[] | null; unit: string | null }[];
  references: string[];
  setup: Setup;
  view: string; // "scene" | "eye" | "brain" | "all"
  hidden: string[]; // controls that the lesson hides
}

/** Whether each task and each question of a lesson is done; a wrong answer has a hint. */
export interface Progress {
  tasks: boolean[];
  answers: { given: boolean; right: boolean; hint: string | null }[];
}

export interface Registry {
  environments: { id: string; task: string; title: string }[];
  variants: Record<string, string[]>; // of Hebb agents, by task
  profiles: string[];
  caseParts: Record<
    string,
    { name: string; doc: string; unit: string | null; low: number[] | null; high: number[] | null }[]
  >;
  /** The sliders: numbers of config, brain and rule, with symbol, bounds and unit, by task. */
  sliders: Record<string, Slider[]>;
}

export interface Slider {
  id: string; // "kp"
  where: "config" | "brain" | "options";
  path: string[]; // in Setup.config, AgentSetup.brain or Setup.options
  symbol: string; // "K_P"
  label: string; // "stiffness of the shoulder's muscle"
  unit: string;
  low: number;
  high: number;
  step: number;
  logarithmic: boolean;
  list: boolean; // whether the value stands in a list of one: diameters_m = [0.04]
  /** Values where a setup says nothing: of a brain by variant, for those that have the number; else by profile. */
  defaults: Record<string, number | string | boolean>;
  choices: (string | boolean)[] | null; // for the camera frame and flags: a list in place of a range
}

/** The engine as the page sees it: one for each tab, in a worker. */
export interface Engine {
  registry(): Promise<Registry>;
  lessons(): Promise<Lesson[]>;
  defaultSetup(env: string): Promise<Setup>;
  /** Begin anew with a setup; the record is empty. */
  open(setup: Setup): Promise<State>;
  apply(command: Command): Promise<State>;
  /** The same as a part of what was done before: undo takes both back together. */
  goOn(command: Command): Promise<State>;
  undo(): Promise<State>;
  /** The babble that comes after so many others from here on. Looking at it changes nothing. */
  film(agent: number, ahead: number): Promise<Film>;
  /** The case on the stage with the ball so far from the wrist when the elbow alone bends until the palm touches it. */
  palmCase(fromWrist: number): Promise<Case>;
  state(): Promise<State>;
  scene(agent: number): Promise<Scene>;
  sight(agent: number): Promise<Sight>;
  /** RGBA rows from the top; "eye", "fovea" or "edges". */
  picture(agent: number, view: string, width: number, height: number): Promise<Uint8ClampedArray>;
  brain(agent: number): Promise<Brain | null>; // null for an agent without maps
  /** Weights of one neuron with all neurons of the other map, in that map's shape. */
  weights(agent: number, association: number, map: "input" | "output", neuron: number): Promise<MapActivity>;
  progress(lesson: string): Promise<Progress>;
  addPolicy(name: string, bytes: Uint8Array): Promise<void>;
  /** A learning agent as a file of the Python package, and back (the setup's agent changes with it). */
  saveAgent(agent: number): Promise<Uint8Array>;
  loadAgent(agent: number, bytes: Uint8Array): Promise<State>;
  /** Lines of Python that make the same agent, seed and config. */
  python(agent: number): Promise<string>;
  /** The record as a file to hand in (JSON). */
  record(lesson: string | null, name: string): Promise<string>;
  /** Check the expression of a rule: null if it can be used, else what is wrong and where (character). */
  checkRule(rule: string): Promise<{ problem: string; at: number } | null>;
}
