/** What a student does in each lesson, by the controls of the page: an entry for each task. */
import { expect, type Page } from "@playwright/test";
import { button, run } from "./page";

type Deed = (page: Page) => Promise<void>;

const babble =
  (...buttons: string[]): Deed =>
  async (page) => {
    for (const name of buttons) await run(page, name);
  };

const test: Deed = async (page) => {
  await page.getByRole("button", { name: /^Test on/ }).click();
  await expect(page.locator(".status")).toContainText("Tested:", { timeout: 60_000 });
};

const next: Deed = (page) => button(page, "Next case").click();

const setUp =
  (task: number): Deed =>
  async (page) => {
    await page.locator(".lesson .task").nth(task).getByRole("button", { name: "Set this up" }).click();
  };

const playUntil =
  (outcome: RegExp): Deed =>
  async (page) => {
    await page.getByLabel("playing speed").selectOption("Infinity");
    for (let episodes = 0; episodes < 40; episodes++) {
      await next(page);
      await expect(button(page, "One step")).toBeEnabled();
      await button(page, "Play").click();
      await expect(button(page, "One step")).toBeDisabled({ timeout: 60_000 });
      await expect(page.locator(".status")).toContainText("The episode ended");
      if (outcome.test((await page.locator(".status p").first().textContent())!)) return;
    }
    throw new Error(`no episode ended in ${outcome}`);
  };

const move =
  (part: string, key: string): Deed =>
  async (page) => {
    await page.locator(`.scene-handle[data-part="${part}"]`).focus();
    await page.keyboard.press(key);
    await page.keyboard.press("Enter");
  };

const playAlongThePalm =
  (centimetres: number): Deed =>
  async (page) => {
    const number = page.getByLabel("Ball along the palm, from the wrist, as a number");
    await number.fill(String(centimetres));
    await number.press("Enter");
    await expect(button(page, "One step")).toBeEnabled();
    await run(page, "Play");
  };

const silenceHalf: Deed = async (page) => {
  await page.getByLabel(/brush: silence/).check();
  await page.getByLabel("brush radius").fill("5");
  const map = page.getByRole("application", { name: /^Input “/ });
  const box = (await map.boundingBox())!;
  await page.mouse.move(box.x + 0.2 * box.width, box.y + 2);
  await page.mouse.down();
  for (const x of [0.2, 0.4]) {
    for (let y = 0; y < 1; y += 0.04) await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
  }
  await page.mouse.up();
};

const ownRule: Deed = async (page) => {
  await page.getByRole("textbox", { name: /Δw/ }).fill("eta*(a-a_mean)*(g-g_mean)*(w_max-abs(w))");
  await run(page, "Learn by it");
};

const times = (n: number, name: string) => babble(...Array.from({ length: n }, () => name));

export const DEEDS: Record<string, Deed[][]> = {
  equilibrium: [[playUntil(/./)], [setUp(1), playUntil(/./)], [setUp(2), playUntil(/collision/), test]],
  eye: [[next, move("target", "ArrowDown")], [move("obstacle", "ArrowDown")], [setUp(2), next]],
  "population-codes": [
    [next, move("obstacle", "ArrowDown")],
    [setUp(1), next],
    [setUp(2), times(5, "Babble 100 ×"), test],
    [silenceHalf, test],
  ],
  "pattern-generators": [[playUntil(/success/)], [playUntil(/collision/)], [test], [setUp(3), test]],
  hebb: [
    [babble("Babble 1,000 ×"), test],
    [setUp(1), babble("Babble 1,000 ×"), test],
    [setUp(2), ownRule, times(3, "Babble 100 ×"), test],
  ],
  "why-reaching-fails": [
    [babble("Babble 1,000 ×"), test],
    [setUp(1), babble("Babble 1,000 ×"), test],
    [setUp(2), times(3, "Babble 100 ×"), test],
    [setUp(3), babble("Babble 1,000 ×"), test],
  ],
  reflex: [
    [babble("Babble 100 ×"), test],
    [setUp(1), test, playUntil(/success/)],
    [setUp(2), test, playUntil(/timeout/)],
    [setUp(3), playAlongThePalm(2), playAlongThePalm(4)],
  ],
  chain: [
    [times(10, "Babble once"), test, babble("Babble 100 ×"), test],
    [setUp(1), test, playUntil(/success/)],
    [setUp(2), babble("Babble 100 ×"), test],
  ],
  "hebb-and-ppo": [
    [times(3, "Babble 100 ×"), test],
    [playUntil(/./)],
    [setUp(2), test],
    [times(4, "Babble 1,000 ×"), test],
  ],
};
