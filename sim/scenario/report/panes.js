"use strict";
// The plots: one pane for each unit, all with the same time axis, the same cursor and the same two marks A and B.

vinv.kSide = { left: 64, right: 12 };

vinv.panes = (run, place) => {
  const times = vinv.decode(document.getElementById("times").textContent, Float64Array);
  const cache = new Map();
  const values = (i) => {
    if (!cache.has(i)) {
      const packed = vinv.decode(document.getElementById("c" + i).textContent, Float32Array);
      cache.set(i, vinv.column(packed, run.columns[i].constant, times.length));
    }
    return cache.get(i);
  };
  const end = Math.max(run.end, times.length ? times[times.length - 1] : 0, 1e-3);
  const drives = [...new Set([...run.columns, ...run.states].map((c) => c.drive).filter((d) => d))];
  const firstOfInterest = (run.events.find((e) => e[1] === "trip" && e[2]) || [])[2] || drives[0];
  const state = {
    view: { min: 0, max: end }, end, a: null, b: null, cursor: -1, history: [], idle: false,
    drives: new Set(drives.length > 4 ? [firstOfInterest] : drives), hidden: new Set(),
  };
  const trips = run.events.filter((e) => e[1] === "trip");
  const listeners = [];
  let plots = [];
  let legends = [];
  let settling = false; // a scale is being set by us, not by a person

  // Vertical lines through all panes and lanes.
  const lines = () => {
    const found = trips.map((e) => ({ t: e[0], colour: "bad", text: e[3].replace(/^trip /, "").split(":")[0] }));
    for (const c of run.checks) if (!c[1]) found.push({ t: c[0], colour: "warn", text: "" });
    if (state.a !== null) found.push({ t: state.a, colour: "mark", text: "A" });
    if (state.b !== null) found.push({ t: state.b, colour: "mark", text: "B" });
    return found;
  };

  // Marks above the plots, states below them.
  const makeLanes = () => ({ canvas: vinv.make("canvas"), labels: vinv.make("div", { class: "labels" }), rows: [], values: [] });
  const lanes = [makeLanes(), makeLanes()];
  const shared = { get view() { return state.view; }, end, lines };
  const drawLanes = () => { for (const l of lanes) vinv.drawLanes(l.canvas, l.rows, shared, vinv.kSide); };

  const setView = (min, max, remember = true) => {
    if (!(max - min > 1e-6)) return;
    if (remember) state.history.push({ ...state.view });
    if (state.history.length > 50) state.history.shift();
    state.view = { min, max };
    settling = true;
    for (const u of plots) u.setScale("x", { min, max });
    settling = false;
    drawLanes();
    for (const f of listeners) f();
  };
  const zoom = (factor, at = (state.view.min + state.view.max) / 2) => {
    const min = Math.max(0, at - (at - state.view.min) * factor);
    const max = Math.min(end, at + (state.view.max - at) * factor);
    setView(min, max);
  };
  const pan = (fraction) => {
    const width = state.view.max - state.view.min;
    const min = Math.max(0, Math.min(end - width, state.view.min + fraction * width));
    setView(min, min + width, false);
  };

  const readout = vinv.make("span", { class: "readout" });
  const update = () => {
    const t = state.cursor >= 0 ? times[state.cursor] : null;
    const parts = [];
    const part = (name, text) => parts.push(vinv.make("b", {}, name), " " + text + "   ");
    if (t !== null) part("t", vinv.seconds(t) + " s");
    if (state.a !== null) part("A", vinv.seconds(state.a) + " s");
    if (state.b !== null) part("B", vinv.seconds(state.b) + " s");
    if (state.a !== null && state.b !== null) part("B−A", vinv.seconds(state.b - state.a) + " s");
    readout.replaceChildren(...parts);
    // Columns that have nothing to say leave their room to the names.
    area.setAttribute("data-marks", (state.a === null ? "" : "a") + (state.b === null ? "" : "b"));
    const a = state.a === null ? -1 : vinv.nearest(times, state.a);
    const b = state.b === null ? -1 : vinv.nearest(times, state.b);
    for (const legend of legends) {
      for (const row of legend) {
        const v = values(row.column);
        row.cursor.textContent = state.cursor >= 0 ? vinv.number(v[state.cursor]) : "";
        row.a.textContent = a >= 0 ? vinv.number(v[a]) : "";
        row.b.textContent = b >= 0 ? vinv.number(v[b]) : "";
        row.difference.textContent = a >= 0 && b >= 0 ? vinv.number(v[b] - v[a]) : "";
      }
    }
    lanes[1].rows.forEach((lane, i) => {
      lanes[1].values[i].textContent = t === null ? "" : vinv.stateAt(lane.state, t);
    });
  };
  let pending = false;
  const soon = () => {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => { pending = false; update(); });
  };
  const redraw = () => {
    for (const u of plots) u.redraw(false);
    drawLanes();
    update();
  };
  const setMark = (name, t) => {
    state[name] = t;
    redraw();
  };

  const drawLines = (u, withText) => {
    const g = u.ctx;
    g.save();
    g.font = Math.round(11 * devicePixelRatio) + "px system-ui, sans-serif";
    g.textAlign = "left";
    g.textBaseline = "alphabetic";
    let lastText = -Infinity;
    for (const line of lines()) {
      if (line.t < u.scales.x.min || line.t > u.scales.x.max) continue;
      const x = Math.round(u.valToPos(line.t, "x", true));
      g.strokeStyle = g.fillStyle = vinv.colour(line.colour);
      g.lineWidth = devicePixelRatio;
      g.setLineDash(line.colour === "mark" ? [] : [4 * devicePixelRatio, 3 * devicePixelRatio]);
      g.beginPath();
      g.moveTo(x + 0.5, u.bbox.top);
      g.lineTo(x + 0.5, u.bbox.top + u.bbox.height);
      g.stroke();
      if (line.colour === "mark") {
        g.fillText(line.text, x + 4 * devicePixelRatio, u.bbox.top + u.bbox.height - 4 * devicePixelRatio);
      } else if (withText && line.text && x > lastText + 8) {
        g.fillText(line.text, x + 4 * devicePixelRatio, u.bbox.top + 11 * devicePixelRatio);
        lastText = x + g.measureText(line.text).width;
      }
    }
    g.restore();
  };

  const mouse = (u) => {
    let before = null;
    let pressed = 0;
    const at = (e) => u.posToVal(e.clientX - u.over.getBoundingClientRect().left, "x");
    u.over.addEventListener("mousedown", (e) => { pressed = e.clientX; });
    u.over.addEventListener("click", (e) => {
      if (Math.abs(e.clientX - pressed) > 3 || e.detail > 1) return;
      before = { a: state.a, b: state.b };
      const i = vinv.nearest(times, at(e));
      if (i >= 0) setMark(e.shiftKey ? "b" : "a", times[i]);
    });
    u.over.addEventListener("dblclick", () => {
      if (before) Object.assign(state, before); // its first click was not meant as a mark
      setView(0, end);
      redraw();
    });
    u.over.addEventListener("wheel", (e) => {
      if (!e.ctrlKey && !e.shiftKey) return;
      e.preventDefault();
      if (e.ctrlKey) zoom(e.deltaY > 0 ? 1.25 : 0.8, at(e));
      else pan(Math.sign(e.deltaY || e.deltaX) * 0.1);
    }, { passive: false });
  };

  const axis = () => ({
    stroke: () => vinv.colour("dim"), grid: { stroke: () => vinv.colour("grid"), width: 1 },
    ticks: { stroke: () => vinv.colour("line"), width: 1 }, font: "11px system-ui, sans-serif",
  });
  const makePlot = (group, target, isFirst) => new uPlot({
    width: Math.max(200, target.clientWidth), height: isFirst ? 220 : 150,
    padding: [8, vinv.kSide.right, 0, 0],
    legend: { show: false },
    cursor: {
      y: false,
      sync: { key: "vinv", setSeries: false, filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
      drag: { x: true, y: false, setScale: true }, bind: { dblclick: () => () => null },
    },
    scales: { x: { time: false, min: state.view.min, max: state.view.max } },
    axes: [{ ...axis(), size: 26 }, {
      ...axis(), size: vinv.kSide.left - 16, label: group.unit === "-" ? "" : group.unit, labelSize: 16, labelGap: 0,
      labelFont: "11px system-ui, sans-serif",
    }],
    series: [{}, ...group.columns.map((i, k) => ({
      label: run.columns[i].name, stroke: () => vinv.colour("s" + (k % 8)), width: 1.5, points: { show: false }, pxAlign: 0,
      dash: k >= 8 ? [6, 3] : undefined, show: !state.hidden.has(i),
    }))],
    hooks: {
      ready: [mouse],
      draw: [(u) => drawLines(u, isFirst)],
      setScale: [(u, key) => { if (key === "x" && !settling) setView(u.scales.x.min, u.scales.x.max); }],
      setCursor: [(u) => {
        const i = u.cursor.idx === null || u.cursor.idx === undefined ? -1 : u.cursor.idx;
        if (i !== state.cursor) { state.cursor = i; soon(); }
      }],
    },
  }, [times, ...group.columns.map(values)], target);

  const makeLegend = (group, plot) => {
    const head = vinv.make("tr", {}, vinv.make("th", {}, group.unit === "-" ? "no unit" : group.unit));
    for (const text of ["cursor", "A", "B", "B−A"]) head.append(vinv.make("th", {}, text));
    const body = vinv.make("tbody");
    const rows = group.columns.map((column, k) => {
      const row = { column };
      const swatch = vinv.make("span", { class: "swatch" });
      swatch.style.background = "var(--s" + (k % 8) + ")";
      const label = vinv.label(run.columns[column], drives.length);
      const button = vinv.make("button", {
        type: "button", title: label, "aria-pressed": String(!state.hidden.has(column)), onclick: () => {
          const show = state.hidden.has(column);
          if (show) state.hidden.delete(column);
          else state.hidden.add(column);
          button.setAttribute("aria-pressed", String(show));
          plot.setSeries(k + 1, { show });
        },
      }, swatch, label);
      const tr = vinv.make("tr", {}, vinv.make("td", {}, button));
      for (const name of ["cursor", "a", "b", "difference"]) {
        row[name] = vinv.make("td", { class: "n" });
        tr.append(row[name]);
      }
      body.append(tr);
      return row;
    });
    return { rows, table: vinv.make("table", { class: "legend" }, vinv.make("thead", {}, head), body) };
  };

  const area = vinv.make("div");
  const build = () => {
    for (const u of plots) u.destroy();
    plots = [];
    legends = [];
    area.replaceChildren();
    const shows = (c) => !c.drive || state.drives.has(c.drive);
    const groups = vinv.groups(run.columns, (c) => shows(c) && (state.idle || !c.constant));
    groups.forEach((group, i) => {
      const target = vinv.make("div");
      const pane = vinv.make("div", { class: "pane" }, target);
      area.append(pane);
      const plot = makePlot(group, target, i === 0);
      const legend = makeLegend(group, plot);
      pane.append(legend.table);
      plots.push(plot);
      legends.push(legend.rows);
    });
    lanes[0].rows = vinv.markLanes(run).map((lane) => ({ ...lane, times: lane.marks.map((m) => m.t) }));
    lanes[1].rows = run.states.filter((s) => shows(s) && (state.idle || s.t.length > 1))
      .map((s) => ({ name: vinv.label(s, drives.length), state: s }));
    for (const l of lanes) {
      l.labels.replaceChildren();
      l.values = l.rows.map((lane) => {
        const value = vinv.make("span", { class: "v" }, lane.marks ? String(lane.marks.length) : "");
        l.labels.append(vinv.make("div", {}, vinv.make("span", { title: lane.name }, lane.name), value));
        return value;
      });
      const pane = vinv.make("div", { class: "pane lanes" }, l.canvas, l.labels);
      if (l === lanes[0]) area.prepend(pane);
      else area.append(pane);
    }
    redraw();
  };

  const button = (text, title, act) => vinv.make("button", { type: "button", title, onclick: act }, text);
  const toolbar = vinv.make("div", { class: "bar top" },
    button("Whole run", "double click in a plot", () => setView(0, end)),
    button("+", "zoom in (Ctrl and wheel)", () => zoom(0.5)),
    button("−", "zoom out (Ctrl and wheel)", () => zoom(2)),
    button("←", "earlier (Shift and wheel)", () => pan(-0.5)),
    button("→", "later (Shift and wheel)", () => pan(0.5)),
    button("Back", "the span before", () => {
      const last = state.history.pop();
      if (last) setView(last.min, last.max, false);
    }),
    button("A to B", "show the span between the marks", () => {
      if (state.a !== null && state.b !== null) setView(Math.min(state.a, state.b), Math.max(state.a, state.b));
    }));
  if (drives.length > 1) {
    for (const d of drives) {
      const chip = vinv.make("button", {
        type: "button", "aria-pressed": String(state.drives.has(d)), onclick: () => {
          if (state.drives.has(d)) state.drives.delete(d);
          else state.drives.add(d);
          chip.setAttribute("aria-pressed", String(state.drives.has(d)));
          build();
        },
      }, d);
      toolbar.append(chip);
    }
  }
  const idle = vinv.make("input", { type: "checkbox", onchange: () => { state.idle = idle.checked; build(); } });
  toolbar.append(vinv.make("label", {}, idle, " also what never changes"), readout);
  const tip = vinv.make("div", { class: "tip", hidden: "" });
  place.append(
    vinv.make("p", { class: "note" }, "Drag to zoom, double click for the whole run. A click sets mark A, Shift and click mark B."),
    toolbar, area, tip);

  const markUnder = (l, e) => {
    const box = l.canvas.getBoundingClientRect();
    const lane = l.rows[Math.floor((e.clientY - box.top) / vinv.kLaneHeight)];
    const inner = box.width - vinv.kSide.left - vinv.kSide.right;
    const x = e.clientX - box.left - vinv.kSide.left;
    const t = state.view.min + (x / inner) * (state.view.max - state.view.min);
    if (!lane || t < 0) return null;
    if (lane.state) return { t, text: lane.name + ": " + vinv.stateAt(lane.state, t) };
    const near = lane.marks[vinv.nearest(lane.times, t)];
    const distance = (Math.abs(near.t - t) / (state.view.max - state.view.min)) * inner;
    return distance < 8 ? { t: near.t, text: vinv.seconds(near.t) + " s  " + near.text } : null;
  };
  for (const l of lanes) {
    l.canvas.addEventListener("mousemove", (e) => {
      const mark = markUnder(l, e);
      tip.hidden = !mark;
      if (!mark) return;
      tip.textContent = mark.text;
      tip.style.left = Math.min(e.clientX + 12, window.innerWidth - 240) + "px";
      tip.style.top = e.clientY + 16 + "px";
    });
    l.canvas.addEventListener("mouseleave", () => { tip.hidden = true; });
    l.canvas.addEventListener("click", (e) => {
      const mark = markUnder(l, e);
      if (mark) setMark(e.shiftKey ? "b" : "a", mark.t);
    });
  }

  build();
  new ResizeObserver(() => {
    for (const u of plots) {
      const width = u.root.parentElement.clientWidth;
      if (width > 0 && width !== u.width) u.setSize({ width, height: u.height });
    }
    drawLanes();
  }).observe(area);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  return {
    view: () => state.view,
    onView: (f) => listeners.push(f),
    goTo: (t) => {
      state.a = Math.max(0, Math.min(t, end));
      const span = vinv.spanAround(state.a, state.view, end);
      setView(span.min, span.max);
      redraw();
      place.scrollIntoView({ block: "start" });
    },
  };
};
