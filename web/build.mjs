// Bundles the report's script and style into the Python package, with the notices of what they
// hold of others. With --check it writes nothing and fails where the committed files differ.
import { build } from "esbuild";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const target = join(here, "../src/panoplan/exporters/report");
const result = await build({
  absWorkingDir: here,
  entryPoints: { report: "report/main.js" },
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  outdir: target,
  write: false,
  metafile: true,
});
const made = new Map(result.outputFiles.map((file) => [file.path, file.text]));
made.set(join(target, "NOTICES.txt"), notices(Object.keys(result.metafile.inputs)));

const stale = [];
for (const [path, text] of made) {
  if (process.argv.includes("--check")) {
    if (!existsSync(path) || readFileSync(path, "utf8") !== text) stale.push(path);
  } else {
    writeFileSync(path, text);
  }
}
if (stale.length) {
  console.error(`not as the sources make it: ${stale.join(", ")}; run npm run build`);
  process.exit(1);
}

function notices(inputs) {
  const names = new Set();
  for (const input of inputs) {
    const found = input.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)\//);
    if (found) names.add(found[1]);
  }
  const parts = [...names].sort().map((name) => {
    const folder = join(here, "node_modules", name);
    const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const file = readdirSync(folder).find((item) => /^licen[cs]e/i.test(item));
    const text = file ? readFileSync(join(folder, file), "utf8").trim() : "(no licence text)";
    return `${name} ${about.version} (${about.license})\n\n${text}\n`;
  });
  return `The script and style of the report hold code of these packages.\n\n${parts.join("\n---\n\n")}`;
}
