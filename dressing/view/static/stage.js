"use strict";
// A stage: meshes drawn with WebGL 2, a camera to turn, and the ray that finds what lies under the pointer.
const STAGE_VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in float value; in float panel; in vec2 thread; uniform mat4 camera; uniform vec3 shift;
out vec3 n; out vec3 p; out float shade; out vec3 bary; out vec2 uv; flat out float piece; flat out int face;
void main() {
  p = position + shift; n = normal; uv = thread; shade = value; piece = panel; face = gl_VertexID / 3;
  int corner = gl_VertexID - 3 * face;
  bary = vec3(corner == 0, corner == 1, corner == 2);
  gl_Position = camera * vec4(p, 1.0);
}`;
const STAGE_FRAGMENT = `#version 300 es
precision highp float; in vec3 n; in vec3 p; in float shade; in vec3 bary; in vec2 uv; flat in float piece; flat in int face;
uniform vec3 colour, eye; uniform bool wires, mapped, checked; uniform float lit_piece; uniform int lit_face; out vec4 pixel;
vec3 map(float t) {
  vec3 a = vec3(0.19, 0.33, 0.66), b = vec3(0.93, 0.91, 0.84), c = vec3(0.80, 0.24, 0.17);
  return t < 0.5 ? mix(a, b, 2.0 * t) : mix(b, c, 2.0 * t - 1.0);
}
void main() {
  vec3 v = normalize(eye - p), u = normalize(n);
  bool wrong = dot(u, v) < 0.0;
  if (wrong) u = -u;
  vec3 base = mapped ? pow(map(clamp(shade, 0.0, 1.0)), vec3(2.2)) : colour;
  if (checked && !mapped) {
    // Stripes along warp and weft, 5 cm wide.
    vec2 s = step(0.5, fract(10.0 * uv));
    base *= 1.0 - 0.28 * s.x - 0.28 * s.y;
  }
  vec3 c = wrong && !mapped ? 0.62 * mix(base, vec3(dot(base, vec3(0.333))), 0.25) : base;
  float light = 0.42 + 0.16 * u.y + 0.55 * max(dot(u, normalize(vec3(-0.7, 0.7, 0.6))), 0.0) + 0.2 * max(dot(u, v), 0.0);
  if (mapped) light = 0.55 + 0.45 * max(dot(u, v), 0.0);
  vec3 lit = c * light;
  if (piece >= 0.0 && piece == lit_piece) lit = mix(lit, vec3(0.95, 0.75, 0.2), mapped ? 0.0 : 0.25);
  if (face == lit_face) lit = vec3(0.95, 0.6, 0.05);
  if (wires) {
    vec3 d = fwidth(bary), near = smoothstep(vec3(0.0), 1.2 * d, bary);
    lit = mix(vec3(0.03), lit, 0.35 + 0.65 * min(min(near.x, near.y), near.z));
  }
  pixel = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
}`;

const cross3 = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const toLinear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

class StageMesh {
  // Triangles with vertices that may move. `faces` index rows of `positions` (Float32Array, 3 a row); rows at one
  // place are shaded as one, so that seams look sewn. `panels`: a number per face, or null.
  constructor(gl, options) {
    Object.assign(this, { name: "", kind: "garment", colour: [0.5, 0.5, 0.5], shown: true, panels: null, uv: null, shift: [0, 0, 0] }, options);
    this.gl = gl;
    this.linear = this.colour.map(toLinear);
    this.buffers = {};
    this.array = gl.createVertexArray();
    this.setShape(options.faces, options.positions, options.node);
  }

  setShape(faces, positions, node) {
    this.faces = faces;
    this.count = faces.length;
    this.node = node || StageMesh.joined(positions);
    this.corners = { position: new Float32Array(3 * this.count), normal: new Float32Array(3 * this.count) };
    const panel = new Float32Array(this.count);
    for (let k = 0; k < this.count; k++) panel[k] = this.panels ? this.panels[(k / 3) | 0] : -1;
    this.fill("panel", 3, 1, panel);
    if (this.uv) this.fill("thread", 4, 2, Float32Array.from({ length: 2 * this.count }, (_, k) => this.uv[2 * faces[k >> 1] + (k & 1)]));
    this.setValues(null);
    this.move(positions);
  }

  static joined(positions) {
    const known = new Map(), node = new Uint32Array(positions.length / 3);
    for (let k = 0; k < node.length; k++) {
      const key = `${positions[3 * k].toFixed(5)},${positions[3 * k + 1].toFixed(5)},${positions[3 * k + 2].toFixed(5)}`;
      if (!known.has(key)) known.set(key, k);
      node[k] = known.get(key);
    }
    return node;
  }

  move(positions) {
    // Vertices somewhere else: normals are means over the faces around a node, by area.
    this.positions = positions;
    const { faces, node, count } = this, { position, normal } = this.corners;
    const sums = new Float32Array(positions.length);
    for (let k = 0; k < count; k += 3) {
      const a = 3 * faces[k], b = 3 * faces[k + 1], c = 3 * faces[k + 2];
      const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
      const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      for (let q = 0; q < 3; q++) {
        const i = 3 * node[faces[k + q]];
        sums[i] += x; sums[i + 1] += y; sums[i + 2] += z;
      }
    }
    for (let k = 0; k < count; k++) {
      const from = 3 * faces[k], i = 3 * node[faces[k]], to = 3 * k;
      position[to] = positions[from]; position[to + 1] = positions[from + 1]; position[to + 2] = positions[from + 2];
      normal[to] = sums[i]; normal[to + 1] = sums[i + 1]; normal[to + 2] = sums[i + 2];
    }
    this.fill("position", 0, 3, position);
    this.fill("normal", 1, 3, normal);
  }

  setValues(values, perFace) {
    // Values between 0 and 1 that colour it: of vertices or of faces; null: its own colour.
    this.mapped = Boolean(values);
    const corners = new Float32Array(this.count);
    if (values) for (let k = 0; k < this.count; k++) corners[k] = values[perFace ? (k / 3) | 0 : this.faces[k]];
    this.fill("value", 2, 1, corners);
  }

  fill(name, slot, size, data) {
    const gl = this.gl;
    gl.bindVertexArray(this.array);
    this.buffers[name] ??= gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(slot);
    gl.vertexAttribPointer(slot, size, gl.FLOAT, false, 0, 0);
    gl.bindVertexArray(null);
  }

  hit(origin, ray) {
    // The nearest face that a ray meets: { distance, face, weights of its corners }, or null (Moeller, Trumbore 1997).
    let best = null;
    const { positions, faces, count } = this;
    for (let k = 0; k < count; k += 3) {
      const a = 3 * faces[k], b = 3 * faces[k + 1], c = 3 * faces[k + 2];
      const e = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
      const f = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
      const h = cross3(ray, f), scale = dot3(e, h);
      if (Math.abs(scale) < 1e-14) continue;
      const s = [origin[0] - positions[a], origin[1] - positions[a + 1], origin[2] - positions[a + 2]];
      const u = dot3(s, h) / scale;
      if (u < 0 || u > 1) continue;
      const q = cross3(s, e), v = dot3(ray, q) / scale;
      if (v < 0 || u + v > 1) continue;
      const distance = dot3(f, q) / scale;
      if (distance > 1e-6 && (!best || distance < best.distance)) best = { distance, face: k / 3, weights: [1 - u - v, u, v] };
    }
    return best;
  }
}

class Stage {
  // `smooth`: edges without steps, which a processor that draws takes a third longer for.
  constructor(canvas, smooth = true) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: smooth, preserveDrawingBuffer: smooth });
    this.meshes = [];
    Object.assign(this, { turn: 0.45, tilt: 0.1, distance: 4, middle: [0, 0.9, 0], size: 1, wires: false, checked: false });
    Object.assign(this, { litPiece: -1, litFace: -1, litMesh: null, onDraw: () => {}, grab: null, asked: false, drawn: 0 });
    if (this.gl) this.compile();
    this.listen();
  }

  static drawnByProcessor() {
    const gl = document.createElement("canvas").getContext("webgl2"), told = gl && gl.getExtension("WEBGL_debug_renderer_info");
    return Boolean(told && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(told.UNMASKED_RENDERER_WEBGL)));
  }

  compile() {
    const gl = this.gl, program = (this.program = gl.createProgram());
    for (const [kind, source] of [[gl.VERTEX_SHADER, STAGE_VERTEX], [gl.FRAGMENT_SHADER, STAGE_FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ["position", "normal", "value", "panel", "thread"].forEach((name, slot) => gl.bindAttribLocation(program, slot, name));
    gl.linkProgram(program);
    this.at = (name) => gl.getUniformLocation(program, name);
  }

  add(options) {
    const mesh = new StageMesh(this.gl, options);
    this.meshes.push(mesh);
    return mesh;
  }

  frame() {
    const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
    for (const mesh of this.meshes) for (let k = 0; k < mesh.positions.length; k++) {
      low[k % 3] = Math.min(low[k % 3], mesh.positions[k]);
      high[k % 3] = Math.max(high[k % 3], mesh.positions[k]);
    }
    this.middle = low.map((value, k) => 0.5 * (value + high[k]));
    this.size = Math.max(...low.map((value, k) => high[k] - value), 1e-6);
    const narrow = Math.min(1, this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1));
    this.distance = 2.9 * this.size / Math.max(narrow, 0.45);
  }

  camera() {
    const { turn, tilt, distance, middle, size, canvas } = this;
    const away = [Math.sin(turn) * Math.cos(tilt), Math.sin(tilt), Math.cos(turn) * Math.cos(tilt)];
    const right = [Math.cos(turn), 0, -Math.sin(turn)], up = cross3(away, right);
    const eye = middle.map((value, k) => value + distance * away[k]);
    const f = 1 / Math.tan(0.2), aspect = canvas.clientHeight / Math.max(canvas.clientWidth, 1);
    const near = 0.02 * distance, far = distance + 6 * size, depth = (far + near) / (near - far);
    const rows = [right.map((x) => x * f * aspect), up.map((x) => x * f), away.map((x) => x * depth), away.map((x) => -x)];
    const last = [-dot3(rows[0], eye), -dot3(rows[1], eye), -dot3(rows[2], eye) + 2 * far * near / (near - far), -dot3(rows[3], eye)];
    const matrix = [];
    for (let column = 0; column < 3; column++) for (const row of rows) matrix.push(row[column]);
    return { matrix: [...matrix, ...last], eye, right, up, away };
  }

  draw() {
    // Drawn once per picture of the screen, however often it is asked for.
    if (this.asked || !this.gl) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.drawNow(); });
  }

  drawNow() {
    const { gl, canvas, at } = this, ratio = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.useProgram(this.program);
    const { matrix, eye } = this.camera();
    gl.uniformMatrix4fv(at("camera"), false, matrix);
    gl.uniform3fv(at("eye"), eye);
    const shown = this.meshes.filter((mesh) => mesh.shown);
    for (const mesh of shown) {
      gl.uniform3fv(at("colour"), mesh.linear);
      gl.uniform3fv(at("shift"), mesh.shift);
      gl.uniform1i(at("mapped"), mesh.mapped ? 1 : 0);
      gl.uniform1i(at("wires"), this.wires && mesh.kind !== "body" ? 1 : 0);
      gl.uniform1i(at("checked"), this.checked && mesh.uv ? 1 : 0);
      gl.uniform1f(at("lit_piece"), mesh === this.litMesh ? this.litPiece : -9);
      gl.uniform1i(at("lit_face"), mesh === this.litMesh ? this.litFace : -1);
      // Cloth that lies a tenth of a millimetre off the skin must not flicker with it.
      gl.polygonOffset(mesh.kind === "body" ? 3 : 0, mesh.kind === "body" ? 12 : 0);
      gl.bindVertexArray(mesh.array);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
    gl.bindVertexArray(null);
    this.drawn += 1;
    canvas.dataset.drawn = String(shown.length);
    this.onDraw();
  }

  ray(x, y) {
    const { eye, right, up, away } = this.camera(), { clientWidth, clientHeight } = this.canvas, f = 1 / Math.tan(0.2);
    const across = (2 * x / clientWidth - 1) * clientWidth / clientHeight / f, over = (1 - 2 * y / clientHeight) / f;
    const ray = right.map((value, k) => value * across + up[k] * over - away[k]);
    const length = Math.hypot(...ray);
    return { eye, ray: ray.map((value) => value / length) };
  }

  pick(x, y, kinds) {
    // What lies under a place of the canvas [pixels]: { mesh, face, weights, distance, point }, or null.
    const { eye, ray } = this.ray(x, y);
    let best = null;
    for (const mesh of this.meshes) {
      if (!mesh.shown || (kinds && !kinds.includes(mesh.kind))) continue;
      const hit = mesh.hit(eye.map((value, k) => value - mesh.shift[k]), ray);
      if (hit && (!best || hit.distance < best.distance)) best = { ...hit, mesh };
    }
    return best && { ...best, point: eye.map((value, k) => value + best.distance * ray[k]) };
  }

  project(point) {
    // Where a point [m] is on the canvas [pixels].
    const { matrix } = this.camera(), m = [0, 1, 2, 3].map((row) =>
      matrix[row] * point[0] + matrix[4 + row] * point[1] + matrix[8 + row] * point[2] + matrix[12 + row]);
    return [0.5 * (1 + m[0] / m[3]) * this.canvas.clientWidth, 0.5 * (1 - m[1] / m[3]) * this.canvas.clientHeight];
  }

  pan(x, y) {
    const { right, up } = this.camera(), step = 0.4 * this.distance / this.canvas.clientHeight;
    this.middle = this.middle.map((value, k) => value - step * (x * right[k] - y * up[k]));
    this.draw();
  }

  zoom(factor) {
    this.distance = Math.max(0.05 * this.size, Math.min(12 * this.size, this.distance * factor));
    this.draw();
  }

  rotate(x, y) {
    this.turn -= x;
    this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + y));
    this.draw();
  }

  listen() {
    // One pointer turns, two pinch and move; what `grab` takes is not the camera's.
    const canvas = this.canvas, fingers = new Map();
    const place = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    let taken = null;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      fingers.set(event.pointerId, place(event));
      taken = fingers.size === 1 && event.button === 0 && !event.shiftKey && this.grab ? this.grab(...place(event)) : null;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId), now = place(event);
      if (!before) return;
      const x = now[0] - before[0], y = now[1] - before[1];
      if (taken) taken.move(...now);
      else if (fingers.size === 2) {
        const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
        const span = (p) => Math.max(Math.hypot(p[0] - other[0], p[1] - other[1]), 1);
        this.zoom(span(before) / span(now));
        this.pan(0.5 * x, 0.5 * y);
      } else if (event.buttons === 1 && !event.shiftKey) this.rotate(0.01 * x, 0.01 * y);
      else this.pan(x, y);
      fingers.set(event.pointerId, now);
    });
    const end = (event) => { fingers.delete(event.pointerId); if (taken) taken.end(); taken = null; };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); this.zoom(Math.exp(0.001 * event.deltaY)); }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (by && event.shiftKey) this.pan(30 * by[0], 30 * by[1]);
      else if (by) this.rotate(-0.12 * by[0], 0.12 * by[1]);
      else if (event.key === "+" || event.key === "=") this.zoom(0.87);
      else if (event.key === "-") this.zoom(1.15);
      else return;
      event.preventDefault();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }
}
