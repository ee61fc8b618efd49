/** One agent's solids on the stage. They glide from one control step to the next. */

import {
  Color,
  Group,
  KeepStencilOp,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NotEqualStencilFunc,
  ReplaceStencilOp,
  SRGBColorSpace,
} from "three";

import type { Solid } from "../engine/contract";
import { formOf, geometryOf, type Pose, poseOf } from "./shapes";
import type { Palette } from "./theme";

/** Parts that are the same for all agents: drawn once. */
const SHARED = new Set(["ground", "target", "obstacle", "eye", "goal"]);
/** Parts that cast no shadow. */
const SHADELESS = new Set(["ground", "eye", "goal"]);
/** Where the light comes from: it falls by this much to the side on its way down. */
const SLANT = { x: 0.12, y: 0.18 };
const GHOST_OPACITY = 0.45;
/** The hand shows behind it. */
const OBSTACLE_OPACITY = 0.7;

interface Body {
  mesh: Mesh;
  shadow: Mesh | null;
  from: Pose;
  to: Pose;
  part: string;
  colour: Color; // the engine's
}

export class Actor {
  readonly group = new Group();
  private bodies: Body[] = [];
  private readonly agent: number;
  private palette: Palette;
  private form = "";
  private begun = 0;
  private lasts = 0;
  private ground = 0;

  /** Agent 0 is drawn as the engine paints it; others stand beside it as ghosts in their own colour. */
  constructor(agent: number, palette: Palette) {
    this.agent = agent;
    this.palette = palette;
  }

  /** Poses to glide to within some milliseconds, from `now` on. */
  show(solids: Solid[], now: number, milliseconds: number): void {
    const own = solids.filter(({ part }) => this.agent === 0 || !SHARED.has(part));
    const ground = solids.find(({ shape }) => shape.kind === "ground")?.shape;
    this.ground = ground?.kind === "ground" ? ground.height : 0;
    const form = own.map(formOf).join("|");
    if (form === this.form) {
      own.forEach((solid, i) => {
        const body = this.bodies[i];
        if (body === undefined) return;
        body.from = { position: body.mesh.position.clone(), rotation: body.mesh.quaternion.clone() };
        body.to = poseOf(solid.shape);
      });
      this.lasts = milliseconds;
    } else {
      this.build(own);
      this.form = form;
      this.lasts = 0;
    }
    this.begun = now;
  }

  /** Moves all to where they are at a time [ms]; whether they go on moving. */
  glide(now: number): boolean {
    const share = this.lasts === 0 ? 1 : Math.min(1, (now - this.begun) / this.lasts);
    for (const { mesh, from, to } of this.bodies) {
      mesh.position.lerpVectors(from.position, to.position, share);
      mesh.quaternion.slerpQuaternions(from.rotation, to.rotation, share);
    }
    this.cast();
    return share < 1;
  }

  /** Draws a part elsewhere in the plane until the next step is shown. */
  preview(part: string, x: number, y: number): void {
    for (const body of this.bodies.filter((each) => each.part === part)) {
      for (const pose of [body.from, body.to]) pose.position.set(x, y, pose.position.z);
    }
  }

  paint(palette: Palette): void {
    this.palette = palette;
    for (const { mesh, part, colour, shadow } of this.bodies) {
      const material = mesh.material as MeshLambertMaterial;
      if (part === "ground") material.color.setHex(palette.ground);
      else if (this.agent > 0) material.color.setHex(palette.agents[1]);
      else if (part === "obstacle" && palette.obstacle !== null) material.color.setHex(palette.obstacle);
      else material.color.copy(colour);
      if (shadow) (shadow.material as MeshBasicMaterial).opacity = palette.shadow;
    }
  }

  dispose(): void {
    for (const { mesh, shadow } of this.bodies) {
      mesh.geometry.dispose();
      (mesh.material as MeshLambertMaterial).dispose();
      if (shadow) (shadow.material as MeshBasicMaterial).dispose();
    }
    this.group.clear();
    this.bodies = [];
  }

  private build(solids: Solid[]): void {
    this.dispose();
    this.bodies = solids.map((solid) => {
      const pose = poseOf(solid.shape);
      const mesh = new Mesh(geometryOf(solid.shape), this.material(solid));
      this.group.add(mesh);
      const casts = this.agent === 0 && !SHADELESS.has(solid.part);
      const shadow = casts ? new Mesh(mesh.geometry, shade()) : null;
      if (shadow) {
        shadow.matrixAutoUpdate = false;
        shadow.renderOrder = 1;
        this.group.add(shadow);
      }
      const colour = (mesh.material as MeshLambertMaterial).color.clone();
      return { mesh, shadow, from: pose, to: pose, part: solid.part, colour };
    });
    this.paint(this.palette);
  }

  private material({ colour, part }: Solid): MeshLambertMaterial {
    const [red = 0, green = 0, blue = 0] = colour;
    const material = new MeshLambertMaterial({
      color: new Color().setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace),
    });
    if (this.agent > 0)
      Object.assign(material, { transparent: true, opacity: GHOST_OPACITY, depthWrite: false });
    else if (part === "obstacle") Object.assign(material, { transparent: true, opacity: OBSTACLE_OPACITY });
    return material;
  }

  /** Flattens each body onto the ground along the light. */
  private cast(): void {
    const height = this.ground + 0.0005;
    const { x, y } = SLANT;
    // prettier-ignore
    const flatten = new Matrix4().set(
      1,
      0,
      -x,
      x * height,
      0,
      1,
      -y,
      y * height,
      0,
      0,
      0,
      height,
      0,
      0,
      0,
      1,
    );
    for (const { mesh, shadow } of this.bodies) {
      if (shadow === null) continue;
      mesh.updateMatrix();
      shadow.matrix.multiplyMatrices(flatten, mesh.matrix);
      shadow.matrixWorldNeedsUpdate = true;
    }
  }
}

/** Black, and where shadows overlap no darker than one of them. */
function shade(): MeshBasicMaterial {
  return new MeshBasicMaterial({
    color: 0,
    transparent: true,
    depthWrite: false,
    stencilWrite: true,
    stencilRef: 1,
    stencilFunc: NotEqualStencilFunc,
    stencilFail: KeepStencilOp,
    stencilZFail: KeepStencilOp,
    stencilZPass: ReplaceStencilOp,
  });
}
