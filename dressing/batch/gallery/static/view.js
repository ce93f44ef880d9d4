"use strict";
// The 3-D view of one result, drawn with WebGL 2. Data come as scripts, since pages on disk may not fetch files.
const VERTEX = `#version 300 es
in vec3 position; in vec3 normal; uniform vec3 low, size; uniform mat4 camera; out vec3 n; out vec3 p;
void main() { p = low + size * position; n = normal; gl_Position = camera * vec4(p, 1.0); }`;
const FRAGMENT = `#version 300 es
precision highp float; in vec3 n; in vec3 p; uniform vec3 colour, eye; uniform bool wires; out vec4 pixel;
void main() {
  vec3 v = normalize(eye - p), u = normalize(n);
  bool wrong = dot(u, v) < 0.0;
  if (wrong) u = -u;
  vec3 c = wrong ? 0.62 * mix(colour, vec3(dot(colour, vec3(0.333))), 0.25) : colour;
  float light = 0.42 + 0.16 * u.y + 0.55 * max(dot(u, normalize(vec3(-0.7, 0.7, 0.6))), 0.0)
    + 0.2 * max(dot(u, v), 0.0);
  vec3 lit = wires ? vec3(0.1) : c * light;
  pixel = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
}`;
const field = (id) => document.getElementById(id);
const canvas = field("canvas");
const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
let parts = [], bodyPart = null, program = null, turn = 0.45, tilt = 0.1, distance = 0, middle = [0, 0.9, 0], size = 1;

function bytes(text) { return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)); }

function upload(part) {
  const buffer = (target, data) => {
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, data, gl.STATIC_DRAW);
    return made;
  };
  const raw = bytes(part.indices).buffer;
  const indices = part.wide ? new Uint32Array(raw) : new Uint16Array(raw);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  buffer(gl.ARRAY_BUFFER, new Uint16Array(bytes(part.positions).buffer));
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 0, 0);
  buffer(gl.ARRAY_BUFFER, new Int8Array(bytes(part.normals).buffer));
  gl.enableVertexAttribArray(1);
  gl.vertexAttribPointer(1, 3, gl.BYTE, true, 0, 0);
  buffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  const lines = new Uint32Array(2 * indices.length);
  for (let k = 0; k < indices.length; k += 3) {
    lines.set([indices[k], indices[k + 1], indices[k + 1], indices[k + 2], indices[k + 2], indices[k]], 2 * k);
  }
  return { ...part, array, count: indices.length, type: part.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, lines };
}

function compile() {
  program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, "position");
  gl.bindAttribLocation(program, 1, "normal");
  gl.linkProgram(program);
}

function times(a, b) {
  const c = new Array(16).fill(0);
  for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}

function camera() {
  const away = [Math.sin(turn) * Math.cos(tilt), Math.sin(tilt), Math.cos(turn) * Math.cos(tilt)];
  const right = [Math.cos(turn), 0, -Math.sin(turn)];
  const up = [away[1] * right[2] - away[2] * right[1], away[2] * right[0] - away[0] * right[2],
    away[0] * right[1] - away[1] * right[0]];
  const eye = middle.map((value, k) => value + distance * away[k]);
  const dot = (a) => a[0] * eye[0] + a[1] * eye[1] + a[2] * eye[2];
  const look = [right[0], up[0], away[0], 0, right[1], up[1], away[1], 0, right[2], up[2], away[2], 0,
    -dot(right), -dot(up), -dot(away), 1];
  const f = 1 / Math.tan(0.2), near = 0.02 * distance, far = distance + 4 * size;
  const lens = [f * canvas.height / canvas.width, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
    0, 0, 2 * far * near / (near - far), 0];
  return { matrix: times(lens, look), eye, right, up };
}

