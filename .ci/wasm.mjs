// Runs a WebAssembly program that imports nothing. A panic in it is a trap, which ends Node with an error.
import { readFile } from "node:fs/promises";

const { instance } = await WebAssembly.instantiate(await readFile(process.argv[2]), {});
const code = instance.exports.main(0, 0);
if (code !== 0) throw new Error(`the program ended with ${code}`);
console.log(`ran in WebAssembly, with ${instance.exports.memory.buffer.byteLength >> 20} MiB of memory`);
