/** A lesson: what one has to know, what to do, what to answer, and where to read on. */
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Lesson, Progress } from "../engine/contract";
import type { Session } from "../session/session";
import { inline, Prose } from "./prose";
import { Question } from "./question";

import "./lessons.css";

export function LessonPanel({ session }: { session: Session }) {
  const lesson = session.lesson.value;
  const progress = session.progress.value;
  useTold(session, lesson, progress);
  if (lesson === null) return null;
  return (
    <aside class="lesson" aria-labelledby="lesson-title">
      <h2 id="lesson-title">
        Lesson {lesson.number}: {lesson.title}
      </h2>
      <p class="quiet">
        About {lesson.minutes} minutes. {summary(lesson, progress)}
      </p>
      <Part title="Background">
        <Prose text={lesson.background} />
      </Part>
      <Part title="Key equation">
        <p class="equation">{inline(lesson.equation.text)}</p>
        <p>
          {lesson.equation.name}. {inline(lesson.equation.means)}.
        </p>
      </Part>
      <Part title="Try this">
        <ol>
          {lesson.tasks.map((task, at) => (
            <Task key={task.id} session={session} task={task} done={progress?.tasks[at] ?? false} />
          ))}
        </ol>
      </Part>
      <Part title={lesson.questions.length === 1 ? "Question" : "Questions"}>
        {lesson.questions.map((question, at) => (
          <Question
            key={`${lesson.id} ${question.id}`}
            session={session}
            question={question}
            answered={progress?.answers[at]}
          />
        ))}
      </Part>
      <Part title="Reference">
        <ul>
          {lesson.references.map((reference) => (
            <li key={reference}>{inline(reference)}</li>
          ))}
        </ul>
      </Part>
      {!session.hidden.value.includes("files") && (
        <p class="hint">To hand in what you did, download it under “Take it with you” among the controls.</p>
      )}
      <Neighbours session={session} lesson={lesson} />
    </aside>
  );
}

function Part({ title, children }: { title: string; children: ComponentChildren }) {
  return (
    <details class="group" open>
      <summary>
        <h3>{title}</h3>
      </summary>
      {children}
    </details>
  );
}

function Task(props: { session: Session; task: Lesson["tasks"][number]; done: boolean }) {
  const { session, task, done } = props;
  const { setup } = task;
  return (
    <li class={done ? "task done" : "task"}>
      <span class="mark" role="img" aria-label={done ? "Done." : "Not done yet."}>
        {done ? "✓" : "○"}
      </span>{" "}
      {inline(task.text)}{" "}
      {setup && (
        <button type="button" class="small" onClick={() => void session.attempt(() => session.change(setup))}>
          Set this up
        </button>
      )}
    </li>
  );
}

function Neighbours({ session, lesson }: { session: Session; lesson: Lesson }) {
  const others = [lesson.number - 1, lesson.number + 1]
    .map((number) => session.defaults.lessons.find((each) => each.number === number))
    .filter((other) => other !== undefined);
  return (
    <nav class="row" aria-label="Lessons">
      {others.map((other) => (
        <button
          key={other.id}
          type="button"
          onClick={() => void session.attempt(() => session.beginLesson(other))}
        >
          {other.number < lesson.number ? "‹ " : ""}
          {other.number}. {other.title}
          {other.number > lesson.number ? " ›" : ""}
        </button>
      ))}
    </nav>
  );
}

function summary(lesson: Lesson, progress: Progress | null): string {
  const tasks = progress?.tasks.filter(Boolean).length ?? 0;
  const right = progress?.answers.filter((answer) => answer.right).length ?? 0;
  return `${tasks} of ${lesson.tasks.length} tasks done, ${right} of ${lesson.questions.length} answers right.`;
}

/** Tells when a task was done. */
function useTold(session: Session, lesson: Lesson | null, progress: Progress | null): void {
  const last = useRef<{ lesson: Lesson | null; tasks: boolean[] }>({ lesson: null, tasks: [] });
  useEffect(() => {
    if (progress === null) return;
    const before = last.current.lesson === lesson ? last.current.tasks : progress.tasks;
    const now = progress.tasks.findIndex((done, at) => done && before[at] === false);
    if (now >= 0) session.said.value = `Task ${now + 1} of the lesson is done. ${session.said.value}`;
    last.current = { lesson, tasks: progress.tasks };
  }, [session, lesson, progress]);
}
