// The plan of each storey: rooms tell of themselves when pointed at or focused.
import { element, number, spread, svg } from "./element.js";

export function planView(data, showPanorama) {
  const told = element("div", { class: "told", role: "status", "aria-live": "polite" }, [
    element("p", {}, "Point at a room, or move to it with the Tab key."),
  ]);
  const storeys = data.storeys.map((storey) => {
    const drawing = draw(storey, data, told, showPanorama);
    return element("figure", {}, [drawing, element("figcaption", {}, storey.name)]);
  });
  return element("div", { class: "beside" }, [element("div", { class: "storeys" }, storeys), told]);
}

function draw(storey, data, told, showPanorama) {
  const [x0, y0, x1, y1] = storey.bounds;
  const margin = 0.4;
  const box = [x0 - margin, -y1 - margin, x1 - x0 + 2 * margin, y1 - y0 + 2 * margin];
  const node = svg("svg", { viewBox: box.join(" "), class: "plan", role: "group" });
  node.setAttribute("aria-label", `Plan of ${storey.name}`);
  node.append(svg("path", { d: path(storey.walls), class: "solid", "aria-hidden": "true" }));
  for (const room of storey.rooms) node.append(drawRoom(room, told));
  for (const [kind, items] of Object.entries(storey.apertures)) {
    for (const { segment: [a, b], through } of items) {
      const ends = { x1: a[0], y1: -a[1], x2: b[0], y2: -b[1] };
      const width = Math.max(through, 0.05) + 0.04;
      node.append(svg("line", { ...ends, class: "gap", "stroke-width": width, "aria-hidden": "true" }));
      node.append(svg("line", { ...ends, class: kind, "aria-hidden": "true" }));
    }
  }
  for (const room of storey.rooms) if (room.label) node.append(label(room.label));
  for (const camera of storey.cameras) node.append(drawCamera(camera, data, showPanorama));
  return node;
}

function drawRoom(room, told) {
  const words = `${room.name}, ${spread(room.area, room.area_sigma, 1, " m²")}`;
  const node = svg("path", {
    d: path(room.rings), class: "room", fill: room.colour, tabindex: "0", role: "img",
    "aria-label": words, "data-room": room.id,
  });
  const show = () => {
    for (const other of document.querySelectorAll(".room.chosen")) other.classList.remove("chosen");
    node.classList.add("chosen");
    told.replaceChildren(...describe(room));
  };
  node.addEventListener("pointerenter", show);
  node.addEventListener("focus", show);
  return node;
}

function describe(room) {
  const facts = [
    ["Area", spread(room.area, room.area_sigma, 2, " m²")],
    ["Ceiling", number(room.ceiling, 2, " m")],
    ["Keyframes", room.keyframes.join(", ") || "–"],
  ];
  if (room.flags.length) facts.push(["To be known", room.flags.join(", ")]);
  const list = facts.flatMap(([key, value]) => [element("dt", {}, key), element("dd", {}, value)]);
  const rows = room.walls.map((wall) =>
    element("tr", {}, [
      element("th", { scope: "row" }, wall.id),
      element("td", {}, spread(wall.length, wall.length_sigma, 2, " m")),
      element("td", {}, wall.sigma === null ? "–" : `± ${number(100 * wall.sigma, 1, " cm")}`),
    ]),
  );
  const head = ["Wall", "Length", "Lies"].map((word) => element("th", { scope: "col" }, word));
  return [
    element("h3", {}, room.name),
    element("dl", {}, list),
    element("table", {}, [element("thead", {}, [element("tr", {}, head)]), element("tbody", {}, rows)]),
  ];
}

function label({ at: [x, y], lines, size }) {
  const first = -y + (0.35 - 0.6 * (lines.length - 1)) * size;
  return svg("g", { class: "label", "aria-hidden": "true" }, lines.map((line, row) =>
    svg("text", { x, y: first + 1.2 * size * row, "text-anchor": "middle", "font-size": size }, line),
  ));
}

function drawCamera(camera, data, showPanorama) {
  const [x, y] = camera.position;
  const dot = { cx: x, cy: -y, r: 0.09 };
  if (!(camera.id in data.panoramas)) {
    return svg("circle", { ...dot, class: "camera blind", "aria-hidden": "true" });
  }
  const node = svg("circle", {
    ...dot, r: 0.13, class: "camera", tabindex: "0", role: "button",
    "aria-label": `Panorama of ${camera.id}`, "data-camera": camera.id,
  });
  node.addEventListener("click", () => showPanorama(camera.id));
  node.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    showPanorama(camera.id);
  });
  return node;
}

function path(rings) {
  return rings.map((ring) => `M${ring.map(([x, y]) => `${x} ${-y}`).join("L")}Z`).join("");
}
