/** Babbling, and testing what was learnt. */
import { useSignal } from "@preact/signals";
import { babble, babbleUntilGood, PATIENCE, percent, TEST_CASES, test } from "../session/babbling";
import type { Session } from "../session/session";
import { Act, Group } from "./group";
import { SpeedSelect } from "./speed";

function WatchedControls({ session }: { session: Session }) {
  if (session.watched.value === null) return null;
  const paused = session.paused.value;
  const turn = () => {
    session.paused.value = !paused;
  };
  return (
    <>
      <button type="button" onClick={turn}>
        {paused ? "Go on babbling" : "Pause babbling"}
      </button>
      <button type="button" disabled={!paused} onClick={() => session.stepOn()}>
        One step of the babble
      </button>
    </>
  );
}

export function BabbleControls({ session }: { session: Session }) {
  const goal = useSignal(90);
  const { agents } = session.state.value;
  const learns = agents.some((agent) => agent.learns);
  const cases = TEST_CASES[session.task.value] ?? 40;
  const canBabble = !session.hidden.value.includes("babble");
  return (
    <Group session={session} controls={["babble", "recall"]} title={canBabble ? "Babble and learn" : "Test"}>
      {canBabble && (
        <>
          {!learns && <p>No agent here learns by babbling.</p>}
          <div class="row">
            {[1, 100, 1000].map((n) => (
              <Act key={n} session={session} disabled={!learns} work={() => babble(session, n)}>
                {n === 1 ? "Babble once" : `Babble ${n.toLocaleString("en")} ×`}
              </Act>
            ))}
          </div>
          <div class="row">
            <Act session={session} disabled={!learns} work={() => babbleUntilGood(session, goal.value / 100)}>
              Babble until it is good
            </Act>
            <label>
              good is{" "}
              <input
                type="number"
                min={1}
                max={100}
                value={goal.value}
                onChange={(event) => {
                  goal.value = Math.min(
                    100,
                    Math.max(1, Math.round(event.currentTarget.valueAsNumber || 90)),
                  );
                }}
              />{" "}
              % success
            </label>
          </div>
          <div class="row">
            <SpeedSelect
              label="babbling speed"
              speed={session.babblingSpeed}
              fastest="as fast as it goes, not shown"
            />
            <WatchedControls session={session} />
          </div>
          <p class="hint">
            Slower than that, the scene shows each babble, and the brain what was seen and done in it. The
            agent learns the same at any speed.
          </p>
          <p class="hint">
            “Until it is good” tests between, and also stops if {PATIENCE} tests in a row are no better than
            the best before.
          </p>
        </>
      )}
      <div class="row">
        <Act session={session} disabled={session.job.value?.bar ?? false} work={() => test(session)}>
          Test on {cases} cases
        </Act>
      </div>
      <dl class="numbers">
        {agents.map(
          (agent, place) =>
            agent.learns && (
              <div key={place}>
                <dt>
                  {agents.length === 1
                    ? "Learnt from"
                    : `${place === 0 ? "First" : "Second"} agent learnt from`}
                </dt>
                <dd>
                  {agent.learnt.toLocaleString("en")} of {agent.babbled.toLocaleString("en")} babbles
                  {agent.babbled > 0 && ` (${percent(agent.learnt / agent.babbled)})`}
                </dd>
              </div>
            ),
        )}
      </dl>
    </Group>
  );
}
