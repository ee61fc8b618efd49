/** The way of a fingertip: a line, and a dot at each control step, so that dots far apart mean fast. */

import {
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  Points,
  PointsMaterial,
} from "three";

/** Steps that are kept; the longest episode has 500. */
const MOST = 1000;
const DOT = 0.008;

export class Trail {
  readonly group = new Group();
  private numbers: number[] = [];
  private readonly geometry = new BufferGeometry();
  private readonly line = new Line(this.geometry, new LineBasicMaterial());
  private readonly dots = new Points(this.geometry, new PointsMaterial({ size: DOT }));

  constructor() {
    this.group.add(this.line, this.dots);
    // It grows: its bounds would have to be computed at each step.
    this.line.frustumCulled = false;
    this.dots.frustumCulled = false;
  }

  add(point: number[]): void {
    const last = this.numbers.slice(-3);
    if (last.length === 3 && last.every((x, i) => x === point[i])) return;
    this.numbers.push(...point.slice(0, 3));
    if (this.numbers.length > 3 * MOST) this.numbers.splice(0, 3);
    this.geometry.setAttribute("position", new Float32BufferAttribute(this.numbers, 3));
  }

  clear(): void {
    this.numbers = [];
    this.geometry.setAttribute("position", new Float32BufferAttribute([], 3));
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
