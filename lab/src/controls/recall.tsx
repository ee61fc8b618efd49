/** An episode on the stage: which case, and how it is played. */
import { play, runs, step } from "../session/playing";
import type { Session } from "../session/session";
import { Act, Group } from "./group";

const SPEEDS = [1, 2, 5, 20, Number.POSITIVE_INFINITY];

export function RecallControls({ session }: { session: Session }) {
  const { episode } = session.state.value;
  const job = session.job.value;
  const playing = job?.label === "Playing";
  return (
    <Group session={session} controls={["recall"]} title="Try what it recalls">
      <div class="row">
        <Act session={session} work={() => session.recall(null)}>
          Next case
        </Act>
        <Act session={session} disabled={!episode} work={() => session.recall(episode!.case)}>
          Same case again
        </Act>
      </div>
      <div class="row">
        {playing ? (
          <button type="button" onClick={() => session.stop()}>
            Pause
          </button>
        ) : (
          <Act session={session} work={() => play(session)}>
            Play
          </Act>
        )}
        <Act session={session} disabled={!runs(episode)} work={() => step(session)}>
          One step
        </Act>
        <label>
          speed{" "}
          <select
            value={String(session.speed.value)}
            onChange={(event) => {
              session.speed.value = Number(event.currentTarget.value);
            }}
          >
            {SPEEDS.map((speed) => (
              <option key={speed} value={String(speed)}>
                {speed === Number.POSITIVE_INFINITY
                  ? "as fast as it goes"
                  : `${speed} ×${speed === 1 ? " (real time)" : ""}`}
              </option>
            ))}
          </select>
        </label>
      </div>
      <p class="hint">
        You can also drag the parts of the case in the scene; the agent then begins anew there.
      </p>
    </Group>
  );
}
