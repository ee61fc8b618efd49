/**
 * Measures the built page: `node tests/browser/measure.mjs`. Sizes, the time until it can be used, frames and long
 * tasks while an episode plays and while an agent babbles, as it is and with the processor slowed down six times.
 */
import { spawn } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { chromium } from "@playwright/test";

const PORT = 8744;
const URL = `http://127.0.0.1:${PORT}/lab/`;

const files = readdirSync("dist", { recursive: true, withFileTypes: true }).filter((file) => file.isFile());
const sizes = {};
for (const file of files) {
  const kind = file.name.split(".").at(-1);
  sizes[kind] =
    (sizes[kind] ?? 0) + gzipSync(readFileSync(join(file.parentPath, file.name)), { level: 9 }).length;
}
const total = Object.values(sizes).reduce((sum, size) => sum + size, 0);
const kilobytes = (size) => `${(size / 1000).toFixed(0)} kB`;
console.log(
  "gzip:",
  kilobytes(total),
  Object.entries(sizes)
    .map(([kind, size]) => `${kind} ${kilobytes(size)}`)
    .join(", "),
);

const server = spawn(process.execPath, ["tests/browser/serve.mjs", "dist", String(PORT), "/lab/"]);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  for (const slowdown of [1, 6]) {
    for (const link of [
      "agent=conjunctive",
      "agent=conjunctive&view=brain",
      "agent=conjunctive&view=scene",
    ]) {
      await measure(slowdown, link);
    }
  }
} finally {
  await browser.close();
  server.kill();
}

async function measure(slowdown, link) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  if (slowdown > 1) {
    const devtools = await page.context().newCDPSession(page);
    await devtools.send("Emulation.setCPUThrottlingRate", { rate: slowdown });
  }
  await page.addInitScript(() => {
    globalThis.long = [];
    globalThis.frames = 0;
    new PerformanceObserver((list) => {
      for (const { duration } of list.getEntries()) globalThis.long.push(Math.round(duration));
    }).observe({ type: "longtask", buffered: true });
    const frame = () => {
      globalThis.frames += 1;
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  await page.goto(`${URL}#${link}`);
  await page.waitForSelector("#controls");
  await page.waitForTimeout(3000);
  const interactive = await page.evaluate(() => performance.getEntriesByName("interactive")[0].startTime);
  console.log(`\n${link}, processor ${slowdown} × slower: interactive after ${interactive.toFixed(0)} ms`);
  await report(page, "loading", async () => {});
  await report(page, "1,000 babbles", () => run(page, "Babble 1,000 ×"));
  await report(page, "an episode in real time", () => run(page, "Play"));
  await page.close();
}

async function run(page, name) {
  await page.getByRole("button", { name, exact: true }).click();
  await page.getByRole("button", { name: "Stop", exact: true }).waitFor({ state: "attached" });
  await page
    .getByRole("button", { name: "Stop", exact: true })
    .waitFor({ state: "detached", timeout: 120_000 });
}

/** Frames a second, and tasks of the main thread over 50 ms since the last report. */
async function report(page, what, work) {
  const frames = () => page.evaluate(() => globalThis.frames);
  const [before, began] = [await frames(), performance.now()];
  await work();
  const seconds = (performance.now() - began) / 1000;
  const rate = ((await frames()) - before) / seconds;
  const long = await page.evaluate(() => globalThis.long.splice(0));
  const told = long.length === 0 ? "none" : `${long.length}, longest ${Math.max(...long)} ms`;
  const speed = seconds > 0.2 ? `${seconds.toFixed(1)} s, ${rate.toFixed(0)} frames/s, ` : "";
  console.log(`  ${what}: ${speed}tasks over 50 ms: ${told}`);
}
