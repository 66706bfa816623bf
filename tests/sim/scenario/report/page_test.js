"use strict";
// The scripts of a report, run by node: functions by their results, and the whole page over a small stand-in of a
// document. Usage: page_test.js REPORT_SAMPLE, the program that writes the pages.
const assert = require("node:assert");
const { execFileSync } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const test = require("node:test");
const vm = require("node:vm");

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "report-page-"));
test.after(() => fs.rmSync(folder, { recursive: true }));
execFileSync(process.argv[2], [folder, "1000"]);
const html = fs.readFileSync(path.join(folder, "fr-e500_long.html"), "utf8");
const elements = [...html.matchAll(/<script(?: type="([^"]*)" id="([^"]*)")?>([^]*?)<\/script>/g)];
const scripts = elements.filter((e) => e[1] === undefined).map((e) => e[3]);
const blobs = new Map(elements.filter((e) => e[1] !== undefined).map((e) => [e[2], e[3]]));

// --- a document that is just enough ---

class Element {
  constructor(tag) {
    this.tag = tag;
    this.children = [];
    this.attributes = new Map();
    this.listeners = new Map();
    this.style = {};
    this.clientWidth = 800;
    this.value = "";
    this.checked = false;
  }
  append(...children) { this.children.push(...children.map((c) => { if (c instanceof Element) c.parentElement = this; return c; })); }
  prepend(...children) { this.children.unshift(...children); }
  replaceChildren(...children) { this.children = []; this.append(...children); }
  setAttribute(name, value) { this.attributes.set(name, value); }
  getAttribute(name) { return this.attributes.has(name) ? this.attributes.get(name) : null; }
  addEventListener(type, f) { this.listeners.set(type, [...(this.listeners.get(type) || []), f]); }
  fire(type, event = {}) { for (const f of this.listeners.get(type) || []) f({ preventDefault() {}, ...event }); }
  getBoundingClientRect() { return { left: 0, top: 0, width: 800, height: 100 }; }
  scrollIntoView() { this.scrolled = true; }
  getContext() { return new Proxy({}, { get: (o, name) => (name in o ? o[name] : () => ({ width: 0 })), set: (o, n, v) => { o[n] = v; return true; } }); }
  set textContent(text) { this.children = [String(text)]; }
  get textContent() { return this.children.map((c) => (c instanceof Element ? c.textContent : c)).join(""); }
  all(tag) { return this.children.flatMap((c) => (c instanceof Element ? [...(c.tag === tag ? [c] : []), ...c.all(tag)] : [])); }
}

// What of uPlot the page uses, without drawing.
class FakePlot {
  constructor(options, data, target) {
    Object.assign(this, { options, data, scales: { x: {} }, width: options.width, height: options.height });
    this.root = new Element("div");
    target.append(this.root);
    this.over = new Element("div");
    this.cursor = { idx: null };
    this.shown = [];
    FakePlot.all.push(this);
    for (const f of options.hooks.ready) f(this);
  }
  setScale(key, range) {
    Object.assign(this.scales[key], range);
    for (const f of this.options.hooks.setScale) f(this, key);
  }
  setSeries(i, what) { this.shown.push([i, what.show]); }
  point(i) {
    this.cursor.idx = i;
    for (const f of this.options.hooks.setCursor) f(this);
  }
  posToVal(x) { return this.scales.x.min + (x / 800) * (this.scales.x.max - this.scales.x.min); }
  redraw() {}
  destroy() { FakePlot.all = FakePlot.all.filter((u) => u !== this); }
  setSize() {}
}

const open = (hash = "", data = blobs) => {
  FakePlot.all = [];
  const places = new Map(["plots", "event-table", "wire-table"].map((id) => [id, new Element("div")]));
  for (const [id, text] of data) {
    const e = new Element("script");
    e.textContent = text;
    places.set(id, e);
  }
  const listeners = new Map();
  const context = vm.createContext({
    uPlot: FakePlot, atob, console, location: { hash }, devicePixelRatio: 1, innerWidth: 1200,
    getComputedStyle: () => ({ getPropertyValue: () => " #123456" }),
    matchMedia: () => ({ addEventListener() {} }),
    requestAnimationFrame: (f) => f(),
    ResizeObserver: class { observe() {} },
    addEventListener: (type, f) => listeners.set(type, f),
    document: {
      getElementById: (id) => places.get(id) || null, createElement: (tag) => new Element(tag),
      documentElement: {}, addEventListener() {},
    },
  });
  context.window = context;
  for (const script of scripts.slice(1)) vm.runInContext(script, context);
  return { vinv: vm.runInContext("vinv", context), places, context, listeners };
};
const plain = (value) => JSON.parse(JSON.stringify(value));
const { vinv } = open();

// --- the page as a whole ---

