import { expect, type Page, test } from "@playwright/test";
import { DEEDS } from "../lessons";
import { button, expectAccessible, expectNoSidewaysScroll, open } from "../page";

const done = (page: Page) => page.locator(".lesson .task.done");

for (const [lesson, tasks] of Object.entries(DEEDS)) {
  test(`${lesson}: its checks fire on what it asks for`, async ({ page }) => {
    test.setTimeout(240_000);
    await page.setViewportSize({ width: 1400, height: 900 });
    await open(page, `lesson=${lesson}`);
    await expect(page.locator(".lesson .task")).toHaveCount(tasks.length);
    await expect(done(page)).toHaveCount(0);
    for (const [task, deeds] of tasks.entries()) {
      for (const deed of deeds) await deed(page);
      await expect(page.locator(".lesson .task").nth(task)).toHaveClass(/done/);
    }
    await expect(done(page)).toHaveCount(tasks.length);
  });

  test(`${lesson}: wrong answers bring a hint, and nothing else is done`, async ({ page }) => {
    await open(page, `lesson=${lesson}`);
    for (const question of await page.locator(".lesson .question").all()) {
      const choices = question.getByRole("radio");
      if ((await choices.count()) > 0) await choices.last().check();
      else await question.getByRole("textbox").fill("-12345");
      await question.getByRole("button", { name: "Answer" }).click();
      await expect(question.locator("p")).toHaveText(/^(Not yet\. .+|✓ Right\.)$/);
    }
    await expect(done(page)).toHaveCount(0);
    await expect(page.getByText(/Not yet\./).first()).toBeVisible();
  });
}

for (const lesson of Object.keys(DEEDS)) {
  for (const width of [360, 820, 1400]) {
    test(`${lesson} at ${width} pixels`, async ({ page }, info) => {
      await page.setViewportSize({ width, height: 900 });
      await page.emulateMedia({ colorScheme: width === 820 ? "dark" : "light" });
      await open(page, `lesson=${lesson}`);
      await button(page, "Next case").click();
      await expectNoSidewaysScroll(page);
      await expectAccessible(page);
      await page.screenshot({ path: info.outputPath(`lesson-${lesson}-${width}.png`), fullPage: true });
    });
  }
}
