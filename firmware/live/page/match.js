// The last match: the bird's-eye view, and the distribution of the correction on each axis.
import {byId, classColours, colour, drawVehicle, element, prepare, strokeLines} from "./drawing.js";
import {shown} from "./state.js";

const AXES = [
  {key: "x", title: "longitudinal", unit: "m", level: "longitudinal_m"},
  {key: "y", title: "lateral", unit: "m", level: "lateral_m"},
  {key: "yaw", title: "yaw", unit: "°", level: "yaw_deg"},
];

export function makePlots() {
  for (const axis of AXES) {
    const plot = element("div");
    const title = element("h3", axis.title);
    axis.value = element("b", "–");
    title.append(axis.value);
    axis.canvas = element("canvas");
    axis.canvas.setAttribute("role", "img");
    axis.canvas.setAttribute("aria-label", "Distribution of the " + axis.title + " correction");
    plot.append(title, axis.canvas);
    byId("plots").append(plot);
  }
}

/// The mask as an image of 200 x 100 pixels, the vehicle driving to the right.
function maskImage(match, colours) {
  const cols = match.mask_cols;
  const rows = match.mask.length / cols;
  const canvas = document.createElement("canvas");
  canvas.width = rows;
  canvas.height = cols;
  const context = canvas.getContext("2d");
  const image = context.createImageData(rows, cols);
  const rgb = colours.map((text) => [1, 3, 5].map((at) => parseInt(text.substr(at, 2), 16)));
  for (let row = 0; row < rows; row++) {
    for (let col = 0; col < cols; col++) {
      const value = match.mask.charCodeAt(row * cols + col) - 48;
      const at = 4 * (col * rows + (rows - 1 - row));
      for (let kind = 0; kind < 3; kind++) {
        const level = (value >> (2 * kind)) & 3;
        if (level * 70 <= image.data[at + 3]) continue;
        image.data.set([...rgb[kind], level * 70], at);
      }
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

function drawBev() {
  const {context, width, height} = prepare(byId("bev"));
  const match = shown.match;
  if (!match) return;
  const colours = classColours();
  const length_m = match.mask.length / match.mask_cols * match.mask_cell_m;
  const scale = width / length_m;
  const place = (x, y) => [width / 2 + x * scale, height / 2 - y * scale];
  context.imageSmoothingEnabled = true;
  context.drawImage(maskImage(match, colours), 0, 0, width, height);
  context.lineWidth = 1;
  context.globalAlpha = 0.7;
  context.setLineDash([4, 4]);
  strokeLines(context, match.prior, colours, place);
  context.globalAlpha = 1;
  context.setLineDash([]);
  context.lineWidth = 1.5;
  strokeLines(context, match.corrected, colours, place);
  drawVehicle(context, width / 2, height / 2, Math.max(scale, 4), 0);
}

function signed(value, unit) {
  return (value < 0 ? "−" : "+") + Math.abs(value).toFixed(2) + " " + unit;
}

function drawPlot(axis, index) {
  const {context, width, height} = prepare(axis.canvas);
  const match = shown.match;
  if (!match) return;
  const {step, probability} = match[axis.key];
  const base = height - 14;
  const bar = width / probability.length;
  const highest = Math.max(...probability, 1e-6);
  const middle = (value) => width / 2 + value / step * bar;
  const pose = shown.status && shown.status.pose;
  const correction = match.correction[index];
  if (pose && match.evidence) {
    const level = pose.protection_level[axis.level];
    context.fillStyle = colour("level");
    context.fillRect(middle(correction - level), 0, 2 * level / step * bar, base);
  }
  context.fillStyle = colour("bar");
  probability.forEach((value, i) => {
    const size = value / highest * (base - 2);
    context.fillRect(i * bar + 0.5, base - size, Math.max(bar - 1, 1), size);
  });
  context.strokeStyle = colour("rule");
  context.beginPath();
  context.moveTo(0, base + 0.5);
  context.lineTo(width, base + 0.5);
  context.stroke();
  if (match.evidence) {
    context.strokeStyle = colour("ink");
    context.beginPath();
    context.moveTo(middle(correction), 0);
    context.lineTo(middle(correction), base);
    context.stroke();
  }
  context.fillStyle = colour("soft");
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "bottom";
  const end = (probability.length - 1) / 2 * step;
  context.textAlign = "left";
  context.fillText("−" + end.toFixed(1) + " " + axis.unit, 0, height);
  context.textAlign = "center";
  context.fillText("0", width / 2, height);
  context.textAlign = "right";
  context.fillText("+" + end.toFixed(1) + " " + axis.unit, width, height);
  axis.value.textContent = (match.evidence ? signed(correction, axis.unit) : "no evidence") +
    (pose ? " · PL " + pose.protection_level[axis.level].toFixed(2) + " " + axis.unit : "");
}

export function drawMatch() {
  drawBev();
  AXES.forEach(drawPlot);
}

export function onMatch(match) {
  shown.match = match;
  shown.matchAt_ms = performance.now();
  drawMatch();
}
