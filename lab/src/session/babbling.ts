/** Babbling in slices, so that the page stays alive and can be stopped. */
import type { State } from "../engine/contract";
import type { Session } from "./session";
import { watchBabble } from "./watching";
import { pause, Slices, type Work } from "./work";

/** Test cases of a point of the learning curve, by task: a grasp takes longer to play. */
export const TEST_CASES: Record<string, number> = { reach: 100, grasp: 40 };
/** Tests without a better result, after which babbling "until it is good" ends. */
export const PATIENCE = 4;
/** How often the views follow while it babbles: less often where drawing them takes long. */
const SHOWN_EVERY_MS = 200;
const SHARE_OF_SHOWING = 0.25;

/** Babbles until each learning agent has learnt from so many more babbles. */
export async function babble(session: Session, babbles: number): Promise<void> {
  const work = session.begin("Babbling", babbles);
  try {
    const done = await babbleSlices(session, work, babbles, 0);
    session.said.value = learntFrom(done, babbles);
  } finally {
    session.watched.value = null;
    await session.showSlices();
    work.end();
  }
}

function learntFrom(done: number, wanted: number): string {
  if (done < wanted)
    return `Stopped: learnt from ${done.toLocaleString("en")} of ${wanted.toLocaleString("en")} babbles.`;
  return `Learnt from ${done.toLocaleString("en")} ${done === 1 ? "babble" : "babbles"}.`;
}

/** Plays the test cases, which is a point of the learning curve. */
export async function test(session: Session): Promise<void> {
  const work = session.begin("Testing", null);
  try {
    await testOnce(session, work);
    session.said.value = `Tested: ${shares(session.state.value)} of the cases succeeded.`;
  } finally {
    work.end();
  }
}

/** Babbles and tests in turn until an agent's success reaches `goal`, or none was better for a while. */
export async function babbleUntilGood(session: Session, goal: number): Promise<void> {
  const work = session.begin(`Babbling until ${percent(goal)} of the test cases succeed`, null);
  let done = 0;
  let best = -1;
  let sinceBest = 0;
  try {
    while (!work.stopped) {
      const success = await testOnce(session, work);
      if (success > best) [best, sinceBest] = [success, 0];
      else sinceBest += 1;
      if (success >= goal || sinceBest >= PATIENCE || work.stopped) break;
      done = await babbleSlices(session, work, Math.max(10, Math.round(done / 2)), done);
    }
    session.said.value = verdict(work.stopped, best, goal);
  } finally {
    session.watched.value = null;
    await session.showSlices();
    work.end();
  }
}

function verdict(stopped: boolean, best: number, goal: number): string {
  const result = `the best test so far: ${percent(best)} success`;
  if (stopped) return `Stopped; ${result}.`;
  if (best >= goal) return `Good: ${percent(best)} of the test cases succeed.`;
  return `It gets no better: ${result}.`;
}

async function babbleSlices(session: Session, work: Work, babbles: number, before: number): Promise<number> {
  const slices = new Slices();
  let done = 0;
  let showNext = performance.now() + SHOWN_EVERY_MS;
  while (done < babbles && !work.stopped) {
    if (session.babblingSpeed.value !== Number.POSITIVE_INFINITY) {
      if (await watchBabble(session, work)) work.report(before + ++done);
      continue;
    }
    const n = slices.next(babbles - done);
    const began = performance.now();
    await session.applySlice({ do: "babble", n }, work);
    const now = performance.now();
    slices.took(n, now - began);
    done += n;
    work.report(before + done);
    if (now >= showNext) {
      await session.showSlices();
      await pause(0); // for the page to be painted
      const took = performance.now() - now;
      showNext = now + Math.max(SHOWN_EVERY_MS, took / SHARE_OF_SHOWING);
    }
  }
  return before + done;
}

async function testOnce(session: Session, work: Work): Promise<number> {
  const n = TEST_CASES[session.task.value] ?? 40;
  const { curve, agents } = await session.apply({ do: "test", n }, work);
  const point = curve.at(-1)!;
  return Math.max(...point.successes.filter((_, place) => agents[place]!.learns).map((k) => k / point.cases));
}

function shares(state: State): string {
  const point = state.curve.at(-1)!;
  return point.successes.map((k) => percent(k / point.cases)).join(" and ");
}

export function percent(share: number): string {
  return `${Math.round(100 * share)} %`;
}
