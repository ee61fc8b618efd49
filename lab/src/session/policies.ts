/** Policies trained elsewhere that come with the page, one for each task. */
import type { Engine, Setup } from "../engine/contract";

/** Names of the shipped policies: those of the tasks. */
export const SHIPPED = ["reach", "grasp"];

const added = new WeakMap<Engine, Set<string>>();

/** Gives the engine the shipped policies that a setup names, once. */
export async function addShippedPolicies(engine: Engine, setup: Setup): Promise<void> {
  const known = added.get(engine) ?? new Set<string>();
  added.set(engine, known);
  for (const agent of setup.agents) {
    if (agent.kind !== "policy" || !SHIPPED.includes(agent.name) || known.has(agent.name)) continue;
    const response = await fetch(`policies/${agent.name}.safetensors`);
    if (!response.ok)
      throw new Error(`the policy “${agent.name}” cannot be loaded: status ${response.status}`);
    await engine.addPolicy(agent.name, new Uint8Array(await response.arrayBuffer()));
    known.add(agent.name);
  }
}
