// How much later than sent a status comes, because the connection or the browser is slow.

const LATE_S = 3;
const DRIFT = 2e-4;  // the clocks of the two machines drift apart by less than this
let least_s = Infinity;  // the smallest difference between the two clocks
let before_s = 0;  // when the status before came

/// Call it when a connection begins. What comes first through it is not late.
export function beginConnection() {
  least_s = Infinity;
}

/// Returns how many seconds late a status comes that the server sent at this time of its clock, but 0
/// if that is not more than LATE_S. The clock of the browser has another zero, so the status that
/// came fastest tells how far the two clocks are apart.
export function latenessOf(sent_s) {
  const now_s = performance.now() / 1000;
  const difference_s = now_s - sent_s;
  least_s = Math.min(difference_s, least_s + DRIFT * (now_s - before_s));
  before_s = now_s;
  const late_s = difference_s - least_s;
  return late_s > LATE_S ? late_s : 0;
}
