import { expect, test } from "@playwright/test";
import { button, expectAccessible, open, run } from "../page";

test("the first case is there before it is played", async ({ page }) => {
  await open(page, "view=all");
  await expect(page.locator(".scene-text")).toContainText(/The fingertip is .* of the target/);
  await expect(page.getByRole("img", { name: /What the eye sees: red is 0 %/ })).toBeVisible();
});

test("maps say what their axes stand for", async ({ page }) => {
  await open(page, "env=BabbleGrasp-v0&view=brain");
  const map = page.getByRole("application", { name: /^Output “hand”/ });
  await expect(map).toHaveAccessibleDescription(
    /To the right: opening of the thumb \[deg\], 0 to 90 ?\. Up: opening of the finger \[deg\], 0 to 90/,
  );
  await expect(page.getByText("column from the left, 1 to 21").first()).toBeVisible();
});

test("a profile is chosen, and is in the link", async ({ page }) => {
  await open(page, "view=brain");
  await page.getByLabel("Profile of the body").selectOption("icub");
  await expect.poll(() => new URL(page.url()).hash).toContain("profile=icub");
  await page.reload();
  await expect(page.getByLabel("Profile of the body")).toHaveValue("icub");
});

test("the ball is moved along the palm by keys, slider and number, and by drag", async ({ page }) => {
  await open(page, "env=BabbleGrasp-v0&agent=approach&view=scene&config.grasp.diameters_m=%5B0.024%5D");
  const number = page.getByLabel("Ball along the palm, from the wrist, as a number");
  const slider = page.getByRole("slider", { name: "Ball along the palm, from the wrist" });
  await number.fill("2");
  await number.press("Enter");
  await expect(number).toHaveValue("2");
  await expect(slider).toHaveAttribute("aria-valuetext", "2 centimetres");
  await page.getByLabel("playing speed").selectOption("Infinity");
  await run(page, "Play");
  await expect(page.locator(".status")).not.toContainText("success");
  await number.fill("4");
  await number.press("Enter");
  await expect(slider).toHaveAttribute("aria-valuetext", "4 centimetres");
  await slider.focus();
  await page.keyboard.press("ArrowLeft");
  await expect(number).toHaveValue("3.9");
  await expectAccessible(page);
  await run(page, "Play");
  await expect(page.locator(".status")).toContainText("success");
  await button(page, "Same case again").click();
  const object = page.locator('.scene-handle[data-part="object"]');
  await object.focus();
  for (const key of ["Shift+ArrowUp", "Shift+ArrowUp", "Enter"]) await page.keyboard.press(key);
  await expect(number).not.toHaveValue("3.9");
});
