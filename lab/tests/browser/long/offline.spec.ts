import { expect, test } from "@playwright/test";
import { open, run } from "../page";

test("it works again without a network", async ({ page, context }) => {
  await open(page);
  await page.evaluate(() => navigator.serviceWorker.ready);
  await context.setOffline(true);
  await page.reload();
  await expect(page.getByRole("heading", { name: "Controls" })).toBeVisible();
  await expect(page.locator(".scene canvas")).toBeVisible();
  await run(page, "Babble 100 ×");
  await expect(page.getByText(/^100 of/)).toBeVisible();
});

test("two tabs know nothing of each other", async ({ context }) => {
  const [one, two] = [await context.newPage(), await context.newPage()];
  await open(one, "view=brain");
  await open(two, "agent=conjunctive&view=brain");
  await run(one, "Babble 100 ×");
  await run(two, "Babble once");
  await expect(one.getByText(/^100 of/)).toBeVisible();
  await expect(two.getByText(/^1 of/)).toBeVisible();
  await expect(one.getByLabel("First agent")).toHaveValue("hebb paper");
});

test("nothing is fetched from another host", async ({ page, baseURL }) => {
  const others: string[] = [];
  page.on("request", (request) => {
    if (!request.url().startsWith(baseURL!) && !/^(data|blob):/.test(request.url()))
      others.push(request.url());
  });
  await open(page, "agent2=policy:reach");
  await expect(page.locator(".scene canvas")).toBeVisible();
  await run(page, "Babble 100 ×");
  expect(others).toEqual([]);
});

test("the manifest makes it installable", async ({ page, request }) => {
  await open(page);
  const href = await page.locator('link[rel="manifest"]').getAttribute("href");
  const manifest = await (await request.get(href!)).json();
  for (const { src } of manifest.icons) expect((await request.get(src)).ok()).toBe(true);
  expect(manifest.start_url).toBe("./");
});
