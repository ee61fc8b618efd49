import type { Setup } from "../engine/contract";

const KINDS = { random: "Random", scripted: "Scripted", oracle: "Oracle", approach: "Approach" };

/** What to call an agent of a setup. */
export function agentTitle(setup: Setup, place: number): string {
  const agent = setup.agents[place]!;
  const title = kindTitle(agent);
  if (setup.agents.length === 1) return title;
  return `${place === 0 ? "First" : "Second"} agent (${title})`;
}

function kindTitle(agent: Setup["agents"][number]): string {
  if (agent.kind === "policy") return `policy “${agent.name}”`;
  if (agent.kind !== "hebb") return KINDS[agent.kind];
  return `Hebb ${agent.variant}${agent.rule === null ? "" : ", own rule"}`;
}
