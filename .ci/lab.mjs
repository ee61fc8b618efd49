// Runs records of lab sessions in WebAssembly: each must end in the hash that it holds.
// usage: node .ci/lab.mjs FOLDER-OF-THE-ENGINE RECORD.json ...
import { readFile } from "node:fs/promises";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, ...records] = process.argv.slice(2);
const engine = await import(pathToFileURL(resolve(folder, "engine.js")));
await engine.default({ module_or_path: await readFile(resolve(folder, "engine_bg.wasm")) });
for (const path of records) {
  const { setup, commands, hash } = JSON.parse(await readFile(path, "utf8"));
  const session = new engine.Session(JSON.stringify(setup), new engine.Policies());
  for (const command of commands) session.apply(JSON.stringify(command));
  const ended = JSON.parse(session.state()).hash;
  if (ended !== hash) throw new Error(`${path}: ended in ${ended}, not in ${hash}`);
  console.log(`${path}: the same bits in WebAssembly after ${commands.length} commands`);
}
