/** Who acts: one agent, or two side by side on the same case. */
import type { AgentSetup, Setup } from "../engine/contract";
import { SHIPPED } from "../session/policies";
import type { Session } from "../session/session";
import { Group } from "./group";

const OTHERS: [string, AgentSetup][] = [
  ["random movements", { kind: "random" }],
  ["scripted: written by hand, as a reference", { kind: "scripted" }],
  ["oracle: knows the world, as a reference", { kind: "oracle" }],
];

/** In grasping alone. */
const APPROACH: [string, AgentSetup] = [
  "approach: bends the elbow until the palm touches",
  { kind: "approach" },
];

export function AgentControls({ session }: { session: Session }) {
  const { setup } = session.state.value;
  return (
    <Group session={session} controls={["agents"]} title="Agents">
      <AgentSelect session={session} setup={setup} place={0} />
      <AgentSelect session={session} setup={setup} place={1} />
    </Group>
  );
}

function AgentSelect({ session, setup, place }: { session: Session; setup: Setup; place: number }) {
  const choices = choicesFor(session);
  const agent = setup.agents[place] ?? null;
  const current = agent === null ? "" : keyOf(agent);
  const label = place === 0 ? "First agent" : "Second agent, beside it";
  const known = current === "" || choices.some(([key]) => key === current);
  return (
    <div class="row">
      <label>
        {label}{" "}
        <select
          value={current}
          onChange={(event) => {
            const chosen = choices.find(([key]) => key === event.currentTarget.value)?.[2] ?? null;
            void session.attempt(() => session.change(withAgent(setup, place, chosen)));
          }}
        >
          {place === 1 && <option value="">none</option>}
          {choices.map(([key, title]) => (
            <option key={key} value={key}>
              {title}
            </option>
          ))}
          {!known && <option value={current}>{current}</option>}
        </select>
      </label>
      <label class="file">
        Policy from a file
        <input
          type="file"
          accept=".safetensors"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file) void session.attempt(() => usePolicy(session, place, file));
          }}
        />
      </label>
    </div>
  );
}

type Choice = [key: string, title: string, agent: AgentSetup];

function choicesFor(session: Session): Choice[] {
  const task = session.task.value;
  const variants = session.registry.variants[task] ?? [];
  const hebb = variants.map((variant): Choice => {
    const agent: AgentSetup = { kind: "hebb", variant, brain: {}, rule: null };
    return [keyOf(agent), `Hebb babbling, variant “${variant}”`, agent];
  });
  const all = task === "grasp" ? [...OTHERS, APPROACH] : OTHERS;
  const others = all.map(([title, agent]): Choice => [keyOf(agent), title, agent]);
  if (!SHIPPED.includes(task)) return [...hebb, ...others];
  const policy: AgentSetup = { kind: "policy", name: task };
  return [...hebb, [keyOf(policy), "PPO, trained before", policy], ...others];
}

function keyOf(agent: AgentSetup): string {
  if (agent.kind === "hebb") return `hebb ${agent.variant}`;
  return agent.kind === "policy" ? `policy ${agent.name}` : agent.kind;
}

function withAgent(setup: Setup, place: number, agent: AgentSetup | null): Setup {
  const agents = [...setup.agents];
  if (agent === null) agents.splice(place, 1);
  else agents[place] = agent;
  return { ...setup, agents };
}

async function usePolicy(session: Session, place: number, file: File): Promise<void> {
  const name = file.name.replace(/\.safetensors$/, "");
  await session.engine.addPolicy(name, new Uint8Array(await file.arrayBuffer()));
  await session.change(withAgent(session.state.value.setup, place, { kind: "policy", name }));
}
