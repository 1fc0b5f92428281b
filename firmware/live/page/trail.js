// The vehicle's trail on the map, and the ellipse of its position.
import {byId, classColours, colour, drawVehicle, prepare, strokeLines} from "./drawing.js";
import {shown} from "./state.js";

const ENLARGED = 10;  // drawn this much larger, because the ellipse is smaller than the vehicle
const STEP_M = 0.5;  // the distance between two points of the trail
const POINTS = 2000;
const VIEW_M = 130;  // width of the panel
let interrupted = false;  // whether there was no pose since the last point

function drawEllipse(context, pose, x, y, scale) {
  // Turns the covariance along the vehicle's axes into the half axes of an ellipse of three sigma.
  const a = pose.sigma.longitudinal_m ** 2;
  const d = pose.sigma.lateral_m ** 2;
  const b = pose.longitudinal_lateral_covariance_m2;
  const mean = (a + d) / 2;
  const spread = Math.hypot((a - d) / 2, b);
  const angle = 0.5 * Math.atan2(2 * b, a - d) + pose.yaw_deg * Math.PI / 180;
  context.beginPath();
  const size = 3 * ENLARGED * scale;
  context.ellipse(x, y, size * Math.sqrt(mean + spread), size * Math.sqrt(Math.max(mean - spread, 0)),
    -angle, 0, 2 * Math.PI);
  context.fillStyle = colour("level");
  context.strokeStyle = colour("divider");
  context.lineWidth = 1.5;
  context.fill();
  context.stroke();
}

function drawScale(context, scale, height) {
  context.strokeStyle = colour("soft");
  context.fillStyle = colour("soft");
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(10, height - 10);
  context.lineTo(10 + 20 * scale, height - 10);
  context.stroke();
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.fillText("20 m", 10, height - 13);
}

export function drawTrail() {
  const {context, width, height} = prepare(byId("trail"));
  const pose = shown.status && shown.status.pose;
  const last = shown.trail[shown.trail.length - 1];
  if (!pose && !last) return;
  const centre = pose ? [pose.x_m, pose.y_m] : last;
  const scale = width / VIEW_M;
  const place = (x, y) => [width / 2 + (x - centre[0]) * scale, height / 2 - (y - centre[1]) * scale];
  if (shown.map) {
    const {x_m, y_m} = shown.map;
    context.lineWidth = 1;
    context.globalAlpha = 0.55;
    strokeLines(context, shown.map.lines, classColours(), (x, y) => place(x + x_m, y + y_m));
    context.globalAlpha = 1;
  }
  context.lineWidth = 3;
  context.lineCap = "round";
  for (let i = 1; i < shown.trail.length; i++) {
    const [, , valid, begins] = shown.trail[i];
    if (begins) continue;
    context.strokeStyle = valid ? colour("good") : colour("bad");
    context.beginPath();
    context.moveTo(...place(shown.trail[i - 1][0], shown.trail[i - 1][1]));
    context.lineTo(...place(shown.trail[i][0], shown.trail[i][1]));
    context.stroke();
  }
  if (pose) {
    const [x, y] = place(pose.x_m, pose.y_m);
    drawEllipse(context, pose, x, y, scale);
    drawVehicle(context, x, y, Math.max(scale, 3), pose.yaw_deg * Math.PI / 180);
  }
  drawScale(context, scale, height);
}

export function noteTrail(status) {
  const pose = status.pose;
  if (!pose) {
    interrupted = true;
    return;
  }
  const last = shown.trail[shown.trail.length - 1];
  if (last && Math.hypot(pose.x_m - last[0], pose.y_m - last[1]) < STEP_M) return;
  shown.trail.push([pose.x_m, pose.y_m, status.valid ? 1 : 0, interrupted ? 1 : 0]);
  interrupted = false;
  if (shown.trail.length > POINTS) shown.trail.shift();
}
