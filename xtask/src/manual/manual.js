// The search, the chapters on narrow screens, and dark or light. Nothing is fetched: `search.js` holds the index.
"use strict";

const root = document.body.dataset.root;
const field = document.getElementById("search");
const found = document.getElementById("found");
const article = document.querySelector("article");

const plain = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

/** Every section that has all words, those with the words in their headings first. */
function sections(words) {
  const rows = [];
  for (const [page, title, address, text] of SECTIONS) {
    const [inTitle, inPage, inText] = [title, page, text].map((part) => part.toLowerCase());
    let score = 0;
    for (const word of words) {
      if (inTitle.includes(word)) score += 10;
      else if (inPage.includes(word)) score += 4;
      else if (inText.includes(word)) score += 1;
      else { score = 0; break; }
    }
    if (score > 0) rows.push({ page, title, address, text, score });
  }
  return rows.sort((a, b) => b.score - a.score).slice(0, 20);
}

/** The text around the first word, with the words marked. */
function excerpt(text, words) {
  const at = Math.max(0, text.toLowerCase().indexOf(words[0]) - 60);
  let shown = plain(text.slice(at, at + 200));
  for (const word of words) {
    const pattern = new RegExp(plain(word).replace(/[.*+?^${}()|[\]\\]/g, "\\$&"), "gi");
    shown = shown.replace(pattern, "<mark>$&</mark>");
  }
  return shown;
}

function search() {
  const words = field.value.toLowerCase().split(/\s+/).filter((word) => word.length > 1);
  const rows = words.length ? sections(words) : [];
  found.hidden = article.hidden = false;
  found.hidden = words.length === 0;
  article.hidden = words.length > 0;
  const item = ({ page, title, address, text }) => {
    const name = page === title ? title : `${page}: ${title}`;
    return `<p><a href="${root}${address}">${plain(name)}</a>${excerpt(text, words)}</p>`;
  };
  found.innerHTML = rows.length ? rows.map(item).join("") : "<p>Nothing found.</p>";
}

field.addEventListener("input", search);
found.addEventListener("click", (event) => {
  if (event.target.closest("a")) { field.value = ""; search(); }
});
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && document.activeElement !== field) { event.preventDefault(); field.focus(); }
  if (event.key === "Escape" && field.value) { field.value = ""; search(); }
  if (event.key === "Enter" && document.activeElement === field) found.querySelector("a")?.click();
});

const chapters = document.getElementById("chapters");
chapters.addEventListener("click", () => {
  const open = document.body.classList.toggle("with-chapters");
  chapters.setAttribute("aria-expanded", String(open));
});
document.getElementById("text").addEventListener("click", () => document.body.classList.remove("with-chapters"));
document.querySelector("#sidebar [aria-current]")?.scrollIntoView({ block: "center" });

document.getElementById("theme").addEventListener("click", () => {
  const style = document.documentElement.dataset;
  const dark = style.theme ? style.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  style.theme = dark ? "light" : "dark";
  localStorage.setItem("theme", style.theme);
});
