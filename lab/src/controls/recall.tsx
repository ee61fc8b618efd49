/** An episode on the stage: which case, and how it is played. */
import { play, runs, step } from "../session/playing";
import type { Session } from "../session/session";
import { Act, Group } from "./group";
import { PalmControls } from "./palm";
import { SpeedSelect } from "./speed";

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
        <SpeedSelect label="playing speed" speed={session.speed} fastest="as fast as it goes" />
      </div>
      {session.task.value === "grasp" && <PalmControls session={session} />}
      <p class="hint">
        You can also drag the parts of the case in the scene; the agent then begins anew there.
      </p>
    </Group>
  );
}
