/* Puts the label of the peak, the first annotation of a plot, where it covers no curve and stays inside the axes. */
function placePeakLabel(plot) {
  "use strict";

  const full = plot._fullLayout, across = full.xaxis, up = full.yaxis, note = full.annotations[0];
  const words = plot.querySelector(".annotation[data-index='0'] .annotation-text-g");
  if (!words || !across._length) return;
  const size = words.getBoundingClientRect(), GAP = 4, STEP = 4, RING = 13;
  // a curve goes through its marks, and an annotation has the logarithm of its place on a logarithmic axis
  const place = (x, y) => [across.d2p(x), up.d2p(y)];
  const head = [across.r2p(note.x), up.r2p(note.y)];
  const inside = ([x, y]) => x >= 0 && x <= across._length && y >= 0 && y <= up._length;

  const drawn = [];  // points along all lines
  function along(from, to) {
    const steps = Math.min(400, Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / STEP)));
    for (let i = 0; i <= steps; i++) {
      const at = [from[0] + (to[0] - from[0]) * i / steps, from[1] + (to[1] - from[1]) * i / steps];
      if (inside(at)) drawn.push(at);
    }
  }
  for (const trace of plot._fullData) {
    if (trace.visible !== true) continue;
    let last = null;
    for (let i = 0; i < trace.x.length; i++) {
      if (trace.y[i] === null || trace.x[i] === null) { last = null; continue; }
      const now = place(trace.x[i], trace.y[i]);
      if (!now.every(Number.isFinite)) { last = null; continue; }
      along(last && trace.mode.includes("lines") ? last : now, now);
      last = now;
    }
  }
  for (const jump of full.annotations.slice(1)) along([across.r2p(jump.ax), up.r2p(jump.ay)], [across.r2p(jump.x), up.r2p(jump.y)]);

  function cost(offset) {
    const middle = [head[0] + offset[0], head[1] + offset[1]];
    const reach = [size.width / 2 + GAP, size.height / 2 + GAP];
    const outside = Math.max(reach[0] - middle[0], middle[0] + reach[0] - across._length, 0) +
      Math.max(reach[1] - middle[1], middle[1] + reach[1] - up._length, 0);
    // the ring about the chosen point may be at the peak
    const near = Math.hypot(...middle.map((at, axis) => Math.max(Math.abs(at - head[axis]) - reach[axis], 0))) < RING;
    const covered = drawn.filter((at) => Math.abs(at[0] - middle[0]) < reach[0] && Math.abs(at[1] - middle[1]) < reach[1]);
    return 100 * outside + 50 * near + 10 * covered.length + 0.1 * Math.hypot(...offset);
  }
  let best = null, least = Infinity;
  for (const distance of [0, 18, 40, 70, 110]) {
    for (let turn = 0; turn < 16; turn++) {
      const angle = Math.PI * (1 + turn / 8), x = Math.cos(angle), y = Math.sin(angle);
      // from the left upwards: friction lowers the frequency, so the stuck peak is on the right
      const offset = [Math.round(x * (distance + 14 + size.width / 2)), Math.round(y * (distance + 14 + size.height / 2))];
      const price = cost(offset);
      if (price < least - 1e-9) { best = offset; least = price; }
    }
  }
  if (best[0] !== note.ax || best[1] !== note.ay) Plotly.relayout(plot, { "annotations[0].ax": best[0], "annotations[0].ay": best[1] });
}
