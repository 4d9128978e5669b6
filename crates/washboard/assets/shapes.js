// Moves the drawings of mode shapes: y(t) = y − a Re((re + i im) e^{iωt}), and turns the hand of their phases.
"use strict";
document.querySelectorAll(".player").forEach((player) => {
  const CYCLE_MS = 2500, panels = [...player.querySelectorAll(".panel")];
  const bars = player.insertBefore(document.createElement("div"), player.firstChild);
  bars.className = "controls";
  const add = (parent, tag, text) => { const e = parent.appendChild(document.createElement(tag)); e.textContent = text; return e; };

  // every drawn thing with its vertices: x, y, re, im of each
  const things = panels.map((panel) => [...panel.querySelectorAll("[data-v]")].map((node) => {
    const n = node.dataset.v.split(" ").map(Number), corners = [];
    for (let i = 0; i < n.length; i += 4) corners.push(n.slice(i, i + 4));
    return { node, corners };
  }));
  const hands = panels.map((panel) => [...panel.querySelectorAll(".hand")]);

  let chosen = 0, phase = 0, last = null, playing = !matchMedia("(prefers-reduced-motion: reduce)").matches, seen = true;

  function draw() {
    const c = Math.cos(phase), s = Math.sin(phase), a = +size.value;
    for (const { node, corners } of things[chosen]) {
      const at = corners.map(([x, y, re, im]) => [x, y - a * (re * c - im * s)]);
      if (node.tagName === "circle") node.setAttribute("cy", at[0][1].toFixed(2));
      else if (node.tagName === "text") node.setAttribute("y", at[0][1].toFixed(2));
      else node.setAttribute("points", at.map((p) => `${p[0]},${p[1].toFixed(2)}`).join(" "));
    }
    // the displacement is the arrow's part along the direction e^{−iωt}; on the screen angles grow clockwise
    const degrees = phase * 180 / Math.PI;
    hands[chosen].forEach((h) => h.setAttribute("transform", `rotate(${degrees.toFixed(1)} ${h.getAttribute("x1")} ${h.getAttribute("y1")})`));
  }
  function step(now) {
    if (!playing || !seen) { last = null; return; }
    if (last !== null) phase = (phase + 2 * Math.PI * (now - last) / CYCLE_MS) % (2 * Math.PI);
    last = now;
    draw();
    requestAnimationFrame(step);
  }
  const go = () => { if (playing && seen && last === null) requestAnimationFrame(step); };

  const tabs = bars.appendChild(document.createElement("div"));
  tabs.className = "tabs";
  const buttons = panels.map((panel, k) => {
    const b = add(tabs, "button", panel.dataset.tab);
    b.type = "button";
    b.addEventListener("click", () => choose(k));
    return b;
  });
  const play = add(bars, "button", "");
  play.type = "button";
  play.className = "play";
  const name = () => { play.textContent = playing ? "❚❚ Pause" : "▶ Play"; };
  play.addEventListener("click", () => { playing = !playing; name(); go(); });
  const label = add(bars, "label", "Amplitude ");
  const size = label.appendChild(document.createElement("input"));
  Object.assign(size, { type: "range", min: "0.2", max: "1.8", step: "0.1", value: "1" });
  size.addEventListener("input", draw);

  function choose(k) {
    chosen = k;
    panels.forEach((p, i) => p.classList.toggle("chosen", i === k));
    buttons.forEach((b, i) => b.setAttribute("aria-pressed", String(i === k)));
    draw();
  }
  player.classList.add("live");
  name();
  choose(0);

  // a row of a table that leads to a panel chooses it
  document.querySelectorAll("a[href^='#shape-']").forEach((link) => {
    const k = panels.findIndex((p) => "#" + p.id === link.getAttribute("href"));
    const row = link.closest("tr");
    if (k < 0 || !row) return;
    row.classList.add("leads");
    row.addEventListener("click", (e) => { e.preventDefault(); choose(k); player.scrollIntoView({ block: "nearest" }); });
  });
  new IntersectionObserver((entries) => { seen = entries.some((e) => e.isIntersecting); go(); }).observe(player);
  go();
});
