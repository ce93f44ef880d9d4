"use strict";
// The page of the lecture: two cloths, what they are made of, their curves, and the words beside them.
const RANGES = {
  stiffness: { min: 5, max: 5000, log: true, unit: "N/m", label: "k<sub>s</sub>" },
  damping: { min: 0, max: 1, step: 0.01, unit: "N s/m", label: "k<sub>d</sub>" },
  step: { min: 1e-4, max: 0.1, log: true, unit: "ms", scale: 1000, label: "h" },
  cells: { min: 2, max: 30, step: 1, unit: "" }, wind: { min: 0, max: 15, step: 0.5, unit: "m/s" },
  gusts: { min: 0, max: 0.8, step: 0.05, unit: "" }, gravity: { min: 0, max: 20, step: 0.1, unit: "m/s²" },
};
const CHOICES = {
  method: ["explicit", "symplectic", "implicit", "bdf2"], model: ["springs", "triangles"],
  springs: ["structural", "shear", "all"], pins: ["one edge", "corners"],
};
const SPRING_COLOURS = ["#23272e", "#3054a8", "#cc5a2b"];

class LecturePage {
  constructor(root, lessons) {
    Object.assign(this, { root, lessons, ended: false, frames: 0, running: true });
    this.words = LESSONS[document.documentElement.lang] || LESSONS.en;
    this.find = (name) => root.querySelector(`[data-view=${name}]`);
    for (const element of root.querySelectorAll("[data-word]")) element.textContent = this.words[element.dataset.word];
    for (const option of root.querySelectorAll("[data-weave=weave] option")) Object.assign(option, { value: option.textContent, textContent: this.words.choices[option.textContent] || option.textContent });
    this.panes = [0, 1].map((k) => this.pane(k));
    this.nav();
    for (const button of root.querySelectorAll("[data-do]")) button.addEventListener("click", () => this.press(button.dataset.do));
    for (const control of root.querySelectorAll("[data-weave]")) control.addEventListener("change", () => this.weave());
    document.addEventListener("keydown", (event) => this.key(event));
    this.connect();
  }

  pane(k) {
    const figure = this.root.querySelector(`[data-pane="${k}"]`), [canvas, over] = figure.querySelectorAll("canvas");
    const stage = new Stage(canvas, !Stage.drawnByProcessor());
    Object.assign(stage, { wires: true, tilt: 0.25, turn: 0.5 });
    stage.grab = (x, y) => this.grab(k, x, y);
    // Both are seen from the same side.
    const pane = { figure, stage, over, mesh: null };
    stage.onDraw = () => {
      const other = this.panes && this.panes[1 - k].stage;
      if (other && (other.turn !== stage.turn || other.tilt !== stage.tilt || other.distance !== stage.distance)) {
        Object.assign(other, { turn: stage.turn, tilt: stage.tilt, distance: stage.distance, middle: [...stage.middle] });
        other.draw();
      }
      this.drawSprings(pane);
    };
    return pane;
  }

