/* The structure that can be turned, and its deflected shape over one period at the peak. */
(function () {
  "use strict";

  const PERIOD_MS = 2400, TURN = Math.PI / 24, ZOOM = 1.15, NEAR = 1.3;
  const HALF_ANGLE = Math.tan(Math.PI / 8);  // plotly sees 45 degrees from bottom to top
  const element = (id) => document.getElementById(id);
  const section = element("structure"), plot = element("structure-plot");

  function offersWebgl() {
    const canvas = document.createElement("canvas");
    return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
  }

  function showStill() {
    section.classList.remove("live");
    element("structure-no-webgl").hidden = false;
  }

  if (!offersWebgl()) {
    showStill();
    section.dataset.ready = "still";
    return;
  }

  const data = JSON.parse(element("structure-data").textContent);
  const points = unpack(data.points, Float32Array);
  const at = data.at.map((text) => unpack(text, Int32Array));
  const motion = data.motion && unpack(data.motion.values, Int16Array);
  const all = at.map((_, trace) => trace);

  /* ---- where everything is: at rest (phase null), or at a phase in degrees ---- */

  function places(phase) {
    if (phase === null) return points;
    const moved = points.slice(), size = points.length;
    for (let column = 0; column < data.motion.coefficients; column++) {
      const angle = Math.ceil(column / 2) * phase * Math.PI / 180;
      const weight = data.motion.step * (column % 2 || column === 0 ? Math.cos(angle) : Math.sin(angle));
      const start = column * size;
      for (let i = 0; i < size; i++) moved[i] += weight * motion[start + i];
    }
    return moved;
  }

  /* What plotly needs: x, y and z of every trace, and those of the labels. */
  function coordinates(phase) {
    const where = places(phase), traces = {}, notes = {};
    ["x", "y", "z"].forEach(function (name, axis) {
      traces[name] = at.map((numbers) => Float32Array.from(numbers, (point) => (point < 0 ? NaN : where[3 * point + axis])));
      data.labels.forEach((point, i) => { notes["scene.annotations[" + i + "]." + name] = where[3 * point + axis]; });
    });
    return { traces: traces, notes: notes };
  }

  const shown = { phase: null, playing: false, dragged: false };

  function show(phase) {
    shown.phase = phase;
    const words = phase === null ? "at rest" : Math.round(phase) + "°";
    element("structure-phase-label").textContent = words;
    element("structure-phase").value = String(phase || 0);
    element("structure-phase").setAttribute("aria-valuetext", words);
    const now = coordinates(phase);
    return Plotly.update(plot, now.traces, now.notes, all);
  }

  /* ---- what the reader does ---- */

  function play(wanted) {
    if (shown.playing === wanted) return;
    shown.playing = wanted;
    element("structure-play").textContent = wanted ? "Pause" : "Play";
    if (!wanted) return;
    let last = performance.now();
    const step = function (now) {
      if (!shown.playing) return;
      const passed = now - last;
      last = now;
      // While the reader turns the structure plotly would take the camera back to where it was.
      const next = shown.dragged ? Promise.resolve() : show(((shown.phase || 0) + 360 * passed / PERIOD_MS) % 360);
      next.then(() => requestAnimationFrame(step));
    };
    requestAnimationFrame(step);
  }

  function listenToMotion() {
    element("structure-play").addEventListener("click", () => play(!shown.playing));
    element("structure-rest").addEventListener("click", function () { play(false); show(null); });
    element("structure-phase").addEventListener("input", function (event) { play(false); show(Number(event.target.value)); });
    plot.addEventListener("pointerdown", () => { shown.dragged = true; }, true);
    for (const end of ["pointerup", "pointercancel"]) window.addEventListener(end, () => { shown.dragged = false; }, true);
  }

  /* Colours of a stress on all surfaces, or those of the bodies; bodies that are transparent become opaque. */
  function paint(measure) {
    const surfaces = all.filter((trace) => data.figure.data[trace].type === "mesh3d");
    const values = measure && unpack(measure.values, Float32Array);
    const look = {
      intensity: surfaces.map((trace) => (measure ? Float32Array.from(at[trace], (point) => values[point]) : null)),
      opacity: surfaces.map((trace) => (measure ? 1 : bodyOpacity[trace])),
      showscale: surfaces.map((_, i) => Boolean(measure) && i === 0),
      hovertemplate: surfaces.map((trace) => (measure ? bodyHover[trace].replace("<extra>", "<br>%{intensity:.4g} MPa<extra>") : bodyHover[trace])),
    };
    if (measure) {
      Object.assign(look, {
        cmin: 0, cmax: measure.largest || 1, colorscale: "Viridis",
        colorbar: { title: { text: measure.words, side: "right", font: { size: 12 } }, thickness: 12, len: 0.7, x: 1, xanchor: "right" },
      });
    }
    return Plotly.restyle(plot, look, surfaces);
  }

  const bodyOpacity = data.figure.data.map((trace) => (trace.opacity === undefined ? 1 : trace.opacity));
  const bodyHover = data.figure.data.map((trace) => trace.hovertemplate || "");

  /* The camera of a view: so far away that the corners of its box are inside a picture of this shape. */
  function cameraOf(view) {
    const aspect = plot.clientWidth / data.figure.layout.height, triple = (values) => ({ x: values[0], y: values[1], z: values[2] });
    const distance = Math.max(...view.corners.map(([right, up, towards]) =>
      Math.max(Math.abs(right) / aspect, Math.abs(up)) / HALF_ANGLE + towards));
    return {
      eye: triple(view.centre.map((from, axis) => from + distance * view.towards[axis])), center: triple(view.centre),
      up: { x: 0, y: 0, z: 1 },
    };
  }

  const setCamera = (camera) => Plotly.relayout(plot, { "scene.camera": camera });

  /* Names of t1 and t2 on a small contact would cover each other: they are there when the eye is near to it. */
  const names = all.filter((trace) => data.figure.data[trace].mode === "text").map((trace) => [trace, data.figure.data[trace].text]);
  const distanceOf = (camera) => Math.hypot(...["x", "y", "z"].map((axis) => camera.eye[axis] - camera.center[axis]));
  const isNear = (camera) => !data.views.contact || distanceOf(camera) < NEAR * distanceOf(cameraOf(data.views.contact));
  const namesFor = (text, near) => (near ? text : text.map(() => ""));
  let near = true;

  function nameDirections() {
    const now = isNear(plot.layout.scene.camera);
    if (now === near) return;
    near = now;
    names.forEach(([trace, text]) => Plotly.restyle(plot, { text: [namesFor(text, near)] }, [trace]));
  }

  /* The eye goes round the centre: to the right and up by angles, and nearer by a factor. */
  function turned(camera, right, up, nearer) {
    const from = camera.center, arm = ["x", "y", "z"].map((axis) => camera.eye[axis] - from[axis]);
    const distance = Math.hypot(...arm) / nearer, azimuth = Math.atan2(arm[1], arm[0]) + right;
    const steepest = Math.PI / 2 - 0.02;
    const height = Math.max(-steepest, Math.min(steepest, Math.asin(arm[2] / Math.hypot(...arm)) + up));
    const eye = {
      x: from.x + distance * Math.cos(height) * Math.cos(azimuth), y: from.y + distance * Math.cos(height) * Math.sin(azimuth),
      z: from.z + distance * Math.sin(height),
    };
    return { eye: eye, center: from, up: { x: 0, y: 0, z: 1 } };
  }

  const keys = {
    ArrowLeft: [-TURN, 0, 1], ArrowRight: [TURN, 0, 1], ArrowUp: [0, TURN, 1], ArrowDown: [0, -TURN, 1],
    "+": [0, 0, ZOOM], "-": [0, 0, 1 / ZOOM],
  };

  function listen() {
    plot.addEventListener("keydown", function (event) {
      if (!keys[event.key]) return;
      event.preventDefault();
      setCamera(turned(plot.layout.scene.camera, ...keys[event.key]));
    });
    for (const button of section.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => setCamera(cameraOf(data.views[button.dataset.view])));
    }
    for (const box of section.querySelectorAll("[data-traces]")) {
      const traces = box.dataset.traces.split(" ").map(Number);
      box.addEventListener("change", () => Plotly.restyle(plot, { visible: box.checked }, traces));
    }
    const colour = element("structure-colour");
    if (colour) colour.addEventListener("change", () => paint(colour.value === "" ? null : data.stress[Number(colour.value)]));
    plot.on("plotly_webglcontextlost", showStill);
    plot.on("plotly_relayout", nameDirections);
    if (motion) listenToMotion();
  }

  function draw() {
    const figure = data.figure, start = coordinates(null).traces;
    figure.data.forEach((trace, i) => Object.assign(trace, { x: start.x[i], y: start.y[i], z: start.z[i] }));
    figure.layout.scene.annotations.forEach(function (note, i) {
      ["x", "y", "z"].forEach((name, axis) => { note[name] = points[3 * data.labels[i] + axis]; });
    });
    if (window.matchMedia("(max-width: 520px)").matches) {
      figure.layout.height = data.narrow.height;
      data.narrow.offsets.forEach((offset, i) => Object.assign(figure.layout.scene.annotations[i], { ax: offset[0], ay: offset[1] }));
    }
    section.classList.add("live");
    figure.layout.scene.camera = cameraOf(data.views.whole);
    near = isNear(figure.layout.scene.camera);
    names.forEach(([trace, text]) => { figure.data[trace].text = namesFor(text, near); });
    Plotly.newPlot(plot, figure.data, figure.layout, {
      responsive: true, displayModeBar: false, showSendToCloud: false, plotlyServerURL: "",
    }).then(function () {
      listen();
      section.dataset.ready = "live";
    });
  }

  // The other figures come first; until then the still picture is there.
  const drawSoon = () => setTimeout(draw, 0);
  if (document.body.dataset.ready) drawSoon();
  else document.addEventListener("figures-drawn", drawSoon, { once: true });
})();
