/** Where along the palm the ball of a case lies. */
import { useState } from "preact/hooks";
import type { Session } from "../session/session";

/** Distances from the wrist that the engine takes [cm]. */
const [LOW, HIGH, STEP] = [1.6, 5.4, 0.1];
const LABEL = "Ball along the palm, from the wrist";

export function PalmControls({ session }: { session: Session }) {
  const { episode } = session.state.value;
  const [moving, setMoving] = useState<number | null>(null);
  const placed = episode?.palm == null ? null : Number((100 * episode.palm).toFixed(2));
  const shown = moving ?? placed;
  const place = (centimetres: number) => {
    if (!Number.isFinite(centimetres)) return setMoving(null);
    const within = Math.min(HIGH, Math.max(LOW, centimetres));
    setMoving(within);
    void session
      .attempt(async () => session.recall(await session.engine.palmCase(within / 100)))
      .then(() => setMoving(null));
  };
  return (
    <div class="slider">
      <span class="label">
        {LABEL}
        <span class="unit"> [cm]</span>
      </span>
      <input
        type="range"
        aria-label={LABEL}
        aria-valuetext={shown === null ? "not along the palm" : `${shown} centimetres`}
        min={LOW}
        max={HIGH}
        step={STEP}
        value={shown ?? (LOW + HIGH) / 2}
        onInput={(event) => setMoving(event.currentTarget.valueAsNumber)}
        onChange={(event) => place(event.currentTarget.valueAsNumber)}
      />
      <input
        type="number"
        aria-label={`${LABEL}, as a number`}
        min={LOW}
        max={HIGH}
        step="any"
        value={shown ?? ""}
        onChange={(event) => place(event.currentTarget.valueAsNumber)}
      />
      <p class="hint wide">
        It begins a case in which the palm meets the ball there if the elbow alone bends.{" "}
        {episode && placed === null && "In this case it does not meet the palm so."}
      </p>
    </div>
  );
}
