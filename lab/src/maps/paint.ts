/** Paints a map of neurons on a canvas. */
import { type ColourTable, colourOf } from "./colours";
import type { Layout } from "./layout";

export interface Picture {
  activity: Float32Array;
  low: number;
  high: number;
  colours: ColourTable;
  /** Neurons that are crossed out. */
  crossed: Iterable<number>;
  /** Neurons with a ring, and its colour. */
  rings: [number, string][];
}

export function paint(canvas: HTMLCanvasElement, picture: Picture, layout: Layout, scale: number): void {
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.imageSmoothingEnabled = false;
  context.drawImage(coloured(picture, layout), 0, 0, canvas.width, canvas.height);
  drawBlocks(context, layout, scale);
  for (const neuron of picture.crossed) cross(context, layout.placeOf(neuron), scale);
  for (const [neuron, colour] of picture.rings) ring(context, layout.placeOf(neuron), scale, colour);
}

/** One pixel for each neuron. */
function coloured(
  { activity, low, high, colours }: Picture,
  { rows, columns, order }: Layout,
): OffscreenCanvas {
  const image = new ImageData(columns, rows);
  for (let at = 0; at < order.length; at += 1) {
    const [r, g, b] = colourOf(activity[order[at]!]!, low, high, colours);
    image.data.set([r, g, b, 255], 4 * at);
  }
  const canvas = new OffscreenCanvas(columns, rows);
  canvas.getContext("2d", { willReadFrequently: true })!.putImageData(image, 0, 0);
  return canvas;
}

function drawBlocks(context: CanvasRenderingContext2D, layout: Layout, scale: number): void {
  context.fillStyle = "rgb(255 255 255 / 55%)";
  const { rows, columns, blockRows, blockColumns } = layout;
  for (let c = blockColumns; blockColumns > 0 && c < columns; c += blockColumns) {
    context.fillRect(c * scale - 1, 0, 2, rows * scale);
  }
  for (let r = blockRows; blockRows > 0 && r < rows; r += blockRows) {
    context.fillRect(0, r * scale - 1, columns * scale, 2);
  }
}

type Place = { row: number; column: number };

function cross(context: CanvasRenderingContext2D, { row, column }: Place, scale: number): void {
  const [x, y] = [column * scale, row * scale];
  context.fillStyle = "#3c3c3c";
  context.fillRect(x, y, scale, scale);
  context.strokeStyle = "#ffffff";
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(x + 1, y + 1);
  context.lineTo(x + scale - 1, y + scale - 1);
  context.moveTo(x + scale - 1, y + 1);
  context.lineTo(x + 1, y + scale - 1);
  context.stroke();
}

function ring(
  context: CanvasRenderingContext2D,
  { row, column }: Place,
  scale: number,
  colour: string,
): void {
  const [x, y] = [(column + 0.5) * scale, (row + 0.5) * scale];
  for (const [width, style] of [
    [4, "#000000"],
    [2, colour],
  ] as const) {
    context.lineWidth = width;
    context.strokeStyle = style;
    context.beginPath();
    context.arc(x, y, 0.8 * scale, 0, 2 * Math.PI);
    context.stroke();
  }
}
