/** Success on the test cases against the babbles learnt from, of each agent. */
import type { State } from "../engine/contract";
import { percent } from "../session/babbling";
import { agentTitle } from "./agent-title";

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT] = [360, 220, 44, 36, 10, 14];

interface Point {
  learnt: number;
  success: number;
}

export function LearningCurve({ state }: { state: State }) {
  const { setup } = state;
  const lines = setup.agents.map((_, agent) => pointsOf(state, agent));
  const most = Math.max(1, ...lines.flat().map(({ learnt }) => learnt));
  const x = (learnt: number) => LEFT + (learnt / most) * (WIDTH - LEFT - RIGHT);
  const y = (success: number) => TOP + (1 - success) * (HEIGHT - TOP - BOTTOM);
  const text = lines.map((line, agent) => lineText(state, agent, line)).join(" ");
  return (
    <figure class="curve">
      <figcaption>Learning curve</figcaption>
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={`Learning curve. ${text}`}>
        {[0, 0.25, 0.5, 0.75, 1].map((success) => (
          <g key={success}>
            <line class="grid" x1={LEFT} x2={WIDTH - RIGHT} y1={y(success)} y2={y(success)} />
            <text x={LEFT - 6} y={y(success) + 4} text-anchor="end">
              {percent(success)}
            </text>
          </g>
        ))}
        {[0, most].map((learnt) => (
          <text key={learnt} x={x(learnt)} y={HEIGHT - 18} text-anchor={learnt === 0 ? "start" : "end"}>
            {learnt.toLocaleString("en")}
          </text>
        ))}
        <text x={(LEFT + WIDTH) / 2} y={HEIGHT - 3} text-anchor="middle">
          babbles learnt from
        </text>
        {lines.map((line, agent) => (
          <g key={agent} class={`agent${agent + 1}`}>
            <polyline points={line.map((point) => `${x(point.learnt)},${y(point.success)}`).join(" ")} />
            {line.map((point, at) =>
              agent === 0 ? (
                <circle key={at} cx={x(point.learnt)} cy={y(point.success)} r={4} />
              ) : (
                <rect key={at} x={x(point.learnt) - 4} y={y(point.success) - 4} width={8} height={8} />
              ),
            )}
          </g>
        ))}
      </svg>
      <ul class="key">
        {lines.map((line, agent) => (
          <li key={agent} class={`agent${agent + 1}`}>
            {lineText(state, agent, line)}
          </li>
        ))}
      </ul>
    </figure>
  );
}

/** An agent that does not learn is drawn where the other one is. */
function pointsOf({ curve, agents }: State, agent: number): Point[] {
  const { learns } = agents[agent]!;
  return curve
    .filter((point) => point.successes.length > agent)
    .map((point) => ({
      learnt: learns ? point.learnt[agent]! : Math.max(...point.learnt),
      success: point.successes[agent]! / point.cases,
    }));
}

function lineText({ setup, agents }: State, agent: number, line: Point[]): string {
  const title = agentTitle(setup, agent);
  const last = line.at(-1);
  if (!last) return `${title}: not tested yet.`;
  const after = agents[agent]!.learns ? ` after ${last.learnt.toLocaleString("en")} babbles` : "";
  return `${title}: ${percent(last.success)} success${after}.`;
}
