/** The lab of one tab: the engine's state as signals, and what a user can do to it. */
import { batch, computed, type Signal, signal } from "@preact/signals";
import type { Case, Command, Engine, Fault, Lesson, Registry, Setup, State } from "../engine/contract";
import { type Link, type LinkDefaults, readLink, writeLink } from "../link";
import { same } from "../link-values";
import { type Control, isControl, isView, type View } from "../page-state";
import { addShippedPolicies } from "./policies";
import { type Shown, shownOf } from "./shown";
import type { Watched } from "./watching";
import { type Job, pause, Work } from "./work";

/** How often it is looked whether a pause is over. */
const PAUSED_MS = 30;

export class Session {
  readonly state: Signal<State>;
  readonly shown = signal<Shown>({ scenes: [], sight: null, pictures: {}, brain: null, progress: null });
  readonly lesson = signal<Lesson | null>(null);
  readonly view = signal<View>("all");
  readonly hidden = signal<Control[]>([]);
  /** The agent whose eye and brain are shown. */
  readonly shownAgent = signal(0);
  readonly job = signal<Job | null>(null);
  readonly fault = signal<Fault | null>(null);
  /** What was wrong in the link that the page was opened with. */
  readonly linkFaults = signal<string[]>([]);
  /** What happened last, for the status line. */
  readonly said = signal("");
  /** Simulated seconds in a second while an episode plays; Infinity is as fast as it goes. */
  readonly speed = signal(1);
  /** The same while agents babble: slower than Infinity, the babbles are shown. */
  readonly babblingSpeed = signal(Number.POSITIVE_INFINITY);
  /** The babble that is shown. */
  readonly watched = signal<Watched | null>(null);
  readonly paused = signal(false);
  /** Who hands in, kept from lesson to lesson. */
  readonly name = signal("");
  readonly task = computed(() => this.taskOf(this.state.value.setup.env));
  readonly progress = computed(() => this.shown.value.progress);
  private work: Work | null = null;
  private sliced: State | null = null;
  private steps = 0;
  /** What was downloaded last, to hand in. */
  private downloaded = "";

  private constructor(
    readonly engine: Engine,
    readonly registry: Registry,
    readonly defaults: LinkDefaults,
    state: State,
  ) {
    this.state = signal(state);
  }

  /** Opens what a link says, or the default where that cannot be. */
  static async start(engine: Engine, hash: string): Promise<Session> {
    const [registry, lessons] = await Promise.all([engine.registry(), engine.lessons()]);
    const setups = await Promise.all(registry.environments.map(({ id }) => engine.defaultSetup(id)));
    const defaults = { setups, lessons };
    const { link, faults } = readLink(hash, defaults);
    const problems = faults.map(({ key, problem }) => `${key}: ${problem}`);
    const state = await opened(engine, link.setup).catch((error: unknown) => {
      problems.push(faultOf(error).problem);
      return opened(engine, defaults.setups[0]!);
    });
    const session = new Session(engine, registry, defaults, state);
    session.arrange(link);
    session.linkFaults.value = problems;
    await session.show();
    return session;
  }

  taskOf(env: string): string {
    return this.registry.environments.find(({ id }) => id === env)?.task ?? "";
  }

  /** Does a command, and shows what came of it. A fault is shown, and thrown on. Commands of one work are undone together. */
  async apply(command: Command, work: Work | null = null): Promise<State> {
    const state = await this.take(this.carryOut(command, work));
    await this.show();
    return state;
  }

  /** A slice of long work: the page learns of it at the next call of `apply` or `showSlices`. */
  async applySlice(command: Command, work: Work): Promise<void> {
    try {
      this.sliced = await this.carryOut(command, work);
    } catch (error) {
      this.complain(error);
      throw error;
    }
  }

  private carryOut(command: Command, work: Work | null): Promise<State> {
    if (work?.begun) return this.engine.goOn(command);
    if (work) work.begun = true;
    return this.engine.apply(command);
  }

  /** Shows what came of the slices so far. */
  async showSlices(): Promise<State> {
    if (this.sliced) await this.take(Promise.resolve(this.sliced));
    this.sliced = null;
    await this.show();
    return this.state.value;
  }

  /** Goes on with another setup; the same one is no command. */
  async change(setup: Setup): Promise<State> {
    if (same(setup, this.state.value.setup)) return this.state.value;
    await addShippedPolicies(this.engine, setup);
    return this.apply({ do: "change", setup });
  }

  /** Another environment: with the same agents if they know its task, else with its default agent. */
  changeEnvironment(env: string): Promise<State> {
    const { setup } = this.state.value;
    this.stop();
    const fallback = this.defaults.setups.find((one) => one.env === env)!;
    const sameTask = this.taskOf(env) === this.task.value;
    return this.change(sameTask ? { ...setup, env, options: {} } : { ...fallback, seed: setup.seed });
  }

  recall(place: Case | null): Promise<State> {
    this.stop();
    return this.apply({ do: "recall", case: place });
  }

  answer(question: string, value: string | number): Promise<State> {
    return this.apply({ do: "answer", question, value });
  }

  /** Begins anew: nothing is learnt, and the record is empty. */
  async open(setup: Setup, link: Partial<Link> = {}): Promise<void> {
    this.stop();
    await this.take(opened(this.engine, setup), link);
    await this.show();
  }

  async undo(): Promise<void> {
    this.stop();
    await this.take(this.engine.undo());
    this.said.value = "What was done last is undone.";
    await this.show();
  }

