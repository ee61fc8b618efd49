import { expect, test } from "@playwright/test";
import { button, expectAccessible, expectNoSidewaysScroll, open, run } from "../page";

for (const scheme of ["light", "dark"] as const) {
  test(`axe finds nothing, ${scheme}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: scheme });
    await open(page, "agent=conjunctive&agent2=random");
    await run(page, "Babble once");
    await page.getByRole("heading", { name: "Take it with you" }).click();
    await page.getByRole("heading", { name: "Learning rule in one line" }).click();
    await expectAccessible(page);
  });
}

test("the keyboard reaches and works the controls", async ({ page }) => {
  await open(page, "view=brain");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter"); // to the controls
  await page.keyboard.press("Tab");
  await page.keyboard.press("Tab");
  await expect(button(page, "Babble once")).toBeFocused();
  await page.keyboard.press("Enter");
  await expect(page.getByText(/^1 of/)).toBeVisible();
});

test("the keyboard looks at neurons and silences them", async ({ page }) => {
  await open(page, "view=brain");
  await run(page, "Babble once");
  const map = page.getByRole("application", { name: /^Input “obstacle”/ });
  await map.focus();
  await page.keyboard.press("ArrowRight");
  await expect(map).toHaveAccessibleName(/at obstacle to the right 0°, obstacle up 0°/);
  await page.keyboard.press("ArrowRight");
  await expect(map).toHaveAccessibleName(/at obstacle to the right 6°, obstacle up 0°/);
  await expect(page.getByText("Weights from that neuron")).toBeVisible();
  await page.getByLabel(/brush: silence/).check();
  await map.focus();
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Enter");
  await expect(page.locator(".status")).toContainText("5 neurons of “obstacle” silenced");
});

for (const width of [360, 820, 1280]) {
  test(`the page fits ${width} pixels`, async ({ page }) => {
    await page.setViewportSize({ width, height: 800 });
    await open(page, "agent=conjunctive&agent2=random");
    await expectNoSidewaysScroll(page);
  });
}
