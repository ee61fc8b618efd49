/** Colours that the engine does not give: those of the stage, and of each agent's trail. */

export type Theme = "light" | "dark";

export interface Palette {
  ground: number;
  grid: number;
  line: number; // line of sight and the eye's field
  agents: [number, number]; // told apart by people who are colour-blind, too
  shadow: number; // opacity
  obstacle: number | null; // none for the engine's grey, which does not stand out from a dark ground
}

export const PALETTES: Record<Theme, Palette> = {
  light: {
    ground: 0xe9ebe7,
    grid: 0xc3c8c1,
    line: 0x1b6e3c,
    agents: [0x1a5a96, 0xb34700],
    shadow: 0.2,
    obstacle: null,
  },
  dark: {
    ground: 0x2a2f36,
    grid: 0x454c55,
    line: 0x74cc94,
    agents: [0x7db8ee, 0xffb27a],
    shadow: 0.4,
    obstacle: 0xb4bfca,
  },
};
