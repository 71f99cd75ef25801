const SVG = "http://www.w3.org/2000/svg";

// An element with attributes and children; strings become text.
export function element(name, attributes = {}, children = []) {
  return filled(document.createElement(name), attributes, children);
}

export function svg(name, attributes = {}, children = []) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, String(value));
  node.append(...(Array.isArray(children) ? children : [String(children)]));
  return node;
}

export function number(value, digits, unit = "") {
  return value === null || value === undefined ? "–" : `${value.toFixed(digits)}${unit}`;
}

export function spread(value, sigma, digits, unit) {
  const told = number(value, digits);
  return sigma === null || sigma === undefined ? told + unit : `${told} ± ${number(sigma, digits)}${unit}`;
}
