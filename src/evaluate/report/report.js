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
for (const box of all("[data-hide]")) {
  box.onchange = () => document.body.classList.toggle(box.dataset.hide, !box.checked);
}

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

// queries and their hits
const source = document.getElementById("data");
if (source) gallery(JSON.parse(source.textContent));

function gallery(data) {
  const [by, kind, name, order] = ["by", "class", "name", "order"].map((id) => document.getElementById(id));
  const [list, hits] = [document.getElementById("queries"), document.getElementById("hits")];
  by.append(...data.methods.map((method) => element("option", { textContent: method.name })));
  const classes = [...new Set(data.queries.map((model) => data.models[model].class))];
  kind.append(...classes.map((text) => element("option", { value: text, textContent: text })));
  let open = null;

  const card = (tag, model, ...lines) => {
    const { id, picture, class: of, symmetry } = data.models[model];
    const short = id.split(/[\/!]/).pop();
    const texts = [short, of, ...lines].map((textContent, i) => element("span", { textContent, className: i ? "soft" : "one-line" }));
    return element(tag, { className: "model", title: `${id}\n${of}\n${symmetry}` }, element("img", { src: picture, alt: id, loading: "lazy" }), ...texts);
  };
  const method = () => data.methods[by.selectedIndex];

  const show = () => {
    hits.hidden = open === null;
    if (open === null) return;
    const query = data.models[data.queries[open]];
    const [precision, found] = method().queries[open];
    const asked = card("div", data.queries[open], "query", query.symmetry);
    asked.classList.add("asked");
    const rows = found.map(([model, distance, views], rank) => {
      const made = card("div", model, `${rank + 1}. ${distance.toFixed(4)}`, views.map((view) => view.toFixed(3)).join(" + "), data.models[model].symmetry);
      made.classList.add(data.models[model].class === query.class ? "relevant" : "wrong");
      return made;
    });
    const close = element("button", { type: "button", textContent: "Close", onclick: () => { open = null; show(); list_queries(); } });
    hits.replaceChildren(close, element("h3", { textContent: `${query.id}: average precision ${precision.toFixed(3)} by ${method().name}` }),
      element("div", { className: "row" }, asked, ...rows));
  };

  const list_queries = () => {
    const precision = (query) => method().queries[query][0];
    const fits = (query) => {
      const model = data.models[data.queries[query]];
      return (!kind.value || model.class === kind.value) && model.id.toLowerCase().includes(name.value.toLowerCase());
    };
    const shown = data.queries.map((_, query) => query).filter(fits);
    if (order.value) shown.sort((a, b) => (precision(a) - precision(b)) * (order.value === "worst" ? 1 : -1));
    list.replaceChildren(...shown.map((query) => {
      const made = card("button", data.queries[query], `AP ${precision(query).toFixed(2)}`);
      made.setAttribute("aria-pressed", query === open);
      made.onclick = () => {
        open = query;
        show();
        all("[aria-pressed]", list).forEach((other) => other.setAttribute("aria-pressed", other === made));
        hits.scrollIntoView({ block: "nearest" });
      };
      return made;
    }));
  };

  by.onchange = () => { show(); list_queries(); };
  kind.onchange = order.onchange = name.oninput = list_queries;
  list_queries();
}
