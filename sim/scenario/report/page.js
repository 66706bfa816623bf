"use strict";
// Puts the page together. Without it the page still has verdict, checks and events.
vinv.start = () => {
  const run = JSON.parse(document.getElementById("run").textContent);
  const place = document.getElementById("plots");
  const panes = place ? vinv.panes(run, place) : null;
  const view = panes ? panes.view : () => ({ min: 0, max: run.end });
  const tables = [];
  const events = document.getElementById("event-table");
  if (events && run.events.length > 0) {
    tables.push(vinv.table(events, ["time, s", "kind", "drive", "event", "line"], vinv.eventRows(run.events), view));
  }
  const wire = document.getElementById("wire-table");
  if (wire) {
    const log = vinv.parseWire(document.getElementById("wire").textContent);
    tables.push(vinv.table(wire, ["time, s", "network", "sender", "kind", "identifier", "bytes"],
      vinv.wireRows(log, run.wire), view));
  }
  if (!panes) return;
  panes.onView(() => { for (const t of tables) t.search(); });
  const follow = () => {
    const t = vinv.hashTime(location.hash);
    if (t !== null) panes.goTo(t);
  };
  // A second click on the same link does not change the address.
  document.addEventListener("click", (e) => {
    const link = e.target.closest ? e.target.closest("a.t") : null;
    if (link && link.getAttribute("href") === location.hash) follow();
  });
  window.addEventListener("hashchange", follow);
  follow();
};
vinv.start();
