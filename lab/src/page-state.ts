/** What a link says of the page, besides the setup. */

export const VIEWS = ["all", "scene", "eye", "brain"] as const;
export type View = (typeof VIEWS)[number];

/** Groups of controls, which a lesson or a link can hide. */
export const CONTROLS = [
  "task",
  "babble",
  "recall",
  "agents",
  "rule",
  "sliders",
  "lesion",
  "files",
  "seed",
  "undo",
] as const;
export type Control = (typeof CONTROLS)[number];

export const isView = (text: string): text is View => (VIEWS as readonly string[]).includes(text);
export const isControl = (text: string): text is Control => (CONTROLS as readonly string[]).includes(text);
