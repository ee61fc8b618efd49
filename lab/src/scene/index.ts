export { createScene, type SceneOptions, type SceneView } from "./view";
