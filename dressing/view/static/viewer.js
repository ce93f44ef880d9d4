"use strict";
// The viewer of results: what is shown, colours, film, measuring, pieces, picture. One for pages of their own and for
// the gallery of a batch.
const PLAIN = "";
const KINDS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array };

async function unpacked(text) {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

class Viewer {
  constructor(root) {
    this.root = root;
    this.find = (name) => root.querySelector(`[data-view=${name}]`);
    this.stage = new Stage(this.find("canvas"));
    this.pieces = new Pieces(this.find("pieces"));
    Object.assign(this, { data: null, film: null, frameShown: 0, playing: false, marks: [], measuring: false, field: PLAIN });
    this.stage.onDraw = () => this.drawMarks();
    this.pieces.onHover = (what) => this.light(what);
    this.controls();
  }

  say(text) {
    this.find("nothing").textContent = text;
    this.find("nothing").hidden = !text;
  }

  async show(data, text) {
    // Data as `dressing.view` packs them: a header, and its numbers as text.
    if (!this.stage.gl) return this.say("This browser has no WebGL 2; open dressed.glb in another viewer instead.");
    if (typeof DecompressionStream === "undefined") return this.say("This browser is too old to unpack the view; open dressed.glb in another viewer instead.");
    const buffer = await unpacked(text);
    const numbers = (ref) => (ref ? new KINDS[ref[0]](buffer, ref[1], ref[2]) : null);
    this.data = data;
    for (const part of data.parts) {
      const options = { name: part.name, kind: part.kind, colour: part.colour, panelNames: part.panelNames };
      const first = this.unpack(part, numbers);
      const mesh = this.stage.add({ ...options, ...first.shapes[0], positions: first.frames[0].positions });
      mesh.film = first;
      mesh.fields = first.frames[0].fields;
    }
    this.film = Math.max(...this.stage.meshes.map((mesh) => mesh.film.frames.length)) > 1 ? data.fps : null;
    this.find("film").hidden = !this.film;
    if (this.film) this.find("time").max = String(Math.max(...this.stage.meshes.map((mesh) => mesh.film.frames.length)) - 1);
    this.stage.frame();
    this.fillControls();
    this.pieces.show(this.garments());
    this.find("flat").hidden = !this.pieces.groups.length;
    this.stage.draw();
    this.root.dataset.ready = "yes";
  }

  unpack(part, numbers) {
    // Shapes as the page keeps them: `shapes` are topologies, `frames` places of vertices in one of them [m].
    const shapes = part.shapes.map((shape) => {
      const raw = numbers(shape.uv), uv = raw && Float32Array.from(raw, (value) => 1e-4 * value);
      return { faces: numbers(shape.faces), uv, panels: numbers(shape.panels) };
    });
    let before = null;
    const frames = part.frames.map((frame) => {
      const raw = numbers(frame.positions), count = raw.length / 2, steps = new Uint16Array(count);
      for (let k = 0; k < count; k++) steps[k] = raw[k] + 256 * raw[count + k] + (frame.follows ? before[k] : 0);
      before = steps;
      const positions = new Float32Array(count);
      for (let k = 0; k < count; k++) positions[k] = part.low[k % 3] + part.size[k % 3] * steps[k] / 65535;
      return { shape: frame.shape, positions, fields: frame.fields.map((field) => ({ ...field, data: numbers(field.data) })) };
    });
    return { shapes, frames };
  }

  garments() { return this.stage.meshes.filter((mesh) => mesh.kind !== "body"); }

  goTo(index) {
    for (const mesh of this.stage.meshes) {
      const { frames, shapes } = mesh.film, frame = frames[Math.min(index, frames.length - 1)];
      if (mesh.shapeNow !== frame.shape && frames.length > 1) {
        Object.assign(mesh, { uv: shapes[frame.shape].uv, panels: shapes[frame.shape].panels });
        mesh.setShape(shapes[frame.shape].faces, frame.positions);
        mesh.shapeNow = frame.shape;
        if (mesh.kind !== "body") this.piecesStale = true;
      } else mesh.move(frame.positions);
      mesh.fields = frame.fields;
    }
    this.frameShown = index;
    this.colour();
    this.find("time").value = String(index);
    this.find("clock").textContent = `${(index / this.film).toFixed(2)} s`;
    if (!this.playing) this.freshPieces();
    this.stage.draw();
  }

  freshPieces() {
    if (this.piecesStale) this.pieces.show(this.garments());
    this.piecesStale = false;
  }

  play(on) {
    this.playing = on;
    this.find("play").textContent = on ? "Pause" : "Play";
    if (!on) return this.freshPieces();
    const started = performance.now() - 1000 * this.frameShown / this.film, last = Number(this.find("time").max);
    const next = () => {
      if (!this.playing) return;
      const index = Math.floor((performance.now() - started) / 1000 * this.film) % (last + 1);
      if (index !== this.frameShown) this.goTo(index);
      requestAnimationFrame(next);
    };
    next();
  }

  colour() {
    // By the chosen field, where a part has it, between the limits that all parts and frames share.
    let range = null;
    for (const mesh of this.stage.meshes) {
      const field = (mesh.fields || []).find((one) => one.name === this.field);
      mesh.field = field || null;
      if (!field) mesh.setValues(null);
      else {
        const span = Math.max(field.high - field.low, 1e-12), [bottom, top] = field.range, scaled = new Float32Array(field.data.length);
        for (let k = 0; k < scaled.length; k++) scaled[k] = (field.low + span * field.data[k] / 65535 - bottom) / Math.max(top - bottom, 1e-12);
        mesh.setValues(scaled, field.perFace);
        range = [bottom, top, field.unit];
      }
    }
    this.find("scale").hidden = !range;
    if (range) this.find("scale").innerHTML = `<i></i><span>${range[0].toPrecision(3)}</span><span>${range[1].toPrecision(3)} ${range[2]}</span>`;
  }

  light(what) {
    // The same place of the cloth in 3-D and in its pattern.
    Object.assign(this.stage, { litMesh: what && what.mesh, litPiece: what ? what.panel : -1, litFace: what ? what.face : -1 });
    this.pieces.light(what);
    this.find("under").textContent = what ? this.facts(what) : "";
    this.stage.draw();
  }

  facts({ mesh, panel, face }) {
    const words = [mesh.name];
    if (mesh.panelNames?.[panel]) words.push(mesh.panelNames[panel]);
    if (mesh.field) {
      const { data, low, high, perFace, name, unit } = mesh.field;
      const value = (k) => low + (high - low) * data[k] / 65535;
      const now = perFace ? value(face) : [0, 1, 2].reduce((sum, q) => sum + value(mesh.faces[3 * face + q]) / 3, 0);
      words.push(`${name} ${now.toPrecision(3)} ${unit}`);
    }
    return words.join(", ");
  }

  controls() {
    const { stage } = this, canvas = stage.canvas;
    this.find("wires").addEventListener("input", (event) => { stage.wires = event.target.checked; stage.draw(); });
    this.find("colour").addEventListener("input", (event) => { this.field = event.target.value; this.colour(); stage.draw(); });
    this.find("measure").addEventListener("click", () => this.measure(!this.measuring));
    this.find("picture").addEventListener("click", () => this.picture());
    this.find("play").addEventListener("click", () => this.play(!this.playing));
    this.find("time").addEventListener("input", (event) => { this.play(false); this.goTo(Number(event.target.value)); });
    for (const button of this.root.querySelectorAll("[data-turn]")) button.addEventListener("click", () => {
      Object.assign(stage, { turn: Number(button.dataset.turn), tilt: 0.05 });
      stage.frame();
      stage.draw();
    });
    let moved = 0;
    canvas.addEventListener("pointerdown", () => { moved = 0; });
    canvas.addEventListener("pointermove", (event) => {
      moved += Math.abs(event.movementX) + Math.abs(event.movementY);
      if (event.buttons || this.playing) return;
      const found = this.stage.pick(event.offsetX, event.offsetY);
      this.light(found && found.mesh.kind !== "body" ? { mesh: found.mesh, face: found.face, panel: found.mesh.panels ? found.mesh.panels[found.face] : -1 } : null);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (this.measuring && moved < 8) this.mark(this.stage.pick(event.offsetX, event.offsetY));
    });
    canvas.addEventListener("keydown", (event) => {
      if (event.key === " " && this.film) this.play(!this.playing);
      else if (event.key === "m") this.measure(!this.measuring);
      else if (event.key === "Enter" && this.measuring) this.mark(this.stage.pick(canvas.clientWidth / 2, canvas.clientHeight / 2));
      else if (event.key === "Escape") this.measure(false);
      else if (event.key === "w") this.find("wires").click();
      else if ((event.key === "," || event.key === ".") && this.film) {
        const last = Number(this.find("time").max);
        this.goTo(Math.max(0, Math.min(last, this.frameShown + (event.key === "." ? 1 : -1))));
      } else return;
      event.preventDefault();
    });
  }

  fillControls() {
    const parts = this.find("parts"), colours = this.find("colour"), names = new Set();
    parts.replaceChildren(...this.stage.meshes.map((mesh) => {
      const label = document.createElement("label"), box = document.createElement("input");
      Object.assign(box, { type: "checkbox", checked: true, id: mesh.kind === "body" ? "body" : `part-${mesh.name}` });
      box.addEventListener("input", () => { mesh.shown = box.checked; this.stage.draw(); });
      label.append(box, ` ${mesh.name}`);
      for (const frame of mesh.film.frames) for (const field of frame.fields) names.add(field.name);
      return label;
    }));
    colours.replaceChildren(new Option("as they are", PLAIN), ...[...names].map((name) => new Option(name, name)));
    colours.parentElement.hidden = !names.size;
    const list = this.find("facts");
    list.replaceChildren(...(this.data.facts || []).flatMap(([name, value]) => [
      Object.assign(document.createElement("dt"), { textContent: name }), Object.assign(document.createElement("dd"), { textContent: value })]));
  }

  measure(on) {
    this.measuring = on;
    this.marks = on ? this.marks : [];
    this.find("measure").setAttribute("aria-pressed", String(on));
    this.find("measured").textContent = on ? "Click two points, or turn and press Enter for the middle." : "";
    this.stage.draw();
  }

  mark(found) {
    // Marks stick to the cloth: they move with the film.
    if (!found) return;
    if (this.marks.length === 2) this.marks = [];
    this.marks.push(found);
    this.stage.draw();
  }

  placeOf({ mesh, face, weights }) {
    return [0, 1, 2].map((k) => [0, 1, 2].reduce((sum, q) => sum + weights[q] * mesh.positions[3 * mesh.faces[3 * face + q] + k], 0));
  }

  drawMarks() {
    const over = this.find("marks"), places = this.marks.map((mark) => this.placeOf(mark));
    const at = places.map((place) => this.stage.project(place));
    let drawing = at.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="4"/>`).join("");
    if (at.length === 2) {
      const length = Math.hypot(...places[0].map((value, k) => value - places[1][k]));
      drawing += `<line x1="${at[0][0]}" y1="${at[0][1]}" x2="${at[1][0]}" y2="${at[1][1]}"/>`;
      this.find("measured").textContent = `${(100 * length).toFixed(1)} cm in a straight line`;
    }
    over.innerHTML = drawing;
  }

  picture() {
    this.stage.drawNow();
    this.stage.canvas.toBlob((blob) => {
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: `${this.data.title || "result"}.png` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  }
}
