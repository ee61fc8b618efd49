import { readFile } from "node:fs/promises";
import { expect, type Page, test } from "@playwright/test";
import { button, expectAccessible, open, run } from "../page";

const learnt = async (page: Page) => (await page.locator(".numbers dd").first().textContent())!;
const speed = (page: Page, value: string) => page.getByLabel("babbling speed").selectOption(value);
const status = (page: Page) => page.locator(".status");

test("a babble is shown, held, stepped and learnt from", async ({ page }) => {
  await open(page, "agent=conjunctive&view=scene");
  await speed(page, "1");
  await button(page, "Babble once").click();
  await expect(status(page)).toContainText("Babble 1: The fingertip is");
  await button(page, "Pause babbling").click();
  const text = () => page.locator(".scene-text").textContent();
  const held = await text();
  await expect(button(page, "One step of the babble")).toBeEnabled();
  await expect.poll(text).toBe(held);
  await button(page, "One step of the babble").focus();
  for (let steps = 0; steps < 30; steps += 1) await page.keyboard.press("Enter");
  await expect.poll(text).not.toBe(held);
  await expectAccessible(page);
  await speed(page, "20");
  await button(page, "Go on babbling").click();
  await expect(button(page, "Stop")).toHaveCount(0);
  await expect(status(page)).toContainText("Learnt from 1 babble");
  expect(await learnt(page)).toMatch(/^1 of \d+ babbles/);
});

for (const link of ["agent=conjunctive", "env=BabbleGrasp-v0", "env=BabbleGrasp-v0&agent=chain"]) {
  test(`watched babbles and fast ones end in the same state: ${link}`, async ({ page }) => {
    const record = async (value: string) => {
      await open(page, `${link}&view=brain`);
      await speed(page, value);
      for (let babbles = 0; babbles < 2; babbles += 1) await run(page, "Babble once");
      await page.getByRole("heading", { name: "Take it with you" }).click();
      await page.getByLabel("your name").fill("Ada");
      const download = page.waitForEvent("download");
      await page.getByRole("button", { name: /^Download what you did/ }).click();
      return JSON.parse(await readFile(await (await download).path(), "utf8"));
    };
    const fast = await record("Infinity");
    await page.goto("about:blank");
    const watched = await record("20");
    expect(watched.commands).toEqual([{ do: "babble", n: 2 }]);
    expect(watched.hash).toBe(fast.hash);
  });
}

test("the maps move while it babbles, and the number of its babble is told", async ({ page }) => {
  await open(page, "env=BabbleGrasp-v0&view=brain");
  await speed(page, "5");
  await button(page, "Babble once").click();
  await expect(page.getByText(/^Babble 1\. Input maps: what was seen/)).toBeVisible();
  const arm = () => page.getByRole("application", { name: /^Output “arm”/ }).getAttribute("aria-label");
  const before = await arm();
  await expect.poll(arm).not.toBe(before);
  await button(page, "Stop").click();
  await expect(page.getByText("Read out of the output maps")).toBeVisible();
  expect(await learnt(page)).toMatch(/^0 of 0/);
});

test("undo takes back a run, and watched babbles one by one", async ({ page }) => {
  await open(page, "view=brain");
  await run(page, "Babble 100 ×");
  await run(page, "Babble once");
  const undo = page.getByRole("button", { name: /^Undo/ });
  await undo.click();
  await expect(page.getByText(/^100 of/)).toBeVisible();
  await speed(page, "20");
  await button(page, "Babble 100 ×").click();
  await expect(page.getByText(/^10[2-9] of/)).toBeVisible();
  await button(page, "Stop").click();
  await expect(button(page, "Stop")).toHaveCount(0);
  const before = Number.parseInt(await learnt(page), 10);
  await undo.click();
  await expect.poll(() => learnt(page)).toMatch(new RegExp(`^${before - 1} of`));
  await expect(async () => {
    if (await undo.isEnabled()) await undo.click({ timeout: 1000 });
    expect(await learnt(page)).toMatch(/^0 of 0/);
  }).toPass({ intervals: [50] });
});

test("with little motion a babble is shown by a few pictures", async ({ browser }) => {
  const page = await browser.newPage({ reducedMotion: "reduce" });
  await open(page, "env=BabbleGrasp-v0&view=scene");
  await speed(page, "20");
  const texts = new Set<string>();
  await button(page, "Babble once").click();
  await expect(async () => {
    texts.add((await page.locator(".scene-text").textContent())!);
    expect(await button(page, "Stop").count()).toBe(0);
  }).toPass({ intervals: [40] });
  expect(texts.size).toBeLessThanOrEqual(4);
  await page.close();
});
