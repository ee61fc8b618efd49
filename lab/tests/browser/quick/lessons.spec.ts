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

test("a lesson is not left with work that is not downloaded, unless the user agrees", async ({ page }) => {
  await open(page, "lesson=eye&view=brain");
  const question = page.locator(".lesson .question").first();
  await question.getByRole("textbox").fill("19.05");
  await page.keyboard.press("Enter");
  await expect(question).toContainText("Right.");

  const lesson = page.getByRole("combobox", { name: "Lesson" });
  const asked: string[] = [];
  let agree = false;
  page.on("dialog", (dialog) => {
    asked.push(dialog.message());
    return agree ? dialog.accept() : dialog.dismiss();
  });
  await lesson.selectOption({ label: "5. The Hebb rule, and why plain Hebb fails" });
  expect(asked).toHaveLength(1);
  await expect(lesson).toHaveValue("eye");
  await expect(question).toContainText("Right.");

  await page.getByRole("heading", { name: "Take it with you" }).click();
  await expect(page.getByRole("button", { name: /to hand in$/ })).toBeDisabled();
  await page.getByLabel("your name").fill("Ada");
  await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: /to hand in$/ }).click(),
  ]);
  await lesson.selectOption({ label: "5. The Hebb rule, and why plain Hebb fails" });
  await expect(page).toHaveURL(/#lesson=hebb$/);
  expect(asked).toHaveLength(1);

  await page.locator(".lesson .question").first().getByRole("textbox").fill("14");
  await page.keyboard.press("Enter");
  await expect(page.locator(".lesson .question").first()).toContainText("Right.");
  agree = true;
  await page.goBack();
  await expect(page).toHaveURL(/#lesson=eye/);
  expect(asked).toHaveLength(2);
});
