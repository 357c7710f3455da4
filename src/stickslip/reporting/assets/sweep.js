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
  }

  Promise.all(Object.keys(figures).map(draw)).then(function () {
    listen();
    document.body.dataset.ready = "yes";
  });
})();
