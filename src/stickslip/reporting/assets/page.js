/* Moves the figures of the page to the point and the pair that the reader chooses. No network, no library but plotly. */
(function () {
  "use strict";

  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const element = (id) => document.getElementById(id);
  const data = read("page-data");
  const figures = read("page-figures");

  const states = unpack(data.states, Int8Array);
  const energy = unpack(data.energy, Float32Array);
  const springs = unpack(data.springs, Float32Array);
  const friction = unpack(data.friction, Float32Array);
  const preload = unpack(data.preload, Float32Array);
  const loops = data.loops;
  const relative = unpack(loops.relative, Float32Array);
  const slots = unpack(loops.slots, Int32Array);
  const scales = unpack(loops.scales, Float32Array);
  const forces = unpack(loops.forces, Int16Array);
  const normalScales = unpack(loops.normalScales, Float32Array);
  const normalForces = unpack(loops.normalForces, Int16Array);
  const signals = {};
  for (const name of Object.keys(data.signals)) signals[name] = unpack(data.signals[name], Float32Array);

  const chosen = { point: data.point, pair: data.pair };
  const facePairs = Array.from({ length: data.faces }, () => []);
  data.pairFace.forEach((face, pair) => facePairs[face].push(pair));

  // The peak lies between computed points: at the nearest one its own frequency and amplitude are shown, as everywhere.
  const frequencyAt = (point) => (point === data.point ? data.peakFrequency : data.frequency[point]);
  const amplitudeAt = (point) => (point === data.point ? data.peakAmplitude : data.amplitude[point]);
  const hertz = (value) => value.toFixed(2) + " Hz";
  // text that plotly shows as it is: without its tags, entities and "%{x}"
  const escapes = { "&": "&amp;", "<": "&lt;", ">": "&gt;", "%": "&#37;" };
  const shown = (text) => text.replace(/[&<>%]/g, (letter) => escapes[letter]);
  const raised = (exponent) => exponent.replace(/[-+\d]/g, (sign) => ({ "-": "⁻", "+": "" }[sign] ?? "⁰¹²³⁴⁵⁶⁷⁸⁹"[sign]));
  const digits = function (value) {
    const [mantissa, exponent] = Number(value.toPrecision(4)).toString().split("e");
    return mantissa.replace("-", "−") + (exponent ? " × 10" + raised(exponent) : "");
  };

  /* ---- numbers of one pair over a period ---- */

  function synthesis(coefficients, start, times) {
    return times.map(function (time) {
      let value = coefficients[start];
      for (let k = 1; 2 * k < data.coefficients; k++) {
        const angle = 2 * Math.PI * k * time;
        value += coefficients[start + 2 * k - 1] * Math.cos(angle) + coefficients[start + 2 * k] * Math.sin(angle);
      }
      return value;
    });
  }

  // place of the nearest point among those that are held; -1 if none is
  function nearest(points, point) {
    let best = points.length - 1;
    points.forEach(function (candidate, i) {
      if (Math.abs(candidate - point) < Math.abs(points[best] - point)) best = i;
    });
    return best;
  }

  function pairCycle(held, pair) {
    const base = (held * data.nPairs + pair) * 3 * data.coefficients;
    const axes = [0, 1, 2].map((axis) => synthesis(relative, base + axis * data.coefficients, loops.times));
    const slot = slots[held * data.nPairs + pair];
    const length = loops.times.length;
    const coulomb = data.coulomb[pair] === 1;
    let normal;
    if (coulomb) {
      normal = axes[2].map((n) => Math.max(preload[pair] + springs[3 * pair + 2] * n * 1e-6, 0));
    } else {
      const entry = held * loops.normalPairs + loops.normalSlot[pair];
      const values = normalForces.subarray(entry * length, (entry + 1) * length);
      normal = Array.from(values, (value) => value * normalScales[entry]);
    }
    const traction = [0, 1].map(function (axis) {
      const stiffness = springs[3 * pair + axis] * 1e-6;
      if (slot < 0) {
        const mean = relative[base + axis * data.coefficients];
        return axes[axis].map((s) => stiffness * (s - mean));
      }
      const start = (2 * slot + axis) * length;
      return Array.from(forces.subarray(start, start + length), (value) => value * scales[slot]);
    });
    // pairs of other laws have no slider and no friction limit
    const slider = [0, 1].map((axis) =>
      coulomb ? axes[axis].map((s, j) => s - traction[axis][j] / (springs[3 * pair + axis] * 1e-6)) : []);
    // A slider starts at the mean, so tangential motion is shown about its mean; that of n moves the normal force.
    const means = [0, 1].map((axis) => relative[base + axis * data.coefficients]);
    const about = (values, axis) => values.map((value) => value - means[axis]);
    return {
      axes: [about(axes[0], 0), about(axes[1], 1), axes[2]], slider: slider.map(about), normal: normal, traction: traction, coulomb: coulomb,
    };
  }

  /* ---- drawing ---- */

  const phone = window.matchMedia("(max-width: 520px)");
  // Without plotly's toolbar, which covers legends; the tools of every page save figures and data.
  const options = { responsive: true, displayModeBar: false, showSendToCloud: false, plotlyServerURL: "" };

  function draw(id, figure) {
    if (phone.matches) {
      figure.layout.margin = Object.assign({}, figure.layout.margin, { l: 44, r: 6 });
      figure.layout.legend.font.size = 11;
    }
    return Plotly.newPlot(element(id), figure.data, figure.layout, options);
  }

  /* Marks of a map have a size in px for the width of a wide page: on a narrower map they would overlap. */
  function fitMarks(id) {
    const plot = element(id), full = plot._fullLayout, assumed = (full.meta || {}).pxPerMm;
    if (!assumed) return undefined;
    const factor = full.xaxis._length / Math.abs(full.xaxis.range[1] - full.xaxis.range[0]) / assumed;
    if (factor >= 1) return undefined;
    return Plotly.restyle(plot, { "marker.size": plot.data.map((trace) => factor * trace.marker.size) });
  }

  /* Before its figure is drawn a change goes into the figure itself: drawing once is quicker than drawing twice. */
  let drawn = false;
  function restyle(id, update, traces) {
    if (drawn) return Plotly.restyle(id, update, traces);
    const all = figures[id].data;
    (traces || all.map((_, i) => i)).forEach(function (trace, i) {
      for (const [path, values] of Object.entries(update)) {
        const keys = path.split("."), last = keys.pop();
        const part = keys.reduce((whole, key) => (whole[key] = whole[key] || {}), all[trace]);
        part[last] = Array.isArray(values) ? values[i % values.length] : values;
      }
    });
  }

  const closed = (values) => values.concat(values.slice(0, 1));

  function showCurve() {
    const x = [[data.frequency[chosen.point]]];
    restyle("curve", { x: x, y: [[data.amplitude[chosen.point]]] }, [figures.curve.data.length - 1]);
    restyle("energy-curve", { x: x, y: [[data.energyTotal[chosen.point]]] }, [figures["energy-curve"].data.length - 1]);
    const text = hertz(frequencyAt(chosen.point)) + " (" + (chosen.point + 1) + " of " + data.points + ")";
    element("point-label").textContent = text;
    element("point").setAttribute("aria-valuetext", text);
  }

  function svgElement(tag, attributes) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
  }

  function stateMark(style) {
    const shapes = {
      "circle": ["circle", { cx: 8, cy: 8, r: 7 }], "square": ["rect", { x: 1.5, y: 1.5, width: 13, height: 13 }],
      "triangle-up": ["path", { d: "M8 1 L15.5 14.5 L0.5 14.5 Z" }],
    };
    const mark = svgElement("svg", { viewBox: "0 0 16 16", "aria-hidden": "true", fill: style.colour });
    mark.append(svgElement(...shapes[style.symbol]));
    return mark;
  }

  function showLegend(row) {
    const counts = data.stateStyles.map(() => 0);
    for (let pair = 0; pair < data.nPairs; pair++) counts[states[row + pair]] += 1;
    element("state-legend").replaceChildren(...data.stateStyles.flatMap(function (style, i) {
      if (style.name === null) return [];  // no pair can be in that state
      const count = document.createElement("b"), entry = document.createElement("li");
      count.textContent = counts[i];
      entry.append(stateMark(style), style.name, count);
      return entry;
    }));
  }

  function showMaps() {
    const held = nearest(data.mapPoints, chosen.point), point = data.mapPoints[held], row = held * data.nPairs;
    for (const now of document.querySelectorAll(".now")) {
      now.textContent = hertz(frequencyAt(point)) + ", " + digits(amplitudeAt(point)) + " µm" +
        (point === data.point ? " (the peak)" : "") + (point === chosen.point ? "" :
          " (this page contains maps of " + data.mapPoints.length + " points; this is the nearest)");
    }
    element("energy-now").textContent = digits(data.energyTotal[point]) + " " + data.energyUnit;
    let largest = 0;
    for (let pair = 0; pair < data.nPairs; pair++) largest = Math.max(largest, energy[row + pair]);
    facePairs.forEach(function (pairs, face) {
      const styles = pairs.map((pair) => data.stateStyles[states[row + pair]]);
      const text = pairs.map((pair, i) => shown(data.pairLabel[pair]) + "<br>" + styles[i].name + ", " +
        digits(energy[row + pair]) + " " + data.energyUnit + " per cycle");
      restyle("state-map-" + face, {
        "marker.color": [styles.map((style) => style.colour)], "marker.symbol": [styles.map((style) => style.symbol)], text: [text],
      }, [0]);
      restyle("energy-map-" + face, {
        "marker.color": [pairs.map((pair) => energy[row + pair])], "marker.cmax": Math.max(largest, 1e-30), text: [text],
      }, [0]);
    });
    showLegend(row);
  }

  function showChoice() {
    facePairs.forEach(function (pairs, face) {
      const here = data.pairFace[chosen.pair] === face;
      const place = data.pairPosition[chosen.pair];
      const ring = { x: [here ? [place[0]] : []], y: [here ? [place[1]] : []] };
      restyle("state-map-" + face, ring, [1]);
      restyle("energy-map-" + face, ring, [1]);
    });
    element("pair").value = String(chosen.pair);
  }

  function showPair() {
    const held = nearest(loops.points, chosen.point);
    const point = held < 0 ? data.mapPoints[nearest(data.mapPoints, chosen.point)] : loops.points[held];
    const entry = data.mapPoints.indexOf(point) * data.nPairs + chosen.pair;
    element("pair-now").textContent = data.pairLabel[chosen.pair];
    let words = "";
    if (held < 0) words = " (loops of so many pairs would make this page too large; the results file contains them)";
    else if (point !== chosen.point) words = " (this page contains loops of " + loops.points.length + " points; this is the nearest)";
    element("loop-now").textContent = data.lawStates[data.lawOfPair[chosen.pair]][states[entry]] + " at " + hertz(frequencyAt(point)) + ", " +
      digits(energy[entry]) + " " + data.energyUnit + " per cycle" + words;
    if (held < 0) return;
    const cycle = pairCycle(held, chosen.pair);
    restyle("loop", { x: [closed(cycle.axes[0]), closed(cycle.axes[1])], y: cycle.traction.map(closed) }, [0, 1]);
    const limit = cycle.normal.map((n) => friction[chosen.pair] * n);
    const both = closed(limit).concat([null], closed(limit.map((value) => -value)));
    const times = loops.times.concat([1]);
    const y = cycle.traction.map(closed).concat([closed(cycle.normal), both], cycle.axes.map(closed), cycle.slider.map(closed));
    const visible = y.map((_, i) => cycle.coulomb || (i !== 3 && i < 7));
    restyle("signals", { x: y.map((values, i) => (i === 3 ? times.concat([null], times) : times)), y: y, visible: visible });
  }

  const groupTimes = Array.from({ length: 129 }, (_, j) => j / 128);

  function showGroups() {
    data.groups.forEach(function (names, group) {
      const start = chosen.point * data.coefficients;
      const y = names.map((name) => synthesis(signals[name], start, groupTimes).map((value) => value - signals[name][start]));
      // a mean below nine digits of the motion of the group is round-off
      const least = 1e-9 * Math.max(...y.flat());
      const means = names.map((name) => (Math.abs(signals[name][start]) < least ? 0 : signals[name][start]));
      const labels = names.map((name, i) => shown(data.groupLabels[group][i]) + " (mean " + digits(means[i]) + " µm)");
      restyle("group-" + group, { x: names.map(() => groupTimes), y: y, name: labels });
    });
  }

  let waiting = false;
  function choosePoint(point) {
    chosen.point = Math.max(0, Math.min(data.points - 1, point));
    element("point").value = String(chosen.point);
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(function () {
      waiting = false;
      showCurve(); showMaps(); showPair(); showGroups();
    });
  }

  function choosePair(pair) {
    chosen.pair = (pair + data.nPairs) % data.nPairs;
    showChoice(); showPair();
  }

  /* ---- what the reader does ---- */

  function nearestPairTowards(direction) {
    const from = data.pairPosition[chosen.pair];
    let best = chosen.pair, shortest = Infinity;
    for (const pair of facePairs[data.pairFace[chosen.pair]]) {
      const step = [data.pairPosition[pair][0] - from[0], data.pairPosition[pair][1] - from[1]];
      const ahead = step[0] * direction[0] + step[1] * direction[1];
      const aside = Math.abs(step[0] * direction[1]) + Math.abs(step[1] * direction[0]);
      if (ahead > 1e-9 && ahead + 4 * aside < shortest) { best = pair; shortest = ahead + 4 * aside; }
    }
    return best;
  }

  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

  function listenToMap(id, face) {
    const map = element(id);
    map.on("plotly_click", function (event) {
      const pair = event.points[0].customdata;
      if (pair !== undefined) choosePair(pair);
    });
    map.addEventListener("keydown", function (event) {
      if (!arrows[event.key]) return;
      event.preventDefault();
      choosePair(data.pairFace[chosen.pair] === face ? nearestPairTowards(arrows[event.key]) : facePairs[face][0]);
    });
  }

  function listen() {
    element("point").addEventListener("input", (event) => choosePoint(Number(event.target.value)));
    element("to-peak").addEventListener("click", () => choosePoint(data.point));
    element("pair").addEventListener("change", (event) => choosePair(Number(event.target.value)));
    element("previous-pair").addEventListener("click", () => choosePair(chosen.pair - 1));
    element("next-pair").addEventListener("click", () => choosePair(chosen.pair + 1));
    for (const [id, trace] of [["curve", 2], ["energy-curve", 0]]) {
      element(id).on("plotly_click", function (event) {
        const hit = event.points.find((candidate) => candidate.curveNumber === trace);
        if (hit) choosePoint(hit.pointNumber);
      });
    }
    facePairs.forEach((pairs, face) => { listenToMap("state-map-" + face, face); listenToMap("energy-map-" + face, face); });
    let logarithmic = figures.curve.layout.meta.logarithmic;
    element("scale").addEventListener("click", function () {
      logarithmic = !logarithmic;
      Plotly.relayout("curve", scaleOf(logarithmic));
      nameScale(logarithmic);
    });
    const curve = element("curve"), label = () => placePeakLabel(curve);
    curve.on("plotly_afterplot", label);
    label();
  }

  /* ---- the axis of the amplitude ---- */

  const linearNotes = figures.curve.layout.annotations.map((note) => ({ y: note.y, ay: note.ay, ayref: note.ayref }));

  function scaleOf(logarithmic) {
    const top = data.amplitude[data.point], ranges = figures.curve.layout.meta.ranges;
    const update = {
      "yaxis.type": logarithmic ? "log" : "linear", "yaxis.range": (logarithmic ? ranges.log : ranges.linear).slice(),
      "yaxis.dtick": logarithmic ? 1 : null, "yaxis.tickformat": logarithmic ? ".6~g" : null,
    };
    /* annotations lie on a logarithmic axis by their logarithms; ay is a place on the axis for arrows only */
    linearNotes.forEach(function (note, i) {
      for (const key of note.ayref === "y" ? ["y", "ay"] : ["y"]) {
        update["annotations[" + i + "]." + key] = logarithmic ? Math.log10(note[key] || top) : note[key];
      }
    });
    return update;
  }

  function nameScale(logarithmic) {
    element("scale").textContent = logarithmic ? "Linear axis" : "Logarithmic axis";
  }

  /* Before the curve is drawn, its axis changes in the figure itself. */
  function startScale() {
    const { yaxis, annotations, meta } = figures.curve.layout;
    if (!meta.logarithmic) return;
    for (const [path, value] of Object.entries(scaleOf(true))) {
      const [, note, key] = path.match(/^annotations\[(\d+)\]\.(\w+)$/) || [];
      if (key) annotations[note][key] = value;
      else yaxis[path.slice("yaxis.".length)] = value;
    }
    nameScale(true);
  }

  showCurve(); showMaps(); showChoice(); showPair(); showGroups(); startScale();
  drawn = true;

  /* One figure after the other, the curve first, so that each is seen as soon as it is drawn. */
  async function drawAll() {
    for (const [id, figure] of Object.entries(figures)) {
      await draw(id, figure);
      await fitMarks(id);
      await new Promise((shown) => setTimeout(shown, 0));
    }
    listen();
    document.body.dataset.ready = "yes";
    document.dispatchEvent(new Event("figures-drawn"));
  }
  drawAll();
})();
