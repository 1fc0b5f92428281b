// Functions for drawing that all parts of the page use.

export const byId = (id) => document.getElementById(id);

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

export function classColours() {
  return [colour("divider"), colour("crossing"), colour("boundary")];
}

export function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

/// Writes a text only if it differs, so that a selection stays and a screen reader does not repeat it.
export function setText(node, text) {
  const wanted = String(text);
  if (node.textContent !== wanted) node.textContent = wanted;
}

/// Replaces the children of `parent` by these. A child that equals the present one in its place is
/// left alone.
export function setChildren(parent, children) {
  children.forEach((child, index) => {
    const present = parent.children[index];
    if (!present) parent.append(child);
    else if (!present.isEqualNode(child)) present.replaceWith(child);
  });
  while (parent.children.length > children.length) parent.lastElementChild.remove();
}

export function setTitle(state) {
  const wanted = state + " · bevloc";
  if (document.title !== wanted) document.title = wanted;
}

/// A drawing context in CSS pixels, and the size of the canvas in them.
export function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return {context, width, height};
}

/// Lines are arrays [class, x, y, x, y, ...]; `place` turns a point into pixels.
export function strokeLines(context, lines, colours, place) {
  for (const line of lines || []) {
    context.strokeStyle = colours[line[0]];
    context.beginPath();
    for (let i = 1; i + 1 < line.length; i += 2) {
      const [x, y] = place(line[i], line[i + 1]);
      if (i === 1) context.moveTo(x, y); else context.lineTo(x, y);
    }
    context.stroke();
  }
}

export function drawVehicle(context, x, y, scale, heading_rad) {
  context.save();
  context.translate(x, y);
  context.rotate(-heading_rad);
  context.fillStyle = colour("vehicle");
  context.beginPath();
  context.moveTo(3.7 * scale, 0);
  context.lineTo(-1 * scale, -1.1 * scale);
  context.lineTo(-0.2 * scale, 0);
  context.lineTo(-1 * scale, 1.1 * scale);
  context.closePath();
  context.fill();
  context.restore();
}
