/** The engine as the page sees it: each call is a message to the worker, whose reply settles a promise. */

import type { Engine, Fault } from "./contract";
import type { Method, Reply, Request } from "./protocol";

/** What a call of the engine rejects with. */
export class LabError extends Error {
  readonly fault: Fault;

  constructor(fault: Fault) {
    super(fault.problem);
    this.name = "LabError";
    this.fault = fault;
  }
}

const METHODS: Record<Method, true> = {
  registry: true,
  lessons: true,
  defaultSetup: true,
  open: true,
  apply: true,
  goOn: true,
  undo: true,
  film: true,
  palmCase: true,
  state: true,
  scene: true,
  sight: true,
  picture: true,
  brain: true,
  weights: true,
  progress: true,
  addPolicy: true,
  saveAgent: true,
  loadAgent: true,
  python: true,
  record: true,
  checkRule: true,
};

interface Waiting {
  resolve: (value: unknown) => void;
  reject: (error: Error) => void;
}

/** What a worker has that the client needs; tests put another one in its place. */
export interface Port {
  postMessage(message: unknown): void;
  onmessage: ((event: MessageEvent<Reply>) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
}

/** The engine behind a worker. */
export function engineOver(worker: Port): Engine {
  const waiting = new Map<number, Waiting>();
  let calls = 0;
  worker.onmessage = ({ data }) => {
    const call = waiting.get(data.id);
    waiting.delete(data.id);
    if ("fault" in data) call?.reject(new LabError(data.fault));
    else call?.resolve(data.value);
  };
  worker.onerror = (event) => {
    const problem = `the engine did not start: ${event.message || "its files cannot be read"}`;
    const fault = { kind: "InternalError", field: null, problem };
    for (const call of waiting.values()) call.reject(new LabError(fault));
    waiting.clear();
  };
  const caller =
    (method: Method) =>
    (...args: unknown[]) =>
      new Promise((resolve, reject) => {
        const request: Request = { id: ++calls, method, args };
        waiting.set(request.id, { resolve, reject });
        worker.postMessage(request);
      });
  const methods = Object.keys(METHODS) as Method[];
  return Object.fromEntries(methods.map((method) => [method, caller(method)])) as unknown as Engine;
}

/** The engine in a worker of its own. */
export function startEngine(): Engine {
  return engineOver(new Worker(new URL("./worker.ts", import.meta.url), { type: "module" }));
}