  /** Puts an agent from a file in the place of one. The record begins anew with it. */
  async loadAgent(agent: number, bytes: Uint8Array): Promise<void> {
    this.stop();
    await this.take(this.engine.loadAgent(agent, bytes));
    this.said.value = "The agent is loaded. The record begins anew with it.";
    await this.show();
  }

  /** The record of what was done, as a file to hand in. */
  async record(): Promise<string> {
    const record = await this.engine.record(this.lesson.value?.id ?? null, this.name.value.trim());
    this.downloaded = this.mark();
    return record;
  }

  /** Whether something was done in a lesson that no downloaded record has. */
  hasUndelivered(): boolean {
    return this.lesson.value !== null && this.state.value.commands > 0 && this.mark() !== this.downloaded;
  }

  private mark(): string {
    const { commands, hash } = this.state.value;
    return `${this.lesson.value?.id} ${commands} ${hash}`;
  }

  /** Asks before the record of a lesson is lost. */
  private mayLeave(): boolean {
    const lost = "What you did in this lesson is not downloaded, and will be lost. Leave the lesson?";
    return !this.hasUndelivered() || confirm(lost);
  }

  /** Begins a lesson with its own setup, or leaves the one that runs, if the user agrees. */
  async beginLesson(lesson: Lesson | null): Promise<void> {
    if (!this.mayLeave()) return;
    const setup = lesson?.setup ?? this.state.value.setup;
    const view = lesson && isView(lesson.view) ? lesson.view : "all";
    const hidden = lesson?.hidden.filter(isControl) ?? [];
    await this.open(setup, { lesson: lesson?.id ?? null, view, hidden });
  }

  /** Begins long work in the place of other long work. */
  begin(label: string, total: number | null, bar = true): Work {
    this.stop();
    this.work = new Work(this.job, label, total, bar);
    return this.work;
  }

  /** Stops long work after the slice that runs now. */
  stop(): void {
    this.work?.end();
    this.work = null;
    this.paused.value = false;
  }

  /** Waits while what is shown is paused; resolves to whether one step is to be made. */
  async held(work: Work): Promise<boolean> {
    while (this.paused.value && this.steps === 0 && !work.stopped) await pause(PAUSED_MS);
    const stepped = this.paused.value && this.steps > 0;
    this.steps = stepped ? this.steps - 1 : 0;
    return stepped;
  }

  /** Moves what is paused on by one step. */
  stepOn(): void {
    this.steps += 1;
  }

  /** Runs what a user asked for; a fault is shown instead of thrown. */
  attempt(work: () => Promise<unknown>): Promise<void> {
    return work().then(
      () => undefined,
      (error: unknown) => this.complain(error),
    );
  }

  complain(error: unknown): void {
    this.fault.value = faultOf(error);
  }

  /** The address of the page as it is, without its "#". */
  address(): string {
    const { setup } = this.state.value;
    const lesson = this.lesson.value?.id ?? null;
    return writeLink({ setup, lesson, view: this.view.value, hidden: this.hidden.value }, this.defaults);
  }

  /** Goes where a link leads: on with what is learnt, or anew if the link is of another lesson. */
  async follow(hash: string): Promise<void> {
    const { link, faults } = readLink(hash, this.defaults);
    this.linkFaults.value = faults.map(({ key, problem }) => `${key}: ${problem}`);
    this.stop();
    if (link.lesson !== (this.lesson.value?.id ?? null)) {
      return this.mayLeave() ? this.open(link.setup, link) : undefined;
    }
    const { setup } = link;
    await addShippedPolicies(this.engine, setup);
    if (same(setup, this.state.value.setup)) this.arrange(link);
    else await this.take(this.engine.apply({ do: "change", setup }), link);
    await this.show();
  }

  /** Asks the engine for what the views show. */
  async show(): Promise<void> {
    const wanted = {
      agents: this.state.value.setup.agents.length,
      agent: this.shownAgent.value,
      eye: this.sees("eye"),
      lesson: this.lesson.value?.id ?? null,
    };
    this.shown.value = await shownOf(this.engine, wanted);
  }

  sees(view: View): boolean {
    return this.view.value === "all" || this.view.value === view;
  }

  private arrange({ lesson, view, hidden }: Partial<Link>): void {
    batch(() => {
      if (lesson !== undefined)
        this.lesson.value = this.defaults.lessons.find(({ id }) => id === lesson) ?? null;
      if (view !== undefined) this.view.value = view;
      if (hidden !== undefined) this.hidden.value = hidden;
    });
  }

  /** Takes over what the engine answers, and what a link says besides, together. */
  private async take(answer: Promise<State>, link: Partial<Link> = {}): Promise<State> {
    try {
      const state = await answer;
      this.sliced = null;
      batch(() => {
        this.state.value = state;
        this.arrange(link);
        this.fault.value = null;
        if (this.shownAgent.value >= state.setup.agents.length) this.shownAgent.value = 0;
      });
      return state;
    } catch (error) {
      this.complain(error);
      throw error;
    }
  }
}

async function opened(engine: Engine, setup: Setup): Promise<State> {
  await addShippedPolicies(engine, setup);
  return engine.open(setup);
}

function faultOf(error: unknown): Fault {
  const fault = (error as { fault?: Fault } | null)?.fault;
  return (
    fault ?? { kind: "Error", field: null, problem: error instanceof Error ? error.message : String(error) }
  );
}
