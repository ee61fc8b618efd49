/** Babbles to watch: each is shown as it happens, and then learnt from. */
import type { Brain, Film, Scene } from "../engine/contract";
import { whatIsSeen } from "../scene/describe";
import type { Session } from "./session";
import { pause, type Work } from "./work";

/** Shortest time between two pictures, and the one for people who ask for little motion. */
const [FRAME_MS, STILL_MS] = [33, 500];

/** What is shown of a babble now. */
export interface Watched {
  number: number; // of the babble, from 1 on
  scene: Scene;
  seconds: number; // real time until the next picture
  /** What was seen and what was done when the agent last learnt, or will learn if the babble ends well. */
  maps: Brain | null;
}

/** Shows the babbles up to the first one that can be learnt from, and learns from it; false if it was stopped before. */
export async function watchBabble(session: Session, work: Work): Promise<boolean> {
  const agent = watchedAgent(session);
  for (let ahead = 0; session.babblingSpeed.value !== Number.POSITIVE_INFINITY; ahead += 1) {
    const film = await session.engine.film(agent, ahead);
    if (work.stopped) return false;
    await showFilm(session, work, film);
    if (work.stopped) return false;
    if (film.learnable) break;
  }
  work.begun = false; // It can be undone by itself.
  await session.apply({ do: "babble", n: 1 }, work);
  return true;
}

/** The agent that is looked at if it learns, else the first one that does. */
function watchedAgent(session: Session): number {
  const { agents } = session.state.value;
  const shown = session.shownAgent.value;
  return agents[shown]?.learns ? shown : agents.findIndex(({ learns }) => learns);
}

/** Plays a film to its end; a pause holds it, and steps move it on. */
async function showFilm(session: Session, work: Work, film: Film): Promise<void> {
  const last = film.frames.length - 1;
  for (let at = 0; ; ) {
    const wait = frameMs(session, film);
    const scene = film.frames[at]!;
    const maps = mapsAt(film, at, session.shown.value.brain) ?? session.watched.value?.maps ?? null;
    session.watched.value = { number: film.number, scene, seconds: wait / 1000, maps };
    const seen = `Babble ${film.number}: ${whatIsSeen([scene], null)}`;
    session.said.value = at === last ? endWords(film, session.task.value) : seen;
    const began = performance.now();
    await pause(wait);
    const seconds = (performance.now() - began) / 1000;
    const stepped = await session.held(work);
    if (work.stopped || at === last) return;
    const due = stepped ? 1 : Math.round((seconds * session.babblingSpeed.value) / film.period);
    at = Math.min(last, at + Math.max(1, due));
  }
}

function frameMs(session: Session, film: Film): number {
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  return Math.max(still ? STILL_MS : FRAME_MS, (1000 * film.period) / session.babblingSpeed.value);
}

/** The maps with the activities of the last moment up to a frame; none before the first one. */
export function mapsAt(film: Film, frame: number, brain: Brain | null): Brain | null {
  const moment = film.moments.filter((each) => each <= frame).length - 1;
  if (moment < 0 || brain === null) return null;
  const sizes = brain.associations.flatMap(({ input, output }) => [input, output].map(sizeOf));
  let from = moment * sizes.reduce((sum, size) => sum + size, 0);
  const take = <Map extends { shape: number[] }>(map: Map) => {
    from += sizeOf(map);
    return { ...map, activity: film.activities.subarray(from - sizeOf(map), from) };
  };
  const associations = brain.associations.map((one) => ({
    ...one,
    input: take(one.input),
    output: take(one.output),
  }));
  return { ...brain, associations };
}

const sizeOf = ({ shape }: { shape: number[] }) => shape.reduce((product, side) => product * side, 1);

const WORDS: Record<string, string> = {
  collision: "the arm touched the obstacle",
  joint_limit: "it asked for a posture beyond a joint’s range",
  lost: "the hand lost the object",
};

/** How a babble ended, and what follows. */
export function endWords({ number, learnable, outcome }: Film, task: string): string {
  if (!learnable) {
    const why = outcome === "success" ? "the eye did not see the object" : (WORDS[outcome] ?? outcome);
    return `Babble ${number}: ${why}, so nothing is learnt from it.`;
  }
  const good = task === "reach" ? "a legal movement" : "the hand kept the object";
  return `Babble ${number}: ${good}, so it is learnt from.`;
}
