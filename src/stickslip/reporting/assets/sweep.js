/* Draws the figures of a sweep's page. No network, no library but plotly. */
(function () {
  "use strict";

  const element = (id) => document.getElementById(id);
  const figures = JSON.parse(element("page-figures").textContent);
  const phone = window.matchMedia("(max-width: 520px)");
  const options = {
    responsive: true, displaylogo: false, showSendToCloud: false, plotlyServerURL: "",
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
  };

  function draw(id) {
    const figure = figures[id];
    if (phone.matches) {
      figure.layout.margin = Object.assign({}, figure.layout.margin, { l: 44, r: 6 });
      figure.layout.legend.font.size = 11;
    }
    return Plotly.newPlot(element(id), figure.data, figure.layout, options);
  }

  function listen() {
    const button = element("scale");
    button.hidden = !("curves" in figures);
    let logarithmic = false;
    button.addEventListener("click", function () {
      logarithmic = !logarithmic;
      Plotly.relayout("curves", {
        "yaxis.type": logarithmic ? "log" : "linear", "yaxis.autorange": true, "yaxis.dtick": logarithmic ? 1 : null,
      });
      button.textContent = logarithmic ? "Linear axis" : "Logarithmic axis";
    });
    const plots = () => Array.from(document.querySelectorAll(".js-plotly-plot"));
    window.addEventListener("beforeprint", () => plots().forEach((plot) => Plotly.relayout(plot, { width: 660, autosize: false })));
    window.addEventListener("afterprint", () => plots().forEach((plot) => Plotly.relayout(plot, { width: null, autosize: true })));
  }

  Promise.all(Object.keys(figures).map(draw)).then(function () {
    listen();
    document.body.dataset.ready = "yes";
  });
})();
