/** Prose of lessons: paragraphs, *emphasis* and `code`. */
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
  return text.split(/(\*[^\s*](?:[^*]*[^\s*])?\*|`[^`]+`)/).map((piece) => {
    if (piece.length > 2 && piece.startsWith("*") && piece.endsWith("*"))
      return <em>{piece.slice(1, -1)}</em>;
    if (piece.length > 2 && piece.startsWith("`") && piece.endsWith("`"))
      return <code>{piece.slice(1, -1)}</code>;
    return piece;
  });
}
