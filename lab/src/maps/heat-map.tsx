/** A map of neurons in colours, to look at by pointer and keyboard. */
import { useId, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Axis, MapActivity } from "../engine/contract";
import { ACTIVITY, type ColourTable, gradient } from "./colours";
import { axesOf, indices, type Layout, layoutOf } from "./layout";
import { paint } from "./paint";

export interface HeatMapProps {
  title: string;
  map: MapActivity;
  fromTop?: boolean;
  low: number;
  high: number;
  colours?: ColourTable;
  /** Neurons that are silenced; they are crossed out. */
  silenced?: number[];
  /** A neuron with a ring around it. */
  marked?: number | null;
  /** The neuron under the pointer, or chosen by the arrow keys. */
  onLook?: (neuron: number | null) => void;
  /** With a brush: the neurons that it went over. Its radius counts neurons. */
  brush?: { radius: number; onPaint: (neurons: number[]) => void } | null;
}

const PIXELS = 8; // of a canvas for each neuron of a small map

export function HeatMap(props: HeatMapProps) {
  const { map, title, brush = null, onLook } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const [cursor, setCursor] = useState<number | null>(null);
  const [byKey, setByKey] = useState(false);
  const [painted, setPainted] = useState<Set<number>>(new Set());
  const shape = map.shape.join("×");
  const layout = useMemo(() => layoutOf(map.shape, props.fromTop ?? false), [shape, props.fromTop]);
  const scale = layout.rows * layout.columns > 4096 ? 4 : PIXELS;

  // At once, so that what waits for the view also waits for its painting.
  useLayoutEffect(() => {
    const rings: [number, string][] = [];
    if (props.marked != null) rings.push([props.marked, "#ffffff"]);
    if (cursor !== null) rings.push([cursor, "#ff9d00"]);
    const crossed = [...(props.silenced ?? []), ...painted];
    const { low, high, colours = ACTIVITY } = props;
    paint(canvas.current!, { activity: map.activity, low, high, colours, crossed, rings }, layout, scale);
  });

  const look = (neuron: number | null) => {
    setCursor(neuron);
    onLook?.(neuron);
  };
  const brushOver = (neuron: number, done: Set<number>) => {
    const next = new Set(done);
    for (const one of around(neuron, layout, brush!.radius)) next.add(one);
    setPainted(next);
    return next;
  };
  const finish = (neurons: Set<number>) => {
    setPainted(new Set());
    if (neurons.size > 0) brush!.onPaint([...neurons].sort((a, b) => a - b));
  };
  const onPointer = (event: PointerEvent) => {
    const neuron = neuronUnder(event, layout);
    if (neuron !== cursor) look(neuron);
    if (brush && event.buttons === 1 && neuron !== null) brushOver(neuron, painted);
  };
  const onKey = (event: KeyboardEvent) => {
    const next = nextByKey(event.key, cursor, layout);
    setByKey(true);
    if (next !== null) look(next);
    else if (brush && cursor !== null && (event.key === "Enter" || event.key === " ")) {
      finish(brushOver(cursor, new Set()));
    } else return;
    event.preventDefault();
  };
  const axes = useId();
  const told = cursor === null ? summary(props) : describeNeuron(props, cursor);
  return (
    <figure class="map">
      <figcaption>{title}</figcaption>
      <div
        class="neurons"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: an application takes keys
        tabIndex={0}
        role="application"
        aria-roledescription="map of neurons"
        aria-label={`${title}, ${shape} neurons. ${told}`}
        aria-describedby={axes}
        onPointerMove={onPointer}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          onPointer(event);
        }}
        onPointerUp={() => brush && finish(painted)}
        onPointerLeave={() => look(null)}
        onKeyDown={onKey}
        onBlur={() => {
          setByKey(false);
          look(null);
        }}
      >
        <canvas
          ref={canvas}
          width={layout.columns * scale}
          height={layout.rows * scale}
          class={brush ? "brush" : undefined}
        />
      </div>
      <Axes id={axes} map={map} fromTop={props.fromTop ?? false} />
      <Legend low={props.low} high={props.high} colours={props.colours ?? ACTIVITY} />
      <p class="told" aria-live={byKey ? "polite" : "off"}>
        {told}
      </p>
    </figure>
  );
}

/** What the axes of a map stand for, in words; the arrows are for the eye. */
function Axes({ id, map, fromTop }: { id: string; map: MapActivity; fromTop: boolean }) {
  const { up, across } = axesOf(map.shape.length);
  return (
    <p class="axes" id={id}>
      <Way arrow="→" name="To the right" axes={across.map((axis) => map.axes[axis]!)} />
      <Way
        arrow={fromTop ? "↓" : "↑"}
        name={fromTop ? "Down" : "Up"}
        axes={up.map((axis) => map.axes[axis]!)}
      />
    </p>
  );
}

