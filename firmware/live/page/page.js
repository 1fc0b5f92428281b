// The live page: draws the events that the server sends at /events (live_events.h).
import {drawCameras, makeCameras, onCamera} from "./cameras.js";
import {byId, setText} from "./drawing.js";
import {beginConnection} from "./lateness.js";
import {drawMatch, makePlots, onMatch} from "./match.js";
import {shown} from "./state.js";
import {onStatus, showOutdated} from "./status.js";
import {drawTrail} from "./trail.js";

const STALE_MS = 3000;
const DEAD_MS = 10000;  // after a silence as long as this, nobody is at the other end
const PASSED_OVER = 10;  // pictures of the others in two rounds: they come in turn
const NO_ANSWER = "bevlocd does not answer.";
let source = null;
let connect_ms = 0;  // when the present connection was begun
let lastEvent_ms = 0;
let refusal = NO_ANSWER;  // why there are no events

function drawAll() {
  drawCameras();
  drawMatch();
  drawTrail();
}

/// Shows pictures and matches in grey when they are older than STALE_MS. A camera whose turn has not
/// come since then is not to blame, so its picture stays.
function noteAge() {
  const isOld = (at_ms) => performance.now() - at_ms > STALE_MS;
  const isPassedOver = (camera) => shown.pictures - camera.number > PASSED_OVER;
  for (const camera of Object.values(shown.cameras)) {
    const old = camera.data !== null && isOld(camera.at_ms) &&
      (isOld(shown.pictureAt_ms) || isPassedOver(camera));
    camera.figure.classList.toggle("old", old);
    setText(camera.caption, camera.title + (old ? ": no new picture" : ""));
  }
  const oldMatch = shown.match !== null && isOld(shown.matchAt_ms);
  for (const id of ["bev", "plots"]) byId(id).classList.toggle("old", oldMatch);
}

export function noteSilence() {
  noteAge();
  if (performance.now() - lastEvent_ms > STALE_MS) {
    showOutdated("NO DATA", refusal + " The page tries again by itself.");
  }
  endDeadConnection();
}

/// A machine that loses its power does not close its connections, so the browser waits on. When the
/// connection is CLOSED, the browser has noticed it, and the page tries again.
function endDeadConnection() {
  const silence_ms = performance.now() - Math.max(lastEvent_ms, connect_ms);
  if (source.readyState === EventSource.CLOSED || silence_ms <= DEAD_MS) return;
  source.close();
  refusal = NO_ANSWER;
  connect();
}

/// The browser does not tell why the request for events was refused, so this asks with HEAD.
function noteRefusal() {
  fetch("/events", {method: "HEAD"}).then((answer) => {
    const full = answer.status === 503;
    refusal = full ? "bevlocd has no room for another viewer. Close one." : NO_ANSWER;
  }, () => { refusal = NO_ANSWER; });
}

function connect() {
  source = new EventSource("/events");
  connect_ms = performance.now();
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
  source.onopen = beginConnection;
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
    drawCameras();
  });
}
makeCameras();
makePlots();
connect();
setInterval(noteSilence, 500);
addEventListener("resize", drawAll);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
