/** An engine that learns nothing but keeps count, to test the session without the real one. */
import type {
  AgentState,
  Brain,
  Command,
  Engine,
  Fault,
  Film,
  Registry,
  Scene,
  Setup,
  Sight,
  State,
} from "../../src/engine/contract";

export const SETUP: Setup = {
  env: "BabbleReach-v0",
  options: {},
  profile: "paper",
  config: {},
  seed: 0,
  agents: [{ kind: "hebb", variant: "paper", brain: {}, rule: null }],
};

const REGISTRY: Registry = {
  environments: [
    { id: "BabbleReach-v0", task: "reach", title: "reaching" },
    { id: "BabbleGrasp-v0", task: "grasp", title: "grasping" },
  ],
  variants: { reach: ["paper"], grasp: ["paper"] },
  profiles: ["paper"],
  caseParts: {},
  sliders: {},
};

const SCENE: Scene = {
  solids: [],
  gaze: { eye: [0, 0, 0], at: [0, 0, 0] },
  cameraFrame: [],
  fieldOfView: 1,
  fingertip: [0, 0, 0],
};
const SIGHT: Sight = { pan: 0, tilt: 0, centroid: null, redPixels: 0, senses: {} };

export class FakeFault extends Error {
  constructor(readonly fault: Fault) {
    super(fault.problem);
  }
}

/** Success of a test by what was learnt; how long an episode is; what each command was. */
export interface Fake {
  success: (learnt: number) => number;
  steps: number;
  commands: Command[];
}

export function fakeEngine(fake: Partial<Fake> = {}): { engine: Engine; fake: Fake } {
  const { success = () => 0, steps = 5 } = fake;
  const told: Fake = { success, steps, commands: [] };
  let state = opened(SETUP);

  const apply = (command: Command): State => {
    state = { ...state, undoable: state.undoable + 1 };
    return goOn(command);
  };
  const goOn = (command: Command): State => {
    told.commands.push(command);
    state = { ...state, commands: state.commands + 1 };
    const [agent] = state.agents as [AgentState];
    if (command.do === "babble") {
      const learnt = agent.learnt + command.n;
      state.agents = [{ ...agent, learnt, babbled: 2 * learnt }];
    } else if (command.do === "test") {
      const successes = [Math.round(command.n * told.success(agent.learnt))];
      state.curve = [...state.curve, { learnt: [agent.learnt], cases: command.n, successes, outcomes: [{}] }];
    } else if (command.do === "recall") {
      state.episode = {
        case: {},
        palm: null,
        step: 0,
        seconds: 0,
        running: [true],
        outcome: ["running"],
        reward: [0],
      };
    } else if (command.do === "step" && state.episode) {
      const step = Math.min(told.steps, state.episode.step + command.n);
      const running = [step < told.steps];
      state.episode = { ...state.episode, step, seconds: step / 20, running, outcome: ["success"] };
    } else if (command.do === "change") {
      refuse(command.setup);
      state.setup = command.setup;
    }
    return state;
  };
  const methods: Partial<Record<keyof Engine, (...args: never[]) => unknown>> = {
    registry: () => REGISTRY,
    lessons: () => [],
    defaultSetup: (env: string) => ({ ...SETUP, env }),
    open: (setup: Setup) => {
      refuse(setup);
      state = opened(setup);
      return state;
    },
    apply,
    goOn,
    film: (_agent: never, ahead: number): Film => film(state.agents[0]!.babbled + ahead),
    undo: () => state,
    scene: () => SCENE,
    sight: () => SIGHT,
    picture: () => new Uint8ClampedArray(),
    brain: (): Brain | null => null,
  };
  const engine = Object.fromEntries(
    Object.entries(methods).map(([name, method]) => [name, async (...args: never[]) => method(...args)]),
  );
  return { engine: engine as unknown as Engine, fake: told };
}

/** Every other babble can be learnt from. */
function film(before: number): Film {
  const learnable = before % 2 === 1;
  return {
    number: before + 1,
    period: 0.05,
    frames: Array.from({ length: 4 }, () => SCENE),
    moments: [2],
    learnable,
    outcome: learnable ? "success" : "collision",
    activities: new Float32Array(),
  };
}

function opened(setup: Setup): State {
  const agent = { learns: true, babbled: 0, learnt: 0, babbleOutcomes: {}, silenced: 0, recalls: {} };
  return { setup, agents: [agent], episode: null, curve: [], commands: 0, undoable: 0, hash: "0" };
}

function refuse(setup: Setup): void {
  if (setup.profile === "paper") return;
  throw new FakeFault({ kind: "ConfigError", field: "profile", problem: `no profile ${setup.profile}` });
}
