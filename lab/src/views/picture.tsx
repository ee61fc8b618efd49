/** A picture of the eye on a canvas, with marks over it. */
import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { PICTURE } from "../session/shown";

export function Picture(props: {
  pixels: Uint8ClampedArray | undefined;
  name: string;
  caption: ComponentChildren;
  /** Where a cross stands, in half edges of the picture from its middle, right and down. */
  mark?: number[] | null;
  /** Share of the edges that a square in the middle has. */
  square?: number;
}) {
  const { pixels, mark, square } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  useLayoutEffect(() => {
    if (pixels?.length !== 4 * PICTURE * PICTURE) return;
    const context = canvas.current!.getContext("2d", { willReadFrequently: true })!;
    const image = context.createImageData(PICTURE, PICTURE);
    image.data.set(pixels);
    context.putImageData(image, 0, 0);
    if (square) frame(context, square * PICTURE);
    if (mark) cross(context, (0.5 + 0.5 * mark[0]!) * PICTURE, (0.5 + 0.5 * mark[1]!) * PICTURE);
  }, [pixels, mark, square]);
  return (
    <figure class="picture">
      <canvas ref={canvas} width={PICTURE} height={PICTURE} role="img" aria-label={props.name} />
      <figcaption>{props.caption}</figcaption>
    </figure>
  );
}

function frame(context: CanvasRenderingContext2D, edge: number): void {
  const from = (PICTURE - edge) / 2;
  for (const [grown, colour] of [
    [2, "#000000"],
    [1, "#ffffff"],
  ] as const) {
    context.lineWidth = 1;
    context.strokeStyle = colour;
    context.strokeRect(from - grown, from - grown, edge + 2 * grown, edge + 2 * grown);
  }
}

function cross(context: CanvasRenderingContext2D, x: number, y: number): void {
  for (const [width, colour] of [
    [5, "#000000"],
    [2, "#ffffff"],
  ] as const) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x - 10, y);
    context.lineTo(x + 10, y);
    context.moveTo(x, y - 10);
    context.lineTo(x, y + 10);
    context.stroke();
  }
}
