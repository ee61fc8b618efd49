/** The line of sight, and the middle of the eye's field around it. */

import { BufferGeometry, LineBasicMaterial, LineSegments, Vector3 } from "three";

import type { Scene } from "../engine/contract";

/** Length of the pyramid that stands for the eye's field [m]. */
const PYRAMID = 0.025;

/** Lines of one agent's gaze. */
export class GazeLines {
  readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true }));

  show({ gaze, cameraFrame, fieldOfView }: Scene): void {
    const eye = new Vector3().fromArray(gaze.eye);
    const at = new Vector3().fromArray(gaze.at);
    const [right, down] = [0, 1].map((axis) => new Vector3().fromArray(cameraFrame[axis] ?? [0, 0, 0]));
    const points = [eye, at];
    if (right !== undefined && down !== undefined) {
      points.push(...pyramid(eye, at, right, down, Math.tan(fieldOfView / 2)));
    }
    // It always has the same number of points.
    this.lines.geometry.setFromPoints(points);
    this.lines.frustumCulled = false;
  }

  paint(colour: number): void {
    this.lines.material.color.setHex(colour);
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}

/** Ends of the edges of a pyramid with the eye at its top: four at the sides, four at the bottom. */
function pyramid(eye: Vector3, at: Vector3, right: Vector3, down: Vector3, slope: number): Vector3[] {
  const middle = at.clone().sub(eye).setLength(PYRAMID).add(eye);
  const half = PYRAMID * slope;
  const corners = [
    [1, 1],
    [1, -1],
    [-1, -1],
    [-1, 1],
  ].map(([x = 0, y = 0]) =>
    middle
      .clone()
      .addScaledVector(right, x * half)
      .addScaledVector(down, y * half),
  );
  return corners.flatMap((corner, i) => [eye, corner, corner, corners[(i + 1) % 4] ?? corner]);
}
