/* Draws the figures of a sweep's page. No network, no library but plotly. */
(function () {
  "use strict";

  const element = (id) => document.getElementById(id);
  const figures = JSON.parse(element("page-figures").textContent);
  const phone = window.matchMedia("(max-width: 520px)");
  const options = { responsive: true, displayModeBar: false, showSendToCloud: false, plotlyServerURL: "" };

  function draw(id) {
    const figure = figures[id];
    if (phone.matches) {
      figure.layout.margin = Object.assign({}, figure.layout.margin, { l: 44, r: 6 });
      figure.layout.legend.font.size = 11;
    }
    const plot = element(id);
    return Plotly.newPlot(plot, figure.data, figure.layout, options).then(() =>
      plot.on("plotly_legendclick", (event) => hideCases(plot, event)));
  }

  /* An entry of the legend is a value of a key: it hides all cases with this value, or shows them again. Entries have no
     points; their meta is the key and the value, that of other traces the values of all keys. */
  function hideCases(plot, event) {
    const traces = event.data, clicked = traces[event.curveNumber], isEntry = (trace) => /^key /.test(trace.legendgroup);
    if (!isEntry(clicked)) return true;
    clicked.visible = clicked.visible === "legendonly" ? true : "legendonly";
    const hidden = traces.filter((trace) => isEntry(trace) && trace.visible === "legendonly").map((trace) => trace.meta);
    const visible = traces.map(function (trace) {
      if (isEntry(trace)) return trace.visible || true;
      return !(trace.meta && hidden.some(([key, value]) => trace.meta[key] === value));
    });
    Plotly.restyle(plot, { visible: visible });
    return false;
  }

  function listen() {
    const button = element("scale");
    button.hidden = !("curves" in figures);
    let logarithmic = false;
    button.addEventListener("click", function () {
      logarithmic = !logarithmic;
      Plotly.relayout("curves", {
        "yaxis.type": logarithmic ? "log" : "linear", "yaxis.autorange": true, "yaxis.dtick": logarithmic ? 1 : null,
        "yaxis.tickformat": logarithmic ? ".6~g" : null,
      });
      button.textContent = logarithmic ? "Linear axis" : "Logarithmic axis";
    });
  }

  Promise.all(Object.keys(figures).map(draw)).then(function () {
    listen();
    document.body.dataset.ready = "yes";
  });
})();
