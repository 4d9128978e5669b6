// Draws the plots of the page from its data; computes nothing but where things stand on the screen.
"use strict";
const plots = (() => {
  const given = JSON.parse(document.getElementById("data").textContent);
  const ink = "#16202a", faint = "#e3e7eb";
  const font = "12px system-ui, sans-serif";
  // thin and light against thick and dark: told apart without colour, too
  const styles = {
    "measured": { stroke: "#0b4a72", width: 1 },
    "measured-points": { stroke: "#0b4a72", dots: 3.5, solid: true },
    "measured-high": { stroke: "rgba(11, 74, 114, 0)", width: 0, fill: "rgba(11, 74, 114, 0.18)" },
    "measured-low": { stroke: "rgba(11, 74, 114, 0)", width: 0 },
    "fitted": { stroke: "#e8935f", width: 4 },
    "fitted-points": { stroke: "#e8935f", dots: 8, solid: true },
    "found": { stroke: "#b03a06", width: 2.4 },
    "high": { stroke: "#d9a58c", width: 1, fill: "rgba(176, 58, 6, 0.16)" },
    "low": { stroke: "#d9a58c", width: 1 },
    "truth": { stroke: ink, width: 1.6, dash: [7, 5] },
    "singular": { stroke: "#9fb4c3", width: 1 },
    "before": { stroke: "#0b4a72", width: 1.2, joined: true },
    "after": { stroke: "#c2470b", width: 1.2, joined: true },
    "line": { width: 1.5 },
    "passive": { stroke: "#52606d", width: 2 },
    "designed": { width: 2 },
    "designed-true": { stroke: ink, width: 1.4 },
    "poles": { sign: 3.2 },
    "estimates": { sign: 4 },
  };
  const lines = [["#0b4a72"], ["#c2470b", [7, 4]], ["#3a7d44", [2, 3]], [ink, [9, 3, 2, 3]], ["#7b4ea3", [4, 2]]];
  // dashes of what was designed with the truth
  const dashes = [[2, 4], [8, 4]];
  const isLow = (s) => s.role === "low" || s.role === "measured-low";
  const isEnd = (s) => isLow(s) || s.role === "high" || s.role === "measured-high";

  // the width of an upright axis: of its longest number, so that none runs into the name
  const LEAST = 54;
  function room() {
    let known = LEAST;
    return (u, values, index, cycle) => {
      if (cycle > 1 || !values) return known;
      const a = u.axes[index];
      u.ctx.save();
      u.ctx.font = font;
      const widest = Math.max(0, ...values.map((v) => u.ctx.measureText(v ?? "").width));
      u.ctx.restore();
      known = Math.max(LEAST, Math.ceil(widest + a.ticks.size + a.gap + 2));
      return known;
    };
  }

  function axis(spec, side, grid) {
    const horizontal = side === 2;
    const a = { side, stroke: ink, font, labelFont: font, grid: { show: grid, stroke: faint, width: 1 },
      ticks: { stroke: faint, width: 1, size: 5 }, size: 34, gap: 4 };
    if (!horizontal) a.size = room();
    if (spec.label) { a.label = spec.label; a.labelSize = 20; }
    if (spec.log) {
      a.splits = (u, i, low, high) => numbers.logSplits(low, high, (horizontal ? u.bbox.width : u.bbox.height) / devicePixelRatio);
      a.filter = (u, splits) => splits;
      a.values = (u, splits) => splits.map((v) => numbers.logText(v, horizontal));
    } else {
      a.values = (u, splits) => numbers.alike(splits);
      if (spec.unit === "°") a.splits = () => [-180, -90, 0, 90, 180];
    }
    return a;
  }
  const scale = (spec) => ({ time: false, distr: spec.log ? 3 : 1, ...(spec.range ? { range: spec.range } : {}) });

  function series(s) {
    const [stroke, dash] = lines[(s.sign || 0) % lines.length];
    const own = { "line": { stroke, dash }, "designed": { stroke }, "designed-true": { dash: dashes[(s.sign || 0) % dashes.length] } };
    const style = { ...styles[s.role], ...own[s.role] };
    const out = { label: s.label, stroke: style.stroke, scale: s.second ? "second" : "y", pxAlign: 0, value: (u, v) => numbers.value(v) };
    if (style.sign) {
      const sign = overlay.signOf(s.sign || 0);
      Object.assign(out, { label: `${sign.glyph} ${s.label}`, stroke: sign.color, paths: () => null, width: 0, points: { show: false } });
    } else if (style.dots) {
      out.paths = () => null;
      out.width = 0;
      out.points = { show: true, size: style.dots, width: 1.2, stroke: style.stroke, fill: style.solid ? style.stroke : "#fff" };
    } else {
      Object.assign(out, { width: style.width, dash: style.dash, spanGaps: !!style.joined || s.role === "singular", points: { show: false } });
    }
    return out;
  }

  const drawn = [];
  const draw = (place, plot = given[+place.dataset.plot]) => {
    const wide = place.parentElement.classList.contains("wide");
    const height = (width) => wide ? Math.max(260, Math.min(430, width * 0.5)) : Math.max(190, Math.min(250, width * 0.52));
    const told = plot.hover.length > 0;
    const signed = (i) => i > 0 && styles[plot.series[i - 1].role].sign;
    const hooks = {
      drawAxes: [(u) => { overlay.modes(u, plot); overlay.limits(u, plot); }],
      drawSeries: [(u, i) => { if (signed(i)) overlay.points(u, plot.series, i - 1, signed(i)); }],
    };
    // before a value is pointed at, the legend has none
    hooks.setCursor = [(u) => u.root.classList.toggle("idle", u.cursor.idx == null)];
    if (told) hooks.setCursor.push(overlay.teller(plot));
    const bands = plot.series.flatMap((s, i) => isLow(plot.series[i + 1] || s) && !isLow(s)
      ? [{ series: [i + 1, i + 2], fill: styles[s.role].fill }] : []);
    const u = new uPlot({
      width: place.clientWidth, height: height(place.clientWidth), hooks, bands,
      padding: [plot.marks.length ? 22 : 8, plot.lines.some(overlay.isText) ? 22 : 12, 0, 0],
      scales: { x: scale(plot.x_axis), y: scale(plot.y_axis), ...(plot.second_axis ? { second: scale(plot.second_axis) } : {}) },
      axes: [axis(plot.x_axis, 2, true), axis(plot.y_axis, 3, true),
        ...(plot.second_axis ? [{ ...axis(plot.second_axis, 1, false), scale: "second" }] : [])],
      series: [{ label: plot.x_axis.unit || "x", value: (_, v) => numbers.value(v) }, ...plot.series.map(series)],
      legend: { live: !told },
      cursor: { drag: { x: true, y: false }, points: { size: 6, show: !told }, ...(plot.group ? { sync: { key: plot.group } } : {}) },
    }, [plot.x, ...plot.series.map((s) => s.y)], place);
    u.root.classList.add("idle");
    // an interval's ends are no curves of their own; a sign stands for itself
    const rows = [...u.root.querySelectorAll(".u-legend .u-series")], first = rows.length - plot.series.length;
    plot.series.forEach((s, k) => {
      const row = rows[first + k];
      if (isEnd(s)) row.hidden = true;
      const { dash, width } = series(s), marker = row.querySelector(".u-marker");
      if (dash && marker) marker.classList.add(dash[0] < 4 ? "dotted" : "dashed");
      else if (width > 0 && marker) marker.classList.add("solid");
      if (!signed(k + 1)) return;
      row.classList.add("signed");
      row.querySelector("th").style.color = overlay.signOf(s.sign || 0).color;
    });
    drawn.push({ u, place, height, wide });
  };
  // what is folded has no width yet: it is drawn when it is opened
  document.querySelectorAll(".canvas").forEach((place) => {
    const folded = place.closest("details:not([open])");
    if (folded) folded.addEventListener("toggle", () => draw(place), { once: true });
    else draw(place);
  });

  const fit = (to) => drawn.forEach(({ u, place, height, wide }) => {
    const width = to ? to[+wide] : place.clientWidth;
    if (width > 0 && Math.round(width) !== u.width) u.setSize({ width: Math.round(width), height: height(width) });
  });
  let paper = false;
  addEventListener("resize", () => paper || fit());
  addEventListener("beforeprint", () => { paper = true; fit([330, 680]); });
  addEventListener("afterprint", () => { paper = false; fit(); });
  // plots within an element that is about to be emptied
  const forget = (within) => {
    for (let k = drawn.length - 1; k >= 0; k--) if (within.contains(drawn[k].place)) drawn.splice(k, 1)[0].u.destroy();
  };
  return { draw, forget };
})();
