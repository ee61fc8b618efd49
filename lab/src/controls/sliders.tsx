/** Numbers of body, maps and rule: sliders with their symbols, and choices. */
import { useState } from "preact/hooks";
import type { Json, Slider } from "../engine/contract";
import { symbols } from "../lessons/prose";
import type { Session } from "../session/session";
import { Act, Group } from "./group";
import { agentsWith, sliderDefault, sliderValue, withValue } from "./setup-value";

const PLACES = 1000; // of a logarithmic slider

export function SliderControls({ session }: { session: Session }) {
  const { setup } = session.state.value;
  const sliders = session.registry.sliders[session.task.value] ?? [];
  const titles = { config: "Body and task", options: "Environment", brain: "Maps and rule" };
  return (
    <Group session={session} controls={["sliders"]} title="Numbers of the model">
      <ProfileSelect session={session} />
      {(["config", "options", "brain"] as const).map((where) => {
        const rows = sliders
          .filter((slider) => slider.where === where)
          .flatMap((slider) => agentsWith(setup, slider).map((agent) => ({ slider, agent })));
        return (
          rows.length > 0 && (
            <fieldset key={where}>
              <legend>{titles[where]}</legend>
              {where === "brain" && <p class="hint">An agent whose numbers change begins to learn anew.</p>}
              {rows.map(({ slider, agent }) => (
                <SliderRow key={`${slider.id} ${agent}`} session={session} slider={slider} agent={agent} />
              ))}
            </fieldset>
          )
        );
      })}
    </Group>
  );
}

/** The body and task that the numbers differ from. */
function ProfileSelect({ session }: { session: Session }) {
  const { setup } = session.state.value;
  return (
    <div class="row">
      <label>
        Profile of the body{" "}
        <select
          value={setup.profile}
          onChange={(event) => {
            const profile = event.currentTarget.value;
            void session.attempt(() => session.change({ ...setup, profile }));
          }}
        >
          {session.registry.profiles.map((profile) => (
            <option key={profile} value={profile}>
              {profile}
            </option>
          ))}
        </select>
      </label>
    </div>
  );
}

function SliderRow({ session, slider, agent }: { session: Session; slider: Slider; agent: number }) {
  const { setup } = session.state.value;
  const value = sliderValue(setup, slider, agent);
  const usual = sliderDefault(setup, slider, agent);
  const set = (next: Json) =>
    session.attempt(() => session.change(withValue(session.state.value.setup, slider, agent, next)));
  const second =
    slider.where === "brain" && setup.agents.length > 1 ? ` (${agent === 0 ? "first" : "second"} agent)` : "";
  const label = `${slider.label}${second}`;
  return (
    <div class="slider">
      <span class="label">
        {slider.symbol && <i class="symbol">{symbols(slider.symbol)}</i>} {label}
        {slider.unit && <span class="unit"> [{slider.unit}]</span>}
      </span>
      {slider.choices ? (
        <select
          aria-label={label}
          value={String(slider.choices.indexOf(value as never))}
          onChange={(event) => set(slider.choices![Number(event.currentTarget.value)]!)}
        >
          {slider.choices.map((choice, at) => (
            <option key={String(choice)} value={String(at)}>
              {choice === true ? "on" : choice === false ? "off" : String(choice)}
            </option>
          ))}
        </select>
      ) : (
        <NumberRow slider={slider} label={label} value={Number(value)} set={set} />
      )}
      <Act
        session={session}
        class="small"
        disabled={value === usual}
        work={() => session.change(withValue(setup, slider, agent, usual))}
      >
        <span aria-hidden="true">↺</span>
        <span class="hidden">Default of {label}</span>
      </Act>
    </div>
  );
}

/** A range and a number for the same value. The setup changes when the hand lets go. */
function NumberRow(props: { slider: Slider; label: string; value: number; set: (value: number) => void }) {
  const { slider, label, value, set } = props;
  const [moving, setMoving] = useState<number | null>(null);
  const { low, high, step, logarithmic } = slider;
  const shown = moving ?? Number(value.toPrecision(6));
  const place = logarithmic ? (PLACES * Math.log(shown / low)) / Math.log(high / low) : shown;
  const fromPlace = (at: number) =>
    logarithmic ? Number((low * (high / low) ** (at / PLACES)).toPrecision(2)) : rounded(at, step);
  const commit = (next: number) => {
    setMoving(null);
    if (Number.isFinite(next)) set(next);
  };
  return (
    <>
      <input
        type="range"
        aria-label={label}
        aria-valuetext={`${shown} ${slider.unit}`}
        min={logarithmic ? 0 : low}
        max={logarithmic ? PLACES : high}
        step={logarithmic ? 10 : step}
        value={place}
        onInput={(event) => setMoving(fromPlace(event.currentTarget.valueAsNumber))}
        onChange={(event) => commit(fromPlace(event.currentTarget.valueAsNumber))}
      />
      <input
        type="number"
        aria-label={`${label}, as a number`}
        min={low}
        max={high}
        step="any"
        value={shown}
        onChange={(event) => commit(event.currentTarget.valueAsNumber)}
      />
    </>
  );
}

/** Without the digits that adding steps in binary leaves. */
function rounded(value: number, step: number): number {
  return Number((Math.round(value / step) * step).toPrecision(6));
}
