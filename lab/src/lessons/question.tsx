/** A question of a lesson: choices or a number, and what came of the last answer. */
import { useState } from "preact/hooks";
import type { Lesson, Progress } from "../engine/contract";
import type { Session } from "../session/session";
import { inline } from "./prose";

type Asked = Lesson["questions"][number];
type Answered = Progress["answers"][number];

export function Question(props: { session: Session; question: Asked; answered: Answered | undefined }) {
  const { session, question, answered } = props;
  const [value, setValue] = useState("");
  const given = question.choices === null ? Number.parseFloat(value.replace(",", ".")) : value;
  const usable = typeof given === "number" ? Number.isFinite(given) : given !== "";
  const submit = (event: Event) => {
    event.preventDefault();
    if (usable) void session.attempt(() => session.answer(question.id, given));
  };
  const verdict = `verdict-${question.id}`;
  return (
    <form class="question" onSubmit={submit}>
      <fieldset aria-describedby={verdict}>
        <legend>{inline(question.text)}</legend>
        {question.choices === null ? (
          <NumberInput question={question} value={value} onValue={setValue} />
        ) : (
          question.choices.map((choice) => (
            <label key={choice}>
              <input
                type="radio"
                name={`question-${question.id}`}
                checked={value === choice}
                onChange={() => setValue(choice)}
              />{" "}
              {choice}
            </label>
          ))
        )}
        <button type="submit" class="small" disabled={!usable}>
          Answer
        </button>
        <Verdict id={verdict} answered={answered} />
      </fieldset>
    </form>
  );
}

function NumberInput(props: { question: Asked; value: string; onValue: (value: string) => void }) {
  const { question, value, onValue } = props;
  return (
    <label>
      <span class="hidden">A number{question.unit ? ` in ${question.unit}` : ""}</span>
      <input
        type="text"
        inputMode="decimal"
        size={8}
        value={value}
        onInput={(event) => onValue(event.currentTarget.value)}
      />{" "}
      {question.unit}
    </label>
  );
}

function Verdict({ id, answered }: { id: string; answered: Answered | undefined }) {
  return (
    <p id={id} aria-live="polite" class={answered?.right ? "right" : "hint"}>
      {answered?.given && (answered.right ? "✓ Right." : `Not yet. ${answered.hint ?? ""}`)}
    </p>
  );
}
