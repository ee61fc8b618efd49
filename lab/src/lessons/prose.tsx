/** Prose of lessons: paragraphs, *emphasis*, `code`, and symbols as K_P, c_x^b1. */
import type { ComponentChildren } from "preact";

export function Prose({ text }: { text: string }) {
  const paragraphs = text.split(/\n\s*\n/).filter((paragraph) => paragraph.trim() !== "");
  return (
    <>
      {paragraphs.map((paragraph) => (
        <p key={paragraph}>{inline(paragraph.trim())}</p>
      ))}
    </>
  );
}

/** Marks between stars are emphasis, between backticks code; a star with a space beside it is a star. */
export function inline(text: string): ComponentChildren[] {
  return text.split(/(\*[^\s*](?:[^*]*[^\s*])?\*|`[^`]+`)/).flatMap((piece) => {
    if (/^\*.+\*$/.test(piece)) return <em>{symbols(piece.slice(1, -1))}</em>;
    if (/^`.+`$/.test(piece)) return <code>{piece.slice(1, -1)}</code>;
    return symbols(piece);
  });
}

/** Letters after an underscore are an index, after a caret an exponent. */
export function symbols(text: string): ComponentChildren[] {
  return text.split(/(?<=[\p{L}\p{M})])([_^][\p{L}\p{N}]+)/u).map((piece, at) => {
    if (at % 2 === 0) return piece;
    return piece.startsWith("_") ? <sub>{piece.slice(1)}</sub> : <sup>{piece.slice(1)}</sup>;
  });
}
