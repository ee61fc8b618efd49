/** How fast simulated time goes. */
import type { Signal } from "@preact/signals";

const SPEEDS = [1, 2, 5, 20, Number.POSITIVE_INFINITY];

export function SpeedSelect({
  label,
  speed,
  fastest,
}: {
  label: string;
  speed: Signal<number>;
  fastest: string;
}) {
  return (
    <label>
      {label}{" "}
      <select
        value={String(speed.value)}
        onChange={(event) => {
          speed.value = Number(event.currentTarget.value);
        }}
      >
        {SPEEDS.map((each) => (
          <option key={each} value={String(each)}>
            {each === Number.POSITIVE_INFINITY ? fastest : `${each} ×${each === 1 ? " (real time)" : ""}`}
          </option>
        ))}
      </select>
    </label>
  );
}