function draw() {
  if (!program) return;
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.clientWidth * ratio;
  canvas.height = canvas.clientHeight * ratio;
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.useProgram(program);
  const { matrix, eye } = camera();
  const at = (name) => gl.getUniformLocation(program, name);
  gl.uniformMatrix4fv(at("camera"), false, matrix);
  gl.uniform3fv(at("eye"), eye);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  for (const part of [...(bodyPart && field("body").checked ? [bodyPart] : []), ...parts]) {
    gl.uniform3fv(at("low"), part.low);
    gl.uniform3fv(at("size"), part.size);
    gl.uniform3fv(at("colour"), part.colour);
    gl.uniform1i(at("wires"), 0);
    // Cloth that lies a tenth of a millimetre off the skin must not flicker with it, nor lines with cloth.
    if (part === bodyPart) gl.polygonOffset(3, 12);
    else gl.polygonOffset(1, 1);
    gl.bindVertexArray(part.array);
    gl.drawElements(gl.TRIANGLES, part.count, part.type, 0);
    if (!field("wires").checked || part === bodyPart) continue;
    gl.uniform1i(at("wires"), 1);
    part.lineArray ??= lineArray(part);
    gl.bindVertexArray(part.lineArray);
    gl.drawElements(gl.LINES, part.lines.length, gl.UNSIGNED_INT, 0);
  }
  gl.bindVertexArray(null);
  canvas.dataset.drawn = String(parts.length + (bodyPart && field("body").checked ? 1 : 0));
}

function lineArray(part) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [slot, name, type, Kind] of [[0, "positions", gl.UNSIGNED_SHORT, Uint16Array], [1, "normals", gl.BYTE, Int8Array]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Kind(bytes(part[name]).buffer), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(slot);
    gl.vertexAttribPointer(slot, 3, type, true, 0, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, part.lines, gl.STATIC_DRAW);
  return array;
}

function frame(all) {
  const low = [0, 1, 2].map((k) => Math.min(...all.map((part) => part.low[k])));
  const high = [0, 1, 2].map((k) => Math.max(...all.map((part) => part.low[k] + part.size[k])));
  middle = low.map((value, k) => 0.5 * (value + high[k]));
  size = Math.max(...low.map((value, k) => high[k] - value));
  distance = 2.9 * size;
}

function load(source) {
  const script = document.createElement("script");
  script.src = source;
  script.onerror = () => say("The view's data are missing; run toile batch gallery again.");
  document.body.append(script);
}

function say(text) {
  field("nothing").textContent = text;
  field("nothing").hidden = !text;
  canvas.hidden = Boolean(text);
}

function showJob(job) {
  parts = job.garments.map(upload);
  frame(parts);
  if (job.body) load(`bodies/${job.body}.js`);
  draw();
}

function showBody(body) {
  bodyPart = upload(body);
  frame([bodyPart, ...parts]);
  draw();
}

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
  field("facts").replaceChildren(list);
}

function open() {
  const name = decodeURIComponent(location.hash.slice(1));
  const row = JOBS.find((entry) => entry[0] === name);
  field("title").textContent = document.title = name || "Result";
  if (!row) return say("There is no such job.");
  const job = Object.fromEntries(COLUMNS.map((column, k) => [column, row[k]]));
  facts(job);
  if (!job.view) return say(job.message || "This job has no result yet.");
  if (!gl) return say("This browser has no WebGL 2; open dressed.glb in the job's folder instead.");
  compile();
  load(`views/${name}.js`);
}

canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
canvas.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  if (event.buttons === 1 && !event.shiftKey) {
    turn -= 0.01 * event.movementX;
    tilt = Math.max(-1.5, Math.min(1.5, tilt + 0.01 * event.movementY));
  } else {
    const { right, up } = camera(), step = 0.4 * distance / canvas.clientHeight;
    middle = middle.map((value, k) => value - step * (event.movementX * right[k] - event.movementY * up[k]));
  }
  draw();
});
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  distance = Math.max(0.1 * size, Math.min(10 * size, distance * Math.exp(0.001 * event.deltaY)));
  draw();
}, { passive: false });
for (const id of ["body", "wires"]) field(id).addEventListener("input", draw);
window.addEventListener("resize", draw);
window.addEventListener("hashchange", () => location.reload());
open();
