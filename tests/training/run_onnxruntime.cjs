// Runs a model file on onnxruntime:
//   NODE_PATH=... node run_onnxruntime.cjs MODEL FOLDER SAMPLES LEVEL
// Reads FOLDER/<sample>/<input>.bin and writes FOLDER/<sample>/<output>.bin, which hold the raw
// elements of each tensor. LEVEL: onnxruntime's graph optimisation, "disabled" or "all".
'use strict';
const fs = require('fs');
const path = require('path');
const ort = require('onnxruntime-node');

const INPUTS = {
  images: ['int8', Int8Array, [6, 3, 96, 320]],
  raster: ['uint8', Uint8Array, [1, 3, 400, 200]],
  view_index: ['int32', Int32Array, [8, 5000]],
  view_weight: ['float32', Float32Array, [8, 5000]],
};

function readInput(folder, name) {
  const [type, Elements, shape] = INPUTS[name];
  const bytes = fs.readFileSync(path.join(folder, `${name}.bin`));
  const data = new Elements(new Uint8Array(bytes).buffer);
  return new ort.Tensor(type, data, shape);
}

async function main([model, folder, samples, level]) {
  const options = { graphOptimizationLevel: level, intraOpNumThreads: 1, logSeverityLevel: 3 };
  const session = await ort.InferenceSession.create(model, options);
  for (let i = 0; i < Number(samples); ++i) {
    const sample = path.join(folder, String(i));
    const feeds = {};
    for (const name of session.inputNames) feeds[name] = readInput(sample, name);
    for (const [name, tensor] of Object.entries(await session.run(feeds))) {
      const { buffer, byteOffset, byteLength } = tensor.data;
      const bytes = new Uint8Array(buffer, byteOffset, byteLength);
      fs.writeFileSync(path.join(sample, `${name}.bin`), bytes);
    }
  }
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error.message);
  process.exit(1);
});
