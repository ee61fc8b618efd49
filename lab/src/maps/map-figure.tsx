/** A heat map of activities, from zero to the most active neuron. */
import type { MapActivity } from "../engine/contract";
import { HeatMap, type HeatMapProps, strongest } from "./heat-map";

/** Maps whose rows count from the top, as in an image. */
export const FROM_TOP = ["fovea"];

type Rest = Partial<Pick<HeatMapProps, "silenced" | "marked" | "onLook" | "brush">>;

export function MapFigure(props: { title: string; map: MapActivity } & Rest) {
  const high = strongest(props.map.activity)[1] || 1;
  return <HeatMap {...props} fromTop={FROM_TOP.includes(props.map.name)} low={0} high={high} />;
}
