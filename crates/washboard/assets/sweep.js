// The chosen point of a sweep: marked in every plot and in the table, its controller and gains shown.
"use strict";
(() => {
  const source = document.getElementById("sweep");
  if (!source) return;
  const data = JSON.parse(source.textContent), place = document.getElementById("chosen");
  const make = (tag, text, parent, name) => {
    const e = document.createElement(tag);
    if (text) e.textContent = text;
    if (name) e.className = name;
    parent.append(e);
    return e;
  };
  const list = (parent, title, poles) => {
    const part = make("div", "", parent);
    make("h3", title, part);
    make("p", poles.length ? poles.join(",  ") : "none", part);
  };
  const curve = (values) => values && values.map((v) => v === null ? null : 10 ** (v / 1000));

  function show(index) {
    const point = data.points[index];
    if (!point) return;
    document.querySelectorAll("[data-point]").forEach((e) => e.classList.toggle("chosen", e.dataset.point === index));
    // over its neighbours
    document.querySelectorAll("svg [data-point].chosen").forEach((e) => e.parentNode.append(e));
    plots.forget(place);
    place.replaceChildren();
    make("h3", point.title, place);
    point.text.forEach((t) => make("p", t, place));
    if (point.passive === undefined) return;
    const both = make("div", "", place, "poles");
    list(both, "Poles of the controller, 1/s", point.controller_poles);
    list(both, "Poles of the loop, 1/s", point.loop_poles);
    make("h3", "Gains over frequency", place);
    const grid = make("div", "", place, "grid");
    data.outputs.forEach((output, k) => {
      const curves = [["passive", "before", curve(data.passive[point.passive][k])], [`closed loop`, "after", curve(point.closed[k])]];
      const shown = curves.filter(([, , y]) => y && y.some((v) => v !== null));
      if (!shown.length) return;
      const figure = make("figure", "", grid, "plot");
      make("figcaption", output.name, figure);
      const unit = `${output.unit} per ${data.per}`;
      plots.draw(make("div", "", figure, "canvas"), {
        x: data.freq_hz, x_axis: { label: "frequency, Hz", unit: "Hz", log: true, range: [data.freq_hz[0], data.freq_hz[data.freq_hz.length - 1]] },
        y_axis: { label: `gain, ${unit}`, unit, log: true, range: null },
        series: shown.map(([label, role, y]) => ({ label, role, y })), marks: [], lines: [], hover: [], group: "frequency",
      });
    });
  }

  addEventListener("click", (event) => {
    const e = event.target.closest("[data-point]");
    if (e) show(e.dataset.point);
  });
  addEventListener("keydown", (event) => {
    const e = event.target.closest && event.target.closest("tr[data-point]");
    if (e && (event.key === "Enter" || event.key === " ")) { event.preventDefault(); show(e.dataset.point); }
  });
  const first = document.querySelector("tr.front[data-point]") || document.querySelector("tr[data-point]");
  if (first) show(first.dataset.point);
})();
