/** Colour maps that people with any colour vision can read, as 256 steps of red, green, blue. */

/** Of activities: viridis (van der Walt and Smith), from dark to bright. */
const VIRIDIS = ["440154", "482878", "3e4a89", "31688e", "26838f", "1f9d8a", "6cce5a", "b6de2b", "fee825"];
/** Of weights: blue, white, red (Brewer's RdBu), zero in the middle. */
const RED_BLUE = ["053061", "2166ac", "4393c3", "92c5de", "f7f7f7", "f4a582", "d6604d", "b2182b", "67001f"];

export type Colour = readonly [number, number, number];
export type ColourTable = readonly Colour[];

export const ACTIVITY: ColourTable = table(VIRIDIS);
export const WEIGHTS: ColourTable = table(RED_BLUE);

/** The colour of a value between low and high; a value that is no number has the colour of low. */
export function colourOf(value: number, low: number, high: number, colours: ColourTable): Colour {
  const share = high > low ? (value - low) / (high - low) : 0;
  const at = Math.round(255 * Math.min(1, Math.max(0, share || 0)));
  return colours[at]!;
}

/** As a CSS gradient from left to right. */
export function gradient(colours: ColourTable): string {
  const stops = [0, 32, 64, 96, 128, 160, 192, 224, 255].map((at) => `rgb(${colours[at]!.join(" ")})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function table(knots: string[]): ColourTable {
  const points = knots.map((knot) => [0, 2, 4].map((at) => Number.parseInt(knot.slice(at, at + 2), 16)));
  return Array.from({ length: 256 }, (_, step) => {
    const place = (step / 255) * (points.length - 1);
    const from = Math.min(Math.floor(place), points.length - 2);
    const mix = (channel: number) =>
      Math.round(
        points[from]![channel]! + (place - from) * (points[from + 1]![channel]! - points[from]![channel]!),
      );
    return [mix(0), mix(1), mix(2)] as const;
  });
}
