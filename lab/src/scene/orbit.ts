/** A camera that goes around the stage: by mouse, by touch, and by keys. */

import { PerspectiveCamera, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const HOME = new Vector3(0.14, -0.53, 0.86);
const ABOVE = new Vector3(0, -0.0001, 1.15);
const MIDDLE = new Vector3();
const FIELD_DEG = 40;
/** One key press turns this far [rad], or comes nearer by this factor. */
const TURN = Math.PI / 36;
const STEP = 1.1;

export class Orbit {
  readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.02, 10);
  private readonly canvas: HTMLCanvasElement;
  private readonly controls: OrbitControls;

  constructor(canvas: HTMLCanvasElement, onChange: () => void) {
    this.canvas = canvas;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { minDistance: 0.15, maxDistance: 2.5, maxPolarAngle: 0.49 * Math.PI });
    // A finger that moves up or down scrolls the page.
    canvas.style.touchAction = "pan-y";
    this.home();
    this.controls.addEventListener("change", onChange);
    canvas.addEventListener("keydown", this.onKey);
  }

  /** The view from behind the robot's right shoulder. */
  home(): void {
    this.look(HOME);
  }

  /** The view from above, in which nothing hides what is in the plane. */
  above(): void {
    this.look(ABOVE);
  }

  /** Whether dragging turns the camera; not while something else is dragged. */
  enable(enabled: boolean): void {
    this.controls.enabled = enabled;
  }

  /** Fits the picture into a frame [px]; a narrow one sees the whole width of the stage, too. */
  resize(width: number, height: number): void {
    const aspect = width / height;
    this.camera.aspect = aspect;
    const half = Math.tan((FIELD_DEG * Math.PI) / 360) * Math.max(1, 1.1 / aspect);
    this.camera.fov = (Math.atan(half) * 360) / Math.PI;
    this.camera.updateProjectionMatrix();
  }

  dispose(): void {
    this.canvas.removeEventListener("keydown", this.onKey);
    this.controls.dispose();
  }

  private look(from: Vector3): void {
    this.camera.position.copy(from);
    this.controls.target.copy(MIDDLE);
    this.controls.update();
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-TURN, 0],
      ArrowRight: [TURN, 0],
      ArrowUp: [0, -TURN],
      ArrowDown: [0, TURN],
    };
    const turn = turns[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (turn !== undefined) this.turn(...turn);
    else if (event.key === "+" || event.key === "=") this.approach(1 / STEP);
    else if (event.key === "-") this.approach(STEP);
    else if (event.key === "Home") this.home();
    else return;
    event.preventDefault();
  };

  private turn(around: number, down: number): void {
    this.move((from) => {
      from.theta += around;
      from.phi = Math.min(this.controls.maxPolarAngle, Math.max(0.001, from.phi + down));
    });
  }

  private approach(factor: number): void {
    const { minDistance, maxDistance } = this.controls;
    this.move((from) => {
      from.radius = Math.min(maxDistance, Math.max(minDistance, from.radius * factor));
    });
  }

  /** Changes the camera's place around what it looks at; three.js counts its angles from y up. */
  private move(change: (from: Spherical) => void): void {
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    const from = new Spherical().setFromCartesianCoords(offset.y, offset.z, offset.x);
    change(from);
    const { x, y, z } = new Vector3().setFromSpherical(from);
    this.camera.position.set(z, x, y).add(target);
    this.controls.update();
  }
}
