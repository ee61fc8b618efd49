import { readFile } from "node:fs/promises";
import { expect, type Page, test } from "@playwright/test";
import { button, lastTest, open, run } from "../page";

const unfold = (page: Page, title: string) => page.getByRole("heading", { name: title }).click();

test("two agents are beside each other on the same case", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await page.getByLabel("Second agent, beside it").selectOption("scripted");
  await expect(page).toHaveURL(/agent2=scripted/);
  await run(page, "Babble 100 ×");
  await page.getByLabel("playing speed").selectOption("Infinity");
  await run(page, "Play");
  await expect(page.locator(".status")).toContainText(/first agent .*, second agent /);
  await page.getByRole("radio", { name: "Second agent (Scripted)" }).check();
  await expect(page.getByText("This agent has no maps")).toBeVisible();
});

test("a trained policy plays beside Hebb", async ({ page }) => {
  await open(page, "agent=conjunctive&agent2=policy:reach&view=brain");
  await expect(page.getByLabel("Second agent, beside it")).toHaveValue("policy reach");
  await run(page, "Test on 100 cases");
  await expect(page.locator(".status")).toContainText(/Tested: \d+ % and [89]\d %/);
});

test("an own rule is checked while it is typed, and learns beside the usual one", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await unfold(page, "Learning rule in one line");
  const rule = page.getByRole("textbox", { name: /Δw/ });
  await rule.fill("eta*(a-gmean)");
  await expect(page.locator("#rule-wrong")).toContainText("At character");
  await expect(button(page, "Learn by it")).toBeDisabled();
  await button(page, "Eq. 7").click();
  await expect(page.locator("#rule-wrong")).toBeEmpty();
  await button(page, "Learn by it, beside the usual rule").click();
  await expect(page).toHaveURL(/rule=eta\*/);
  await run(page, "Babble 100 ×");
  await run(page, "Test on 100 cases");
  const said = (await page.locator(".status p").first().textContent())!;
  const [first, second] = [...said.matchAll(/(\d+) %/g)].map(([, share]) => Number(share));
  // Eq. 7 in a line is Eq. 7, but for the last bits.
  expect(Math.abs(first! - second!)).toBeLessThanOrEqual(3);
});

test("a lesion by the brush makes success fall, and undo mends it", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await run(page, "Babble 1,000 ×");
  await run(page, "Test on 100 cases");
  const whole = await lastTest(page);
  await page.getByLabel(/brush: silence/).check();
  await page.getByLabel("brush radius").fill("5");
  const map = page.getByRole("application", { name: /^Output/ });
  const box = (await map.boundingBox())!;
  await page.mouse.move(box.x + 5, box.y + 5);
  await page.mouse.down();
  for (let share = 0; share < 1; share += 0.05)
    await page.mouse.move(box.x + share * box.width, box.y + share * box.height);
  await page.mouse.up();
  await expect(page.locator(".status")).toContainText(/\d+ neurons of “movement” silenced/);
  await run(page, "Test on 100 cases");
  await expect.poll(() => lastTest(page)).toBeLessThan(whole - 20);
  await page.getByRole("button", { name: /^Undo/ }).click();
  await page.getByRole("button", { name: /^Undo/ }).click();
  await expect(map).not.toHaveAccessibleName(/silenced/);
});

test("an agent is saved and loaded, Python is shown, a record is downloaded", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await run(page, "Babble 100 ×");
  await unfold(page, "Take it with you");
  const [agent] = await Promise.all([page.waitForEvent("download"), button(page, "Save the agent").click()]);
  const bytes = await readFile(await agent.path());
  expect(agent.suggestedFilename()).toBe("agent-reach.safetensors");

  await page.getByLabel("your name").fill("Ada L.");
  const handIn = button(page, "Download what you did, to hand in");
  const [record] = await Promise.all([page.waitForEvent("download"), handIn.click()]);
  expect(record.suggestedFilename()).toBe("lab-Ada-L-.json");
  expect(JSON.parse(await readFile(await record.path(), "utf8"))).toMatchObject({
    name: "Ada L.",
    commands: [{ do: "babble", n: 100 }],
    hash: expect.stringMatching(/^[0-9a-f]{16}$/),
  });

  await button(page, "Open in Python").click();
  await expect(page.getByRole("dialog")).toContainText('variant="conjunctive"');
  await button(page, "Close").click();

  await page
    .getByLabel("Load an agent")
    .setInputFiles({ name: "a.safetensors", mimeType: "", buffer: bytes });
  await expect(page.getByText(/^100 of/)).toBeVisible();
  await page
    .getByLabel("Load an agent")
    .setInputFiles({ name: "b.safetensors", mimeType: "", buffer: Buffer.from("no") });
  await expect(page.getByRole("alert")).not.toBeEmpty();
  await expect(page.getByText(/^100 of/)).toBeVisible();
});

test("beginning anew asks first, and takes a seed", async ({ page }) => {
  await open(page, "view=brain");
  await run(page, "Babble once");
  await page.getByLabel("seed").fill("7");
  page.once("dialog", (dialog) => void dialog.dismiss());
  await button(page, "Begin anew").click();
  await expect(page.getByText(/^1 of/)).toBeVisible();
  page.once("dialog", (dialog) => void dialog.accept());
  await button(page, "Begin anew").click();
  await expect(page.getByText(/^0 of 0/)).toBeVisible();
  await expect(page).toHaveURL(/#seed=7/);
});

test("each slider and choice changes the address, and its default takes it away", async ({ page }) => {
  for (const env of ["BabbleReach-v0", "BabbleGrasp-v0"]) {
    await open(page, `env=${env}&view=eye`);
    const rows = page.locator(".slider");
    const plain = page.url();
    for (const row of await rows.all()) {
      const range = row.getByRole("slider");
      if ((await range.count()) > 0) {
        await range.focus();
        const value = Number(await range.inputValue());
        const most = Number(await range.getAttribute("max"));
        await page.keyboard.press(value < most ? "ArrowRight" : "ArrowLeft");
      } else {
        const select = row.getByRole("combobox");
        await select.selectOption((await select.inputValue()) === "0" ? "1" : "0");
      }
      await expect(page, (await row.textContent()) ?? "").not.toHaveURL(plain);
      await row.getByRole("button").click();
      await expect(page).toHaveURL(plain);
    }
    await expect(page.getByRole("alert")).toBeEmpty();
  }
});

test("the task changes, with an agent that knows it", async ({ page }) => {
  await open(page, "agent=conjunctive&view=brain");
  await page.getByLabel("Task").selectOption("BabbleGrasp-v0");
  await expect(page.getByLabel("First agent")).toHaveValue("hebb paper");
  await run(page, "Babble once");
  await page.getByLabel("First agent").selectOption("hebb chain");
  await page.getByLabel("Task").selectOption("BabbleGraspFull-v0");
  await expect(page.getByLabel("First agent")).toHaveValue("hebb chain");
  await expect(page.getByRole("alert")).toBeEmpty();
});
