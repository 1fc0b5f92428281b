// The cameras' pictures with the HD map.
import {byId, element, prepare, strokeLines} from "./drawing.js";
import {shown} from "./state.js";

const CAMERAS = ["front_left", "front", "front_right", "back_left", "back", "back_right"];

export function makeCameras() {
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
    shown.cameras[name] =
      {figure, image, canvas, caption, title, data: null, at_ms: 0, number: 0};
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

export function drawCameras() {
  Object.values(shown.cameras).forEach(drawCamera);
}

export function onCamera(data) {
  const camera = shown.cameras[data.camera];
  if (!camera) return;
  camera.at_ms = shown.pictureAt_ms = performance.now();
  camera.number = ++shown.pictures;
  camera.figure.style.aspectRatio = data.width_px + " / " + data.height_px;
  camera.image.onload = () => {
    camera.image.hidden = false;
    camera.data = data;
    drawCamera(camera);
  };
  camera.image.src = "data:image/jpeg;base64," + data.jpeg;
}
