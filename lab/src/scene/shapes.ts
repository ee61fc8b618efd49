/** Meshes for the engine's solids: the form is made once, the pose is set at each step. */

import {
  BoxGeometry,
  type BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  Matrix4,
  PlaneGeometry,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";

import type { Solid } from "../engine/contract";

type Shape = Solid["shape"];

export interface Pose {
  position: Vector3;
  rotation: Quaternion;
}

const Y = new Vector3(0, 1, 0);

/** What a solid's form depends on: two solids with the same text can share a mesh. */
export function formOf({ part, colour, shape }: Solid): string {
  return [part, ...colour, shape.kind, ...sizes(shape).map((size) => size.toFixed(4))].join(" ");
}

function sizes(shape: Shape): number[] {
  switch (shape.kind) {
    case "sphere":
      return [shape.radius];
    case "capsule":
    case "cylinder":
      return [shape.radius, length(shape)];
    case "cuboid":
    case "ground":
      return shape.halfExtents;
  }
}

/** Along y where the form has an axis; a ground lies in the plane z = 0. */
export function geometryOf(shape: Shape): BufferGeometry {
  switch (shape.kind) {
    case "sphere":
      return new SphereGeometry(shape.radius, 24, 16);
    case "capsule":
      return new CapsuleGeometry(shape.radius, length(shape), 6, 16);
    case "cylinder":
      return new CylinderGeometry(shape.radius, shape.radius, length(shape), 32);
    case "cuboid": {
      const [x = 0, y = 0, z = 0] = shape.halfExtents;
      return new BoxGeometry(2 * x, 2 * y, 2 * z);
    }
    case "ground": {
      const [x = 0, y = 0] = shape.halfExtents;
      return new PlaneGeometry(2 * x, 2 * y);
    }
  }
}

export function poseOf(shape: Shape): Pose {
  const pose = { position: new Vector3(), rotation: new Quaternion() };
  switch (shape.kind) {
    case "sphere":
      pose.position.fromArray(shape.centre);
      break;
    case "capsule":
    case "cylinder": {
      const [a, b] = [new Vector3().fromArray(shape.a), new Vector3().fromArray(shape.b)];
      pose.position.addVectors(a, b).multiplyScalar(0.5);
      pose.rotation.setFromUnitVectors(Y, b.sub(a).normalize());
      break;
    }
    case "cuboid": {
      pose.position.fromArray(shape.centre);
      const [x = [], y = [], z = []] = shape.rotation;
      const [xx = 1, xy = 0, xz = 0] = x;
      const [yx = 0, yy = 1, yz = 0] = y;
      const [zx = 0, zy = 0, zz = 1] = z;
      pose.rotation.setFromRotationMatrix(
        new Matrix4().set(xx, xy, xz, 0, yx, yy, yz, 0, zx, zy, zz, 0, 0, 0, 0, 1),
      );
      break;
    }
    case "ground":
      pose.position.set(shape.centre[0] ?? 0, shape.centre[1] ?? 0, shape.height);
  }
  return pose;
}

function length({ a, b }: { a: number[]; b: number[] }): number {
  return Math.hypot(...a.map((x, i) => x - (b[i] ?? 0)));
}
