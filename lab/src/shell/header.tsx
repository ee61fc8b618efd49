/** Title, task, lesson, link, theme. */
import { useState } from "preact/hooks";
import { VIEWS, type View } from "../page-state";
import type { Session } from "../session/session";
import { copyText } from "./copy";
import { setTheme, type Theme, theme } from "./theme";

const VIEW_TITLES: Record<View, string> = { all: "All", scene: "Scene", eye: "Eye", brain: "Brain" };

export function Header({ session }: { session: Session }) {
  return (
    <header>
      <h1>gym-babble lab</h1>
      {!session.hidden.value.includes("task") && <TaskSelect session={session} />}
      <LessonSelect session={session} />
      <fieldset class="views">
        <legend class="hidden">View</legend>
        {VIEWS.map((view) => (
          <label key={view}>
            <input
              type="radio"
              name="view"
              checked={session.view.value === view}
              onChange={() => {
                session.view.value = view;
                void session.attempt(() => session.show());
              }}
            />
            <span>{VIEW_TITLES[view]}</span>
          </label>
        ))}
      </fieldset>
      <CopyLink />
      <label class="theme">
        Colours{" "}
        <select value={theme.value} onChange={(event) => setTheme(event.currentTarget.value as Theme)}>
          <option value="auto">as the system</option>
          <option value="light">light</option>
          <option value="dark">dark</option>
        </select>
      </label>
    </header>
  );
}

function TaskSelect({ session }: { session: Session }) {
  const { environments } = session.registry;
  return (
    <label>
      Task{" "}
      <select
        value={session.state.value.setup.env}
        onChange={(event) => {
          const env = event.currentTarget.value;
          void session.attempt(() => session.changeEnvironment(env));
        }}
      >
        {environments.map(({ id, title }) => (
          <option key={id} value={id}>
            {title}: {id}
          </option>
        ))}
      </select>
    </label>
  );
}

function LessonSelect({ session }: { session: Session }) {
  const { lessons } = session.defaults;
  if (lessons.length === 0) return null;
  return (
    <label>
      Lesson{" "}
      <select
        value={session.lesson.value?.id ?? ""}
        onChange={(event) => {
          const lesson = lessons.find(({ id }) => id === event.currentTarget.value) ?? null;
          // Where the user stays, the menu shall say so.
          event.currentTarget.value = session.lesson.value?.id ?? "";
          void session.attempt(() => session.beginLesson(lesson));
        }}
      >
        <option value="">none: try freely</option>
        {lessons.map(({ id, number, title }) => (
          <option key={id} value={id}>
            {number}. {title}
          </option>
        ))}
      </select>
    </label>
  );
}

function CopyLink() {
  const [said, setSaid] = useState("");
  const copy = async () =>
    setSaid((await copyText(location.href)) ? "Copied." : "Copy the address of this page instead.");
  return (
    <span>
      <button type="button" onClick={() => void copy()}>
        Copy link
      </button>{" "}
      <span aria-live="polite" class="quiet">
        {said}
      </span>
    </span>
  );
}
