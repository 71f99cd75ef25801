import { element, number, spread } from "./element.js";

export function roomTable(data) {
  const rows = data.storeys.flatMap((storey) =>
    storey.rooms.map((room) => [
      room.name, storey.name, spread(room.area, room.area_sigma, 2, " m²"),
      number(room.perimeter, 2, " m"), number(room.ceiling, 2, " m"), String(room.keyframes.length),
    ]),
  );
  const missing = data.missing.map((room) => [room.name, room.storey, room.reason, "–", "–", room.count]);
  const heads = ["Room", "Storey", "Area", "Perimeter", "Ceiling", "Keyframes"];
  return table("Rooms", heads, [...rows, ...missing]);
}

export function skippedTable(data) {
  if (!data.skipped.length) return element("p", {}, "Nothing was left out.");
  const rows = data.skipped.map((item) => [item.keyframe, item.what, item.reason, String(item.count)]);
  return table("Left out", ["Keyframe", "What", "Why", "Times"], rows);
}

export function cameraTable(data) {
  const rows = data.storeys.flatMap((storey) =>
    storey.cameras.map((camera) => [
      camera.id, storey.name, camera.room ?? "–",
      `${number(camera.position[0], 2)}, ${number(camera.position[1], 2)} m`,
    ]),
  );
  return table("Cameras", ["Keyframe", "Storey", "Room", "Place"], rows);
}

function table(title, heads, rows) {
  const head = heads.map((word) => element("th", { scope: "col" }, word));
  const body = rows.map(([first, ...rest]) =>
    element("tr", {}, [
      element("th", { scope: "row" }, first),
      ...rest.map((cell) => element("td", {}, cell)),
    ]),
  );
  const scroll = { class: "scroll", tabindex: "0", role: "region", "aria-label": `Table: ${title}` };
  return element("div", scroll, [
    element("table", {}, [element("thead", {}, [element("tr", {}, head)]), element("tbody", {}, body)]),
  ]);
}
