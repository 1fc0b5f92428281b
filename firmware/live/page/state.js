// What the page shows now. Each module draws its part of it.

export const shown = {
  pose: "corrected", status: null, match: null, matchAt_ms: 0, map: null, trail: [], cameras: {},
  pictures: 0, pictureAt_ms: 0,  // how many pictures have come, and when the latest one came
};
