/** Seed, beginning anew, undo. */
import { useEffect, useState } from "preact/hooks";
import type { Session } from "../session/session";
import { Act, Group } from "./group";

export function BeginControls({ session }: { session: Session }) {
  const { setup, undoable } = session.state.value;
  const [seed, setSeed] = useState(setup.seed);
  useEffect(() => setSeed(setup.seed), [setup.seed]);
  const { hidden } = session;
  const anew = () => {
    const { commands } = session.state.value;
    const lost = "What the agents have learnt and the record of what you did will be lost. Begin anew?";
    return commands > 0 && !confirm(lost) ? Promise.resolve() : session.open({ ...setup, seed });
  };
  return (
    <Group session={session} controls={["seed", "undo"]} title="Begin anew, undo">
      <div class="row">
        {!hidden.value.includes("seed") && (
          <>
            <label>
              seed{" "}
              <input
                type="number"
                min={0}
                max={Number.MAX_SAFE_INTEGER}
                step={1}
                value={seed}
                onChange={(event) => {
                  const next = event.currentTarget.valueAsNumber;
                  if (Number.isSafeInteger(next) && next >= 0) setSeed(next);
                  else event.currentTarget.value = String(seed);
                }}
              />
            </label>
            <Act session={session} work={anew}>
              Begin anew
            </Act>
          </>
        )}
        {!hidden.value.includes("undo") && (
          <Act session={session} disabled={undoable === 0} work={() => session.undo()}>
            Undo {undoable > 0 && `(${undoable})`}
          </Act>
        )}
      </div>
      <p class="hint">
        The same seed gives the same babbles and the same cases. Undo takes back what you did last: a run of
        babbles or tests as a whole, but babbles that were shown one by one, as far as memory allows.
      </p>
    </Group>
  );
}
