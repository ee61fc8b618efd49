import { defineConfig } from "@playwright/test";

const PORT = Number(process.env.LAB_PORT ?? 8743);
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

// The page is served from a subfolder, as on a course page, by a server that knows no type of .wasm.
export default defineConfig({
  testDir: "tests/browser",
  outputDir: "test-results",
  fullyParallel: true,
  workers: 2,
  timeout: 60_000,
  reporter: "list",
  use: {
    baseURL: `http://127.0.0.1:${PORT}/course/lab/`,
    launchOptions: {
      executablePath: CHROMIUM,
      args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    },
  },
  projects: [
    { name: "quick", testDir: "tests/browser/quick" },
    { name: "long", testDir: "tests/browser/long" },
  ],
  webServer: {
    command: `node tests/browser/serve.mjs dist ${PORT} /course/lab/`,
    url: `http://127.0.0.1:${PORT}/course/lab/`,
  },
});
