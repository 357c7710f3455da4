/* What every page has beside its figures: a list of contents, and buttons that save figures as SVG and data as CSV. */
(function () {
  "use strict";

  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");

  function save(name, parts, type) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(parts, { type: type }));
    link.download = slug(document.title) + "-" + name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  /* Fields of RFC 4180; a leading sign of a formula in a text gets an apostrophe, because spreadsheets would run it. */
  function field(value) {
    let text = value === null || value === undefined ? "" : String(value).replace(/\u2212/g, "-").replace(/\s+/g, " ").trim();
    if (/^[=+@\-]/.test(text) && Number.isNaN(Number(text))) text = "'" + text;
    return /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
  }
  const csv = (rows) => ["\ufeff" + rows.map((row) => row.map(field).join(",")).join("\r\n") + "\r\n"];
  // texts of plotly: its tags, and the entities in which the page writes other texts
  const entities = { "&amp;": "&", "&lt;": "<", "&gt;": ">", "&quot;": '"', "&#34;": '"', "&#39;": "'", "&#37;": "%" };
  const plain = (text) => String(text || "").replace(/<[^>]*>/g, " ").replace(/&[#\w]+;/g, (each) => entities[each] || each);

  function tableRows(table) {
    return Array.from(table.rows, (row) => Array.from(row.cells, (cell) => cell.textContent));
  }

  /* The drawn lines and marks, a pair of columns each. */
  function figureRows(plot) {
    const axis = (name) => plain(((plot.layout[name] || {}).title || {}).text);
    const traces = plot.data.filter((trace) => trace.x && trace.y && trace.x.length && !trace.z);
    const heads = traces.flatMap((trace, i) => {
      const name = plain(trace.name) || "line " + (i + 1);
      const y = axis(trace.yaxis ? "yaxis" + trace.yaxis.slice(1) : "yaxis");
      return [name + ": " + (axis("xaxis") || "x"), name + ": " + (y || "y")];
    });
    const most = Math.max(0, ...traces.map((trace) => trace.x.length));
    const rows = Array.from({ length: most }, (_, i) => traces.flatMap((trace) => [trace.x[i], trace.y[i]]));
    const maps = plot.data.filter((trace) => trace.z && trace.type === "heatmap");
    for (const map of maps) {
      heads.push("x", "y", "value");
      map.z.forEach((line, j) => line.forEach((value, i) => rows.push([map.x[i], map.y[j], value])));
    }
    return [heads, ...rows];
  }

  function button(words, label, act) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = words;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", act);
    return made;
  }

  function toolsAfter(element, buttons) {
    const row = document.createElement("div");
    row.className = "tools screen-only";
    row.append(...buttons);
    element.after(row);
  }

  function addTools() {
    document.querySelectorAll(".plot").forEach(function (plot) {
      const name = plot.id || "figure", words = plot.getAttribute("aria-label") || name;
      const buttons = [button("SVG", "Save as SVG: " + words, function () {
        Plotly.toImage(plot, { format: "svg", width: plot.offsetWidth, height: plot.offsetHeight }).then((picture) =>
          save(name + ".svg", [decodeURIComponent(picture.slice(picture.indexOf(",") + 1))], "image/svg+xml"));
      })];
      if (name !== "structure-plot") {
        buttons.push(button("CSV", "Save data as CSV: " + words, () => save(name + ".csv", csv(figureRows(plot)), "text/csv")));
      }
      toolsAfter(plot, buttons);
    });
    document.querySelectorAll(".scroll > table").forEach(function (table) {
      const box = table.parentElement, words = box.getAttribute("aria-label");
      // beside another table, the button stays in its column
      toolsAfter(box.parentElement.classList.contains("two") ? table : box, [
        button("CSV", "Save table as CSV: " + words, () => save(slug(words) + ".csv", csv(tableRows(table)), "text/csv")),
      ]);
    });
  }

  /* A list of the sections; each gets an id from its heading. */
  function addContents() {
    const list = document.createElement("ul");
    document.querySelectorAll("main section").forEach(function (section) {
      const heading = section.querySelector("h2");
      if (!heading) return;
      if (!section.id) section.id = "section-" + slug(heading.textContent);
      const entry = document.createElement("li"), link = document.createElement("a");
      link.setAttribute("href", "#" + section.id);
      link.textContent = heading.textContent;
      entry.append(link);
      list.append(entry);
    });
    if (list.children.length < 3 || document.querySelector("main nav")) return;
    const contents = document.createElement("details"), summary = document.createElement("summary");
    contents.className = "contents screen-only";
    contents.open = window.matchMedia("(min-width: 821px)").matches;
    summary.textContent = "Contents";
    contents.append(summary, list);
    const first = document.querySelector("main section:not([aria-label])");
    if (first) first.before(contents);
  }

  /* In print: two small figures beside each other, and flat ones across the page. The structure is a still picture. */
  const plots = () => Array.from(document.querySelectorAll(".js-plotly-plot:not(#structure-plot)"));
  const HALF = 332, WHOLE = 676;
  const fonts = (text, title) => ({
    "font.size": text, "legend.font.size": text, "legend.grouptitlefont.size": text, "legend2.font.size": text, "xaxis.title.font.size": title,
    "yaxis.title.font.size": title, "yaxis2.title.font.size": title,
  });

  function present(plot, changes) {
    return Object.fromEntries(Object.entries(changes).filter(([path]) => path === "font.size" || path.split(".")[0] in plot.layout));
  }

  /* Marks of maps have a size in px: on smaller maps they would overlap. */
  function scaleMarks(plot, factor) {
    if (!plot.closest(".maps")) return;
    Plotly.restyle(plot, { "marker.size": plot.data.map((trace) => factor * trace.marker.size) });
  }

  /* Two plots above each other need more height: each has a title of its own, or there is a legend between them. */
  function shareOf(plot) {
    if (plot.layout.legend2) return 0.3;
    return plot.layout.yaxis2 && !plot.layout.yaxis2.overlaying ? 0.45 : 0.24;
  }

  /* In print a legend between two plots needs more of their height. */
  const PRINTED_GAP = [0.32, 0.68];
  function placeBetween(plot, [lower, upper]) {
    if (!plot.layout.legend2) return {};
    return { "yaxis.domain": [upper, 1], "yaxis2.domain": [0, lower], "legend2.y": lower + 0.02 };
  }

  function fitToPrint(plot) {
    if (plot.dataset.height) return;
    const isHalf = Boolean(plot.closest(".maps, .two")), screen = plot.layout.height;
    // figures name the height of a legend of several rows, of which print keeps three quarters, and their share of the rest
    const meta = plot.layout.meta || {}, legend = meta.legend || 0, rest = screen - legend;
    const height = Math.round((isHalf ? 96 + shareOf(plot) * rest : (meta.print || 0.45) * rest) + 0.75 * legend);
    plot.dataset.height = screen;
    plot.dataset.gap = JSON.stringify(plot.layout.legend2 ? [plot.layout.yaxis2.domain[1], plot.layout.yaxis.domain[0]] : []);
    scaleMarks(plot, 0.6);
    plot.style.height = height + "px";  // plotly may fit its figures to their elements once more
    Plotly.relayout(plot, Object.assign(present(plot, fonts(9, 10)), { width: isHalf ? HALF : WHOLE, autosize: false, height: height }, placeBetween(plot, PRINTED_GAP)));
    makeRoom(plot, height);
  }

  /* A legend of many rows would be cut, with a scroll bar, at half of the height, and leave no room for the curves. */
  function makeRoom(plot, height) {
    const { legend, yaxis2 } = plot._fullLayout;
    if (!legend || !legend._height || plot.layout.legend2) return;
    const curves = yaxis2 && !yaxis2.overlaying ? 200 : 120, around = 66;
    const needed = Math.ceil(Math.max(2 * legend._height + 8, legend._height + around + curves));
    if (needed <= height) return;
    plot.style.height = needed + "px";
    Plotly.relayout(plot, { height: needed });
  }

  function fitToScreen(plot) {
    if (!plot.dataset.height) return;
    plot.style.height = "";
    Plotly.relayout(plot, Object.assign(present(plot, fonts(12, 13)), { width: null, autosize: true, height: Number(plot.dataset.height) }, placeBetween(plot, JSON.parse(plot.dataset.gap))));
    scaleMarks(plot, 1.0 / 0.6);
    delete plot.dataset.height;
  }

  window.addEventListener("beforeprint", () => plots().forEach(fitToPrint));
  window.addEventListener("afterprint", () => plots().forEach(fitToScreen));
  // a browser without window does not send these events
  window.matchMedia("print").addEventListener("change", (now) => plots().forEach(now.matches ? fitToPrint : fitToScreen));

  addContents();
  addTools();
})();
