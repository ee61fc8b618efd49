import { defineConfig } from "vitest/config";
import { contentPolicy, offlineFiles } from "./build/plugins.ts";

// Relative URLs: the page works in any folder of any static host.
export default defineConfig({
  base: "./",
  plugins: [contentPolicy(), offlineFiles()],
  worker: { format: "es" },
  build: {
    target: "es2022",
    // A file for each asset: data URLs would count against the policy of index.html.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rolldownOptions: {
      input: { index: "index.html", sw: "src/offline/service-worker.ts" },
      output: { entryFileNames: (chunk) => (chunk.name === "sw" ? "sw.js" : "assets/[name]-[hash].js") },
    },
  },
  test: { include: ["tests/unit/**/*.test.{ts,tsx}"] },
});
