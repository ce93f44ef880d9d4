"use strict";
// The gallery: filters over JOBS, cards in portions as one scrolls.
const PORTION = 120;
const jobs = JOBS.map((row) => Object.fromEntries(COLUMNS.map((name, k) => [name, row[k]])));
const field = (id) => document.getElementById(id);
const FILTERS = ["find", "state", "class", "strain_low", "strain_high", "cpu_low", "cpu_high", "order"];
let shown = [], count = 0;

function make(tag, className, text) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

function offer(id, column, all) {
  const numbers = new Map();
  for (const job of jobs) if (job[column]) numbers.set(job[column], (numbers.get(job[column]) || 0) + 1);
  field(id).append(new Option(all, ""));
  for (const [value, number] of [...numbers].sort()) field(id).append(new Option(`${value} (${number})`, value));
}

function card(job) {
  const link = make("a", "card");
  link.href = `view.html#${job.name}`;
  const picture = make("div", "picture");
  if (job.view) {
    const image = make("img");
    image.loading = "lazy";
    image.alt = job.name;
    image.src = `../jobs/${job.name}/thumbnail.png`;
    picture.append(image);
  } else picture.textContent = job.failure_class || job.state;
  const text = make("div", "text");
  text.append(make("b", "", job.name));
  text.append(make("small", job.state, job.failure_class || job.status || job.state));
  if (job.cpu_seconds !== null) {
    const strain = job.strain_p99 === null ? "" : `, strain ${job.strain_p99} %`;
    text.append(make("small", "", `${job.cpu_seconds} CPU s${strain}`));
  }
  if (job.message) text.append(make("small", "message", job.message));
  link.append(picture, text);
  return link;
}

function between(value, low, high) {
  if (low === "" && high === "") return true;
  return value !== null && (low === "" || value >= Number(low)) && (high === "" || value <= Number(high));
}

function more() {
  const next = shown.slice(count, count + PORTION);
  field("cards").append(...next.map(card));
  count += next.length;
}

function update() {
  const value = Object.fromEntries(FILTERS.map((id) => [id, field(id).value]));
  const words = value.find.toLowerCase().split(/\s+/).filter(Boolean);
  shown = jobs.filter((job) => {
    const text = `${job.name} ${job.avatar} ${job.garments} ${job.fabrics} ${job.message}`.toLowerCase();
    return words.every((word) => text.includes(word))
      && (!value.state || job.state === value.state) && (!value.class || job.failure_class === value.class)
      && between(job.strain_p99, value.strain_low, value.strain_high)
      && between(job.cpu_seconds, value.cpu_low, value.cpu_high);
  });
  if (value.order !== "name") shown.sort((a, b) => (b[value.order] ?? -1) - (a[value.order] ?? -1));
  const chosen = FILTERS.filter((id) => value[id] && !(id === "order" && value[id] === "name"));
  history.replaceState(null, "", `#${chosen.map((id) => `${id}=${encodeURIComponent(value[id])}`).join("&")}`);
  field("count").textContent = `${shown.length} of ${jobs.length} jobs`;
  field("cards").replaceChildren();
  count = 0;
  if (shown.length) more();
  else field("cards").append(make("p", "empty", "No job fits these filters."));
}

offer("state", "state", "all");
offer("class", "failure_class", "all");
for (const part of location.hash.slice(1).split("&")) {
  const [id, value] = part.split("=");
  if (FILTERS.includes(id)) field(id).value = decodeURIComponent(value);
}
document.querySelector(".filters").addEventListener("input", update);
document.querySelector(".filters").addEventListener("reset", () => setTimeout(update));
document.querySelector(".filters").addEventListener("submit", (event) => event.preventDefault());
new IntersectionObserver((seen) => { if (seen[0].isIntersecting && count < shown.length) more(); },
  { rootMargin: "800px" }).observe(field("end"));
update();
