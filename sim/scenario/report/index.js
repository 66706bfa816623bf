"use strict";
// Filters and sorts the table of runs. Without it the table is complete, in the order in which the runs were given.
(() => {
  const table = document.getElementById("runs");
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const filter = document.createElement("input");
  filter.type = "search";
  filter.size = 28;
  const failed = document.createElement("input");
  failed.type = "checkbox";
  const label = (text, input, behind) => {
    const element = document.createElement("label");
    if (behind) element.append(input, text);
    else element.append(text, input);
    return element;
  };
  const show = () => {
    const words = filter.value.toLowerCase().split(" ");
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = (failed.checked && row.className === "passed") || !words.every((w) => text.includes(w));
    }
  };
  filter.addEventListener("input", show);
  failed.addEventListener("change", show);
  document.getElementById("tools").append(label("Filter ", filter, false), label(" only what did not pass", failed, true));

  const value = (row, column) => {
    const cell = row.cells[column];
    const key = cell.getAttribute("data-sort");
    return key === null ? cell.textContent : Number(key);
  };
  [...table.tHead.rows[0].cells].slice(0, 4).forEach((cell, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "sort";
    button.textContent = cell.textContent;
    let direction = -1;
    button.addEventListener("click", () => {
      direction = -direction;
      const order = (a, b) => {
        const x = value(a, column);
        const y = value(b, column);
        return direction * (x < y ? -1 : x > y ? 1 : 0);
      };
      body.append(...[...rows].sort(order));
    });
    cell.replaceChildren(button);
  });
})();
