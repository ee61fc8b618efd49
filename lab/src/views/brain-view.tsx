/** The maps of the agent that is shown, the weights between them, and how well it has learnt. */
import { useSignal } from "@preact/signals";
import type { Brain } from "../engine/contract";
import type { Session } from "../session/session";
import { AssociationView } from "./association-view";
import { LearningCurve } from "./learning-curve";
import { Outcomes } from "./outcomes";

export function BrainView({ session }: { session: Session }) {
  const watched = session.watched.value;
  const brain = watched?.maps ?? session.shown.value.brain;
  return (
    <>
      {watched?.maps && (
        <p class="caption">
          Babble {watched.number}. Input maps: what was seen. Output maps: what was done. The rule changes the
          weights between neurons that are active in both, if the babble ends well.
        </p>
      )}
      {brain ? (
        <Maps session={session} brain={brain} />
      ) : (
        <p>This agent has no maps: it does not learn by babbling.</p>
      )}
      <div class="figures">
        <LearningCurve state={session.state.value} />
        <Outcomes state={session.state.value} />
      </div>
    </>
  );
}

function Maps({ session, brain }: { session: Session; brain: Brain }) {
  const brush = useSignal(false);
  const radius = useSignal(1);
  const canLesion = !session.hidden.value.includes("lesion");
  return (
    <>
      {canLesion && (
        <fieldset class="row">
          <legend>Lesion</legend>
          <label>
            <input
              type="checkbox"
              checked={brush.value}
              onChange={(event) => {
                brush.value = event.currentTarget.checked;
              }}
            />{" "}
            brush: silence the neurons that you paint over (or press Enter on one)
          </label>
          <label>
            brush radius{" "}
            <input
              type="number"
              min={0}
              max={5}
              value={radius.value}
              onChange={(event) => {
                radius.value = Math.min(5, Math.max(0, Math.round(event.currentTarget.valueAsNumber || 0)));
              }}
            />{" "}
            neurons
          </label>
        </fieldset>
      )}
      {brain.associations.map((association, at) => (
        <AssociationView
          key={association.name}
          session={session}
          association={association}
          at={at}
          brush={canLesion && brush.value ? radius.value : null}
        />
      ))}
      {!session.watched.value && <ReadOut brain={brain} />}
    </>
  );
}

function ReadOut({ brain }: { brain: Brain }) {
  const numbers = brain.decided.map(({ name, value, unit }) => `${name} ${value.toFixed(2)} ${unit}`.trim());
  return <p class="caption">Read out of the output maps: {numbers.join("; ")}.</p>;
}
