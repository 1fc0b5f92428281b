// The live page: draws what the server sends at /events. docs/live.md describes the events.
"use strict";

const CAMERAS = ["front_left", "front", "front_right", "back_left", "back", "back_right"];
const AXES = [
  {key: "x", title: "longitudinal", unit: "m", level: "longitudinal_m"},
  {key: "y", title: "lateral", unit: "m", level: "lateral_m"},
  {key: "yaw", title: "yaw", unit: "°", level: "yaw_deg"},
];
const STALE_MS = 3000;
const RATES_S = 3;  // over which rates are averaged
const ENLARGED = 10;  // the ellipse on the map, which is smaller than the vehicle
const TRAIL_STEP_M = 0.5;
const TRAIL_POINTS = 2000;
const VIEW_M = 130;  // width of the map panel
const NO_ANSWER = "bevlocd does not answer.";

const shown = {
  pose: "corrected", status: null, match: null, matchAt_ms: 0, map: null, trail: [], cameras: {},
};
const earlier = [];  // statuses of the last seconds, for rates
let lastEvent_ms = 0;
let refusal = NO_ANSWER;  // why there are no events

const byId = (id) => document.getElementById(id);

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

function classColours() {
  return [colour("divider"), colour("crossing"), colour("boundary")];
}

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

