/** The way of a fingertip: a line, and a dot at each step shown, so that dots far apart mean fast. */

import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  Group,
  Line,
  LineBasicMaterial,
  Points,
  PointsMaterial,
} from "three";

/** Points that are kept; the longest episode has 500 steps. */
const MOST = 600;
const DOT = 0.008;

export class Trail {
  readonly group = new Group();
  private readonly points = new BufferAttribute(new Float32Array(3 * MOST), 3).setUsage(DynamicDrawUsage);
  private readonly geometry = new BufferGeometry().setAttribute("position", this.points);
  private readonly line = new Line(this.geometry, new LineBasicMaterial());
  private readonly dots = new Points(this.geometry, new PointsMaterial({ size: DOT }));
  private length = 0;

  constructor() {
    this.group.add(this.line, this.dots);
    // It grows: its bounds would have to be computed at each step.
    this.line.frustumCulled = false;
    this.dots.frustumCulled = false;
    this.clear();
  }

  add([x = 0, y = 0, z = 0]: number[]): void {
    const { array } = this.points;
    if (this.length === MOST) {
      array.copyWithin(0, 3);
      this.length -= 1;
    }
    this.points.setXYZ(this.length, x, y, z);
    this.points.needsUpdate = true;
    this.length += 1;
    this.geometry.setDrawRange(0, this.length);
  }

  clear(): void {
    this.length = 0;
    this.geometry.setDrawRange(0, 0);
  }

  paint(colour: number): void {
    this.line.material.color.setHex(colour);
    this.dots.material.color.setHex(colour);
  }

  dispose(): void {
    this.geometry.dispose();
    this.line.material.dispose();
    this.dots.material.dispose();
  }
}
