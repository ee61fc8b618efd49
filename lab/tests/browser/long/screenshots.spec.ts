/** Pictures of the page to look at; they are kept in test-results. */
import { test } from "@playwright/test";
import { button, expectAccessible, expectNoSidewaysScroll, open, run } from "../page";

const STATES = {
  reach: "agent=conjunctive&agent2=random",
  grasp: "env=BabbleGrasp-v0&agent=chain",
};

for (const [name, hash] of Object.entries(STATES)) {
  for (const view of ["scene", "eye", "brain", "all"]) {
    for (const width of [360, 820, 1400]) {
      test(`${name}, ${view}, ${width} pixels`, async ({ page }, info) => {
        await page.setViewportSize({ width, height: 900 });
        await page.emulateMedia({ colorScheme: width === 820 ? "dark" : "light" });
        await open(page, `${hash}&view=${view}`);
        await run(page, "Babble 100 ×");
        await run(page, `Test on ${name === "reach" ? "100" : "40"} cases`);
        await button(page, "Next case").click();
        await expectNoSidewaysScroll(page);
        await expectAccessible(page);
        await page.screenshot({ path: info.outputPath(`${name}-${view}-${width}.png`), fullPage: true });
      });
    }
  }
}
