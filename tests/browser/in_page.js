// What the checks ask of a page, as functions of the page's own window; each answers with a list of complaints, empty where all is well.
(() => {
  const frames = (n) => new Promise((done) => {
    const next = (left) => left ? requestAnimationFrame(() => next(left - 1)) : done();
    next(n);
  });
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const seen = (e) => e.getClientRects().length > 0;
  const shows = (all) => [...document.querySelectorAll(all)].filter(seen);
  const named = (e) => (e.closest("figure")?.querySelector("figcaption")?.textContent || e.textContent || e.tagName).trim().slice(0, 60);

  const pixels = (canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  // levels of 255: an edge that is blended in another order differs by a few
  const ALIKE = 32;
  const differs = (a, b) => a.some((v, k) => Math.abs(v - b[k]) > ALIKE);
  const LEAST_INK = 200;
  const blank = (canvas) => pixels(canvas).reduce((n, v, k) => n + (k % 4 === 3 && v > 0), 0) < LEAST_INK;

  const open = async () => {
    document.querySelectorAll("details:not([open]) > summary").forEach((s) => s.click());
    await frames(3);
    return [...document.querySelectorAll("details:not([open])")].map((d) => `"${named(d)}" does not unfold`);
  };

  // every place of a plot has its canvas with something on it, every drawing has things of some size
  const drawn = () => [
    ...[...document.querySelectorAll("[data-plot], .canvas")].flatMap((place) => {
      const canvas = place.querySelector("canvas");
      if (!canvas) return [`plot "${named(place)}" was not drawn`];
      if (!(canvas.width > 100 && canvas.height > 100)) return [`plot "${named(place)}" has ${canvas.width} x ${canvas.height} pixels`];
      return blank(canvas) ? [`plot "${named(place)}" is blank`] : [];
    }),
    ...shows("svg").flatMap((svg) => {
      const box = svg.getBBox(), place = svg.getBoundingClientRect();
      return box.width * box.height > 0 && place.width * place.height > 0 ? [] : [`drawing "${named(svg)}" is empty`];
    }),
  ];

  // a curve that is taken away by its legend leaves other pixels behind, and comes back as it was
  const legends = async () => {
    const wrong = [];
    for (const place of document.querySelectorAll(".canvas")) {
      const canvas = place.querySelector("canvas");
      if (!canvas) continue;
      for (const row of [...place.querySelectorAll(".u-legend .u-series")].slice(1).filter(seen)) {
        const head = row.querySelector("th"), before = pixels(canvas);
        head.click(); await frames(2);
        const without = pixels(canvas);
        head.click(); await frames(2);
        if (!differs(without, before)) wrong.push(`plot "${named(place)}": nothing changes without "${row.textContent}"`);
        else if (differs(pixels(canvas), before)) wrong.push(`plot "${named(place)}": "${row.textContent}" does not come back`);
      }
    }
    return wrong;
  };

  const shape = (player) => [...player.querySelectorAll(".panel.chosen [data-v]")]
    .map((e) => ["points", "cy", "y"].map((a) => e.getAttribute(a)).join()).join(";");

  // each mode moves by itself unless motion is unwelcome, stands still when told to, and follows the amplitude
  const motion = async (still = false) => {
    const wrong = [];
    for (const player of document.querySelectorAll(".player")) {
      player.scrollIntoView({ behavior: "instant" });
      await wait(100);
      const changes = async () => { const before = shape(player); await wait(150); return shape(player) !== before; };
      const tabs = [...player.querySelectorAll(".tabs button")], play = player.querySelector(".play");
      if (!tabs.length || !play) { wrong.push("a player without its buttons"); continue; }
      for (const tab of tabs) {
        tab.click();
        if (tab.getAttribute("aria-pressed") !== "true" || player.querySelectorAll(".panel.chosen").length !== 1) wrong.push(`"${tab.textContent}" is not chosen`);
        if (await changes() === still) wrong.push(`"${tab.textContent}" ${still ? "moves where motion is unwelcome" : "does not move"}`);
      }
      if (!still) play.click();
      if (await changes()) wrong.push("the motion does not pause");
      const slider = player.querySelector("input[type=range]"), before = shape(player);
      slider.value = slider.max; slider.dispatchEvent(new Event("input"));
      if (shape(player) === before) wrong.push("the amplitude changes nothing");
      play.click();
      if (!(await changes())) wrong.push("the motion does not start again");
      play.click();
      for (const row of document.querySelectorAll("tr.leads")) {
        const to = row.querySelector("a[href^='#shape-']").getAttribute("href");
        row.click();
        if (player.querySelector(".panel.chosen")?.id !== to.slice(1)) wrong.push(`the row of ${to} does not lead to it`);
      }
    }
    return wrong;
  };

  // every button (motion stands still by now) changes the page; every inner link has its place
  const controls = async () => {
    const wrong = [];
    for (const e of shows("button, select, input[type=checkbox], input[type=radio]")) {
      if (e.disabled || e.getAttribute("aria-pressed") === "true" || e.classList.contains("play")) continue;
      const before = document.body.outerHTML;
      if (e.tagName === "SELECT") { e.selectedIndex = (e.selectedIndex + 1) % e.length; e.dispatchEvent(new Event("change", { bubbles: true })); } else e.click();
      await frames(2);
      if (document.body.outerHTML === before) wrong.push(`"${named(e)}" changes nothing`);
    }
    for (const link of document.querySelectorAll("a[href^='#']")) {
      const to = document.getElementById(decodeURIComponent(link.getAttribute("href").slice(1)));
      if (!to) wrong.push(`"${named(link)}" leads nowhere`);
    }
    return wrong;
  };

  // a point of a sweep that is chosen anywhere is marked everywhere, and its own plots are drawn
  const points = async () => {
    const rows = [...document.querySelectorAll("tr[data-point]")], place = document.getElementById("chosen"), wrong = [];
    const told = (index, how) => {
      const marks = [...document.querySelectorAll("[data-point].chosen")];
      if (!marks.length || marks.some((e) => e.dataset.point !== index)) wrong.push(`point ${index}: ${how}, and others are marked`);
      const all = document.querySelectorAll(`[data-point="${index}"]`).length;
      if (marks.length !== all) wrong.push(`point ${index}: ${how}, and ${marks.length} of ${all} are marked`);
    };
    for (const row of [...rows.slice(1), ...rows.slice(0, 1)]) {
      const before = place.innerHTML, index = row.dataset.point;
      row.click(); await frames(2);
      if (place.innerHTML === before) wrong.push(`point ${index}: its row changes nothing`);
      told(index, "its row is clicked");
      for (const canvas of place.querySelectorAll("canvas")) if (blank(canvas)) wrong.push(`point ${index}: "${named(canvas)}" is blank`);
    }
    for (const dot of document.querySelectorAll("svg [data-point]")) {
      dot.dispatchEvent(new MouseEvent("click", { bubbles: true }));
      told(dot.dataset.point, "a drawing of it is clicked");
    }
    if (rows.length > 1) {
      rows[1].dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
      told(rows[1].dataset.point, "Enter is pressed on it");
    }
    return wrong;
  };

  // nothing is wider than the screen, and text can be read
  const layout = () => {
    const wide = document.documentElement.scrollWidth, screen = document.documentElement.clientWidth, wrong = [];
    if (wide > screen) {
      const inner = (e) => e.closest(".scroll, .canvas, svg") && !e.matches(".scroll");
      const e = [...document.querySelectorAll("main *, header *, footer *")].find((e) => !inner(e) && e.getBoundingClientRect().right > screen + 1);
      wrong.push(`the page is ${wide} px wide on a screen of ${screen}: ${e ? `${e.tagName} "${named(e)}"` : "?"}`);
    }
    for (const legend of shows(".plot .u-legend")) {
      const rows = [...legend.querySelectorAll(".u-series")].filter((e) => seen(e) && getComputedStyle(e).visibility === "visible");
      const aside = rows.length && rows[0].getBoundingClientRect().left - legend.getBoundingClientRect().left;
      if (aside > 8) wrong.push(`the legend of "${named(legend)}" begins ${Math.round(aside)} px aside`);
    }
    const light = (text) => {
      const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
      const part = (v) => { const s = (a * v + (1 - a) * 255) / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; };
      return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    };
    const { color, backgroundColor } = getComputedStyle(document.body), l = [light(color), light(backgroundColor)].sort();
    // WCAG's least contrast of text
    const contrast = (l[1] + 0.05) / (l[0] + 0.05);
    return contrast < 4.5 ? [...wrong, `text has a contrast of ${contrast.toFixed(1)}`] : wrong;
  };

  // only the elements that the pages are made of, none that acts by an attribute or leads away
  const foreign = () => [...document.querySelectorAll("*")].flatMap((e) => {
    const name = e.tagName.toLowerCase(), wrong = [];
    if (["img", "iframe", "object", "embed", "link", "form", "base", "audio", "video", "foreignobject"].includes(name)) wrong.push(`an element ${name}`);
    for (const a of e.attributes) {
      if (a.name.startsWith("on")) wrong.push(`${name} with ${a.name}`);
      if (["src", "href", "xlink:href", "action"].includes(a.name) && !a.value.startsWith("#")) wrong.push(`${name} with ${a.name}="${a.value}"`);
    }
    if (name === "script" && e.type !== "application/json" && !e.nonce) wrong.push("a script without the page's word");
    return wrong;
  });

  const stillness = () => motion(true);

  window.check = { open, drawn, legends, motion, stillness, controls, points, layout, foreign };
})();
