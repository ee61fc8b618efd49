/**
 * Where the neurons of a map stand in its picture. A map of two axes has its first axis upwards and its last one
 * to the right; with three axes, the first counts pictures beside each other; with four, pairs of axes are maps
 * in a map. The fovea's rows count from the top, as in an image.
 */
export interface Layout {
  rows: number;
  columns: number;
  /** Neurons of one picture among those beside each other, for lines between them; 0 for none. */
  blockRows: number;
  blockColumns: number;
  /** Neurons row by row, rows from the top. */
  order: Uint32Array;
  neuronAt(row: number, column: number): number;
  placeOf(neuron: number): { row: number; column: number };
}

export function layoutOf(shape: number[], fromTop: boolean): Layout {
  const { up, across } = axesOf(shape.length);
  const lengths = (axes: number[]) => axes.map((axis) => shape[axis]!);
  const size = (axes: number[]) => lengths(axes).reduce((product, n) => product * n, 1);
  const [rows, columns] = [size(up), size(across)];
  const flipped = (row: number) => (fromTop ? row : rows - 1 - row);
  const order = Uint32Array.from({ length: rows * columns }, (_, at) => {
    const place: number[] = [];
    spread(flipped(Math.floor(at / columns)), up, lengths(up), place);
    spread(at % columns, across, lengths(across), place);
    return place.reduce((neuron, index, axis) => neuron * shape[axis]! + index, 0);
  });
  return {
    rows,
    columns,
    blockRows: up.length > 1 ? shape[up.at(-1)!]! : 0,
    blockColumns: across.length > 1 ? shape[across.at(-1)!]! : 0,
    order,
    neuronAt: (row, column) => order[row * columns + column]!,
    placeOf(neuron) {
      const at = indices(neuron, shape);
      const along = (axes: number[]) => axes.reduce((index, axis) => index * shape[axis]! + at[axis]!, 0);
      return { row: flipped(along(up)), column: along(across) };
    },
  };
}

/** The index along each axis; the last axis is fastest. */
export function indices(neuron: number, shape: number[]): number[] {
  const at: number[] = [];
  for (let axis = shape.length - 1; axis >= 0; axis -= 1) {
    at[axis] = neuron % shape[axis]!;
    neuron = Math.floor(neuron / shape[axis]!);
  }
  return at;
}

/** Which axes go up and which across, the outermost first. */
export function axesOf(count: number): { up: number[]; across: number[] } {
  if (count === 1) return { up: [], across: [0] };
  if (count === 3) return { up: [1], across: [0, 2] };
  const axes = Array.from({ length: count }, (_, axis) => axis);
  return { up: axes.filter((axis) => axis % 2 === 0), across: axes.filter((axis) => axis % 2 === 1) };
}

/** Writes the index along each of some axes to its place. */
function spread(index: number, axes: number[], lengths: number[], at: number[]): void {
  for (const [k, i] of indices(index, lengths).entries()) at[axes[k]!] = i;
}
