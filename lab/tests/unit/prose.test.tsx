import { describe, expect, it } from "vitest";
import { inline } from "../../src/lessons/prose";

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
    expect(shown(inline("ċ_x = γ c_x^b1"))).toBe("ċ<sub>x</sub> = γ c<sub>x</sub><sup>b1</sup>");
  });

  it("leaves stars, underscores and carets alone that mark nothing", () => {
    expect(shown(inline("2 * 3 * 4 and _a ^b"))).toBe("2 * 3 * 4 and _a ^b");
  });
});
