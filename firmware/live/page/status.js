// The state with its reasons, the facts beside it and the tables.
import {byId, element, setChildren, setText, setTitle} from "./drawing.js";
import {latenessOf} from "./lateness.js";
import {shown} from "./state.js";
import {drawTrail, noteTrail} from "./trail.js";

const RATES_S = 3;  // rates are averaged over this many seconds
const earlier = [];  // the statuses of the last RATES_S

/// Says in place of the state why the page does not show the present one, and fades the page.
export function showOutdated(word, reason) {
  document.body.classList.add("stale");
  setTitle(word);
  setText(byId("state"), word);
  byId("state").className = "badge bad";
  setText(byId("summary"), reason);
  setChildren(byId("why"), []);
}

function showState(status) {
  const late_s = latenessOf(status.sent_s);
  if (late_s > 0) {
    showOutdated("LATE", `The page shows what was ${late_s.toFixed(0)} s ago, because the connection ` +
      "or the browser is too slow.");
    return;
  }
  document.body.classList.remove("stale");
  const badge = byId("state");
  setText(badge, status.state || status.phase.toUpperCase());
  const kind = !status.healthy ? "bad" : status.valid && !status.why.length ? "good" : "warn";
  badge.className = "badge " + (status.phase === "running" ? kind : "");
  setTitle(status.state || status.phase);
  const summary = status.phase !== "running" ? status.health :
    status.valid ? "The pose may be used." : "The pose must not be used.";
  // If the answer of /healthz begins with the state, the badge and the reasons already show it.
  const more = status.phase === "running" && !status.healthy && !status.health.startsWith(status.state);
  setText(byId("summary"), summary + (more ? " Not healthy: " + status.health : ""));
  setChildren(byId("why"), (status.why || []).map((reason) => {
    const item = element("li");
    item.append(element("b", reason.reason + ": "), reason.do);
    return item;
  }));
}

/// How much a counter grew per second over the statuses of the last seconds.
function perSecond(status, read) {
  const first = earlier[0];
  if (!first || first.time_s === status.time_s) return 0;
  return Math.max(0, (read(status) - read(first)) / (status.time_s - first.time_s));
}

/// A cell with a count that should be zero.
function lossCell(count) {
  return element("td", count, count ? "bad" : "");
}

function showFrames(status) {
  const rows = status.cameras.map((camera, index) => {
    const row = element("tr");
    const faults = camera.faults.join(", ");
    row.append(element("td", camera.name.replace("_", " ")),
      element("td", camera.used ? "yes" : "no", camera.used ? "" : "bad"),
      element("td", perSecond(status, (of) => of.cameras[index].captured).toFixed(1)),
      lossCell(camera.lost), lossCell(camera.dropped), lossCell(camera.unreadable),
      lossCell(camera.failures),
      element("td", faults || "none", faults ? "bad" : ""));
    return row;
  });
  setChildren(byId("frames"), rows);
}

function showPairs(status) {
  const sent = perSecond(status, (of) => of.can.sent);
  const received = perSecond(status, (of) => of.can.received);
  const pairs = [
    ["framesets skipped", status.framesets.skipped],
    ["framesets without a prior", status.framesets.without_prior],
    ["framesets with too few images", status.framesets.refused],
    ["spread of a frameset", status.framesets.spread_ms.toFixed(2) + " ms"],
    ["corrections accepted", status.tracker.corrections.accepted],
    ["frames refused by E2E", status.vehicle.e2e_refused],
    ["vehicle frames lost", status.vehicle.frames_lost],
    ["vehicle epochs incomplete", status.vehicle.incomplete],
    ["vehicle epochs SNA or out of range", status.vehicle.not_available],
    ["odometry implausible", status.vehicle.odometry_refused],
    ["odometry that came too rarely", status.vehicle.slow_odometry],
    ["CAN sent", sent.toFixed(0) + " per s"],
    ["CAN received", received.toFixed(0) + " per s"],
    ["CAN dropped", status.can.send_dropped + status.can.receive_dropped],
    ["CAN overruns", status.can.receive_overruns],
    ["CAN error frames", status.can.error_frames],
    ["memory", status.memory_mb.toFixed(0) + " MB"],
    ["CPU", (100 * perSecond(status, (of) => of.cpu_s)).toFixed(0) + " %"],
  ];
  setChildren(byId("pairs"), pairs.map(([name, value]) => {
    const pair = element("div");
    pair.append(element("dt", name), element("dd", value));
    return pair;
  }));
}

/// Clears what only a daemon with a running appliance knows.
function clearFacts() {
  earlier.length = 0;
  for (const id of ["rate", "latency", "speed", "can", "place"]) setText(byId(id), "–");
  for (const id of ["frames", "pairs"]) setChildren(byId(id), []);
  for (const camera of Object.values(shown.cameras)) camera.figure.classList.remove("unused");
  drawTrail();
}

function showPlace(pose) {
  setText(byId("place"), !pose ? "No pose yet." :
    `x ${pose.x_m.toFixed(2)} m, y ${pose.y_m.toFixed(2)} m, yaw ${pose.yaw_deg.toFixed(1)}° · sigma ` +
    `${pose.sigma.longitudinal_m.toFixed(2)} m along, ${pose.sigma.lateral_m.toFixed(2)} m across, ` +
    `${pose.sigma.yaw_deg.toFixed(2)}°`);
}

export function onStatus(status) {
  shown.status = status;
  setText(byId("version"), "bevloc " + status.version);
  showState(status);
  noteTrail(status);
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
  setText(byId("rate"), status.rate_hz.toFixed(1) + " Hz");
  setText(byId("latency"), status.latency_ms.count ?
    `${status.latency_ms.median.toFixed(0)} ms, 99 %: ${status.latency_ms.p99.toFixed(0)}` : "–");
  setText(byId("speed"), pose ? (3.6 * pose.speed_mps).toFixed(0) + " km/h" : "–");
  setText(byId("can"), status.can.condition);
  showFrames(status);
  showPairs(status);
  showPlace(pose);
  drawTrail();
}
