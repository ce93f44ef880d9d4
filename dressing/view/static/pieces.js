"use strict";
// Pattern pieces in 2-D, laid out side by side; what is under the pointer here or on the stage is shown in both.
class Pieces {
  constructor(canvas) {
    this.canvas = canvas;
    this.groups = [];
    this.lit = null;
    this.onHover = () => {};
    canvas.addEventListener("pointermove", (event) => this.hover(event));
    canvas.addEventListener("pointerleave", () => this.onHover(null));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(meshes) {
    // Each panel by itself: its faces, its outline and its bounds [m].
    this.groups = [];
    for (const mesh of meshes.filter((one) => one.uv && one.panels)) {
      const known = new Map();
      for (let face = 0; face < mesh.count / 3; face++) {
        const panel = mesh.panels[face];
        if (!known.has(panel)) known.set(panel, { mesh, panel, faces: [], low: [1e9, 1e9], high: [-1e9, -1e9] });
        const group = known.get(panel);
        group.faces.push(face);
        for (let q = 0; q < 3; q++) for (let k = 0; k < 2; k++) {
          const value = mesh.uv[2 * mesh.faces[3 * face + q] + k];
          group.low[k] = Math.min(group.low[k], value);
          group.high[k] = Math.max(group.high[k], value);
        }
      }
      this.groups.push(...known.values());
    }
    for (const group of this.groups) group.outline = Pieces.outline(group);
    this.draw();
  }

  static outline({ mesh, faces }) {
    // Edges that one face of the panel has.
    const edges = new Map();
    for (const face of faces) for (let q = 0; q < 3; q++) {
      const a = mesh.faces[3 * face + q], b = mesh.faces[3 * face + (q + 1) % 3], key = a < b ? `${a},${b}` : `${b},${a}`;
      if (edges.has(key)) edges.delete(key); else edges.set(key, [a, b]);
    }
    return [...edges.values()];
  }

  layout(width, height) {
    // Rows of pieces, at the largest scale at which they fit.
    const gap = 10, fits = (scale) => {
      let x = gap, y = gap, row = 0;
      for (const group of this.groups) {
        const w = (group.high[0] - group.low[0]) * scale, h = (group.high[1] - group.low[1]) * scale + 12;
        if (x + w + gap > width && x > gap) { x = gap; y += row + gap; row = 0; }
        if (x + w + gap > width) return false;
        group.at = [x, y];
        x += w + gap;
        row = Math.max(row, h);
      }
      return y + row + gap <= height;
    };
    let low = 1, high = 4000;
    for (let k = 0; k < 30; k++) { const middle = Math.sqrt(low * high); if (fits(middle)) low = middle; else high = middle; }
    fits(low);
    this.scale = low;
  }

  place(group, u, v) { return [group.at[0] + (u - group.low[0]) * this.scale, group.at[1] + (group.high[1] - v) * this.scale]; }

  draw() {
    const { canvas } = this, ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !this.groups.length) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    this.layout(width, height);
    for (const group of this.groups) {
      const { mesh, faces, outline } = group, lit = this.lit && this.lit.mesh === mesh && this.lit.panel === group.panel;
      const corner = (index) => this.place(group, mesh.uv[2 * index], mesh.uv[2 * index + 1]);
      const colour = mesh.colour.map((c) => Math.round(255 * c));
      pen.fillStyle = `rgba(${colour},${lit ? 0.75 : 0.4})`;
      pen.beginPath();
      for (const face of faces) {
        const [a, b, c] = [0, 1, 2].map((q) => corner(mesh.faces[3 * face + q]));
        pen.moveTo(...a); pen.lineTo(...b); pen.lineTo(...c);
      }
      pen.fill();
      pen.strokeStyle = "#23272e";
      pen.lineWidth = lit ? 2 : 1;
      pen.beginPath();
      for (const [a, b] of outline) { pen.moveTo(...corner(a)); pen.lineTo(...corner(b)); }
      pen.stroke();
      if (lit && this.lit.face !== undefined) {
        pen.fillStyle = "#f29a0d";
        pen.beginPath();
        [0, 1, 2].forEach((q) => pen[q ? "lineTo" : "moveTo"](...corner(mesh.faces[3 * this.lit.face + q])));
        pen.fill();
        const middle = [0, 1, 2].map((q) => corner(mesh.faces[3 * this.lit.face + q]));
        pen.beginPath();
        pen.arc(...[0, 1].map((k) => (middle[0][k] + middle[1][k] + middle[2][k]) / 3), 6, 0, 7);
        pen.strokeStyle = "#c0560a";
        pen.stroke();
      }
      pen.fillStyle = "#667085";
      pen.font = "11px system-ui, sans-serif";
      pen.fillText(mesh.panelNames?.[group.panel] ?? "", group.at[0], group.at[1] + (group.high[1] - group.low[1]) * this.scale + 11,
        (group.high[0] - group.low[0]) * this.scale);
    }
    canvas.dataset.pieces = String(this.groups.length);
  }

  hover(event) {
    const box = this.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    for (const group of this.groups) {
      const u = (x - group.at[0]) / this.scale + group.low[0], v = group.high[1] - (y - group.at[1]) / this.scale;
      if (u < group.low[0] || u > group.high[0] || v < group.low[1] || v > group.high[1]) continue;
      const { uv, faces: corners } = group.mesh;
      for (const face of group.faces) {
        const [a, b, c] = [0, 1, 2].map((q) => 2 * corners[3 * face + q]);
        const side = (p, q) => (uv[q] - uv[p]) * (v - uv[p + 1]) - (uv[q + 1] - uv[p + 1]) * (u - uv[p]);
        const s = side(a, b), t = side(b, c), w = side(c, a);
        if ((s >= 0 && t >= 0 && w >= 0) || (s <= 0 && t <= 0 && w <= 0)) return this.onHover({ mesh: group.mesh, panel: group.panel, face });
      }
    }
    return this.onHover(null);
  }

  light(what) { this.lit = what; this.draw(); }
}
