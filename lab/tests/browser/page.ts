/** What the browser tests have in common. */
import AxeBuilder from "@axe-core/playwright";
import { expect, type Page } from "@playwright/test";

/** Opens the page with a link; errors of the page fail the test. */
export async function open(page: Page, hash = ""): Promise<void> {
  page.on("pageerror", (error) => {
    throw error;
  });
  page.on("console", (message) => {
    if (message.type() === "error") throw new Error(message.text());
  });
  await page.goto(hash === "" ? "./" : `./#${hash}`);
  await expect(page.getByRole("heading", { name: "Controls" })).toBeVisible();
}

export const button = (page: Page, name: string) => page.getByRole("button", { name, exact: true });

/** Presses a button, and waits until the work that it begins has ended. */
export async function run(page: Page, name: string): Promise<void> {
  await button(page, name).click();
  await expect(button(page, "Stop")).toHaveCount(0, { timeout: 60_000 });
}

/** Success in the last test [%]. */
export async function lastTest(page: Page): Promise<number> {
  await expect(page.locator(".status")).toContainText("Tested:");
  return Number.parseInt((await page.locator(".status p").first().textContent())!.match(/(\d+) %/)![1]!, 10);
}

export async function expectAccessible(page: Page): Promise<void> {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const told = violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join("; ")}`);
  expect(told).toEqual([]);
}

/** Whether everything fits the width of the page. */
export async function expectNoSidewaysScroll(page: Page): Promise<void> {
  const [wanted, there] = await page.evaluate(() => [
    document.documentElement.scrollWidth,
    document.documentElement.clientWidth,
  ]);
  expect(wanted).toBeLessThanOrEqual(there!);
}
