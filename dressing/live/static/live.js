"use strict";
// The page of live cloth: draws frames as they come, and says what is done to the cloth.
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);

class LivePage {
  constructor(root) {
    this.root = root;
    this.words = WORDS[document.documentElement.lang] || WORDS.en;
    this.find = (name) => root.querySelector(`[data-view=${name}]`);
    this.control = (name) => root.querySelector(`[data-set=${name}]`);
    Object.assign(this, { tool: "pull", cloth: null, colour: "", state: null, frames: 0, before: null, ended: false, lastStep: 0, pinMarks: new Set() });
    this.stage = new Stage(this.find("canvas"), !Stage.drawnByProcessor());
    this.stage.tilt = 0.3;
    this.stage.grab = (x, y) => this.grab(x, y);
    for (const element of root.querySelectorAll("[data-word]")) element.textContent = this.words[element.dataset.word];
    this.find("help").textContent = this.words.help;
    this.choose("pull");
    this.listen();
    this.connect();
  }

  say(text) {
    this.find("nothing").textContent = text;
    this.find("nothing").hidden = !text;
    clearTimeout(this.quiet);
    if (text && !this.ended) this.quiet = setTimeout(() => this.say(""), 6000);
  }

  connect() {
    const socket = (this.socket = new WebSocket(`ws://${location.host}${location.pathname}talk`));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.told(JSON.parse(data)) : this.frame(data));
    socket.onopen = () => this.say("");
    socket.onclose = () => {
      if (this.ended) return;
      this.say(this.words.lost);
      setTimeout(() => this.connect(), 1000);
    };
  }

  send(wish) { if (this.socket.readyState === 1) this.socket.send(JSON.stringify(wish)); }

  told(message) {
    if (message.say) this.say(message.say);
    if (message.scene) this.show(message.scene);
    if (message.state) this.numbers(message.state);
  }

  show(scene) {
    const { stage } = this, first = !this.cloth;
    stage.meshes.length = 0;
    const faces = Uint32Array.from(scene.cloth.faces), count = scene.cloth.count;
    this.corners = Float32Array.from(scene.corners);
    this.cloth = stage.add({ name: "cloth", faces, uv: Float32Array.from(scene.cloth.uv), positions: new Float32Array(3 * count), node: Uint32Array.from({ length: count }, (_, k) => k), colour: this.paint() || scene.cloth.colour });
    this.obstacles = scene.obstacles.map((one) => stage.add({ name: one.name, kind: "body", colour: one.colour, faces: Uint32Array.from(one.faces), positions: Float32Array.from(one.positions) }));
    this.pins = stage.add({ name: "pins", kind: "pin", colour: [0.85, 0.25, 0.15], faces: new Uint32Array(0), positions: new Float32Array(0) });
    if (this.objectPaint) this.paintObjects();
    this.floor = null;
    this.find("sheet").hidden = !scene.sheet;
    if (scene.sheet) for (const name of ["cells", "side", "grain", "pins", "object"]) this.set(name, scene.sheet[name]);
    this.fresh = first;
    this.before = null;
  }

  paint() { return this.painted ? rgb(this.painted) : null; }

  frame(data) {
    const [step, offsets, count] = new Uint32Array(data, 0, 3), shifts = new Float32Array(data, 12, offsets);
    const values = new Float32Array(data, 12 + 4 * offsets, count), positions = new Float32Array(data, 12 + 4 * (offsets + count));
    if (this.cloth && positions.length === this.cloth.positions.length) {
      this.obstacles.forEach((mesh, k) => { mesh.shift = [...shifts.slice(3 * k, 3 * k + 3)]; });
      this.cloth.move(positions);
      this.coloured(positions, step, values);
      this.marks();
      if (this.fresh) { this.fresh = false; this.stage.frame(); this.root.dataset.ready = "yes"; }
      if (this.control("rotate").checked) this.stage.turn += 0.004;
      this.lastStep = step;
    }
    this.stage.draw();
    // A frame counts as drawn when the screen has had it: a page that lags gets fewer.
    requestAnimationFrame(() => {
      this.frames += 1;
      if (this.socket.readyState === 1) this.socket.send("drawn");
    });
  }

  coloured(positions, step, sent) {
    if (!this.colour) return;
    const { faces } = this.cloth, corners = this.corners;
    let values, top, low = 0, unit = "%";
    if (this.colour === "pressure") {
      if (!sent.length) return;
      // The top of the scale follows the cloth slowly, so that colours do not flicker.
      const now = Float32Array.from(sent).sort()[Math.floor(0.99 * (sent.length - 1))];
      this.pressureTop = Math.max(2, this.pressureTop ? 0.9 * this.pressureTop + 0.1 * now : now);
      top = Number(this.pressureTop.toPrecision(2));
      unit = "Pa";
      this.cloth.setValues(sent.map((value) => value / top), false);
    } else
    if (this.colour === "speed") {
      values = new Float32Array(positions.length / 3);
      top = 2;
      if (this.before && step > this.before.step) {
        const scale = 60 / (step - this.before.step) / top, old = this.before.positions;
        for (let k = 0; k < values.length; k++) {
          values[k] = scale * Math.hypot(positions[3 * k] - old[3 * k], positions[3 * k + 1] - old[3 * k + 1], positions[3 * k + 2] - old[3 * k + 2]);
        }
      }
      unit = "m/s";
      this.before = { step, positions };
      this.cloth.setValues(values, false);
    } else {
      // Of the map from the pattern: its larger singular value, or its length along the threads, less 1.
      values = new Float32Array(faces.length / 3);
      top = 5;
      if (this.colour !== "stretch") low = -top;
      for (let t = 0; t < values.length; t++) {
        const [a, b, c] = [3 * faces[3 * t], 3 * faces[3 * t + 1], 3 * faces[3 * t + 2]], r = 6 * t;
        const ux = corners[r + 2] - corners[r], uy = corners[r + 3] - corners[r + 1], vx = corners[r + 4] - corners[r], vy = corners[r + 5] - corners[r + 1];
        const scale = 1 / (ux * vy - uy * vx);
        let e = 0, f = 0, g = 0;
        for (let k = 0; k < 3; k++) {
          const p = positions[b + k] - positions[a + k], q = positions[c + k] - positions[a + k];
          const along = (vy * p - uy * q) * scale, across = (ux * q - vx * p) * scale;
          e += along * along; f += along * across; g += across * across;
        }
        if (this.colour === "stretch") values[t] = 100 * (Math.sqrt(0.5 * (e + g) + Math.sqrt(0.25 * (e - g) ** 2 + f * f)) - 1) / top;
        else values[t] = 0.5 + 50 * (Math.sqrt(this.colour === "warp" ? e : g) - 1) / top;
      }
      this.cloth.setValues(values, true);
    }
    this.find("scale").innerHTML = `<i></i><span>${low}</span><span>${top} ${unit}</span>`;
  }

  marks() {
    // A small octahedron at every pin.
    const pins = this.state ? this.state.pinned : [], size = 0.006, { positions } = this.cloth;
    const shown = pins.length > 400 ? [] : pins;
    const points = new Float32Array(18 * shown.length), faces = new Uint32Array(24 * shown.length);
    const corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    const sides = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5];
    shown.forEach((node, k) => {
      corners.forEach((corner, q) => { for (let axis = 0; axis < 3; axis++) points[18 * k + 3 * q + axis] = positions[3 * node + axis] + size * corner[axis]; });
      sides.forEach((corner, q) => { faces[24 * k + q] = 6 * k + corner; });
    });
    this.pins.setShape(faces, points, Uint32Array.from({ length: points.length / 3 }, (_, k) => k));
  }

  numbers(state) {
    this.state = state;
    this.find("numbers").innerHTML = this.words.numbers(state) + (state.pages > 1 ? ` · ${this.words.busy(state.pages)}` : "");
    this.find("fabric").textContent = FABRICS[state.settings.fabric] ? this.words.fabric_numbers(FABRICS[state.settings.fabric]) : "";
    this.root.querySelector("[data-do=record]").setAttribute("aria-pressed", String(state.recording));
    this.layFloor(state.floor);
    this.root.querySelector("[data-do=pause]").setAttribute("aria-pressed", String(!state.running));
    for (const [name, value] of Object.entries(state.settings)) if (document.activeElement !== this.control(name)) this.set(name, value);
  }

  layFloor(height) {
    const wide = 1.5;
    if (height !== null && !this.floor) {
      this.floor = this.stage.add({ name: "floor", kind: "body", colour: [0.80, 0.79, 0.76], faces: Uint32Array.of(0, 2, 1, 0, 3, 2), positions: Float32Array.of(-wide, height, -wide, wide, height, -wide, wide, height, wide, -wide, height, wide) });
    }
    if (this.floor) this.floor.shown = height !== null;
  }

  paintObjects() { for (const mesh of this.obstacles) mesh.linear = this.objectPaint.map(toLinear); }

  set(name, value) {
    const control = this.control(name);
    if (control.type === "checkbox") control.checked = value; else control.value = String(value);
    const output = control.parentElement.querySelector("output");
    if (output) output.textContent = control.value;
  }

  choose(tool) {
    this.tool = tool;
    for (const button of this.root.querySelectorAll("[data-tool]")) button.setAttribute("aria-pressed", String(button.dataset.tool === tool));
    this.find("hint").textContent = this.words.hints[tool];
  }

  nodeAt(x, y) {
    // The nearest corner of the triangle under a place of the canvas, and how far it is; null where there is no cloth.
    const found = this.stage.pick(x, y);
    if (!found) return null;
    if (found.mesh === this.pins) return { node: this.state.pinned[Math.floor(found.face / 8)], pin: true, ...found };
    if (found.mesh !== this.cloth) return { object: found.mesh, ...found };
    const corner = found.weights.indexOf(Math.max(...found.weights));
    return { node: this.cloth.faces[3 * found.face + corner], ...found };
  }

  grab(x, y) {
    if (this.tool === "turn" || !this.cloth) return null;
    const found = this.nodeAt(x, y);
    if (!found) return null;
    if (this.tool === "pin") {
      if (found.node === undefined) return null;
      this.send({ do: found.pin || this.state.pinned.includes(found.node) ? "unpin" : "pin", node: found.node });
      return { move() {}, end() {} };
    }
    if (this.tool === "move" && found.object && found.object.name !== "body") {
      const { name, shift } = found.object, start = [...shift];
      return { move: (...at) => this.send({ do: "move", name, offset: this.across(found.distance, [x, y], at).map((value, k) => value + start[k]) }), end() {} };
    }
    if (found.node === undefined || (this.tool === "move" && !found.pin)) return null;
    this.send({ do: "grip", node: found.node });
    this.held = found.node;
    return {
      move: (...at) => this.send({ do: "pull", offset: this.across(found.distance, [x, y], at) }),
      end: () => { this.send({ do: "release" }); this.held = null; },
    };
  }

  across(distance, from, to) {
    // How far a pointer has gone [m], in the plane of the screen at a distance.
    const ends = [from, to].map(([x, y]) => { const { eye, ray } = this.stage.ray(x, y); return { eye, ray }; });
    const { away } = this.stage.camera(), depth = -distance * dot3(ends[0].ray, away);
    const [a, b] = ends.map(({ eye, ray }) => { const t = depth / -dot3(ray, away); return eye.map((value, k) => value + t * ray[k]); });
    return b.map((value, k) => value - a[k]);
  }

  listen() {
    const { root, stage } = this;
    for (const button of root.querySelectorAll("[data-tool]")) button.addEventListener("click", () => this.choose(button.dataset.tool));
    for (const button of root.querySelectorAll("[data-do]")) button.addEventListener("click", () => this.press(button.dataset.do));
    for (const control of root.querySelectorAll("[data-set]")) control.addEventListener("input", () => this.changed(control));
    stage.canvas.addEventListener("keydown", (event) => {
      const act = { " ": "pause", s: "step", r: "restart" }[event.key];
      if (act) this.press(act);
      else if (event.key === "w") { this.set("wires", !stage.wires); this.changed(this.control("wires")); }
      else if (event.key === "p") {
        const found = this.nodeAt(stage.canvas.clientWidth / 2, stage.canvas.clientHeight / 2);
        if (found && found.node !== undefined) this.send({ do: this.state.pinned.includes(found.node) ? "unpin" : "pin", node: found.node });
      } else return;
      event.preventDefault();
    });
  }

  press(name) {
    if (name === "cut") this.send({ do: "cut", seconds: Number(this.control("cut_seconds").value) });
    else if (name === "record") {
      // A film ends by being saved.
      if (this.state.recording) this.send({ do: "save" });
      this.send({ do: "record", on: !this.state.recording });
    } else if (name === "pause") this.send({ do: "pause", on: this.state.running });
    else if (name === "picture") {
      this.stage.drawNow();
      Object.assign(document.createElement("a"), { href: this.stage.canvas.toDataURL("image/png"), download: "live.png" }).click();
    } else {
      this.send({ do: name });
      if (name === "stop") { this.ended = true; this.say(this.words.ended); }
    }
  }

  changed(control) {
    const name = control.dataset.set, value = control.type === "checkbox" ? control.checked : control.value;
    const output = control.parentElement.querySelector("output");
    if (output) output.textContent = value;
    if (name === "wires") this.stage.wires = value;
    else if (name === "texture") this.stage.checked = value;
    else if (name === "paint_object") { this.objectPaint = rgb(value); this.paintObjects(); }
    else if (name === "paint_back") this.stage.canvas.parentElement.style.background = value;
    else if (name === "colour") { this.send({ do: "show", values: value === "pressure" ? value : "" }); this.colour = value; this.find("scale").hidden = !value; if (!value) this.cloth.setValues(null); }
    else if (name === "paint") { this.painted = value; this.cloth.linear = this.paint().map(toLinear); }
    else if (name === "wind" || name === "gusts") this.send({ do: "wind", speed: Number(this.control("wind").value), gusts: Number(this.control("gusts").value) });
    else if (name === "fabric") this.send({ do: "fabric", name: value });
    else if (name === "gravity" || name === "friction") this.send({ do: name, value: Number(value) });
    else if (["floor", "self_contact", "ball_moves"].includes(name)) this.send({ do: name, on: value });
    else if (["cells", "side", "grain"].includes(name)) this.send({ do: "restart", [name]: Number(value) });
    else if (name === "pins" || name === "object") this.send({ do: "restart", [name]: value });
    this.stage.draw();
  }
}
