// Puts the report together. All text comes from the data and is set as text, never as markup.
import "@photo-sphere-viewer/core/index.css";
import "./style.css";
import { curve } from "./curve.js";
import { element } from "./element.js";
import { modelView } from "./model.js";
import { panoramaView } from "./panorama.js";
import { planView } from "./plan.js";
import { cameraTable, roomTable, skippedTable } from "./tables.js";

const data = JSON.parse(document.getElementById("data").textContent);
const page = document.getElementById("report");

const header = element("header", {}, [
  element("h1", {}, data.title),
  element("p", {}, data.summary),
  element("p", { class: "quiet" }, data.metres),
]);
const panorama = panoramaView(data);
const plan = planView(data, panorama.show);
const main = element("main", {}, [
  section("plan", "Plan", [plan]),
  panorama.element && section("panoramas", "Panoramas", [panorama.element]),
  data.model && section("model", "Model", [modelView(data)]),
  section("rooms", "Rooms", [roomTable(data), element("p", { class: "quiet" }, data.area_rule)]),
  section("scale", "Scale", [element("p", {}, data.scale.told), curve(data.scale)]),
  section("skipped", "Left out", [skippedTable(data)]),
  section("cameras", "Cameras", [cameraTable(data)]),
].filter(Boolean));
const footer = element("footer", {}, [
  element("p", { class: "quiet" }, `panoplan ${data.version}`),
  element("details", {}, [
    element("summary", {}, "Notices of third parties"),
    element("pre", { tabindex: "0", "aria-label": "Notices of third parties" }, data.notices),
  ]),
]);
page.replaceChildren(header, main, footer);
document.documentElement.dataset.ready = "yes";

function section(id, title, children) {
  const heading = element("h2", { id: `${id}-title` }, title);
  return element("section", { id, "aria-labelledby": `${id}-title` }, [heading, ...children]);
}
