/** One association: its input map, the weights of a neuron, and its output map. */
import { useEffect, useState } from "preact/hooks";
import type { Brain, MapActivity } from "../engine/contract";
import { WEIGHTS } from "../maps/colours";
import { HeatMap, strongest } from "../maps/heat-map";
import { FROM_TOP, MapFigure } from "../maps/map-figure";
import { plain } from "../session/playing";
import type { Session } from "../session/session";

type Association = Brain["associations"][number];
type Side = "input" | "output";

export function AssociationView(props: {
  session: Session;
  association: Association;
  at: number;
  /** Radius of the lesion brush, null without it. */
  brush: number | null;
}) {
  const { session, association, at, brush } = props;
  const { input, output } = association;
  const [looked, setLooked] = useState<{ side: Side; neuron: number } | null>(null);
  const { side, neuron } = looked ?? usual(association);
  const weights = useWeights(session, at, side, neuron, association);
  const on = (map: Side) => ({
    onLook: (found: number | null) => setLooked(found === null ? null : { side: map, neuron: found }),
    brush: brush === null ? null : { radius: brush, onPaint: (neurons: number[]) => lesion(map, neurons) },
    marked: looked === null && side === map ? neuron : null,
  });
  const lesion = (map: Side, neurons: number[]) =>
    session.attempt(async () => {
      const agent = session.shownAgent.value;
      await session.apply({ do: "lesion", agent, map, association: at, neurons });
      const { silenced } = session.state.value.agents[agent]!;
      session.said.value = `${neurons.length} neurons of “${plain(association[map].name)}” silenced; ${silenced} in all.`;
    });
  const bound = weights?.activity.reduce((most, weight) => Math.max(most, Math.abs(weight)), 0) || 1;
  return (
    <div class="association">
      <MapFigure
        title={`Input “${plain(input.name)}”`}
        map={input}
        silenced={association.silencedInputs}
        {...on("input")}
      />
      {weights && (
        <HeatMap
          title={`Weights ${side === "input" ? "from" : "to"} ${looked ? "that neuron" : "the ringed neuron"}`}
          map={weights}
          fromTop={side === "output" && FROM_TOP.includes(input.name)}
          low={-bound}
          high={bound}
          colours={WEIGHTS}
        />
      )}
      <MapFigure
        title={`Output “${plain(output.name)}”`}
        map={output}
        silenced={association.silencedOutputs}
        {...on("output")}
      />
    </div>
  );
}

/**
 * The neuron whose weights are shown if none is looked at: the most active input, as in the paper's Fig. 5. Of the
 * fovea, where many are equally active, the most active output, as in Fig. 8.
 */
function usual({ input, output }: Association): { side: Side; neuron: number } {
  const side = FROM_TOP.includes(input.name) ? "output" : "input";
  return { side, neuron: strongest((side === "input" ? input : output).activity)[0] };
}

/** Asks the engine for the weights again when the neuron or the brain changes. */
function useWeights(
  session: Session,
  at: number,
  side: Side,
  neuron: number,
  association: Association,
): MapActivity | null {
  const [weights, setWeights] = useState<MapActivity | null>(null);
  const agent = session.shownAgent.value;
  useEffect(() => {
    let current = true;
    void session.attempt(async () => {
      const found = await session.engine.weights(agent, at, side, neuron);
      if (current) setWeights(found);
    });
    return () => {
      current = false;
    };
  }, [session, agent, at, side, neuron, association]);
  return weights;
}
