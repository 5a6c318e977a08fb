"use strict";
// Unfolds a part and filters the table. Without scripts the page is a plain table.
const parts = [...document.querySelectorAll("tbody")];
const toggle = (part) => part.classList.toggle("open");
for (const part of parts) part.querySelector("tr.part").onclick = () => toggle(part);
const filters = {
  all: () => true,
  failed: (part) => part.classList.contains("failed"),
  changed: (part) => part.dataset.how === "patched",
};
const bar = document.getElementById("filters");
for (const [name, wanted] of Object.entries(filters)) {
  const button = document.createElement("button");
  button.textContent = `${name} (${parts.filter(wanted).length})`;
  button.id = `show-${name}`;
  button.onclick = () => {
    for (const part of parts) part.hidden = !wanted(part);
    for (const other of bar.children) other.classList.toggle("on", other === button);
  };
  bar.append(button);
}
for (const part of parts.filter(filters.failed).concat(parts.length === 1 ? parts : [])) part.classList.add("open");
