/** The page: header, lesson, views, controls, and a line that says what happens. */
import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import { AgentControls } from "../controls/agents";
import { BabbleControls } from "../controls/babble";
import { BeginControls } from "../controls/begin";
import { FileControls } from "../controls/files";
import { RecallControls } from "../controls/recall";
import { RuleControls } from "../controls/rule";
import { SliderControls } from "../controls/sliders";
import { LessonPanel } from "../lessons/panel";
import { VIEWS } from "../page-state";
import type { Session } from "../session/session";
import { agentTitle } from "../views/agent-title";
import { BrainView } from "../views/brain-view";
import { EyeView } from "../views/eye-view";
import { SceneView } from "../views/scene-view";
import { Header } from "./header";
import { Status } from "./status";

export function App({ session }: { session: Session }) {
  useUndoKey(session);
  useUndelivered(session);
  return (
    <>
      <button type="button" class="skip" onClick={() => document.getElementById("controls")!.focus()}>
        To the controls
      </button>
      <Header session={session} />
      <Faults session={session} />
      <main class={session.lesson.value ? "with-lesson" : ""}>
        <LessonPanel session={session} />
        <Views session={session} />
      </main>
      <Status session={session} />
    </>
  );
}

/** The views that are shown. The controls come after the first one, for narrow pages. */
function Views({ session }: { session: Session }) {
  const drawn = useOneByOne();
  const [first, ...others] = [
    session.sees("scene") && (
      <View key="scene" name="scene" title="Scene">
        <SceneView session={session} />
      </View>
    ),
    session.sees("eye") && (
      <View key="eye" name="eye" title="Eye">
        <ShownAgent session={session} name="eye" />
        <EyeView session={session} />
      </View>
    ),
    session.sees("brain") && (
      <View key="brain" name="brain" title="Brain">
        <ShownAgent session={session} name="brain" />
        <BrainView session={session} />
      </View>
    ),
  ].filter(Boolean);
  return (
    <>
      {first}
      <section key="controls" id="controls" class="controls" aria-labelledby="controls-title" tabIndex={-1}>
        <h2 id="controls-title">Controls</h2>
        <BabbleControls session={session} />
        <RecallControls session={session} />
        <AgentControls session={session} />
        <RuleControls session={session} />
        <SliderControls session={session} />
        <BeginControls session={session} />
        <FileControls session={session} />
      </section>
      {others.slice(0, drawn)}
    </>
  );
}

/** Counts up from 0, each time in a task of its own, so that no task draws more than one view. */
function useOneByOne(): number {
  const [count, setCount] = useState(0);
  useEffect(() => {
    if (count === VIEWS.length) return;
    const timer = setTimeout(() => setCount(count + 1));
    return () => clearTimeout(timer);
  }, [count]);
  return count;
}

/** Ctrl+Z undoes the last command, except where it undoes typing. */
function useUndoKey(session: Session): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      const typing =
        event.target instanceof HTMLInputElement && !/radio|checkbox|range/.test(event.target.type);
      const undo = (event.ctrlKey || event.metaKey) && !event.shiftKey && event.key === "z";
      if (!undo || typing || session.hidden.value.includes("undo")) return;
      event.preventDefault();
      if (session.state.value.undoable > 0) void session.attempt(() => session.undo());
    };
    addEventListener("keydown", onKey);
    return () => removeEventListener("keydown", onKey);
  }, [session]);
}

/** Lets the browser ask before it closes or reloads a lesson whose record is not downloaded. */
function useUndelivered(session: Session): void {
  useEffect(() => {
    const onUnload = (event: BeforeUnloadEvent) => {
      if (session.hasUndelivered()) event.preventDefault();
    };
    addEventListener("beforeunload", onUnload);
    return () => removeEventListener("beforeunload", onUnload);
  }, [session]);
}

function View({ name, title, children }: { name: string; title: string; children: ComponentChildren }) {
  return (
    <section aria-labelledby={`${name}-title`} class={`view ${name}-view`}>
      <h2 id={`${name}-title`}>{title}</h2>
      {children}
    </section>
  );
}

function ShownAgent({ session, name }: { session: Session; name: string }) {
  const { setup } = session.state.value;
  if (setup.agents.length === 1) return null;
  return (
    <fieldset class="row">
      <legend>Agent</legend>
      {setup.agents.map((_, place) => (
        <label key={place}>
          <input
            type="radio"
            name={`agent-${name}`}
            checked={session.shownAgent.value === place}
            onChange={() => {
              session.shownAgent.value = place;
              void session.attempt(() => session.show());
            }}
          />{" "}
          {agentTitle(setup, place)}
        </label>
      ))}
    </fieldset>
  );
}

function Faults({ session }: { session: Session }) {
  const fault = session.fault.value;
  const inLink = session.linkFaults.value;
  return (
    <div role="alert" class="faults">
      {inLink.length > 0 && (
        <div class="fault">
          <p>The link could not be followed in all: what is wrong in it is left out.</p>
          <ul>
            {inLink.map((problem) => (
              <li key={problem}>{problem}</li>
            ))}
          </ul>
          <Close
            close={() => {
              session.linkFaults.value = [];
            }}
          />
        </div>
      )}
      {fault && (
        <div class="fault">
          <p>{fault.problem}</p>
          <Close
            close={() => {
              session.fault.value = null;
            }}
          />
        </div>
      )}
    </div>
  );
}

function Close({ close }: { close: () => void }) {
  return (
    <button type="button" class="small" onClick={close}>
      Close
    </button>
  );
}
