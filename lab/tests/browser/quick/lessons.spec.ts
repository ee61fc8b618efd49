import { expect, test } from "@playwright/test";
import { DEEDS } from "../lessons";
import { expectAccessible, open } from "../page";

test("a lesson is chosen, done by keyboard and pointer, and marks what was done", async ({ page }) => {
  await open(page);
  await page.getByLabel("Lesson").selectOption({ label: "1. Equilibrium points and lag" });
  await expect(page).toHaveURL(/#lesson=equilibrium$/);
  await expect(page.getByRole("heading", { name: "Learning rule in one line" })).toHaveCount(0);
  await expect(page.getByText("0 of 3 tasks done")).toBeVisible();
  for (const deed of DEEDS.equilibrium![0]!) await deed(page);
  await expect(page.getByText("1 of 3 tasks done")).toBeVisible();
  await expect(page.locator(".status")).toContainText("Task 1 of the lesson is done");
  await expectAccessible(page);
});

test("an answer is judged, and the last one counts", async ({ page }) => {
  await open(page, "lesson=eye&view=brain");
  const question = page.locator(".lesson .question").first();
  await question.getByRole("textbox").fill("120");
  await page.keyboard.press("Enter");
  await expect(question).toContainText("Not yet. Eq. 1");
  await question.getByRole("textbox").fill("19,05");
  await page.keyboard.press("Enter");
  await expect(question).toContainText("Right.");
  await expect(page.getByText("1 of 3 answers right")).toBeVisible();
});
