/** The client: each reply settles its call, errors are LabErrors, and a worker that dies settles all. */

import { expect, test } from "vitest";
import { engineOver, LabError, type Port } from "../../src/engine/client";
import type { Request } from "../../src/engine/protocol";

/** A worker whose replies the test gives. */
function stage() {
  const asked: Request[] = [];
  const port: Port = {
    postMessage: (message) => asked.push(message as Request),
    onmessage: null,
    onerror: null,
  };
  const engine = engineOver(port);
  const reply = (data: unknown) => port.onmessage?.({ data } as MessageEvent);
  return { asked, engine, port, reply };
}

test("replies settle their calls in any order", async () => {
  const { asked, engine, reply } = stage();
  const scene = engine.scene(1);
  const text = engine.python(0);
  expect(asked.map(({ method, args }) => [method, ...args])).toEqual([
    ["scene", 1],
    ["python", 0],
  ]);
  reply({ id: asked[1]!.id, value: "import gym_babble" });
  reply({ id: asked[0]!.id, value: { solids: [] } });
  expect(await text).toBe("import gym_babble");
  expect(await scene).toEqual({ solids: [] });
});

test("a fault rejects with its field, and the others go on", async () => {
  const { asked, engine, reply } = stage();
  const call = engine.apply({ do: "babble", n: 0 });
  const fault = { kind: "ConfigError", field: "n", problem: "n = 0 is not in [1, 100000]" };
  reply({ id: asked[0]!.id, fault });
  await expect(call).rejects.toThrow(LabError);
  await expect(call).rejects.toMatchObject({ fault, message: fault.problem });
});

test("a worker that does not start rejects every call", async () => {
  const { engine, port } = stage();
  const calls = [engine.registry(), engine.lessons()];
  port.onerror?.({ message: "404" } as ErrorEvent);
  for (const call of calls) await expect(call).rejects.toThrow("did not start: 404");
});
