/** What the eye sees, and the map that it becomes. */
import type { Sight } from "../engine/contract";
import { strongest } from "../maps/heat-map";
import { MapFigure } from "../maps/map-figure";
import { plain } from "../session/playing";
import type { Session } from "../session/session";

import { Picture } from "./picture";

/** Share of the image's edge that the fovea has: 63 of 630 pixels. */
const FOVEA = 0.1;

export function EyeView({ session }: { session: Session }) {
  const { sight, pictures, brain } = session.shown.value;
  if (!sight) return null;
  const seen = sight.centroid ? place(sight.centroid) : "no red in view";
  const input = brain?.associations[0];
  return (
    <div class="figures">
      {session.watched.value && (
        <p class="caption whole">These show the case on the stage, not the babble.</p>
      )}
      <Picture
        pixels={pictures.eye}
        mark={sight.centroid}
        square={FOVEA}
        name={`What the eye sees: ${seen}`}
        caption={
          <>
            The eye’s image. Cross: centroid of the red pixels, which the reflex (Eq. 1) brings to the middle.
            Square: the fovea. Now: {seen}. {angles(sight)}
          </>
        }
      />
      {pictures.fovea && (
        <Picture
          pixels={pictures.fovea}
          name="The fovea, the middle of the image"
          caption="The fovea: the middle tenth of the image."
        />
      )}
      {pictures.edges && (
        <Picture
          pixels={pictures.edges}
          name="Edges in the fovea"
          caption="Edges in the fovea, found by Sobel filters: where brightness changes."
        />
      )}
      {input && (
        <div>
          <MapFigure title={`Input map “${plain(input.input.name)}”`} map={input.input} />
          <p class="caption">
            The map that it becomes (Eq. 3): each neuron is active if what is seen is near its own value.
            Strongest neuron: {strongest(input.input.activity)[1].toFixed(2)}.
          </p>
        </div>
      )}
    </div>
  );
}

function angles({ pan, tilt }: Sight): string {
  return `The eye looks ${turn(pan, "right", "left")} and ${turn(tilt, "up", "down")}.`;
}

function turn(angle: number, positive: string, negative: string): string {
  const degrees = Math.round((Math.abs(angle) * 180) / Math.PI);
  return `${degrees}° ${angle >= 0 ? positive : negative}`;
}

function place([x, y]: number[]): string {
  const share = (value: number) => `${Math.round(100 * Math.abs(value))} %`;
  return `red is ${share(x!)} ${x! >= 0 ? "right" : "left"} and ${share(y!)} ${y! >= 0 ? "below" : "above"} the middle`;
}
