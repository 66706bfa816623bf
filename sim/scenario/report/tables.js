"use strict";
// Long tables, a page of rows at a time, with a filter: the events and the wire log.

// rows: {count, at(i), cells(i): [{text, css, time}], text(i)}. heads: [text]. view(): {min, max}, what the plots show.
vinv.table = (place, heads, rows, view) => {
  const kPage = 200;
  let shown = null; // indices of the rows that match; null: all
  let first = 0;
  const body = vinv.make("tbody");
  const where = vinv.make("span");
  const count = () => (shown ? shown.length : rows.count);

  const draw = () => {
    body.replaceChildren();
    const end = Math.min(first + kPage, count());
    for (let k = first; k < end; ++k) {
      const i = shown ? shown[k] : k;
      const tr = vinv.make("tr", { class: rows.css ? rows.css(i) : "" });
      for (const cell of rows.cells(i)) {
        const content = cell.time === undefined ? cell.text
          : vinv.make("a", { class: "t", href: "#t=" + cell.text }, cell.text);
        tr.append(vinv.make("td", { class: cell.css || "" }, content));
      }
      body.append(tr);
    }
    where.textContent = count() === 0 ? "none" : first + 1 + "–" + end + " of " + count();
    back.disabled = first === 0;
    next.disabled = end >= count();
  };
  const turn = (pages) => {
    first = Math.max(0, Math.min(first + pages * kPage, Math.floor(Math.max(count() - 1, 0) / kPage) * kPage));
    draw();
  };
  const search = () => {
    const words = filter.value.trim();
    const span = inView.checked ? view() : null;
    first = 0;
    shown = null;
    if (words !== "" || span) {
      shown = [];
      for (let i = 0; i < rows.count; ++i) {
        if (span && (rows.at(i) < span.min || rows.at(i) > span.max)) continue;
        if (words === "" || vinv.matches(rows.text(i), words)) shown.push(i);
      }
    }
    draw();
  };
  const filter = vinv.make("input", { type: "search", size: "28", "aria-label": "filter", oninput: search });
  const inView = vinv.make("input", { type: "checkbox", onchange: search });
  const back = vinv.make("button", { type: "button", onclick: () => turn(-1) }, "Back");
  const next = vinv.make("button", { type: "button", onclick: () => turn(1) }, "Next");
  const head = vinv.make("tr");
  for (const text of heads) head.append(vinv.make("th", {}, text));
  place.replaceChildren(
    vinv.make("div", { class: "bar" }, vinv.make("label", {}, "Filter ", filter),
      vinv.make("label", {}, inView, " only the time shown in the plots"), back, next, where),
    vinv.make("div", { class: "scroll" }, vinv.make("table", {}, vinv.make("thead", {}, head), body)));
  draw();
  return { search: () => { if (inView.checked) search(); } };
};

vinv.eventRows = (events) => ({
  count: events.length,
  at: (i) => events[i][0],
  css: (i) => events[i][1],
  text: (i) => events[i].slice(1, 4).join(" "),
  cells: (i) => {
    const [t, kind, drive, text, line] = events[i];
    return [{ text: vinv.seconds(t), css: "n", time: t }, { text: kind }, { text: drive }, { text },
      { text: line > 0 ? String(line) : "", css: "n" }];
  },
});

vinv.wireRows = (log, wire) => ({
  count: log.lines.length,
  at: (i) => log.at[i],
  text: (i) => {
    const r = vinv.wireRow(log.lines[i], wire);
    return [r.network, r.sender, r.what, r.id, r.bytes].join(" ");
  },
  cells: (i) => {
    const r = vinv.wireRow(log.lines[i], wire);
    return [{ text: vinv.seconds(log.at[i]), css: "n", time: log.at[i] }, { text: r.network }, { text: r.sender },
      { text: r.what }, { text: r.id, css: "mono" }, { text: r.bytes, css: "mono" }];
  },
});
