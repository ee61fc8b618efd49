import { expect, test } from "@playwright/test";
import { button, lastTest, open, run } from "../page";

test("babbling raises success", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await run(page, "Test on 100 cases");
  const before = await lastTest(page);
  await run(page, "Babble 100 ×");
  await expect(page.getByText("100 of")).toBeVisible();
  await run(page, "Test on 100 cases");
  await expect.poll(() => lastTest(page)).toBeGreaterThan(before + 20);
  await expect(page.getByRole("img", { name: /Learning curve.*after 100 babbles/ })).toBeVisible();
});

test("it babbles until it is good, and says so", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await page.getByLabel("good is").fill("60");
  await run(page, "Babble until it is good");
  await expect(page.locator(".status")).toContainText(/Good: \d+ % of the test cases succeed/);
});

test("long work shows how far it is, and stops", async ({ page }) => {
  await open(page, "env=BabbleGrasp-v0&agent=chain&view=brain");
  await button(page, "Babble 1,000 ×").click();
  await expect(page.getByRole("progressbar")).toBeVisible();
  await expect(page.locator(".status")).toContainText("left");
  await run(page, "Stop");
  await expect(page.locator(".status")).toContainText(/Stopped: learnt from [\d,]+ of [\d,]+ babbles/);
});

test("a recall plays to its end, by pause and by steps", async ({ page }) => {
  await open(page, "agent=conjunctive&view=eye");
  await run(page, "Babble 100 ×");
  await button(page, "Next case").click();
  await button(page, "One step").click();
  await page.getByLabel("playing speed").selectOption("5");
  await button(page, "Play").click();
  await button(page, "Pause").click();
  await expect(button(page, "Play")).toBeVisible();
  await page.getByLabel("playing speed").selectOption("Infinity");
  await run(page, "Play");
  await expect(page.locator(".status")).toContainText(/The episode ended after [\d.]+ s/);
  await expect(button(page, "One step")).toBeDisabled();
});
