/** Handles over the stage: a button for each part of a case that can be put elsewhere, by mouse, touch or keys. */

import { type PerspectiveCamera, Plane, Raycaster, Vector2, Vector3 } from "three";

import { centimetres } from "./describe";
import type { Point } from "./placing";

/** One press of an arrow key moves by this much, with the shift key by five times as much [m]. */
const STEP = 0.01;
/** Shorter ways of the pointer are a click [px]. */
const SLIP = 3;

/** What a handle tells of itself. */
export interface HandleEvents {
  /** While it is dragged: where it would be. */
  preview(part: string, to: Point): void;
  /** It was let go; resolves to whether it may stay there. */
  place(part: string, to: Point): Promise<boolean>;
  /** The user takes the part away. */
  remove(part: string): void;
  /** What a person should be told. */
  say(text: string): void;
  /** Whether something is being dragged, so that the camera must rest. */
  hold(held: boolean): void;
}

export class Handle {
  readonly part: string;
  readonly button = document.createElement("button");
  private readonly label: string;
  private readonly camera: PerspectiveCamera;
  private readonly events: HandleEvents;
  private shown: Point = [0, 0];
  /** Where it was before it was moved; none while it stands. */
  private before: Point | null = null;
  private grip: { offset: Point; x: number; y: number } | null = null;

  constructor(
    part: string,
    label: string,
    camera: PerspectiveCamera,
    events: HandleEvents,
    removable: boolean,
  ) {
    this.part = part;
    this.label = label;
    this.camera = camera;
    this.events = events;
    const { button } = this;
    button.type = "button";
    button.className = "scene-handle";
    button.dataset.part = part;
    const keys = "arrow keys move it, Enter sets it, Escape puts it back";
    button.title = `${label}: drag it, or ${keys}${removable ? ", Delete takes it away" : ""}`;
    button.setAttribute("aria-roledescription", "handle");
    button.addEventListener("pointerdown", this.onDown);
    button.addEventListener("pointermove", this.onMove);
    button.addEventListener("pointerup", this.onUp);
    button.addEventListener("pointercancel", this.onCancel);
    button.addEventListener("keydown", (event) => this.onKey(event, removable));
    button.addEventListener("blur", () => this.grip ?? this.set());
  }

  /** Where its part stands; a handle that is being moved stays with the user. */
  stand(at: Point): void {
    if (this.before === null) this.go(at);
  }

  /** Places the button over its part. */
  project(width: number, height: number): void {
    const { x, y } = new Vector3(...this.shown, 0).project(this.camera);
    // Beside the picture a handle waits at its edge.
    const inside = (at: number, edge: number) => Math.min(edge, Math.max(0, at * edge));
    const [left, top] = [inside(0.5 + 0.5 * x, width), inside(0.5 - 0.5 * y, height)];
    this.button.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
  }

  private go(to: Point): void {
    this.shown = to;
    this.button.setAttribute("aria-label", this.told());
  }

  /** "Target, 12 cm right, 25 cm ahead of the shoulder". */
  private told(): string {
    const [x, y] = this.shown;
    const right = `${centimetres(x)} ${x < 0 ? "left" : "right"}`;
    const ahead = `${centimetres(y)} ${y < 0 ? "behind" : "ahead of"} the shoulder`;
    return `${this.label}, ${right}, ${ahead}`;
  }

  private move(to: Point): void {
    this.before ??= this.shown;
    this.go(to);
    this.events.preview(this.part, to);
  }

  private step(to: Point): void {
    this.move(to);
    this.events.say(`${this.told()}.`);
  }

  private back(): void {
    if (this.before !== null) this.return(this.before);
  }

  private return(to: Point): void {
    this.before = null;
    this.go(to);
    this.events.preview(this.part, to);
  }

  private set(): void {
    const { before, shown } = this;
    if (before === null) return;
    this.before = null;
    void this.events.place(this.part, shown).then((stays) => stays || this.return(before));
  }

  private readonly onDown = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    const at = this.under(event);
    if (at === null) return;
    this.button.setPointerCapture(event.pointerId);
    this.grip = {
      offset: [this.shown[0] - at[0], this.shown[1] - at[1]],
      x: event.clientX,
      y: event.clientY,
    };
    this.events.hold(true);
  };

  private readonly onMove = (event: PointerEvent): void => {
    if (this.grip === null) return;
    const slip = Math.hypot(event.clientX - this.grip.x, event.clientY - this.grip.y) < SLIP;
    const at = this.under(event);
    if (at === null || (slip && this.before === null)) return;
    this.move([at[0] + this.grip.offset[0], at[1] + this.grip.offset[1]]);
  };

  private readonly onUp = (): void => {
    this.release();
    this.set();
  };

  private readonly onCancel = (): void => {
    this.release();
    this.back();
  };

  private release(): void {
    this.grip = null;
    this.events.hold(false);
  }

  private onKey(event: KeyboardEvent, removable: boolean): void {
    const far = event.shiftKey ? 5 * STEP : STEP;
    const [x, y] = this.shown;
    const places: Record<string, Point> = {
      ArrowLeft: [x - far, y],
      ArrowRight: [x + far, y],
      ArrowUp: [x, y + far],
      ArrowDown: [x, y - far],
    };
    const to = places[event.key];
    if (to !== undefined) this.step(to);
    else if (event.key === "Enter") this.set();
    else if (event.key === "Escape") this.back();
    else if (event.key === "Delete" && removable) this.events.remove(this.part);
    else return;
    event.preventDefault();
  }

  /** The point of the arm's plane under the pointer; none beside the plane. */
  private under(event: PointerEvent): Point | null {
    const frame = this.button.parentElement?.getBoundingClientRect();
    if (frame === undefined) return null;
    const x = (2 * (event.clientX - frame.left)) / frame.width - 1;
    const y = 1 - (2 * (event.clientY - frame.top)) / frame.height;
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(x, y), this.camera);
    const hit = caster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1)), new Vector3());
    return hit === null ? null : [hit.x, hit.y];
  }
}
