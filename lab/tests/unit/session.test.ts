import { describe, expect, it, vi } from "vitest";
import { babble, babbleUntilGood, PATIENCE } from "../../src/session/babbling";
import { play } from "../../src/session/playing";
import { Session } from "../../src/session/session";
import { pause, Slices } from "../../src/session/work";
import { fakeEngine, SETUP } from "./fake-engine";

const learnt = (session: Session) => session.state.value.agents[0]!.learnt;

describe("a session", () => {
  it("opens the default and says why, if the engine refuses a link", async () => {
    const { engine } = fakeEngine();
    const session = await Session.start(engine, "profile=cubist&seed=4");
    expect(session.linkFaults.value).toEqual(["no profile cubist"]);
    expect(session.state.value.setup).toEqual(SETUP);
    expect(session.address()).toBe("");
  });

  it("is as before after a command that the engine refuses, and tells the fault", async () => {
    const { engine } = fakeEngine();
    const session = await Session.start(engine, "");
    await session.attempt(() => session.change({ ...SETUP, profile: "cubist" }));
    expect(session.state.value.setup).toEqual(SETUP);
    expect(session.fault.value?.field).toBe("profile");
    await session.change({ ...SETUP, seed: 2 });
    expect(session.fault.value).toBeNull();
    expect(session.address()).toBe("seed=2");
  });

  it("makes no command of a change to the same setup", async () => {
    const { engine, fake } = fakeEngine();
    const session = await Session.start(engine, "");
    await session.change(structuredClone(SETUP));
    expect(fake.commands).toEqual([]);
  });
});

describe("babbling", () => {
  it("learns just as many babbles as asked for, in slices", async () => {
    const { engine, fake } = fakeEngine();
    const session = await Session.start(engine, "");
    await babble(session, 1000);
    expect(learnt(session)).toBe(1000);
    expect(fake.commands.length).toBeGreaterThan(1);
    expect(session.job.value).toBeNull();
  });

  it("stops between two slices", async () => {
    const { engine } = fakeEngine();
    const session = await Session.start(engine, "");
    const done = babble(session, 1_000_000_000);
    session.stop();
    await done;
    expect(learnt(session)).toBeLessThan(1_000_000_000);
    expect(session.job.value).toBeNull();
  });

  it("stops when it is good", async () => {
    const { engine } = fakeEngine({ success: (n) => Math.min(1, n / 100) });
    const session = await Session.start(engine, "");
    await babbleUntilGood(session, 0.8);
    expect(session.state.value.curve.at(-1)!.successes[0]).toBeGreaterThanOrEqual(80);
    expect(session.said.value).toMatch(/^Good/);
  });

  it("stops after a while without a better test", async () => {
    const { engine } = fakeEngine({ success: (n) => Math.min(0.5, n / 100) });
    const session = await Session.start(engine, "");
    await babbleUntilGood(session, 0.8);
    const shares = session.state.value.curve.map((point) => point.successes[0]! / point.cases);
    expect(shares.filter((share) => share === 0.5).length).toBe(PATIENCE + 1);
    expect(session.said.value).toMatch(/no better/);
  });
});

describe("watching", () => {
  const watching = async (speed: number) => {
    vi.stubGlobal("matchMedia", () => ({ matches: false }));
    const { engine, fake } = fakeEngine();
    const session = await Session.start(engine, "");
    session.babblingSpeed.value = speed;
    const seen: number[] = [];
    session.watched.subscribe((watched) => {
      if (watched !== null && seen.at(-1) !== watched.number) seen.push(watched.number);
    });
    return { session, fake, seen };
  };

  it("shows each babble, also those that cannot be learnt from, and learns as at any speed", async () => {
    const { session, fake, seen } = await watching(20);
    await babble(session, 3);
    expect(seen).toEqual([1, 2, 3, 4, 5, 6]);
    expect(fake.commands).toEqual(Array(3).fill({ do: "babble", n: 1 }));
    expect(session.state.value.undoable).toBe(3);
    expect(session.watched.value).toBeNull();
  });

  it("goes on fast and unseen, when the speed is changed meanwhile", async () => {
    const { session, seen } = await watching(1);
    const done = babble(session, 50);
    await vi.waitUntil(() => seen.length > 0);
    session.babblingSpeed.value = Number.POSITIVE_INFINITY;
    await done;
    expect(learnt(session)).toBe(50);
    expect(seen.length).toBeLessThanOrEqual(2);
  });

  it("learns nothing from a babble that was stopped, and nothing while it is paused", async () => {
    const { session, fake, seen } = await watching(20);
    session.paused.value = false;
    const done = babble(session, 1);
    session.paused.value = true;
    await vi.waitUntil(() => seen.length > 0);
    for (let steps = 0; steps < 3; steps += 1) session.stepOn();
    await pause(300);
    expect(fake.commands).toEqual([]);
    session.stop();
    await done;
    expect(fake.commands).toEqual([]);
    expect(session.paused.value).toBe(false);
  });
});

describe("undo", () => {
  it("takes back a run of babbles as a whole", async () => {
    const { engine, fake } = fakeEngine();
    const session = await Session.start(engine, "");
    await babble(session, 1000);
    await babbleUntilGood(session, 0);
    await babble(session, 500);
    expect(session.state.value.undoable).toBe(3);
    expect(fake.commands.length).toBeGreaterThan(5);
  });
});

describe("playing", () => {
  it("begins the next case, and plays it to its end", async () => {
    const { engine, fake } = fakeEngine({ steps: 7 });
    const session = await Session.start(engine, "");
    session.speed.value = Number.POSITIVE_INFINITY;
    await play(session);
    expect(fake.commands[0]).toEqual({ do: "recall", case: null });
    expect(session.state.value.episode?.step).toBe(7);
    expect(session.said.value).toMatch(/ended after 0.3 s|ended after 0.4 s/);
  });
});

describe("slices", () => {
  it("come to the time that they should take, and never exceed what is left", () => {
    const slices = new Slices(50);
    const each = 0.25;
    let n = 1;
    for (let round = 0; round < 10; round += 1) {
      n = slices.next(1e9);
      slices.took(n, n * each);
    }
    expect(n * each).toBeCloseTo(50);
    expect(slices.next(3)).toBe(3);
    slices.took(3, 1e6);
    expect(slices.next(10)).toBe(1);
  });
});
