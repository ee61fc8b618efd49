/** The scene of the robot. three.js is loaded by itself, so that the controls are there before it. */
import { useEffect, useRef } from "preact/hooks";
import type { SceneView as Drawn } from "../scene";
import { runs } from "../session/playing";
import type { Session } from "../session/session";
import { isDark, onThemeChange } from "../shell/theme";

/** How long a pose glides to the next one at real time, and at least [s]. */
const [CONTROL_SECONDS, FRAME_SECONDS] = [0.05, 0.033];

export function SceneView({ session }: { session: Session }) {
  const container = useRef<HTMLDivElement>(null);
  const drawn = useRef<Drawn | null>(null);
  const task = session.task.value;

  useEffect(() => {
    let gone = false;
    let stopTheme = () => {};
    void session.attempt(async () => {
      const { createScene } = await import("../scene");
      if (gone) return;
      const view = createScene(container.current!, {
        parts: session.registry.caseParts[task] ?? [],
        theme: isDark() ? "dark" : "light",
        reducedMotion: matchMedia("(prefers-reduced-motion: reduce)").matches,
      });
      drawn.current = view;
      view.onDrag((next) => session.recall(next).then(() => undefined));
      view.onSay((text) => {
        session.said.value = text;
      });
      stopTheme = onThemeChange((dark) => view.setTheme(dark ? "dark" : "light"));
      show(view, session);
    });
    return () => {
      gone = true;
      stopTheme();
      drawn.current?.dispose();
      drawn.current = null;
    };
  }, [session, task]);

  // Read here, so that the effect runs again when they change.
  const { scenes } = session.shown.value;
  const { episode } = session.state.value;
  const watched = session.watched.value;
  useEffect(() => {
    if (drawn.current) show(drawn.current, session);
  }, [scenes, episode, watched]);
  return (
    <>
      <div class="scene-place" ref={container} />
      <div class="row">
        <button type="button" onClick={() => drawn.current?.look("home")}>
          Camera back
        </button>
        <button type="button" onClick={() => drawn.current?.look("above")}>
          From above
        </button>
        <button type="button" onClick={() => drawn.current?.clearTrails()}>
          Clear trails
        </button>
      </div>
    </>
  );
}

/** What a view showed last: the number of a babble, or the step of an episode. */
const last = new WeakMap<Drawn, { babble: number | null; step: number }>();

function show(view: Drawn, session: Session): void {
  const { scenes } = session.shown.value;
  if (scenes.length === 0) return;
  const { episode } = session.state.value;
  const watched = session.watched.value;
  const [babble, step] = [watched?.number ?? null, episode?.step ?? 0];
  const before = last.get(view) ?? { babble: null, step: 0 };
  if (babble !== before.babble || step < before.step) view.clearTrails();
  last.set(view, { babble, step });
  if (watched) {
    view.show([watched.scene], babble === before.babble ? watched.seconds : 0);
    view.setCase({}, false);
    return;
  }
  const playing = session.job.value !== null && runs(episode);
  view.show(scenes, playing ? Math.max(FRAME_SECONDS, CONTROL_SECONDS / session.speed.value) : 0);
  view.setCase(episode?.case ?? {}, episode !== null && !playing);
  if (playing) session.said.value = view.describe(episode);
}
