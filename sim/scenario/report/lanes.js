"use strict";
// Events as marks and states as lanes, on one canvas, with the time axis of the plots above.

vinv.kLaneHeight = 22;

// What of a state is visible, merged where it is too fine to be seen: [{from, to, word}] in pixels; word null: several.
vinv.laneSegments = (state, view, width, end) => {
  const pixel = (t) => ((t - view.min) / (view.max - view.min)) * width;
  const segments = [];
  let i = Math.max(0, vinv.lastAt(state.t, view.min));
  for (; i < state.t.length && state.t[i] <= view.max; ++i) {
    const from = Math.max(0, pixel(state.t[i]));
    const to = Math.min(width, pixel(i + 1 < state.t.length ? state.t[i + 1] : end));
    const last = segments[segments.length - 1];
    if (to - from >= 1 || !last) {
      segments.push({ from, to, word: state.words[state.v[i]] });
    } else if (last.word === null) {
      last.to = to;
    } else {
      segments.push({ from, to, word: null });
    }
  }
  return segments;
};

// Marks of one lane that are visible, one for each pixel: [{x, mark}].
vinv.laneMarks = (marks, times, view, width) => {
  const shown = [];
  for (let i = vinv.lastAt(times, view.min) + 1; i < marks.length && times[i] <= view.max; ++i) {
    const x = Math.round(((times[i] - view.min) / (view.max - view.min)) * width);
    if (!shown.length || shown[shown.length - 1].x !== x) shown.push({ x, mark: marks[i] });
  }
  return shown;
};

// The lanes of marks that a run has: [{name, colour, marks: [{t, text}]}].
vinv.markLanes = (run) => {
  const of = (...kinds) => run.events.filter((e) => kinds.includes(e[1])).map((e) => ({ t: e[0], text: (e[2] ? e[2] + ": " : "") + e[3] }));
  const checks = (passed) => run.checks.filter((c) => c[1] === passed).map((c) => ({ t: c[0], text: c[2] }))
    .sort((a, b) => a.t - b.t);
  return [
    { name: "trips", colour: "bad", marks: of("trip") },
    { name: "failed checks", colour: "bad", marks: checks(false) },
    { name: "passed checks", colour: "ok", marks: checks(true) },
    { name: "actions", colour: "link", marks: of("action") },
    { name: "notes and wire events", colour: "warn", marks: of("note", "wire") },
  ].filter((lane) => lane.marks.length > 0);
};

// lanes: mark lanes and {state}; side: pixels that the plots have beside their drawing area, {left, right}.
vinv.drawLanes = (canvas, lanes, shared, side) => {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = lanes.length * vinv.kLaneHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.height = height + "px";
  const g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  g.font = "11px system-ui, sans-serif";
  g.textBaseline = "middle";
  const inner = Math.max(1, width - side.left - side.right);
  g.translate(side.left, 0);
  lanes.forEach((lane, row) => {
    const top = row * vinv.kLaneHeight;
    const middle = top + vinv.kLaneHeight / 2;
    g.fillStyle = vinv.colour("grid");
    g.fillRect(0, top + vinv.kLaneHeight - 1, inner, 1);
    if (lane.marks) {
      g.fillStyle = vinv.colour(lane.colour);
      for (const { x } of vinv.laneMarks(lane.marks, lane.times, shared.view, inner)) {
        g.beginPath();
        g.moveTo(x, middle - 6);
        g.lineTo(x + 5, middle);
        g.lineTo(x, middle + 6);
        g.lineTo(x - 5, middle);
        g.fill();
      }
      return;
    }
    for (const s of vinv.laneSegments(lane.state, shared.view, inner, shared.end)) {
      const quiet = s.word === "off" || s.word === "none" || s.word === "";
      g.fillStyle = vinv.colour(s.word === null ? "busy" : s.word === "on" ? "on" : "lane");
      if (quiet) g.fillRect(s.from, middle, s.to - s.from, 1);
      else g.fillRect(s.from, top + 3, Math.max(1, s.to - s.from), vinv.kLaneHeight - 6);
      if (quiet || s.word === null || s.to - s.from < 24) continue;
      g.save();
      g.beginPath();
      g.rect(s.from, top, s.to - s.from, vinv.kLaneHeight);
      g.clip();
      g.fillStyle = vinv.colour("fg");
      g.fillText(s.word, s.from + 4, middle);
      g.restore();
      g.fillStyle = vinv.colour("bg");
      g.fillRect(s.to - 1, top + 3, 1, vinv.kLaneHeight - 6);
    }
  });
  for (const line of shared.lines()) {
    if (line.t < shared.view.min || line.t > shared.view.max) continue;
    g.fillStyle = vinv.colour(line.colour);
    g.fillRect(((line.t - shared.view.min) / (shared.view.max - shared.view.min)) * inner - 0.5, 0, 1, height);
  }
};
