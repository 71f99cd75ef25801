// Opens a report in headless Chromium as people use it, and prints what happened as JSON.
// Usage: node browser.mjs REPORT.html SCREENSHOT.png [CHROMIUM]
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [report, screenshot, executablePath = "/usr/bin/chromium"] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const args = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const browser = await chromium.launch({ executablePath, args });
// The page's policy lets no script but its own run; axe is one.
const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, bypassCSP: true, offline: true });
const page = await context.newPage();
const errors = [];
const requests = [];
page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
page.on("pageerror", (error) => errors.push(String(error)));
page.on("request", (request) => /^https?:/.test(request.url()) && requests.push(request.url()));
page.on("dialog", (dialog) => { errors.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
page.setDefaultTimeout(120_000);

await page.goto(pathToFileURL(report).href);
await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
const told = {};
told.title = await page.title();
told.rooms = await page.locator("path.room").count();
told.scripts = await page.locator("#report script, #report img[onerror]").count();

const room = page.locator("path.room").first();
await room.dispatchEvent("pointerenter");
told.hovered = await page.locator(".told").innerText();
await page.locator("path.room").last().focus();
told.focused = await page.locator(".told h3").innerText();

if (await page.locator("canvas.model").count()) {
  await page.locator("canvas.model").scrollIntoViewIfNeeded();
  await page.waitForFunction(() => document.querySelector("canvas.model").dataset.shown === "yes");
  const shade = () => page.evaluate(() => document.querySelector("canvas.model").toDataURL().length);
  const before = await page.evaluate(() => document.querySelector("canvas.model").toDataURL());
  await page.locator("canvas.model").press("ArrowLeft");
  const after = await page.evaluate(() => document.querySelector("canvas.model").toDataURL());
  told.model = { bytes: await shade(), turned: before !== after };
}

const camera = page.locator("circle.camera[role=button]").first();
if (await camera.count()) {
  await camera.focus();
  await camera.press("Enter");
  await page.waitForFunction(() => document.querySelector(".viewer").dataset.shown);
  const yaw = () => page.evaluate(() => document.querySelector(".viewer").viewer.getPosition().yaw);
  const before = await yaw();
  const box = await page.locator(".viewer canvas").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 150, box.y + box.height / 2, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction((yaw) => document.querySelector(".viewer").viewer.getPosition().yaw !== yaw, before);
  told.panorama = {
    shown: await page.evaluate(() => document.querySelector(".viewer").dataset.shown),
    before, after: await yaw(),
  };
}

await page.evaluate(axe);
const found = await page.evaluate(() => window.axe.run());
told.axe = found.violations
  .filter((item) => ["serious", "critical"].includes(item.impact))
  .map((item) => `${item.id}: ${item.nodes.length} × ${item.nodes[0].target} ${item.help}`);
await page.screenshot({ path: screenshot, fullPage: true });
await page.emulateMedia({ media: "print" });
told.print = await page.evaluate(() =>
  ["plan", "rooms", "model"].filter((id) => {
    const node = document.getElementById(id);
    return node && getComputedStyle(node).display !== "none";
  }),
);
await browser.close();
console.log(JSON.stringify({ ...told, errors, requests }));
