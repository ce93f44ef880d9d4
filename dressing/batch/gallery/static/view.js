"use strict";
// The page of one job: its facts from the ledger, and its result in the viewer.
const viewer = new Viewer(document.querySelector("[data-view=root]"));

function load(source) {
  const script = document.createElement("script");
  script.src = source;
  script.onerror = () => viewer.say("The view's data are missing; run toile batch gallery again.");
  document.body.append(script);
}

function showJob(header, numbers) { viewer.show({ ...header, facts: [] }, numbers); }

function facts(job) {
  const list = document.createElement("dl");
  const row = (name, value) => {
    if (value === null || value === undefined || value === "") return;
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = name;
    if (value instanceof Node) text.append(value); else text.textContent = value;
    list.append(term, text);
  };
  const link = (path, text) => Object.assign(document.createElement("a"), { href: path, textContent: text });
  row("state", job.failure_class ? `${job.state}: ${job.failure_class}` : job.status || job.state);
  row("reason", job.message);
  row("body", job.avatar);
  row("garments", job.garments);
  row("fabrics", job.fabrics);
  row("quality", job.quality);
  row("CPU time", job.cpu_seconds === null ? null : `${job.cpu_seconds} s`);
  row("triangles", job.faces);
  row("crossings", job.avatar_intersections === null ? null
    : `${job.avatar_intersections} with the body, ${job.self_intersections} with itself`);
  row("strain", job.strain_p99 === null ? null : `${job.strain_p99} % (99th percentile)`);
  row("gap", job.min_gap_mm === null ? null : `${job.min_gap_mm} mm`);
  if (job.view) row("files", link(`../jobs/${job.name}/`, "folder"));
  if (job.view) row("3-D model", link(`../jobs/${job.name}/dressed.glb`, "dressed.glb"));
  if (job.view) row("report", link(`../jobs/${job.name}/report.json`, "report.json"));
  if (job.log) row("log", link(`../logs/${job.name}.txt`, "log"));
  document.getElementById("job").replaceChildren(list);
}

function open() {
  const name = decodeURIComponent(location.hash.slice(1));
  const row = JOBS.find((entry) => entry[0] === name);
  document.getElementById("title").textContent = document.title = name || "Result";
  if (!row) return viewer.say("There is no such job.");
  const job = Object.fromEntries(COLUMNS.map((column, k) => [column, row[k]]));
  facts(job);
  if (!job.view) return viewer.say(job.message || "This job has no result yet.");
  load(`views/${name}.js`);
}

window.addEventListener("hashchange", () => location.reload());
open();
