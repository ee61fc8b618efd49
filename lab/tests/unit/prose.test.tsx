import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { inline } from "../../src/lessons/prose";

interface Texts {
  background: string;
  equation: { text: string; means: string };
  tasks: { text: string }[];
  questions: { text: string; hint: string; choices: string[] | null }[];
}
const lessons: Texts[] = JSON.parse(readFileSync("../rust/babble_lab/lessons/lessons.json", "utf8"));

/** What is shown, with the names of elements as tags. */
function shown(nodes: unknown): string {
  if (typeof nodes === "string") return nodes;
  if (Array.isArray(nodes)) return nodes.map(shown).join("");
  const { type, props } = nodes as { type: string; props: { children: unknown } };
  return `<${type}>${shown(props.children)}</${type}>`;
}

describe("prose of lessons", () => {
  it("sets emphasis, code, indices and exponents", () => {
    expect(shown(inline("the *time constant* K_D/K_P, `w_max*2`"))).toBe(
      "the <em>time constant</em> K<sub>D</sub>/K<sub>P</sub>, <code>w_max*2</code>",
    );
    expect(shown(inline("ċ_x = γ c_x^b1 (1 − c_x)^b2"))).toBe(
      "ċ<sub>x</sub> = γ c<sub>x</sub><sup>b1</sup> (1 − c<sub>x</sub>)<sup>b2</sup>",
    );
  });

  it("leaves no index and no exponent of a lesson unset", () => {
    for (const lesson of lessons) {
      const { background, equation, tasks, questions } = lesson;
      const texts = [background, equation.text, equation.means, ...tasks.map(({ text }) => text)];
      texts.push(...questions.flatMap(({ text, choices, hint }) => [text, hint, ...(choices ?? [])]));
      const left = texts.map((text) => shown(inline(text)).replace(/<code>.*?<\/code>/g, ""));
      expect(left.filter((text) => /[_^]/.test(text))).toEqual([]);
    }
  });

  it("leaves stars, underscores and carets alone that mark nothing", () => {
    expect(shown(inline("2 * 3 * 4 and _a ^b"))).toBe("2 * 3 * 4 and _a ^b");
  });
});
