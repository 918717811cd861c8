"use strict";
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

// light or dark
document.getElementById("theme").onclick = () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
};

// methods shown
const names = all(".legend label").map((label) => label.textContent.trim());
const boxes = all("[data-hide]");
const methods_changed = () => {
  for (const box of boxes) document.body.classList.toggle(box.dataset.hide, !box.checked);
  document.getElementById("shown").textContent = `${boxes.filter((box) => box.checked).length} of ${boxes.length}`;
  document.dispatchEvent(new Event("methods"));
};
for (const box of boxes) box.onchange = methods_changed;
for (const button of all("[data-show]")) {
  button.onclick = () => {
    for (const box of boxes) box.checked = button.dataset.show === "all" || box.defaultChecked;
    methods_changed();
  };
}
const legend = document.querySelector(".legend");
if (matchMedia("(max-width: 40rem)").matches) legend.open = false;
// what is scrolled to must not lie below it
new ResizeObserver(() => { document.documentElement.style.scrollPaddingTop = `${legend.offsetHeight + 8}px`; }).observe(legend);

// sorting: numbers first down, then up
for (const heading of all(".sortable thead th")) {
  heading.tabIndex = 0;
  heading.onkeydown = (event) => event.key === "Enter" && heading.click();
  heading.onclick = () => {
    const table = heading.closest("table");
    const column = heading.cellIndex;
    const value = (row) => {
      const cell = row.cells[column];
      return cell.dataset.value === undefined ? cell.textContent.trim() : Number(cell.dataset.value);
    };
    const body = table.tBodies[0];
    const rows = [...body.rows];
    const number = typeof value(rows[0]) === "number";
    const was = heading.getAttribute("aria-sort");
    const descending = was ? was === "ascending" : number;
    const compare = (a, b) => (number ? value(a) - value(b) : value(a).localeCompare(value(b)));
    rows.sort((a, b) => (descending ? compare(b, a) : compare(a, b)));
    all("th", table.tHead).forEach((other) => other.removeAttribute("aria-sort"));
    heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
    body.append(...rows);
  };
}

// classes by name and order
const class_bars = all(".class");
if (class_bars.length) {
  const [name, order] = ["class-name", "class-order"].map((id) => document.getElementById(id));
  const value = (bars) => {
    const first = boxes.findIndex((box) => box.checked);
    return first < 0 ? 0 : parseFloat(all(".bar i", bars)[first].style.width);
  };
  const orders = {
    name: () => 0,
    size: (a, b) => b.dataset.size - a.dataset.size,
    worst: (a, b) => value(a) - value(b),
    best: (a, b) => value(b) - value(a),
  };
  const arrange = () => {
    const wanted = name.value.toLowerCase();
    for (const bars of class_bars) bars.hidden = !bars.dataset.name.toLowerCase().includes(wanted);
    document.querySelector(".bars").append(...[...class_bars].sort(orders[order.value]));
  };
  name.oninput = order.onchange = arrange;
  document.addEventListener("methods", arrange);
}

// rows that hold a text
for (const input of all("[data-filters]")) {
  const rows = all(`#${input.dataset.filters} tbody tr`);
  input.oninput = () => {
    const wanted = input.value.toLowerCase();
    for (const row of rows) row.hidden = !row.textContent.toLowerCase().includes(wanted);
  };
}

// one of several blocks
for (const select of all("[data-shows]")) {
  const blocks = all(`[data-of="${select.dataset.shows}"]`);
  select.onchange = () => blocks.forEach((block, i) => { block.hidden = i !== select.selectedIndex; });
}

// values under the pointer
const tip = document.getElementById("tip");
for (const chart of all(".chart")) {
  const numbers = JSON.parse(chart.dataset.numbers);
  const svg = chart.querySelector("svg");
  const area = svg.querySelector("clipPath rect");
  if (!area) continue;
  const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
  line.setAttribute("stroke", "var(--soft)");
  line.setAttribute("y1", area.getAttribute("y"));
  line.setAttribute("y2", Number(area.getAttribute("y")) + Number(area.getAttribute("height")));
  svg.append(line);
  const hide = () => { tip.hidden = true; line.style.display = "none"; };
  const show = (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const [left, width] = [Number(area.getAttribute("x")), Number(area.getAttribute("width"))];
    const recall = (at.x - left) / width;
    if (recall < -0.03 || recall > 1.03) return hide();
    const distance = (i) => Math.abs(numbers.recall[i] - recall);
    const nearest = numbers.recall.map((_, i) => i).reduce((a, b) => (distance(b) < distance(a) ? b : a));
    const x = left + width * numbers.recall[nearest];
    line.style.display = "";
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
    const rows = numbers.series.map((series, i) => ({ i, value: series[nearest], name: names[i] ?? "chance" }))
      .filter((row) => row.value !== null && !document.body.classList.contains(`hide${row.i}`))
      .sort((a, b) => b.value - a.value)
      .map((row) => {
        const dot = element("i");
        dot.style.setProperty("--c", `var(--m${row.i})`);
        return element("div", {}, dot, row.name, element("b", { textContent: row.value.toFixed(3) }));
      });
    tip.replaceChildren(element("div", { textContent: `recall ${numbers.recall[nearest].toFixed(2)}` }), ...rows);
    tip.hidden = false;
    const place = (pointer, size, room) => Math.max(4, pointer + 16 + size > room ? pointer - size - 16 : pointer + 16);
    tip.style.left = `${place(event.clientX, tip.offsetWidth, innerWidth)}px`;
    tip.style.top = `${place(event.clientY, tip.offsetHeight, innerHeight)}px`;
  };
  hide();
  svg.addEventListener("pointermove", show);
  svg.addEventListener("pointerdown", show);
  svg.addEventListener("pointerleave", hide);
}

