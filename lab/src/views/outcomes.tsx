/** How babbles, episodes and test cases ended. */
import type { State } from "../engine/contract";
import { plain } from "../session/playing";
import { agentTitle } from "./agent-title";

export function Outcomes({ state }: { state: State }) {
  return (
    <div class="outcomes">
      {state.agents.map((agent, place) => {
        const columns = {
          babbles: agent.babbleOutcomes,
          episodes: agent.recalls,
          "last test": state.curve.at(-1)?.outcomes[place] ?? {},
        };
        const names = [...new Set(Object.values(columns).flatMap(Object.keys))].sort();
        return (
          <table key={place}>
            <caption>How they ended: {agentTitle(state.setup, place)}</caption>
            <thead>
              <tr>
                <th scope="col">outcome</th>
                {Object.keys(columns).map((column) => (
                  <th key={column} scope="col">
                    {column}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {names.map((name) => (
                <tr key={name}>
                  <th scope="row">{plain(name)}</th>
                  {Object.entries(columns).map(([column, counts]) => (
                    <td key={column}>{(counts[name] ?? 0).toLocaleString("en")}</td>
                  ))}
                </tr>
              ))}
              {names.length === 0 && (
                <tr>
                  <td colSpan={4}>nothing yet</td>
                </tr>
              )}
            </tbody>
          </table>
        );
      })}
    </div>
  );
}
