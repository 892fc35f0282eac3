// The page in Firefox, opened from its file: node --test studies/web/tests/firefox.mjs
//
// Skipped without Firefox; ROCKING_BLOCK_SKIPPED then names the file of skipped tests.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { accessSync, appendFileSync, mkdirSync } from "node:fs";
import { delimiter, dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { launch } from "puppeteer-core";

const root = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.ROCKING ?? join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "release", "rocking");
const screenshots = join(root, "target/web/screenshots");

function firefox() {
  for (const folder of process.env.PATH.split(delimiter)) {
    for (const name of ["firefox", "firefox-esr"]) {
      try {
        accessSync(join(folder, name));
        return join(folder, name);
      } catch {
        // Look further.
      }
    }
  }
  return null;
}

test("the page runs in Firefox and gives the bytes of the program", async (t) => {
  const executablePath = firefox();
  if (!executablePath) {
    const reason = "Firefox is not installed";
    if (process.env.ROCKING_BLOCK_SKIPPED) appendFileSync(process.env.ROCKING_BLOCK_SKIPPED, `studies/web/tests/firefox.mjs: ${reason}\n`);
    return t.skip(reason);
  }
  // The window has the size of the page: not each release of Firefox knows all commands by which Puppeteer would set it.
  const browser = await launch({ browser: "firefox", executablePath, defaultViewport: null, args: ["--width=1360", "--height=900"] });
  try {
    const page = await browser.newPage();
    const faults = [];
    page.on("pageerror", (error) => faults.push(error.message));
    await page.goto(`${pathToFileURL(join(root, "target/web/rocking.html"))}#scale=3&friction=0.3&foundation=rigid`);
    await page.waitForFunction("Number(document.documentElement.dataset.runs ?? 0) >= 1");
    // The table in the form in which it is saved.
    const table = await page.evaluate(async () => {
      const saved = new Promise((resolve) => {
        const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => (resolve(blob), make.call(URL, blob));
      });
      document.getElementById("save-csv").click();
      return (await saved).text();
    });
    const words = (await page.$eval("#command", ({ textContent }) => textContent)).split(" ");
    const args = words.slice(1).map((word) => (word === "history.csv" ? "-" : word));
    const expected = execFileSync(program, args, { cwd: root, maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"] });
    assert.ok(table === expected.toString(), words.join(" "));
    await page.focus("#field-scale input[type=range]");
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction("Number(document.documentElement.dataset.runs) >= 2");
    mkdirSync(screenshots, { recursive: true });
    await page.screenshot({ path: join(screenshots, "firefox.png"), fullPage: true });
    assert.deepEqual(faults, []);
  } finally {
    await browser.close();
  }
});
