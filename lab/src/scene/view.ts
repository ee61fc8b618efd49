/** The scene: the robot and its world in three dimensions, drawn when something has changed. */

import {
  BufferGeometry,
  DirectionalLight,
  GridHelper,
  Group,
  HemisphereLight,
  Line,
  LineBasicMaterial,
  Scene as Stage,
  Vector3,
  WebGLRenderer,
} from "three";

import type { Case, EpisodeState, Scene } from "../engine/contract";
import { Actor } from "./actor";
import { whatIsSeen } from "./describe";
import { GazeLines } from "./gaze";
import { Handle } from "./handles";
import { Orbit } from "./orbit";
import {
  type Arm,
  armOf,
  draggable,
  moved,
  type Parts,
  type Point,
  placeOf,
  postureAt,
  startIsPosture,
} from "./placing";
import { PALETTES, type Theme } from "./theme";
import { Trail } from "./trail";

import "./scene.css";

/** More pixels than this for each pixel of the page cost more than they show. */
const MOST_DENSE = 2;
const CELL = 0.1;

export interface SceneOptions {
  /** Parts of the task's cases. */
  parts: Parts;
  theme: Theme;
  /** Poses jump from step to step. */
  reducedMotion: boolean;
}

export interface SceneView {
  /** The worlds of the agents after a control step, and the real time until the next one [s]. */
  show(scenes: Scene[], seconds: number): void;
  /** The case on the stage, and whether its parts can be dragged. */
  setCase(given: Case, draggable: boolean): void;
  /** Called with the case that a person has made by dragging; if the promise rejects, the part goes back. */
  onDrag(callback: (next: Case) => Promise<void>): void;
  /** Called with what a person should be told. */
  onSay(callback: (text: string) => void): void;
  clearTrails(): void;
  setTheme(theme: Theme): void;
  /** The camera's first place, or the view from above. */
  look(from: "home" | "above"): void;
  /** What is to be seen, in words. */
  describe(episode: EpisodeState | null): string;
  dispose(): void;
}

/** Draws into a container, whose size the picture follows. */
export function createScene(container: HTMLElement, options: SceneOptions): SceneView {
  return new View(container, options);
}

/** What is drawn of one agent. */
interface Player {
  actor: Actor;
  trail: Trail;
  gaze: GazeLines;
}

let views = 0;

class View implements SceneView {
  private readonly options: SceneOptions;
  private readonly stage = new Stage();
  private readonly frame = document.createElement("div");
  private readonly text = document.createElement("p");
  private readonly renderer = new WebGLRenderer({ antialias: true, alpha: true, stencil: true });
  private readonly orbit: Orbit;
  private readonly players: Player[] = [];
  private readonly grid = new Group();
  private readonly armLine = new Line(new BufferGeometry(), new LineBasicMaterial({ depthTest: false }));
  private readonly observer = new ResizeObserver(() => this.resize());
  private handles: Handle[] = [];
  private scenes: Scene[] = [];
  private given: Case = {};
  private arm: Arm | null = null;
  private theme: Theme;
  private pending = 0;
  /** Whether the shaders are being compiled, or done: until then nothing is drawn. */
  private shaders: "none" | "compiling" | "ready" = "none";
  private drag: (next: Case) => Promise<void> = () => Promise.resolve();
  private say: (text: string) => void = () => undefined;

  constructor(container: HTMLElement, options: SceneOptions) {
    this.options = options;
    this.theme = options.theme;
    const canvas = this.renderer.domElement;
    this.orbit = new Orbit(canvas, () => this.draw());
    this.frame.className = "scene";
    this.name(canvas);
    this.frame.append(canvas, this.text);
    container.append(this.frame);
    this.armLine.visible = false;
    this.armLine.frustumCulled = false;
    this.stage.add(new HemisphereLight(0xffffff, 0x8a8f99, 2), sun(), this.grid, this.armLine);
    this.renderer.debug.checkShaderErrors = false; // It would wait for each of them.
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.observer.observe(this.frame);
    this.resize();
  }

