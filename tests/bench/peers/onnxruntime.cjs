// Times a model file on onnxruntime:
//   NODE_PATH=... node onnxruntime.cjs MODEL FOLDER THREADS RUNS
// Reads FOLDER/<input>.bin, which hold the raw elements of each input. Computes both features but not
// the mask, as the pose needs, and prints the milliseconds of each run as a JSON list. The first run
// is not timed.
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
const OUTPUTS = ['bev_features', 'map_features'];
const NS_PER_MS = 1e6;

function readInput(folder, name) {
  const [type, Elements, shape] = INPUTS[name];
  const bytes = fs.readFileSync(path.join(folder, `${name}.bin`));
  return new ort.Tensor(type, new Elements(new Uint8Array(bytes).buffer), shape);
}

async function main([model, folder, threads, runs]) {
  const session = await ort.InferenceSession.create(model, {
    graphOptimizationLevel: 'all',
    executionMode: 'sequential',
    intraOpNumThreads: Number(threads),
    interOpNumThreads: 1,
    logSeverityLevel: 3,
  });
  const feeds = {};
  for (const name of session.inputNames) feeds[name] = readInput(folder, name);
  await session.run(feeds, OUTPUTS);
  const times = [];
  for (let i = 0; i < Number(runs); ++i) {
    const start = process.hrtime.bigint();
    await session.run(feeds, OUTPUTS);
    times.push(Number(process.hrtime.bigint() - start) / NS_PER_MS);
  }
  console.log(JSON.stringify(times));
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error.message);
  process.exit(1);
});
