// What the search for the scale minimised.
import { element, svg } from "./element.js";

export function curve(scale) {
  if (!scale.curve || scale.curve.length < 2) return element("p", { class: "quiet" }, scale.no_curve);
  const [width, height, left, foot] = [640, 260, 60, 40];
  const xs = scale.curve.map(([s]) => s);
  const ys = scale.curve.map(([, value]) => value);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const x = (s) => left + ((s - x0) / (x1 - x0 || 1)) * (width - left - 10);
  const y = (v) => 10 + (1 - (v - y0) / (y1 - y0 || 1)) * (height - foot - 10);
  const points = scale.curve.map(([s, v]) => `${x(s).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
  const axis = `M${left} 10V${height - foot}H${width - 10}`;
  const words = `Objective of the search, by scale, from ${x0.toPrecision(3)} to ${x1.toPrecision(3)}`;
  const text = (at, anchor, content) => svg("text", { ...at, "text-anchor": anchor }, content);
  const children = [
    svg("path", { d: axis, class: "axis" }),
    svg("polyline", { points, class: "curve" }),
    text({ x: left, y: height - foot + 16 }, "start", x0.toPrecision(3)),
    text({ x: width - 10, y: height - foot + 16 }, "end", x1.toPrecision(3)),
    text({ x: (left + width) / 2, y: height - 8 }, "middle", "camera heights a trajectory unit"),
    text({ x: left - 6, y: 18 }, "end", y1.toPrecision(4)),
    text({ x: left - 6, y: height - foot }, "end", y0.toPrecision(4)),
  ];
  if (scale.value !== null && scale.value >= x0 && scale.value <= x1) {
    children.push(svg("path", { d: `M${x(scale.value)} 10V${height - foot}`, class: "found" }));
  }
  const drawing = { viewBox: `0 0 ${width} ${height}`, class: "chart", role: "img", "aria-label": words };
  return svg("svg", drawing, children);
}