  nav() {
    const nav = this.find("steps");
    this.find("turning").hidden = this.lessons.length < 2;
    if (this.lessons.length < 2) return;
    this.lessons.forEach((name, k) => {
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: `${k + 1} ${this.words.lessons[name].title}` });
      button.addEventListener("click", () => this.turn(k));
      nav.append(button);
    });
  }

  say(text) { this.find("nothing").textContent = text; this.find("nothing").hidden = !text; }

  connect() {
    const socket = (this.socket = new WebSocket(`ws://${location.host}${location.pathname}talk`));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.told(JSON.parse(data)) : this.frame(new Float32Array(data)));
    socket.onopen = () => this.say("");
    socket.onclose = () => { if (!this.ended) { this.say(this.words.lost); setTimeout(() => this.connect(), 1000); } };
  }

  send(wish) { if (this.socket.readyState === 1) this.socket.send(JSON.stringify(wish)); }

  told(message) {
    if (message.say) { this.say(message.say); clearTimeout(this.quiet); this.quiet = setTimeout(() => this.say(""), 6000); }
    if (message.scene) this.show(message.scene);
    if (message.state) this.numbers(message.state);
  }

  show(scene) {
    const fresh = !this.scene || this.scene.at !== scene.at;
    this.scene = scene;
    scene.panes.forEach((told, k) => {
      const pane = this.panes[k], { stage } = pane;
      stage.meshes.length = 0;
      pane.mesh = stage.add({ name: "cloth", faces: Uint32Array.from(told.faces), positions: new Float32Array(3 * told.count), node: Uint32Array.from({ length: told.count }, (_, i) => i), colour: k ? [0.80, 0.55, 0.42] : [0.50, 0.62, 0.80] });
      if (told.ball) stage.add({ name: "ball", kind: "body", colour: [0.8, 0.79, 0.76], faces: Uint32Array.from(told.ball.faces), positions: Float32Array.from(told.ball.positions) });
      pane.told = told;
      pane.version = told.version;
      pane.figure.querySelector("figcaption").textContent = this.words.caption(told.setup, scene.name, k);
      pane.figure.querySelector("canvas").setAttribute("aria-label", pane.figure.querySelector("figcaption").textContent);
    });
    if (fresh) {
      this.lesson();
      this.unframed = true;
      for (const curve of this.curves) curve.clear();
    }
    this.set(scene);
  }

  lesson() {
    // Words, controls and curves of a step.
    const { scene, words } = this, lesson = words.lessons[scene.name];
    this.find("text").innerHTML = `<h1>${lesson.title}</h1>${lesson.text}`;
    this.find("controls").replaceChildren(...scene.controls.map((name) => this.control(name, null)));
    this.panes.forEach(({ figure }, k) => figure.querySelector(".own").replaceChildren(...scene.own.map((name) => this.control(name, k))));
    this.curves = scene.curves.map((name) => (name === "energy" ? new Curves(words.energy, "J", false) : new Curves(words.error, "m", true)));
    this.find("graphs").replaceChildren(...this.curves.map((curve) => curve.canvas));
    this.find("weave").hidden = this.find("picture").hidden = scene.name !== "yarns";
    [...this.find("steps").children].forEach((button, k) => {
      if (k === scene.at) { button.setAttribute("aria-current", "step"); button.scrollIntoView({ block: "nearest", inline: "nearest" }); } else button.removeAttribute("aria-current");
    });
    this.root.querySelector(".panel").scrollTop = 0;
    this.root.dataset.lesson = scene.name;
  }

  control(name, pane) {
    const label = document.createElement("label"), range = RANGES[name];
    label.dataset.set = pane === null ? name : `${name}${pane}`;
    const title = document.createElement("span");
    title.innerHTML = `${this.words[name] || name}${range && range.label ? ` <i>${range.label}</i>` : ""}`;
    let input;
    if (range) {
      const output = document.createElement("output");
      input = Object.assign(document.createElement("input"), { type: "range", min: 0, max: 1000, step: 1 });
      if (!range.log) Object.assign(input, { min: range.min, max: range.max, step: range.step });
      label.append(title, output, input);
      input.addEventListener("input", () => { output.textContent = this.shown(name, this.valueOf(name, input)); });
    } else {
      input = document.createElement("select");
      for (const choice of CHOICES[name]) input.append(Object.assign(document.createElement("option"), { value: choice, textContent: this.words.choices[choice] || choice }));
      label.append(title, input);
    }
    input.addEventListener("change", () => this.send({ do: "set", name, value: this.valueOf(name, input), ...(pane === null ? {} : { pane }) }));
    return label;
  }

  valueOf(name, input) {
    const range = RANGES[name];
    if (!range) return input.value;
    return range.log ? range.min * (range.max / range.min) ** (input.value / 1000) : Number(input.value);
  }

  shown(name, value) { const { scale = 1, unit } = RANGES[name]; return `${Number((value * scale).toPrecision(3))} ${unit}`; }

  set(scene) {
    const put = (name, label, value) => {
      const input = label.querySelector("input, select"), range = RANGES[name];
      if (document.activeElement !== input || !range) input.value = range && range.log ? Math.round(1000 * Math.log(value / range.min) / Math.log(range.max / range.min)) : value;
      if (range) label.querySelector("output").textContent = this.shown(name, value);
    };
    for (const label of this.find("controls").children) put(label.dataset.set, label, scene.panes[0].setup[label.dataset.set]);
    this.panes.forEach(({ figure }, k) => {
      for (const label of figure.querySelector(".own").children) put(label.dataset.set.slice(0, -1), label, scene.panes[k].setup[label.dataset.set.slice(0, -1)]);
    });
    if (scene.name === "yarns") {
      this.find("picture").innerHTML = this.words.picture.reduce((text, [from, to]) => text.replaceAll(from, to), scene.picture);
      for (const control of this.root.querySelectorAll("[data-weave]")) {
        control.value = control.dataset.weave === "tex" ? parseFloat(scene.weave.warp.split(":")[1]) : scene.weave[control.dataset.weave];
        const output = control.parentElement.querySelector("output");
        if (output) output.textContent = control.value;
      }
    }
  }

  weave() {
    const value = (name) => this.root.querySelector(`[data-weave=${name}]`).value, yarn = `cotton:${value("tex")}tex`;
    this.send({ do: "weave", weave: value("weave"), ends_per_cm: Number(value("ends_per_cm")), picks_per_cm: Number(value("picks_per_cm")), warp: yarn, weft: yarn });
  }

  frame(data) {
    let at = 1;
    const time = data[0];
    if (this.scene) this.panes.forEach((pane, k) => {
      const [version, count, faces, kinetic, elastic, gravity, error] = data.subarray(at, at + 7);
      const positions = data.slice(at + 7, at + 7 + 3 * count), corners = data.subarray(at + 7 + 3 * count, at + 7 + 3 * count + faces);
      at += 7 + 3 * count + faces;
      if (faces && (version !== pane.version || pane.mesh.positions.length !== positions.length)) {
        pane.mesh.setShape(Uint32Array.from(corners), positions, Uint32Array.from({ length: count }, (_, i) => i));
        pane.version = version;
      } else if (positions.length === pane.mesh.positions.length) pane.mesh.move(positions);
      for (const [i, name] of this.scene.curves.entries()) this.curves[i].add(k, time, name === "energy" ? kinetic + elastic + gravity : error);
      if (this.unframed) pane.stage.frame();
      pane.stage.draw();
    });
    if (this.unframed && this.scene) { this.unframed = false; for (const { stage } of this.panes) { stage.middle = [0, -0.15, this.scene.panes[0].ball ? 0 : -0.25]; stage.distance *= 1.15; } this.root.dataset.ready = "yes"; }
    if (this.frames % 6 === 0 && this.curves) for (const curve of this.curves) curve.draw();
    requestAnimationFrame(() => { this.frames += 1; if (this.socket.readyState === 1) this.socket.send("drawn"); });
  }

  drawSprings(pane) {
    // Springs in the colour of their kind, over the cloth, while they are few.
    const { over, stage, told, mesh } = pane, ratio = window.devicePixelRatio || 1;
    const pen = over.getContext("2d"), size = [Math.round(over.clientWidth * ratio), Math.round(over.clientHeight * ratio)];
    if (over.width !== size[0] || over.height !== size[1]) [over.width, over.height] = size;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, over.clientWidth, over.clientHeight);
    if (!told || this.scene.name !== "springs" || told.kinds.length > 800) return;
    const places = Array.from({ length: told.count }, (_, i) => stage.project([...mesh.positions.slice(3 * i, 3 * i + 3)]));
    // A bending spring lies on two others: it is drawn as an arc beside them.
    for (let s = 0; s < told.kinds.length; s++) {
      const kind = told.kinds[s], a = places[told.pairs[2 * s]], b = places[told.pairs[2 * s + 1]];
      pen.strokeStyle = SPRING_COLOURS[kind];
      pen.globalAlpha = kind === 2 ? 0.45 : 0.9;
      pen.lineWidth = kind ? 1 : 1.6;
      pen.beginPath();
      pen.moveTo(...a);
      if (kind === 2) pen.quadraticCurveTo(0.5 * (a[0] + b[0]) + 0.12 * (b[1] - a[1]), 0.5 * (a[1] + b[1]) - 0.12 * (b[0] - a[0]), ...b);
      else pen.lineTo(...b);
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  numbers(state) {
    this.running = state.running;
    this.root.querySelector("[data-do=pause]").setAttribute("aria-pressed", String(!state.running));
    state.panes.forEach((one, k) => {
      const line = this.panes[k].figure.querySelector(".stage p");
      line.className = one.exploded === null ? "" : "exploded";
      line.textContent = this.words.numbers(one, state);
    });
  }

  grab(k, x, y) {
    const pane = this.panes[k], found = pane.stage.pick(x, y);
    if (!found || found.mesh !== pane.mesh) return null;
    const corner = found.weights.indexOf(Math.max(...found.weights));
    this.send({ do: "grip", pane: k, node: pane.mesh.faces[3 * found.face + corner] });
    return {
      move: (...at) => {
        const { right, up } = pane.stage.camera(), scale = 2 * found.distance * Math.tan(0.2) / pane.stage.canvas.clientHeight;
        this.send({ do: "pull", offset: right.map((value, i) => scale * ((at[0] - x) * value - (at[1] - y) * up[i])) });
      },
      end: () => this.send({ do: "release" }),
    };
  }

  turn(at) { if (at >= 0 && at < this.lessons.length) this.send({ do: "turn", at }); }

  key(event) {
    if (/^(INPUT|SELECT|BUTTON)$/.test(event.target.tagName) && event.key !== "PageUp" && event.key !== "PageDown") return;
    const act = { " ": "pause", s: "step", r: "restart", PageDown: "on", PageUp: "back" }[event.key];
    if (!act) return;
    this.press(act);
    event.preventDefault();
  }

  press(name) {
    if (name === "pause") this.send({ do: "pause", on: this.running });
    else if (name === "on" || name === "back") this.turn(this.scene.at + (name === "on" ? 1 : -1));
    else {
      if (name === "restart") for (const curve of this.curves) curve.clear();
      this.send({ do: name });
      if (name === "stop") { this.ended = true; this.say(this.words.ended); }
    }
  }
}
