/** A learning rule of one's own in one line, beside Eq. 7. */
import { useEffect, useState } from "preact/hooks";
import type { AgentSetup } from "../engine/contract";
import type { Session } from "../session/session";
import { Act, Group } from "./group";

const EXAMPLES: [string, string][] = [
  ["Eq. 7", "eta*(a-a_mean)*(g-g_mean)*(w_max-abs(w))"],
  ["Hebb", "eta*a*g*(w_max-abs(w))"],
  ["Oja", "eta*a*(g-a*w)"],
];
const NAMES = "a, a_mean (ā), g, g_mean (ḡ), w, eta (η), w_max";

export function RuleControls({ session }: { session: Session }) {
  const { setup } = session.state.value;
  const [agent] = setup.agents;
  const current = agent?.kind === "hebb" ? agent.rule : null;
  const [text, setText] = useState(current ?? "");
  useEffect(() => setText(current ?? ""), [current]);
  const wrong = useRuleCheck(session, text);
  if (agent?.kind !== "hebb") return null;
  const learn = (rule: string | null, beside: boolean) => () => {
    const own: AgentSetup = { ...agent, rule };
    const second: AgentSetup[] = beside ? [{ ...agent, rule: null }] : setup.agents.slice(1);
    return session.change({ ...setup, agents: [own, ...second] });
  };
  const usable = text.trim() !== "" && wrong === null;
  return (
    <Group session={session} controls={["rule"]} title="Learning rule in one line" folded={current === null}>
      <label class="rule">
        <i class="symbol">Δw</i> ={" "}
        <input
          type="text"
          spellcheck={false}
          autocomplete="off"
          aria-describedby="rule-help rule-wrong"
          aria-invalid={wrong !== null}
          value={text}
          onInput={(event) => setText(event.currentTarget.value)}
        />
      </label>
      <p id="rule-wrong" class="wrong" aria-live="polite">
        {wrong && `At character ${wrong.at + 1}: ${wrong.problem}`}
      </p>
      <p id="rule-help" class="hint">
        Names: {NAMES}. Also + − * / ^, parentheses, abs, min, max, tanh, exp, sqrt, sign.
      </p>
      <div class="row">
        {EXAMPLES.map(([title, rule]) => (
          <button key={title} type="button" class="small" onClick={() => setText(rule)}>
            {title}
          </button>
        ))}
      </div>
      <div class="row">
        <Act session={session} disabled={!usable} work={learn(text.trim(), false)}>
          Learn by it
        </Act>
        <Act session={session} disabled={!usable} work={learn(text.trim(), true)}>
          Learn by it, beside the usual rule
        </Act>
        <Act session={session} disabled={current === null} work={learn(null, false)}>
          Usual rule again
        </Act>
      </div>
    </Group>
  );
}

/** What is wrong with a rule while it is typed; null if nothing is, or nothing is there. */
function useRuleCheck(session: Session, text: string): { problem: string; at: number } | null {
  const [wrong, setWrong] = useState<{ problem: string; at: number } | null>(null);
  useEffect(() => {
    let current = true;
    const rule = text.trim();
    if (rule === "") {
      setWrong(null);
      return;
    }
    void session.attempt(async () => {
      const found = await session.engine.checkRule(rule);
      if (current) setWrong(found);
    });
    return () => {
      current = false;
    };
  }, [session, text]);
  return wrong;
}