  show(scenes: Scene[], seconds: number): void {
    const now = performance.now();
    const glides = this.options.reducedMotion ? 0 : 1000 * seconds;
    this.scenes = scenes;
    for (const [agent, scene] of scenes.entries()) {
      const { actor, trail, gaze } = this.player(agent);
      actor.show(scene.solids, now, glides);
      trail.add(scene.fingertip);
      gaze.show(scene);
    }
    for (const [agent, { actor, gaze }] of this.players.entries()) {
      actor.group.visible = agent < scenes.length;
      gaze.lines.visible = looksElsewhere(scenes, agent);
    }
    this.armLine.visible = false;
    this.text.textContent = whatIsSeen(scenes, null);
    const [first] = scenes;
    if (first !== undefined) {
      this.arm = armOf(first, startIsPosture(this.options.parts) ? "palm" : "fingertip");
      this.lay(first);
    }
    this.standHandles();
    this.compile();
    this.draw();
  }

  /** Compiles the shaders of what is shown first beside other work. */
  private compile(): void {
    if (this.shaders !== "none") return;
    this.shaders = "compiling";
    const ready = () => {
      this.shaders = "ready";
      this.draw();
    };
    this.renderer.compileAsync(this.stage, this.orbit.camera).then(ready, ready);
  }

  setCase(given: Case, canDrag: boolean): void {
    if (JSON.stringify(given) !== JSON.stringify(this.given)) this.clearTrails();
    this.given = given;
    const places = canDrag
      ? draggable(this.options.parts).filter(
          ({ part }) => placeOf(part, given, this.options.parts, this.arm) !== null,
        )
      : [];
    const same =
      places.length === this.handles.length && places.every(({ part }, i) => this.handles[i]?.part === part);
    if (!same) this.makeHandles(places);
    this.standHandles();
    this.draw();
  }

  onDrag(callback: (next: Case) => Promise<void>): void {
    this.drag = callback;
  }

  onSay(callback: (text: string) => void): void {
    this.say = callback;
  }

  clearTrails(): void {
    for (const { trail } of this.players) trail.clear();
    this.draw();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const palette = PALETTES[theme];
    for (const [agent, { actor, trail, gaze }] of this.players.entries()) {
      actor.paint(palette);
      trail.paint(palette.agents[agent] ?? palette.agents[0]);
      gaze.paint(agent === 0 ? palette.line : palette.agents[1]);
    }
    this.armLine.material.color.setHex(palette.agents[0]);
    this.grid.clear();
    if (this.scenes[0] !== undefined) this.lay(this.scenes[0]);
    this.draw();
  }

  look(from: "home" | "above"): void {
    this.orbit[from]();
    this.draw();
  }

  describe(episode: EpisodeState | null): string {
    return whatIsSeen(this.scenes, episode);
  }

  dispose(): void {
    cancelAnimationFrame(this.pending);
    this.observer.disconnect();
    this.orbit.dispose();
    for (const player of this.players) for (const part of Object.values(player)) part.dispose();
    this.armLine.geometry.dispose();
    this.armLine.material.dispose();
    this.renderer.dispose();
    // A browser has few contexts, and takes long to notice that one is free.
    this.renderer.forceContextLoss();
    this.frame.remove();
  }

  private name(canvas: HTMLCanvasElement): void {
    this.text.id = `scene-text-${++views}`;
    this.text.className = "scene-text";
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute(
      "aria-label",
      "The robot and its world. Arrow keys turn the view, plus and minus come nearer and go back, Home resets it.",
    );
    canvas.setAttribute("aria-describedby", this.text.id);
  }

  private player(agent: number): Player {
    const found = this.players[agent];
    if (found !== undefined) return found;
    const actor = new Actor(agent, PALETTES[this.theme]);
    const made = { actor, trail: new Trail(), gaze: new GazeLines() };
    this.players[agent] = made;
    this.stage.add(actor.group, made.trail.group, made.gaze.lines);
    this.setTheme(this.theme);
    return made;
  }

