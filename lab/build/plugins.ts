/** What the build adds to the page: a policy of what it may load, and the list of files to keep offline. */
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join, relative, sep } from "node:path";
import type { Plugin } from "vite";

const POLICY = [
  "default-src 'self'",
  "script-src 'self' 'wasm-unsafe-eval'",
  "img-src 'self' data: blob:",
  "object-src 'none'",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");

/** The Content-Security-Policy of the built page; the development server needs inline scripts. */
export function contentPolicy(): Plugin {
  return {
    name: "content-policy",
    apply: "build",
    transformIndexHtml: () => [
      {
        tag: "meta",
        attrs: { "http-equiv": "Content-Security-Policy", content: POLICY },
        injectTo: "head-prepend",
      },
    ],
  };
}

/** Puts the names of all built files, and a version made of their bytes, into the service worker. */
export function offlineFiles(): Plugin {
  let publicFolder = "";
  return {
    name: "offline-files",
    apply: "build",
    configResolved(config) {
      publicFolder = config.publicDir;
    },
    generateBundle(_, bundle) {
      const hash = createHash("sha256").update(readFileSync("index.html"));
      const names: string[] = [];
      for (const file of Object.values(bundle)) {
        if (file.fileName === "sw.js") continue;
        names.push(file.fileName);
        hash.update(file.fileName).update(file.type === "chunk" ? file.code : file.source);
      }
      for (const path of filesIn(publicFolder)) {
        names.push(relative(publicFolder, path).split(sep).join("/"));
        hash.update(names.at(-1)!).update(readFileSync(path));
      }
      const worker = bundle["sw.js"];
      if (worker?.type !== "chunk") throw new Error("the service worker was not built");
      worker.code = worker.code
        .replace("__FILES__", JSON.stringify(names.sort()))
        .replace("__VERSION__", JSON.stringify(hash.digest("hex").slice(0, 16)));
    },
  };
}

function filesIn(folder: string): string[] {
  return readdirSync(folder)
    .sort()
    .map((name) => join(folder, name))
    .flatMap((path) => (statSync(path).isDirectory() ? filesIn(path) : [path]));
}
