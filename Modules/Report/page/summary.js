"use strict";
// Sorts and filters the table of runs, which stands as it is without: the worst first.
(function () {
  const byId = (id) => document.getElementById(id);
  const body = byId("runs").tBodies[0], rows = [...body.rows];
  const heads = [...byId("runs").tHead.rows[0].cells];
  const collator = new Intl.Collator("en", { numeric: true });
  let sorted = 0, sign = 1;

  const keyOf = (row, column) => row.cells[column].dataset.key ?? row.cells[column].textContent;

  /** Numbers by size, texts by their numbers and letters; what is not there comes last. */
  const compare = (a, b) => {
    const x = keyOf(a, sorted), y = keyOf(b, sorted);
    if (!x || !y) return Number(!x) - Number(!y);
    return sign * (Number(x) - Number(y) || collator.compare(x, y));
  };

  const sortBy = (column) => {
    sign = column === sorted ? -sign : 1;
    sorted = column;
    body.append(...[...rows].sort(compare));
    heads.forEach((head, n) => {
      if (n === sorted) head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    byId("sort").value = sorted;
  };

  const filter = () => {
    const words = byId("find").value.toLowerCase(), state = byId("state").value;
    let shown = 0;
    for (const row of rows) {
      row.hidden = !row.textContent.toLowerCase().includes(words) || (state && keyOf(row, 0) !== state);
      shown += !row.hidden;
    }
    byId("run-count").textContent = `${shown} of ${rows.length}`;
  };

  heads.forEach((head, n) => {
    byId("sort").append(new Option(head.textContent, n));
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    button.addEventListener("click", () => sortBy(n));
    head.replaceChildren(button);
  });
  const states = new Map(rows.map((row) => [keyOf(row, 0), row.cells[0].textContent]));
  for (const [key, words] of states) byId("state").append(new Option(words, key));
  byId("sort").addEventListener("change", (event) => sortBy(Number(event.target.value)));
  byId("find").addEventListener("input", filter);
  byId("state").addEventListener("change", filter);
  byId("run-tools").hidden = false;
  filter();
})();