methods_changed();

// a printed page tells the settings too
const folded = all("#settings details");
addEventListener("beforeprint", () => folded.forEach((one) => { one.open = true; }));
addEventListener("afterprint", () => folded.forEach((one) => { one.open = false; }));

// queries and their hits
const source = document.getElementById("data");
if (source) gallery(JSON.parse(source.textContent));

function gallery(data) {
  const [by, kind, name, order] = ["by", "class", "name", "order"].map((id) => document.getElementById(id));
  const [list, hits] = [document.getElementById("queries"), document.getElementById("hits")];
  by.append(...data.methods.map((method) => element("option", { textContent: method.name })));
  const classes = [...new Set(data.queries.map((model) => data.models[model].class))].sort();
  kind.append(...classes.map((text) => element("option", { value: text, textContent: text })));
  const query_of = new Map(data.queries.map((model, query) => [model, query]));
  const views = ["on the symmetry plane", "on the second plane", "on the third plane"];
  let open = null;

  const line = (textContent, className = "soft") => element("span", { textContent, className });
  const card = (tag, model, ...lines) => {
    const { id, picture, class: of, symmetry, plane } = data.models[model];
    const short = id.split(/[\/!]/).pop();
    const title = [id, of, symmetry, plane && `plane ${plane}`].filter(Boolean).join("\n");
    return element(tag, { className: "model", title }, element("img", { src: picture, alt: id, loading: "lazy" }), line(short, "one-line"), line(of, "soft one-line"), ...lines);
  };
  const method = () => data.methods[by.selectedIndex];
  const by_symmetry = () => method().name.startsWith("symmetry");

  // which plane made the frame: that is what the method sees of the symmetry
  const frame = (model) => {
    if (!by_symmetry()) return [];
    const { symmetry, plane } = data.models[model];
    return [line(symmetry, "plane"), ...(plane ? [line(plane)] : [])];
  };

  const parts = (found, widest) => {
    const bar = element("span", { className: "parts" });
    found.forEach((value, view) => {
      const part = element("i", { title: `${value} ${views[view]}` });
      part.style.width = `${(100 * value) / (widest || 1)}%`;
      bar.append(part);
    });
    return [bar, line(found.map((value) => value.toFixed(3)).join(" + "))];
  };

  const show = () => {
    hits.hidden = open === null;
    if (open === null) return;
    const query = data.models[data.queries[open]];
    const [precision, found] = method().queries[open];
    const asked = card("div", data.queries[open], line("query"), ...frame(data.queries[open]));
    asked.classList.add("asked");
    const widest = Math.max(...found.map((hit) => hit[1]));
    const rows = found.map(([model, distance, ...views], rank) => {
      const next = query_of.get(model);
      const made = card(next === undefined ? "div" : "button", model, line(`${rank + 1}. ${Number(distance.toPrecision(4))}`, "rank"),
        ...(views.length ? parts(views, widest) : []), ...frame(model));
      made.classList.add(data.models[model].class === query.class ? "relevant" : "wrong");
      if (next !== undefined) made.onclick = () => ask(next);
      return made;
    });
    const close = element("button", { type: "button", textContent: "Close", onclick: () => ask(null) });
    const three = element("p", { className: "soft" },
      "Green, solid: of the query's class; orange, dashed: of another. Below, the distance",
      ...(found.some((hit) => hit.length > 2) ? [" and its parts, the three views: ",
        ...views.flatMap((text, view) => [element("i", { className: `view view${view}` }), `${text}${view < 2 ? ", " : "."}`])] : ["."]),
      by_symmetry() ? " Then the mirror plane that the frame was made from: normal and offset in the coordinates of the run." : "");
    hits.replaceChildren(close, element("h3", { textContent: `${query.id}: average precision ${precision.toFixed(3)} by ${method().name}` }),
      three, element("div", { className: "row" }, asked, ...rows));
  };

  const ask = (query) => {
    open = query;
    show();
    all("[data-query]", list).forEach((card) => card.setAttribute("aria-pressed", Number(card.dataset.query) === open));
    if (open !== null) hits.scrollIntoView({ block: "nearest" });
  };

  const list_queries = () => {
    const precision = (query) => method().queries[query][0];
    const wanted = name.value.toLowerCase();
    const fits = (query) => {
      const model = data.models[data.queries[query]];
      return (!kind.value || model.class === kind.value) && model.id.toLowerCase().includes(wanted);
    };
    const shown = data.queries.map((_, query) => query).filter(fits);
    if (order.value) shown.sort((a, b) => (precision(a) - precision(b)) * (order.value === "worst" ? 1 : -1));
    list.replaceChildren(...shown.map((query) => {
      const made = card("button", data.queries[query], line(`AP ${precision(query).toFixed(2)}`));
      made.dataset.query = query;
      made.setAttribute("aria-pressed", query === open);
      made.onclick = () => ask(query);
      return made;
    }));
    if (!shown.length) list.append("No query fits.");
  };

  by.onchange = () => { show(); list_queries(); };
  kind.onchange = order.onchange = name.oninput = list_queries;
  list_queries();
}