  /** Lays lines on the ground, 10 cm apart. */
  private lay(scene: Scene): void {
    if (this.grid.children.length > 0) return;
    const ground = scene.solids.find(({ shape }) => shape.kind === "ground")?.shape;
    if (ground?.kind !== "ground") return;
    const edge = 2 * (ground.halfExtents[0] ?? 0.5);
    const colour = PALETTES[this.theme].grid;
    const lines = new GridHelper(edge, Math.round(edge / CELL), colour, colour);
    lines.rotation.x = Math.PI / 2;
    lines.position.set(ground.centre[0] ?? 0, ground.centre[1] ?? 0, ground.height + 0.0002);
    this.grid.add(lines);
  }

  private makeHandles(places: { part: string; label: string }[]): void {
    for (const { button } of this.handles) button.remove();
    this.handles = places.map(
      ({ part, label }) =>
        new Handle(part, label, this.orbit.camera, this.handleEvents(), part === "obstacle"),
    );
    this.frame.append(...this.handles.map(({ button }) => button));
  }

  private standHandles(): void {
    for (const handle of this.handles) {
      const at = placeOf(handle.part, this.given, this.options.parts, this.arm);
      if (at !== null) handle.stand(at);
    }
    this.projectHandles();
  }

  private projectHandles(): void {
    this.orbit.camera.updateMatrixWorld();
    const { clientWidth: width, clientHeight: height } = this.frame;
    for (const handle of this.handles) handle.project(width, height);
  }

  private handleEvents() {
    return {
      say: (text: string) => this.say(text),
      hold: (held: boolean) => this.orbit.enable(!held),
      remove: (part: string) => void this.ask({ ...this.given, [part]: null }),
      preview: (part: string, to: Point) => this.preview(part, to),
      place: (part: string, to: Point) => {
        const next = moved(part, to, this.given, this.options.parts, this.arm);
        if (typeof next !== "string") return this.ask(next);
        this.say(next);
        return Promise.resolve(false);
      },
    };
  }

  /** Asks for a case; whether it can be played. */
  private async ask(next: Case): Promise<boolean> {
    try {
      await this.drag(next);
      return true;
    } catch (error) {
      this.say(error instanceof Error ? error.message : String(error));
      return false;
    }
  }

  /** Draws a part where it would be; the arm as a line to where its hand would be. */
  private preview(part: string, to: Point): void {
    if (part === "start" && this.arm !== null) {
      const { shoulder, upper } = this.arm;
      const posture = postureAt(this.arm, to);
      const turned = posture?.[0] ?? 0;
      const elbow = [shoulder[0] + upper * Math.cos(turned), shoulder[1] + upper * Math.sin(turned)];
      const points = [shoulder, posture === null ? shoulder : elbow, to];
      this.armLine.geometry.setFromPoints(points.map(([x = 0, y = 0]) => new Vector3(x, y)));
      this.armLine.visible = true;
    } else {
      this.players[0]?.actor.preview(part, ...to);
    }
    this.draw();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.frame;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(MOST_DENSE, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.orbit.resize(width, height);
    this.draw();
  }

  /** Draws at the next frame, and goes on while something glides. */
  private draw(): void {
    if (this.pending !== 0 || this.shaders !== "ready") return;
    this.pending = requestAnimationFrame((now) => {
      this.pending = 0;
      const gliding = this.players.map(({ actor }) => actor.glide(now)).includes(true);
      this.projectHandles();
      this.renderer.render(this.stage, this.orbit.camera);
      if (gliding) this.draw();
    });
  }
}

/** Whether an agent's gaze is to be drawn: it is on the stage, and no other agent looks at the same place. */
function looksElsewhere(scenes: Scene[], agent: number): boolean {
  const own = scenes[agent]?.gaze.at;
  const same = (other: Scene) => other.gaze.at.every((x, i) => x === own?.[i]);
  return own !== undefined && !scenes.slice(0, agent).some(same);
}

function sun(): DirectionalLight {
  const light = new DirectionalLight(0xffffff, 1.6);
  light.position.set(0.24, -0.36, 2);
  return light;
}