test("every script of the pages is valid, and the first is the plot library", () => {
  for (const text of scripts) new vm.Script(text);
  assert.match(scripts[0], /uPlot \(v1\.6\.32\)|uPlot.*v1\.6\.32/);
  const index = fs.readFileSync(path.join(folder, "index.html"), "utf8");
  new vm.Script(/<script>([^]*)<\/script>/.exec(index)[1]);
});

test("the real plot library loads and takes the name that the page uses", () => {
  const context = vm.createContext({
    navigator: { language: "en" }, document: { createElement: () => new Element("div") }, matchMedia: () => ({ addEventListener() {} }),
    devicePixelRatio: 1, addEventListener() {}, dispatchEvent() {}, CustomEvent: class {}, Intl,
  });
  context.window = context;
  assert.equal(vm.runInContext(scripts[0] + ";typeof uPlot", context), "function");
});

test("there is a pane for each unit with what changes, and all have the same times", () => {
  open();
  const labels = FakePlot.all.map((u) => u.options.series.slice(1).map((s) => s.label));
  assert.deepEqual(labels[0], ["set_frequency", "output_frequency"], "the carrier never changes");
  assert.equal(FakePlot.all.length, 10);
  for (const u of FakePlot.all) assert.equal(u.data[0].length, 60001);
  const dcLink = FakePlot.all[2].data[2];
  assert.ok(Math.abs(dcLink[30000] - (540 + 4 * Math.sin(30 * 24))) < 1e-3);
});

test("a zoom in one pane is a zoom in all", () => {
  open();
  FakePlot.all[3].setScale("x", { min: 10, max: 20 });
  for (const u of FakePlot.all) assert.deepEqual(u.scales.x, { min: 10, max: 20 });
});

test("the cursor and both marks show values and differences", () => {
  const { places } = open("");
  for (const u of FakePlot.all) u.setScale("x", { min: 0, max: 60 });
  const [first] = FakePlot.all;
  first.over.fire("mousedown", { clientX: 0 });
  first.over.fire("click", { clientX: 0, detail: 1 });
  first.over.fire("mousedown", { clientX: 400 });
  first.over.fire("click", { clientX: 400, detail: 1, shiftKey: true });
  first.point(2500);
  const row = places.get("plots").all("tr").find((tr) => tr.textContent.startsWith("output frequency"));
  assert.deepEqual(row.all("td").map((td) => td.textContent), ["output frequency", "25", "0", "50", "50"]);
  assert.match(places.get("plots").textContent, /t 2\.500 s +A 0\.000 s +B 30\.000 s +B−A 30\.000 s/);
  assert.match(places.get("plots").textContent, /runningon/, "states at the cursor");
});

test("a drag is no click, and a double click undoes the mark of its first click", () => {
  const { places } = open();
  const [first] = FakePlot.all;
  first.over.fire("mousedown", { clientX: 100 });
  first.over.fire("click", { clientX: 200, detail: 1 });
  assert.doesNotMatch(places.get("plots").textContent, /A \d/);
  first.setScale("x", { min: 10, max: 20 });
  first.over.fire("mousedown", { clientX: 100 });
  first.over.fire("click", { clientX: 100, detail: 1 });
  assert.match(places.get("plots").textContent, /A 11\.250 s/);
  first.over.fire("dblclick");
  assert.doesNotMatch(places.get("plots").textContent, /A \d/);
  assert.deepEqual(first.scales.x, { min: 0, max: 60 });
});

test("an address with a time shows that time", () => {
  const { places } = open("#t=41.300");
  assert.deepEqual(FakePlot.all[0].scales.x, { min: 38.3, max: 44.3 });
  assert.ok(places.get("plots").scrolled);
});

test("what never changes can be shown too, and a signal can be hidden", () => {
  const { places } = open();
  const idle = places.get("plots").all("input")[0];
  idle.checked = true;
  idle.fire("change");
  assert.deepEqual(FakePlot.all[0].options.series.slice(1).map((s) => s.label), ["set_frequency", "output_frequency", "carrier"]);
  assert.equal(FakePlot.all[0].data[3].length, 60001);
  const button = places.get("plots").all("button").find((b) => b.textContent === "output frequency");
  button.fire("click");
  assert.deepEqual(FakePlot.all[0].shown, [[2, false]]);
  assert.equal(button.getAttribute("aria-pressed"), "false");
});

test("the wire log has pages, a filter and the time of the plots", () => {
  const { places } = open();
  const wire = places.get("wire-table");
  assert.equal(wire.all("tbody")[0].children.length, 200);
  assert.match(wire.textContent, /1–200 of 1000/);
  wire.all("button")[1].fire("click");
  assert.match(wire.textContent, /201–400 of 1000/);
  const [filter, inView] = wire.all("input");
  filter.value = "fan 185";
  filter.fire("input");
  assert.match(wire.textContent, /1–200 of 500/);
  filter.value = "fan 205";
  filter.fire("input");
  assert.match(wire.textContent, /none/);
  filter.value = "";
  inView.checked = true;
  inView.fire("change");
  FakePlot.all[0].setScale("x", { min: 0, max: 0.599 });
  assert.match(wire.textContent, /1–10 of 10/);
});

