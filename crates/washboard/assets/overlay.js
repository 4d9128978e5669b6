// What uPlot does not draw: modes and limits behind the curves, signs and error bars of points, and the text at a point.
"use strict";
const overlay = (() => {
  const soft = "#6b7785", face = "system-ui, sans-serif";
  // signs and colours belong together: told apart without colour, too
  const signs = [
    { glyph: "●", color: "#0b5077" }, { glyph: "○", color: "#b03a06" }, { glyph: "✕", color: "#6d4aa8" },
    { glyph: "□", color: "#2b7a3d" }, { glyph: "△", color: "#a3610b" }, { glyph: "◇", color: "#a8356f" },
    { glyph: "■", color: "#47535f" }, { glyph: "▲", color: "#1b8a9a" }, { glyph: "◆", color: "#7a6a12" },
  ];
  const signOf = (n) => signs[n % signs.length];

  // positions near those that are wanted and at least `gap` apart: the mean of each crowd stays (isotonic regression)
  function spread(wanted, gap, low, high) {
    const crowds = [];
    wanted.forEach((w, i) => {
      crowds.push({ sum: w - i * gap, n: 1 });
      for (let k = crowds.length - 1; k > 0 && crowds[k - 1].sum / crowds[k - 1].n >= crowds[k].sum / crowds[k].n; k--) {
        const last = crowds.pop();
        crowds[k - 1].sum += last.sum; crowds[k - 1].n += last.n;
      }
    });
    const at = crowds.flatMap((c) => Array(c.n).fill(c.sum / c.n)).map((q, i) => q + i * gap);
    return at.map((p, i) => Math.min(Math.max(p, low + i * gap), high - (at.length - 1 - i) * gap));
  }

  function modes(u, plot) {
    const { ctx, bbox } = u, px = devicePixelRatio;
    const seen = plot.marks.filter((m) => m.x >= u.scales.x.min && m.x <= u.scales.x.max);
    if (!seen.length) return;
    ctx.save();
    ctx.font = `${11 * px}px ${face}`;
    ctx.lineWidth = px;
    ctx.strokeStyle = ctx.fillStyle = soft;
    ctx.textAlign = "center";
    ctx.textBaseline = "bottom";
    const x = seen.map((m) => u.valToPos(m.x, "x", true));
    ctx.setLineDash([3 * px, 3 * px]);
    x.forEach((p) => { ctx.beginPath(); ctx.moveTo(p, bbox.top); ctx.lineTo(p, bbox.top + bbox.height); ctx.stroke(); });
    ctx.setLineDash([]);
    const gap = Math.max(...seen.map((m) => ctx.measureText(m.label).width)) + 3 * px;
    // where not all numbers have room none is better than a smear
    if (gap * (seen.length - 1) < bbox.width) {
      const at = spread(x, gap, bbox.left, bbox.left + bbox.width);
      seen.forEach((m, i) => {
        ctx.beginPath(); ctx.moveTo(x[i], bbox.top); ctx.lineTo(at[i], bbox.top - 6 * px); ctx.stroke();
        ctx.fillText(m.label, at[i], bbox.top - 6 * px);
      });
    }
    ctx.restore();
  }

  const isText = (line) => line.x[0] === line.x[1];

  function limits(u, plot) {
    const { ctx, bbox } = u, px = devicePixelRatio;
    const xy = (x, y) => [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * px}px ${face}`;
    ctx.lineWidth = px;
    ctx.textAlign = "left";
    ctx.textBaseline = "bottom";
    for (const l of plot.lines.filter((l) => !isText(l))) {
      const [a, b] = [xy(l.x[0], l.y[0]), xy(l.x[1], l.y[1])];
      ctx.strokeStyle = ctx.fillStyle = l.sign == null ? soft : signOf(l.sign).color;
      ctx.setLineDash(l.sign == null ? [] : [6 * px, 4 * px]);
      ctx.beginPath(); ctx.moveTo(...a); ctx.lineTo(...b); ctx.stroke();
      ctx.fillText(l.label, Math.max(a[0], bbox.left) + 5 * px, a[1] + 17 * px);
    }
    ctx.restore();
    ctx.save();
    ctx.font = `bold ${12 * px}px ${face}`;
    ctx.fillStyle = soft;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    for (const l of plot.lines.filter(isText)) {
      const [x, y] = xy(l.x[0], l.y[0]);
      if (y > bbox.top && y < bbox.top + bbox.height && l.x[0] >= u.scales.x.max * 0.999) ctx.fillText(l.label, x + 6 * px, y);
    }
    ctx.restore();
  }

  const outline = {
    "●": (c, x, y, r) => c.arc(x, y, r, 0, 7), "○": (c, x, y, r) => c.arc(x, y, r, 0, 7),
    "✕": (c, x, y, r) => { c.moveTo(x - r, y - r); c.lineTo(x + r, y + r); c.moveTo(x - r, y + r); c.lineTo(x + r, y - r); },
    "□": (c, x, y, r) => c.rect(x - r, y - r, 2 * r, 2 * r), "■": (c, x, y, r) => c.rect(x - r, y - r, 2 * r, 2 * r),
    "△": (c, x, y, r) => { c.moveTo(x, y - r); c.lineTo(x + r, y + r); c.lineTo(x - r, y + r); c.closePath(); },
    "◇": (c, x, y, r) => { c.moveTo(x, y - r); c.lineTo(x + r, y); c.lineTo(x, y + r); c.lineTo(x - r, y); c.closePath(); },
  };
  outline["▲"] = outline["△"];
  outline["◆"] = outline["◇"];

  // estimates at one abscissa stand side by side, so that their error bars can be told apart
  const STEP = 5;

  function points(u, all, index, size) {
    const { ctx, bbox } = u, px = devicePixelRatio, series = all[index], sign = signOf(series.sign || 0);
    const aside = series.role === "estimates" ? STEP * px * (index - (all.length - 1) / 2) : 0;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left - 6 * px, bbox.top - 6 * px, bbox.width + 12 * px, bbox.height + 12 * px);
    ctx.clip();
    ctx.lineWidth = 1.4 * px;
    ctx.strokeStyle = ctx.fillStyle = sign.color;
    series.y.forEach((y, i) => {
      const x = u.data[0][i];
      if (y == null || x < u.scales.x.min || x > u.scales.x.max) return;
      const at = u.valToPos(x, "x", true) + aside, e = series.error && series.error[i];
      if (e != null) {
        const [low, high] = [y - e, y + e].map((v) => u.valToPos(v, "y", true)), w = 2.2 * px;
        ctx.beginPath();
        ctx.moveTo(at, low); ctx.lineTo(at, high);
        ctx.moveTo(at - w, low); ctx.lineTo(at + w, low); ctx.moveTo(at - w, high); ctx.lineTo(at + w, high);
        ctx.stroke();
      }
      ctx.beginPath();
      outline[sign.glyph](ctx, at, u.valToPos(y, "y", true), size * px);
      if ("●■▲◆".includes(sign.glyph)) ctx.fill(); else ctx.stroke();
    });
    ctx.restore();
  }

  // the nearest point's story, beside it: at the pointer, and at a finger's tap
  function teller(plot) {
    let tip = null;
    return (u) => {
      if (!tip) { tip = u.over.appendChild(document.createElement("div")); tip.className = "tip"; }
      const { left, top } = u.cursor;
      let best = null, nearest = 400;
      if (left >= 0) plot.x.forEach((x, i) => {
        if (!plot.hover[i]) return;
        plot.series.forEach((s, k) => {
          if (s.second || s.y[i] == null || !u.series[k + 1].show) return;
          const d = (u.valToPos(x, "x") - left) ** 2 + (u.valToPos(s.y[i], "y") - top) ** 2;
          if (d < nearest) [best, nearest] = [{ i, x: u.valToPos(x, "x"), y: u.valToPos(s.y[i], "y") }, d];
        });
      });
      tip.hidden = best === null;
      if (best === null) return;
      tip.textContent = plot.hover[best.i];
      const right = best.x > u.over.clientWidth / 2;
      tip.style.left = right ? "" : `${best.x + 10}px`;
      tip.style.right = right ? `${u.over.clientWidth - best.x + 10}px` : "";
      tip.style.top = `${Math.max(0, Math.min(best.y - 10, u.over.clientHeight - tip.offsetHeight))}px`;
      tip.style.maxWidth = `${Math.max(best.x, u.over.clientWidth - best.x) - 20}px`;
    };
  }
  return { signOf, modes, limits, isText, points, teller };
})();
