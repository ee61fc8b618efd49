/** The worker: starts the WebAssembly module and answers one message after the other. */

import { faultOf, LocalEngine, transferable } from "./answer";
import type { Reply, Request } from "./protocol";
import init from "./wasm/engine.js";
import moduleUrl from "./wasm/engine_bg.wasm?url";

// As bytes: a static host may serve the file as any type.
async function started(): Promise<LocalEngine> {
  const response = await fetch(moduleUrl);
  if (!response.ok) throw new Error(`${moduleUrl}: ${response.status} ${response.statusText}`);
  await init({ module_or_path: await response.arrayBuffer() });
  return new LocalEngine();
}

const engine = started();

async function answered({ method, args }: Request): Promise<unknown> {
  const call = (await engine)[method] as (...args: unknown[]) => Promise<unknown>;
  return call.apply(await engine, args);
}

self.onmessage = async ({ data }: MessageEvent<Request>) => {
  const { id } = data;
  let reply: Reply;
  try {
    reply = { id, value: await answered(data) };
  } catch (thrown) {
    reply = { id, fault: faultOf(thrown) };
  }
  const buffers = "value" in reply ? transferable(reply.value) : [];
  self.postMessage(reply, { transfer: buffers });
};
