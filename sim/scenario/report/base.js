"use strict";
// What the other scripts of a report share: decoding, searching, wording. No page is needed here.
const vinv = {};

// Packed numbers, little endian as every browser's machine.
vinv.decode = (base64, Type) => {
  const raw = atob(base64);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return new Type(bytes.buffer);
};

// A column for uPlot, which wants null where there is no number.
vinv.column = (packed, constant, length) => {
  const values = constant ? new Float32Array(length).fill(packed.length ? packed[0] : NaN) : packed;
  return values.some(Number.isNaN) ? Array.from(values, (v) => (Number.isNaN(v) ? null : v)) : values;
};

// Index of the last of ascending times that is not after t; -1: none.
vinv.lastAt = (times, t) => {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
};

// Index of the time that is nearest to t; -1 if there is none.
vinv.nearest = (times, t) => {
  const before = vinv.lastAt(times, t);
  if (before < 0) return times.length ? 0 : -1;
  if (before + 1 === times.length) return before;
  return t - times[before] <= times[before + 1] - t ? before : before + 1;
};

vinv.number = (v) => {
  if (v === null || v === undefined || Number.isNaN(v)) return "";
  return v !== 0 && Math.abs(v) < 1e-3 ? v.toExponential(2) : String(Number(v.toPrecision(5)));
};

// Seconds as tables have them: as many decimals as there are, three at least.
vinv.seconds = (t) => {
  const text = t.toFixed(6).replace(/0{1,3}$/, "");
  return Number(text) === 0 ? "0.000" : text;
};

// What a state was at t.
vinv.stateAt = (state, t) => {
  const i = vinv.lastAt(state.t, t);
  return i < 0 ? "" : state.words[state.v[i]];
};

// Signals by unit, in the order in which units first appear: [{unit, columns: [index]}].
vinv.groups = (columns, shows) => {
  const found = new Map();
  columns.forEach((c, i) => {
    if (!shows(c)) return;
    if (!found.has(c.unit)) found.set(c.unit, { unit: c.unit, columns: [] });
    found.get(c.unit).columns.push(i);
  });
  return [...found.values()];
};

vinv.label = (item, drives) => (drives > 1 && item.drive ? item.drive + " " : "") + item.name.replaceAll("_", " ");

// The wire log: times in seconds, and the lines to be taken apart when they are shown.
vinv.parseWire = (text) => {
  const lines = text === "" ? [] : text.split("\n");
  const at = new Float64Array(lines.length);
  let ns = 0;
  lines.forEach((line, i) => {
    ns += parseInt(line, 10);
    at[i] = ns / 1e9;
  });
  return { at, lines };
};

vinv.wireRow = (line, wire) => {
  const [, kind, network, sender, id, hex] = line.split(" ");
  const bytes = hex.replace(/..(?=.)/g, "$& ");
  const row = { network: wire.networks[network], sender: wire.senders[sender], id: "", what: "", bytes };
  const number = parseInt(id, 16);
  if (kind === "0") {
    const extended = number >= 0x80000000;
    const remote = Math.floor(number / 0x40000000) % 2 === 1;
    row.id = (number % 0x20000000).toString(16).toUpperCase().padStart(extended ? 8 : 3, "0");
    row.what = remote ? "CAN remote" : "CAN";
    if (remote) row.bytes = "length " + hex.length / 2;
  } else if (kind === "1") {
    row.id = (number % 0x20000000).toString(16).toUpperCase().padStart(8, "0");
    row.what = "CAN error";
  } else {
    row.what = kind === "2" ? "serial" : "TCP";
  }
  return row;
};

// All words of a filter occur somewhere in the text.
vinv.matches = (text, filter) => {
  const lower = text.toLowerCase();
  return filter.toLowerCase().split(" ").every((word) => lower.includes(word));
};

// The time that a page's address asks for: "#t=3.412"; null: none.
vinv.hashTime = (hash) => {
  const found = /^#t=(-?[0-9.]+)$/.exec(hash);
  return found ? Number(found[1]) : null;
};

// The span to look at for t: as wide as now, but a tenth of the run at most, and inside the run.
vinv.spanAround = (t, now, end) => {
  const width = Math.min(now.max - now.min, Math.max(end / 10, 0.2), end);
  const min = Math.max(0, Math.min(t - width / 2, end - width));
  return { min, max: min + width };
};

// What an element of the page is made of; text never becomes markup.
vinv.make = (tag, properties = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value);
  }
  for (const child of children) element.append(child);
  return element;
};

vinv.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
