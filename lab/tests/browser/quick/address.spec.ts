import { expect, test } from "@playwright/test";
import { open, run } from "../page";

test("garbage in a link is named, and the rest is followed", async ({ page }) => {
  await open(page, "agent=conjunctive&seed=minus-one&speling=1");
  const alert = page.getByRole("alert");
  await expect(alert).toContainText("seed: “minus-one”");
  await expect(alert).toContainText("speling: no such key");
  await expect(page.getByLabel("First agent")).toHaveValue("hebb conjunctive");
  expect(page.url()).toMatch(/#agent=conjunctive$/);
});

test("a link that the engine refuses opens the default, and says why", async ({ page }) => {
  await open(page, "config.body.muscles.kp=-5");
  await expect(page.getByRole("alert")).toContainText("kp");
  await expect(page.getByLabel("stiffness of the arm's muscles", { exact: true })).toBeVisible();
  expect(page.url()).not.toContain("kp");
});

test("a change is in the address, and back takes it away", async ({ page }) => {
  await open(page, "agent=conjunctive");
  await run(page, "Babble 100 ×");
  const radius = page.getByLabel("radius of the obstacle, as a number");
  await radius.fill("0.03");
  await radius.press("Enter");
  await expect(page).toHaveURL(/config\.body\.obstacle\.radius_m=0\.03$/);
  await expect(page.getByText(/^100 of/)).toBeVisible();
  await page.goBack();
  await expect(page).toHaveURL(/#agent=conjunctive$/);
  await expect(radius).toHaveValue("0.035");
  await expect(page.getByText(/^100 of/)).toBeVisible();
});

test("forward and back through views and changes end where they began", async ({ page }) => {
  await open(page, "agent=conjunctive");
  await page.getByRole("radio", { name: "Eye" }).check();
  await page.getByLabel("Second agent, beside it").selectOption("random");
  await page.getByRole("radio", { name: "Brain" }).check();
  await expect(page).toHaveURL(/agent=conjunctive&agent2=random&view=brain$/);
  for (const address of [/agent2=random&view=eye$/, /conjunctive&view=eye$/, /#agent=conjunctive$/]) {
    await page.goBack();
    await expect(page).toHaveURL(address);
  }
  await page.goForward();
  await page.goForward();
  await expect(page).toHaveURL(/agent2=random&view=eye$/);
  await expect(page.getByLabel("Second agent, beside it")).toHaveValue("random");
});

test("a link hides controls and chooses the view", async ({ page }) => {
  await open(page, "view=eye&hide=sliders,rule");
  await expect(page.getByRole("heading", { name: "Eye" })).toBeVisible();
  await expect(page.getByRole("heading", { name: "Brain" })).toHaveCount(0);
  await expect(page.getByRole("heading", { name: "Numbers of the model" })).toHaveCount(0);
});