test("texts of a scenario stay text", () => {
  const run = JSON.parse(blobs.get("run"));
  const evil = "</script><img src=x onerror=alert(1)>";
  run.events = [[1, "note", evil, evil, 1]];
  run.states[0].name = run.columns[0].name = evil;
  const { places } = open("", new Map([...blobs, ["run", JSON.stringify(run)]]));
  assert.ok(places.get("event-table").textContent.includes(evil));
  for (const text of scripts.slice(1)) assert.doesNotMatch(text, /innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(/);
});

// --- functions ---

test("times are found by halving", () => {
  const times = [0, 1, 2, 2, 5];
  assert.deepEqual([-1, 0, 1.9, 2, 9].map((t) => vinv.lastAt(times, t)), [-1, 0, 1, 3, 4]);
  assert.deepEqual([-1, 0.4, 0.6, 3, 4, 9].map((t) => vinv.nearest(times, t)), [0, 0, 1, 3, 4, 4]);
  assert.equal(vinv.nearest([], 1), -1);
});

test("a column without a number somewhere has null there", () => {
  assert.deepEqual(plain(vinv.column(Float32Array.of(1, NaN, 3), false, 3)), [1, null, 3]);
  assert.deepEqual([...vinv.column(Float32Array.of(7), true, 3)], [7, 7, 7]);
});

test("numbers and seconds are short, but say what they are", () => {
  assert.deepEqual([0, -1.5, 802.123456, 14500, 0.0000123, NaN, null].map(vinv.number), ["0", "-1.5", "802.12", "14500", "1.23e-5", "", ""]);
  assert.deepEqual([0, 3.412, 1.0004, 60.000001].map(vinv.seconds), ["0.000", "3.412", "1.0004", "60.000001"]);
});

test("wire records say what they are", () => {
  const names = { networks: ["line"], senders: ["master", "fan"] };
  const row = (line) => Object.values(plain(vinv.wireRow(line, names))).join("|");
  assert.equal(row("1000 0 0 0 605 40416000"), "line|master|605|CAN|40 41 60 00");
  assert.equal(row("1000 0 0 1 80000123 DEAD"), "line|fan|00000123|CAN|DE AD");
  assert.equal(row("1000 0 0 1 40000705 00"), "line|fan|705|CAN remote|length 1");
  assert.equal(row("1000 1 0 1 20000088 00"), "line|fan|00000088|CAN error|00");
  assert.equal(row("1000 2 0 1 0 "), "line|fan||serial|");
  const log = vinv.parseWire("1000000000 0 0 0 1 \n500 0 0 0 2 ");
  assert.deepEqual([...log.at], [1, 1.0000005]);
  assert.deepEqual(plain(vinv.parseWire("").lines), []);
});

test("lanes merge what is too fine to be seen", () => {
  const state = { t: [0, 5, 5.001, 5.002, 8], v: [0, 1, 0, 1, 0], words: ["off", "on"] };
  const segments = (min, max) => plain(vinv.laneSegments(state, { min, max }, 100, 10)).map((s) => [Math.round(s.from), Math.round(s.to), s.word]);
  assert.deepEqual(segments(0, 10), [[0, 50, "off"], [50, 50, null], [50, 80, "on"], [80, 100, "off"]]);
  assert.deepEqual(segments(6, 7), [[0, 100, "on"]]);
  assert.deepEqual(segments(5, 5.004), [[0, 25, "on"], [25, 50, "off"], [50, 100, "on"]]);
  const marks = vinv.laneMarks([{ t: 1 }, { t: 1.001 }, { t: 4 }, { t: 9 }], [1, 1.001, 4, 9], { min: 0.5, max: 5 }, 90);
  assert.deepEqual(plain(marks).map((m) => m.x), [10, 70]);
});

test("the span around a time stays inside the run", () => {
  assert.deepEqual(plain(vinv.spanAround(1, { min: 0, max: 60 }, 60)), { min: 0, max: 6 });
  assert.deepEqual(plain(vinv.spanAround(59, { min: 50, max: 52 }, 60)), { min: 58, max: 60 });
  assert.deepEqual(plain(vinv.spanAround(0.01, { min: 0, max: 0.02 }, 0.02)), { min: 0, max: 0.02 });
});

test("only a time is taken from the address", () => {
  assert.equal(vinv.hashTime("#t=3.412"), 3.412);
  for (const hash of ["", "#t=", "#t=1e9", "#t=<b>", "#events"]) assert.equal(vinv.hashTime(hash), null);
});
