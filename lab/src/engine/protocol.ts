/** Messages between the page and the worker in which the engine runs. */

import type { Engine, Fault } from "./contract";

export type Method = keyof Engine;

export interface Request {
  id: number;
  method: Method;
  args: unknown[];
}

export type Reply = { id: number; value: unknown } | { id: number; fault: Fault };