/// A drawing context in CSS pixels, and the size of the canvas in them.
function prepare(canvas) {
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
function strokeLines(context, lines, colours, place) {
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

// Cameras

function makeCameras() {
  for (const name of CAMERAS) {
    const figure = element("figure");
    const image = element("img");
    image.alt = "camera " + name.replace("_", " ");
    image.hidden = true;
    const canvas = element("canvas");
    canvas.setAttribute("aria-hidden", "true");
    const title = name.replace("_", " ");
    const caption = element("figcaption", title);
    figure.append(image, canvas, caption);
    byId("pictures").append(figure);
    shown.cameras[name] = {figure, image, canvas, caption, title, data: null, at_ms: 0};
  }
}

function drawCamera(camera) {
  const {context, width, height} = prepare(camera.canvas);
  const data = camera.data;
  if (!data) return;
  const scale = Math.min(width / data.width_px, height / data.height_px);
  const left = (width - scale * data.width_px) / 2;
  const top = (height - scale * data.height_px) / 2;
  const place = (u, v) => [left + (u + 0.5) * scale, top + (v + 0.5) * scale];
  const colours = ["#4aa3ff", "#45d483", "#ff6b57"];
  context.beginPath();
  context.rect(left, top, scale * data.width_px, scale * data.height_px);
  context.clip();
  context.lineJoin = "round";
  if (shown.pose !== "corrected") {
    context.lineWidth = 1.5;
    context.setLineDash([5, 4]);
    strokeLines(context, data.prior, colours, place);
  }
  if (shown.pose !== "prior") {
    context.lineWidth = 2;
    context.setLineDash([]);
    strokeLines(context, data.corrected, colours, place);
  }
}

function onCamera(data) {
  const camera = shown.cameras[data.camera];
  if (!camera) return;
  camera.at_ms = performance.now();
  camera.figure.style.aspectRatio = data.width_px + " / " + data.height_px;
  camera.image.onload = () => {
    camera.image.hidden = false;
    camera.data = data;
    drawCamera(camera);
  };
  camera.image.src = "data:image/jpeg;base64," + data.jpeg;
}

// Bird's-eye view

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

function drawVehicle(context, x, y, scale, heading_rad) {
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

// Distributions

function makePlots() {
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

function signed(value, unit) {
  return (value < 0 ? "−" : "+") + Math.abs(value).toFixed(2) + " " + unit;
}

// Trail

function drawEllipse(context, pose, x, y, scale) {
  // The covariance along the vehicle's axes, as the two half axes of an ellipse of three sigma.
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

function drawTrail() {
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
    context.strokeStyle = shown.trail[i][2] ? colour("good") : colour("bad");
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

function noteTrail(status) {
  const pose = status.pose;
  if (!pose) return;
  const last = shown.trail[shown.trail.length - 1];
  if (last && Math.hypot(pose.x_m - last[0], pose.y_m - last[1]) < TRAIL_STEP_M) return;
  shown.trail.push([pose.x_m, pose.y_m, status.valid ? 1 : 0]);
  if (shown.trail.length > TRAIL_POINTS) shown.trail.shift();
}

// Status

function showState(status) {
  const badge = byId("state");
  badge.textContent = status.state || status.phase.toUpperCase();
  const kind = !status.healthy ? "bad" : status.valid && !status.why.length ? "good" : "warn";
  badge.className = "badge " + (status.phase === "running" ? kind : "");
  document.title = (status.state || status.phase) + " · bevloc";
  const summary = status.phase !== "running" ? status.health :
    status.valid ? "The pose may be used." : "The pose must not be used.";
  // Otherwise the badge and the reasons below say what /healthz says.
  const more = status.phase === "running" && !status.healthy && !status.health.startsWith(status.state);
  byId("summary").textContent = summary + (more ? " Not healthy: " + status.health : "");
  const why = byId("why");
  why.replaceChildren();
  for (const reason of status.why || []) {
    const item = element("li");
    item.append(element("b", reason.reason + ": "), reason.do);
    why.append(item);
  }
}

/// How much a counter grew per second over the statuses of the last seconds.
function perSecond(status, read) {
  const first = earlier[0];
  if (!first || first.time_s === status.time_s) return 0;
  return Math.max(0, (read(status) - read(first)) / (status.time_s - first.time_s));
}

function showFrames(status) {
  const rows = status.cameras.map((camera, index) => {
    const row = element("tr");
    const faults = camera.faults.join(", ");
    row.append(element("td", camera.name.replace("_", " ")),
      element("td", camera.used ? "yes" : "no", camera.used ? "" : "bad"),
      element("td", perSecond(status, (of) => of.cameras[index].captured).toFixed(1)),
      element("td", camera.lost, camera.lost ? "bad" : ""),
      element("td", camera.dropped, camera.dropped ? "bad" : ""),
      element("td", faults || "none", faults ? "bad" : ""));
    return row;
  });
  byId("frames").replaceChildren(...rows);
}

function showPairs(status) {
  const sent = perSecond(status, (of) => of.can.sent);
  const received = perSecond(status, (of) => of.can.received);
  const pairs = [
    ["framesets skipped", status.framesets.skipped],
    ["without a prior", status.framesets.without_prior],
    ["spread", status.framesets.spread_ms.toFixed(2) + " ms"],
    ["accepted", status.tracker.corrections.accepted],
    ["refused by E2E", status.vehicle.e2e_refused],
    ["vehicle lost", status.vehicle.frames_lost],
    ["CAN sent", sent.toFixed(0) + " per s"],
    ["CAN received", received.toFixed(0) + " per s"],
    ["CAN dropped", status.can.send_dropped + status.can.receive_dropped],
    ["CAN error frames", status.can.error_frames],
    ["memory", status.memory_mb.toFixed(0) + " MB"],
    ["CPU", (100 * perSecond(status, (of) => of.cpu_s)).toFixed(0) + " %"],
  ];
  byId("pairs").replaceChildren(...pairs.map(([name, value]) => {
    const pair = element("div");
    pair.append(element("dt", name), element("dd", value));
    return pair;
  }));
}

/// What a daemon without an appliance does not know.
function clearFacts() {
  earlier.length = 0;
  for (const id of ["rate", "latency", "speed", "can", "place"]) byId(id).textContent = "–";
  for (const id of ["frames", "pairs"]) byId(id).replaceChildren();
  for (const camera of Object.values(shown.cameras)) camera.figure.classList.remove("unused");
  drawTrail();
}

function showPlace(pose) {
  byId("place").textContent = !pose ? "No pose yet." :
    `x ${pose.x_m.toFixed(2)} m, y ${pose.y_m.toFixed(2)} m, yaw ${pose.yaw_deg.toFixed(1)}° · sigma ` +
    `${pose.sigma.longitudinal_m.toFixed(2)} m along, ${pose.sigma.lateral_m.toFixed(2)} m across, ` +
    `${pose.sigma.yaw_deg.toFixed(2)}°`;
}

function onStatus(status) {
  shown.status = status;
  byId("version").textContent = "bevloc " + status.version;
  showState(status);
  if (status.phase !== "running") {
    clearFacts();
    return;
  }
  for (const camera of status.cameras) {
    shown.cameras[camera.name].figure.classList.toggle("unused", !camera.used);
  }
  const first = earlier[0];
  if (first && first.time_s > status.time_s) earlier.length = 0;  // another daemon
  earlier.push(status);
  while (earlier.length > 1 && status.time_s - earlier[0].time_s > RATES_S) earlier.shift();
  const pose = status.pose;
  byId("rate").textContent = status.rate_hz.toFixed(1) + " Hz";
  byId("latency").textContent = status.latency_ms.count ?
    `${status.latency_ms.median.toFixed(0)} ms, 99 %: ${status.latency_ms.p99.toFixed(0)}` : "–";
  byId("speed").textContent = pose ? (3.6 * pose.speed_mps).toFixed(0) + " km/h" : "–";
  byId("can").textContent = status.can.condition;
  noteTrail(status);
  showFrames(status);
  showPairs(status);
  showPlace(pose);
  drawTrail();
}

function onMatch(match) {
  shown.match = match;
  shown.matchAt_ms = performance.now();
  drawBev();
  AXES.forEach(drawPlot);
}

function drawAll() {
  Object.values(shown.cameras).forEach(drawCamera);
  drawBev();
  AXES.forEach(drawPlot);
  drawTrail();
}

/// Greys pictures and matches that nothing newer has replaced.
function noteAge() {
  const isOld = (at_ms) => performance.now() - at_ms > STALE_MS;
  for (const camera of Object.values(shown.cameras)) {
    const old = camera.data !== null && isOld(camera.at_ms);
    camera.figure.classList.toggle("old", old);
    camera.caption.textContent = camera.title + (old ? ": no new picture" : "");
  }
  const oldMatch = shown.match !== null && isOld(shown.matchAt_ms);
  for (const id of ["bev", "plots"]) byId(id).classList.toggle("old", oldMatch);
}

function noteSilence() {
  noteAge();
  const silent = performance.now() - lastEvent_ms > STALE_MS;
  document.body.classList.toggle("stale", silent);
  if (!silent) return;
  byId("state").textContent = "NO DATA";
  byId("state").className = "badge bad";
  byId("summary").textContent = refusal + " The page tries again by itself.";
  byId("why").replaceChildren();
}

/// The browser does not tell with which status the events were refused.
function noteRefusal() {
  fetch("/events", {method: "HEAD"}).then((answer) => {
    const full = answer.status === 503;
    refusal = full ? "As many viewers as bevlocd allows look already: close one." : NO_ANSWER;
  }, () => { refusal = NO_ANSWER; });
}

function connect() {
  const source = new EventSource("/events");
  const on = (name, handle) => source.addEventListener(name, (event) => {
    lastEvent_ms = performance.now();
    refusal = NO_ANSWER;
    handle(JSON.parse(event.data));
  });
  on("status", onStatus);
  on("camera", onCamera);
  on("match", onMatch);
  on("map", (map) => { shown.map = map; drawTrail(); });
  on("trail", (trail) => { shown.trail = trail; drawTrail(); });
  source.onerror = () => {
    if (source.readyState !== EventSource.CLOSED) return;  // the browser tries again
    noteRefusal();
    setTimeout(connect, 2000);
  };
}

for (const button of document.querySelectorAll(".choice button")) {
  button.addEventListener("click", () => {
    shown.pose = button.dataset.pose;
    for (const other of document.querySelectorAll(".choice button")) {
      other.setAttribute("aria-pressed", String(other === button));
    }
    Object.values(shown.cameras).forEach(drawCamera);
  });
}
makeCameras();
makePlots();
connect();
setInterval(noteSilence, 500);
addEventListener("resize", drawAll);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
