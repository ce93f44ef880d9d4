"use strict";
// Curves that grow as cloth moves: energies, and distances to a fine solution.
const CURVE_COLOURS = ["#3054a8", "#cc5a2b"];

class Curves {
  // `unit` is written at the top; `log`: powers of ten upwards.
  constructor(title, unit, log) {
    Object.assign(this, { title, unit, log, lines: [[], []], longest: 600 });
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", title);
  }

  clear() { this.lines = [[], []]; this.draw(); }

  add(pane, time, value) {
    const line = this.lines[pane];
    if (line.length && time < line[line.length - 1][0]) line.length = 0;
    line.push([time, value]);
    if (line.length > this.longest) line.shift();
  }

  draw() {
    const { canvas } = this, ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    if (!wide) return;
    if (canvas.width !== Math.round(wide * ratio)) Object.assign(canvas, { width: Math.round(wide * ratio), height: Math.round(high * ratio) });
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    const value = (v) => (this.log ? Math.log10(Math.max(v, 1e-7)) : v);
    let points = this.lines.map((line) => line.filter((p) => Number.isFinite(p[1])));
    if (!this.log && points[0].length && points[1].length) {
      // What explodes leaves the picture, and the other stays in it.
      const cap = 3 * Math.min(...points.map((line) => Math.max(...line.map((p) => Math.abs(p[1])))));
      if (cap > 1e-3) points = points.map((line) => line.map(([t, v]) => [t, Math.max(-cap, Math.min(cap, v))]));
    }
    const all = points.flat();
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = "#667085";
    pen.fillText(`${this.title} [${this.unit}]`, 10, 16);
    if (!all.length) return;
    const times = all.map((p) => p[0]), values = all.map((p) => value(p[1]));
    const from = Math.min(...times), to = Math.max(...times, from + 1);
    let low = Math.min(...values), top = Math.max(...values);
    if (top - low < 1e-9) { low -= 0.5; top += 0.5; }
    const x = (t) => 58 + (wide - 70) * (t - from) / (to - from), y = (v) => high - 20 - (high - 48) * (value(v) - low) / (top - low);
    const shown = (v) => (this.log ? 10 ** v : v);
    const number = (v) => (Math.abs(v) >= 1e4 || (v !== 0 && Math.abs(v) < 1e-2) ? v.toExponential(0) : String(Number(v.toPrecision(2))));
    pen.fillText(number(shown(top)), 10, y(shown(top)) + 10);
    pen.fillText(number(shown(low)), 10, y(shown(low)));
    pen.fillText(`${to.toFixed(1)} s`, wide - 40, high - 4);
    pen.strokeStyle = "#dcdfe4";
    pen.strokeRect(58, 24, wide - 70, high - 44);
    points.forEach((line, k) => {
      pen.strokeStyle = CURVE_COLOURS[k];
      pen.lineWidth = 1.8;
      pen.setLineDash(k ? [5, 3] : []);
      pen.beginPath();
      line.forEach(([t, v], i) => (i ? pen.lineTo(x(t), y(v)) : pen.moveTo(x(t), y(v))));
      pen.stroke();
    });
    pen.setLineDash([]);
  }
}
