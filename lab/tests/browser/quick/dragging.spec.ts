import { expect, type Page, test } from "@playwright/test";
import { button, open } from "../page";

const handle = (page: Page, part: string) => page.locator(`.scene-handle[data-part="${part}"]`);

/** A case on the stage, whose parts can be dragged. */
async function staged(page: Page, hash: string): Promise<void> {
  await open(page, `view=scene&${hash}`);
  await button(page, "Next case").click();
  await expect(handle(page, "start")).toBeVisible();
}

const placeOf = async (page: Page, part: string) => (await handle(page, part).getAttribute("aria-label"))!;

test("the target is dragged by mouse, and stays where it was put", async ({ page }) => {
  await staged(page, "agent=scripted");
  const before = await placeOf(page, "target");
  const box = (await handle(page, "target").boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 15, y + 15, { steps: 4 });
  await page.mouse.up();
  await expect.poll(() => placeOf(page, "target")).not.toBe(before);
  const after = await placeOf(page, "target");
  await button(page, "Same case again").click();
  await expect.poll(() => placeOf(page, "target")).toBe(after);
});

test("parts are moved by keys: set, put back, taken away", async ({ page }) => {
  await staged(page, "agent=scripted");
  const before = await placeOf(page, "target");
  await handle(page, "target").focus();
  await page.keyboard.press("ArrowDown");
  const moved = await placeOf(page, "target");
  expect(moved).not.toBe(before);
  await expect(page.locator(".status")).toContainText(moved);
  await page.keyboard.press("Escape");
  expect(await placeOf(page, "target")).toBe(before);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await button(page, "Same case again").click();
  await expect.poll(() => placeOf(page, "target")).toBe(moved);
  await handle(page, "obstacle").focus();
  await page.keyboard.press("Delete");
  await expect(handle(page, "obstacle")).toHaveCount(0);
});

test("what is out of reach is said, and put back", async ({ page }) => {
  await staged(page, "agent=scripted");
  const before = await placeOf(page, "target");
  await handle(page, "target").focus();
  for (let i = 0; i < 12; i++) await page.keyboard.press("Shift+ArrowUp");
  await page.keyboard.press("Enter");
  await expect(page.locator(".status")).toContainText("out of the arm's reach");
  await expect.poll(() => placeOf(page, "target")).toBe(before);
});

test("in grasping the object and the hand are moved", async ({ page }) => {
  await staged(page, "env=BabbleGrasp-v0&agent=scripted");
  const ways = { object: ["ArrowUp"], start: ["ArrowRight", "ArrowRight", "ArrowUp", "ArrowUp"] };
  for (const [part, way] of Object.entries(ways)) {
    await handle(page, part).focus();
    for (const key of way) await page.keyboard.press(key);
    const moved = await placeOf(page, part);
    await page.keyboard.press("Enter");
    await button(page, "Same case again").click();
    await expect.poll(() => placeOf(page, part)).toBe(moved);
  }
});

test("keys turn the camera, and handles follow their parts", async ({ page }) => {
  await staged(page, "agent=scripted");
  const x = async () => (await handle(page, "target").boundingBox())!.x;
  const home = await x();
  await page.getByRole("application", { name: /robot and its world/ }).focus();
  for (let i = 0; i < 6; i++) await page.keyboard.press("ArrowRight");
  await expect.poll(async () => Math.abs((await x()) - home)).toBeGreaterThan(5);
  await page.keyboard.press("Home");
  await expect.poll(x).toBeCloseTo(home, 0);
});