function Way({ arrow, name, axes }: { arrow: string; name: string; axes: Axis[] }) {
  const [inner, ...outer] = axes.map(axisText).reverse();
  if (inner === undefined) return null;
  return (
    <span>
      <span aria-hidden="true">{arrow}</span>
      <span class="hidden">{name}:</span> {inner}
      {outer.map((text) => `; from block to block ${text}`)}
      <span class="hidden">. </span>
    </span>
  );
}

/** "pan [share of range], 0 to 1". */
export function axisText({ name, unit, range }: Axis): string {
  const [low, high] = range.map((value) => minus(Number(value.toFixed(2))));
  return `${name}${unit && ` [${unit}]`}, ${low} to ${high}`;
}

function Legend({ low, high, colours }: { low: number; high: number; colours: ColourTable }) {
  return (
    <div class="legend">
      <span>{short(low)}</span>
      <span class="ramp" style={{ backgroundImage: gradient(colours) }} />
      <span>{short(high)}</span>
    </div>
  );
}

export function short(value: number): string {
  return value === 0 ? "0" : String(Number(value.toPrecision(2)));
}

function summary({ map, silenced }: HeatMapProps): string {
  const [peak, most] = strongest(map.activity);
  const dead = silenced?.length ? `; ${silenced.length} silenced` : "";
  if (most === 0) return `nowhere more than 0${dead}`;
  return `most: ${short(most)} at ${placeText(peak, map)}${dead}`;
}

function describeNeuron({ map, silenced }: HeatMapProps, neuron: number): string {
  const dead = silenced?.includes(neuron) ? ", silenced" : "";
  return `${short(map.activity[neuron] ?? 0)} at ${placeText(neuron, map)}${dead}`;
}

/** What a neuron prefers: "pan 40 % of range, tilt 65 % of range". */
export function placeText(neuron: number, { shape, axes }: MapActivity): string {
  const values = indices(neuron, shape).map((index, at) => {
    const { name, unit, range } = axes[at]!;
    const [low = 0, high = 0] = range;
    return `${name} ${valueText(low + ((high - low) * index) / (shape[at]! - 1), unit)}`;
  });
  return values.reverse().join(", ");
}

function valueText(value: number, unit: string): string {
  if (unit === "share of range") return `${minus(Math.round(100 * value))} % of range`;
  if (unit === "deg") return `${minus(Math.round(value))}°`;
  return `${minus(Number(value.toFixed(2)))}${unit && ` ${unit}`}`;
}

const minus = (value: number) => String(value).replace("-", "−");

/** The first of the greatest values. */
export function strongest(activity: Float32Array): [number, number] {
  let peak = 0;
  for (let j = 1; j < activity.length; j += 1) if (activity[j]! > activity[peak]!) peak = j;
  return [peak, activity[peak] ?? 0];
}

function around(neuron: number, layout: Layout, radius: number): number[] {
  const { row, column } = layout.placeOf(neuron);
  const found: number[] = [];
  for (let r = Math.max(0, row - radius); r <= Math.min(layout.rows - 1, row + radius); r += 1) {
    for (let c = Math.max(0, column - radius); c <= Math.min(layout.columns - 1, column + radius); c += 1) {
      if ((r - row) ** 2 + (c - column) ** 2 <= radius ** 2) found.push(layout.neuronAt(r, c));
    }
  }
  return found;
}

function neuronUnder(event: PointerEvent, layout: Layout): number | null {
  const box = (event.currentTarget as HTMLElement).getBoundingClientRect();
  const row = Math.floor(((event.clientY - box.top) / box.height) * layout.rows);
  const column = Math.floor(((event.clientX - box.left) / box.width) * layout.columns);
  if (row < 0 || row >= layout.rows || column < 0 || column >= layout.columns) return null;
  return layout.neuronAt(row, column);
}

const STEPS: Record<string, [number, number]> = {
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
};

/** The neuron that an arrow key leads to, Home the first one; from none it begins in the middle. */
function nextByKey(key: string, cursor: number | null, layout: Layout): number | null {
  const middle = layout.neuronAt(Math.floor(layout.rows / 2), Math.floor(layout.columns / 2));
  if (key === "Home") return middle;
  const step = STEPS[key];
  if (!step) return null;
  if (cursor === null) return middle;
  const { row, column } = layout.placeOf(cursor);
  const clamp = (value: number, n: number) => Math.min(Math.max(value, 0), n - 1);
  return layout.neuronAt(clamp(row + step[0], layout.rows), clamp(column + step[1], layout.columns));
}
