// Draws the plots of the page from its data; computes nothing but where things stand on the screen.
"use strict";
(() => {
  const plots = JSON.parse(document.getElementById("data").textContent);
  const ink = "#16202a", soft = "#6b7785", faint = "#e3e7eb";
  const font = "12px system-ui, sans-serif";
  // thin and light against thick and dark: told apart without colour, too
  const styles = {
    "measured": { stroke: "#0b4a72", width: 1 },
    "measured-points": { stroke: "#0b4a72", dots: 3.5, solid: true },
    "fitted": { stroke: "#e8935f", width: 4 },
    "fitted-points": { stroke: "#e8935f", dots: 8, solid: true },
    "found": { stroke: "#b03a06", width: 2.4 },
    "high": { stroke: "#d9a58c", width: 1 },
    "low": { stroke: "#d9a58c", width: 1 },
    "truth": { stroke: ink, width: 1.6, dash: [7, 5] },
    "stable": { stroke: "#0b5077", dots: 7, solid: true },
    "unstable": { stroke: "#c58b6f", dots: 5 },
  };
  const raised = (n) => "10" + String(n).replace(/./g, (c) => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]);
  const plain = (v) => String(+v.toPrecision(6)).replace("-", "−");
  const value = (v) => {
    if (v == null) return "–";
    const size = Math.abs(v);
    if (size === 0 || (size >= 1e-3 && size < 1e5)) return String(+v.toPrecision(4)).replace("-", "−");
    const [digits, exponent] = v.toExponential(2).split("e");
    return digits.replace("-", "−") + "·" + raised(+exponent);
  };

  // marks of a logarithmic axis: 1, 2, 5 of each decade where there is room, else whole decades, else every other one
  function logSplits(u, low, high, pixels) {
    const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high));
    const room = pixels / Math.max(Math.log10(high / low), 1e-9);
    const steps = room > 110 ? [1, 2, 5] : [1], stride = Math.max(1, Math.ceil(26 / room));
    const at = [];
    for (let d = first; d <= last; d++)
      if (d % stride === 0) for (const s of steps) at.push(s * 10 ** d);
    return at.filter((v) => v >= low * 0.9999 && v <= high * 1.0001);
  }
  function axis(spec, side, grid) {
    const horizontal = side === 2;
    const a = { side, stroke: ink, font, labelFont: font, grid: { stroke: faint, width: 1 }, ticks: { stroke: faint, width: 1, size: 5 },
      size: horizontal ? 34 : 54, gap: 4 };
    if (spec.label) { a.label = spec.label; a.labelSize = 20; }
    if (spec.log) {
      a.splits = (u, i, low, high) => logSplits(u, low, high, (horizontal ? u.bbox.width : u.bbox.height) / devicePixelRatio);
      a.filter = (u, splits) => splits;
      a.values = (u, splits) => splits.map((v) => v >= 0.001 && v < 10000 && horizontal ? plain(v)
        : Math.abs(Math.log10(v) % 1) < 1e-9 ? raised(Math.round(Math.log10(v))) : "");
    } else {
      a.values = (u, splits) => splits.map(plain);
      if (spec.unit === "°") a.splits = () => [-180, -90, 0, 90, 180];
    }
    return a;
  }
  const scale = (spec) => ({ time: false, distr: spec.log ? 3 : 1, ...(spec.range ? { range: spec.range } : {}) });

  function series(s, plot) {
    const style = styles[s.role];
    const out = { label: s.label, stroke: style.stroke, value: (u, v) => value(v) };
    if (style.dots) {
      out.paths = () => null;
      out.width = 0;
      out.points = { show: true, size: style.dots, width: 1.2, stroke: style.stroke, fill: style.solid ? style.stroke : "#fff" };
    } else {
      Object.assign(out, { width: style.width, dash: style.dash, points: { show: false } });
    }
    return out;
  }

  const isPoint = (line) => line.x[0] === line.x[1];

  // straight lines and modes, behind the curves
  function under(plot) {
    return (u) => {
      const { ctx, bbox } = u, px = devicePixelRatio;
      const xy = (x, y) => [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top - 16 * px, bbox.width, bbox.height + 16 * px);
      ctx.clip();
      ctx.font = `${11 * px}px system-ui, sans-serif`;
      ctx.lineWidth = px;
      ctx.strokeStyle = ctx.fillStyle = soft;
      ctx.textAlign = "center";
      ctx.textBaseline = "bottom";
      ctx.setLineDash([3 * px, 3 * px]);
      for (const m of plot.marks) {
        if (m.x < u.scales.x.min || m.x > u.scales.x.max) continue;
        const [x] = xy(m.x, u.scales.y.max);
        ctx.beginPath(); ctx.moveTo(x, bbox.top); ctx.lineTo(x, bbox.top + bbox.height); ctx.stroke();
        ctx.fillText(m.label, x, bbox.top - 2 * px);
      }
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.setLineDash([]);
      ctx.textAlign = "left";
      for (const l of plot.lines) {
        const [a, b] = [xy(l.x[0], l.y[0]), xy(l.x[1], l.y[1])];
        ctx.beginPath(); ctx.moveTo(...a); ctx.lineTo(...b); ctx.stroke();
        if (!isPoint(l)) ctx.fillText(l.label, Math.max(a[0], bbox.left) + 5 * px, a[1] + 17 * px);
      }
      ctx.restore();
      ctx.save();
      ctx.font = `bold ${12 * px}px system-ui, sans-serif`;
      ctx.fillStyle = soft;
      ctx.textAlign = "left";
      ctx.textBaseline = "middle";
      for (const l of plot.lines.filter(isPoint)) {
        const [x, y] = xy(l.x[0], l.y[0]);
        if (y > bbox.top && y < bbox.top + bbox.height && l.x[0] >= u.scales.x.max * 0.999) ctx.fillText(l.label, x + 6 * px, y);
      }
      ctx.restore();
    };
  }

  // the nearest point's story, below a plot of points
  function teller(plot, readout) {
    return (u) => {
      const { left, top } = u.cursor;
      let best = null, nearest = 400;
      if (left >= 0) plot.x.forEach((x, i) => {
        const y = plot.series.map((s) => s.y[i]).find((v) => v != null);
        const d = (u.valToPos(x, "x") - left) ** 2 + (u.valToPos(y, "y") - top) ** 2;
        if (d < nearest) [best, nearest] = [i, d];
      });
      readout.textContent = best === null ? "" : plot.hover[best];
    };
  }

  const drawn = [];
  document.querySelectorAll(".canvas").forEach((place) => {
    const plot = plots[+place.dataset.plot], wide = place.parentElement.classList.contains("wide");
    const height = (width) => wide ? Math.max(260, Math.min(430, width * 0.5)) : Math.max(190, Math.min(250, width * 0.52));
    const told = plot.hover.length > 0;
    const high = plot.series.findIndex((s) => s.role === "high") + 1;
    const hooks = { drawAxes: [under(plot)] };
    if (told) {
      const readout = place.parentElement.appendChild(document.createElement("div"));
      readout.className = "readout";
      hooks.setCursor = [teller(plot, readout)];
    }
    const width = place.clientWidth;
    const u = new uPlot({
      width, height: height(width), padding: [plot.marks.length ? 16 : 8, plot.lines.some(isPoint) ? 22 : 12, 0, 0], hooks,
      scales: { x: scale(plot.x_axis), y: scale(plot.y_axis) },
      axes: [axis(plot.x_axis, 2), axis(plot.y_axis, 3)],
      series: [{ label: plot.x_axis.unit || "x", value: (_, v) => value(v) }, ...plot.series.map(series)],
      bands: high ? [{ series: [high, high + 1], fill: "rgba(176, 58, 6, 0.16)" }] : [],
      legend: { live: !told },
      cursor: { drag: { x: true, y: false }, points: { size: 6 }, ...(plot.group ? { sync: { key: plot.group } } : {}) },
    }, [plot.x, ...plot.series.map((s) => s.y)], place);
    drawn.push({ u, place, height, wide });
  });

  const fit = (to) => drawn.forEach(({ u, place, height, wide }) => {
    const width = to ? to[+wide] : place.clientWidth;
    if (width > 0 && Math.round(width) !== u.width) u.setSize({ width: Math.round(width), height: height(width) });
  });
  let paper = false;
  addEventListener("resize", () => paper || fit());
  addEventListener("beforeprint", () => { paper = true; fit([330, 680]); });
  addEventListener("afterprint", () => { paper = false; fit(); });
})();
