// Where a stage is seen from: turned about a point, z upright, matrices column by column.
const Camera = (function () {
  'use strict';
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const l = Math.hypot(a[0], a[1], a[2]) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
  const FIELD = 28 * Math.PI / 180;

  function product(a, b) {
    const out = new Float32Array(16);
    for (let c = 0; c < 4; c++) {
      for (let r = 0; r < 4; r++) {
        for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
      }
    }
    return out;
  }

  class Camera {
    constructor(bounds) {
      this.corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [0, 1, 2].map((d) => bounds[k >> d & 1][d]));
      this.aspect = 1.5;
      this.center = [0, 1, 2].map((k) => (bounds[0][k] + bounds[1][k]) / 2);
      this.radius = Math.hypot.apply(null, sub(bounds[1], bounds[0])) / 2 || 1;
      this.view('iso');
    }
    view(name) {
      const turns = { iso: [-0.95, 0.5], x: [0, 0], y: [-Math.PI / 2, 0], z: [-Math.PI / 2, Math.PI / 2 - 1e-4] };
      this.azimuth = turns[name][0];
      this.elevation = turns[name][1];
      this.target = this.center.slice();
      // As near as all corners allow, with some room around.
      const a = this.axes(), tan = Math.tan(FIELD / 2), wide = tan * Math.max(1, this.aspect), high = tan * Math.max(1, 1 / this.aspect);
      this.distance = Math.max.apply(null, this.corners.map((corner) => {
        const x = sub(corner, this.target);
        return dot(x, a.back) + 1.12 * Math.max(Math.abs(dot(x, a.right)) / wide, Math.abs(dot(x, a.up)) / high);
      })) || 1;
    }
    axes() {
      const c = Math.cos(this.elevation);
      const back = [c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation)];
      const right = unit(cross([0, 0, 1], back));
      return { back: back, right: right, up: cross(back, right) };
    }
    eye() {
      const b = this.axes().back;
      return this.target.map((t, k) => t + this.distance * b[k]);
    }
    matrix(aspect) {
      const a = this.axes(), eye = this.eye();
      const look = new Float32Array([
        a.right[0], a.up[0], a.back[0], 0, a.right[1], a.up[1], a.back[1], 0, a.right[2], a.up[2], a.back[2], 0,
        -dot(a.right, eye), -dot(a.up, eye), -dot(a.back, eye), 1]);
      const off = Math.hypot.apply(null, sub(this.target, this.center));
      const far = this.distance + 1.5 * this.radius + off;
      const near = Math.max(this.distance - 1.5 * this.radius - off, far / 2000);
      // The smaller side of the picture has the whole field of view.
      const f = 1 / Math.tan(FIELD / 2), x = aspect > 1 ? f / aspect : f, y = aspect > 1 ? f : f * aspect;
      const lens = new Float32Array([
        x, 0, 0, 0, 0, y, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]);
      return product(lens, look);
    }
    turn(dx, dy) {
      this.azimuth -= dx * 0.008;
      this.elevation = Math.max(-1.57, Math.min(1.57, this.elevation + dy * 0.008));
    }
    pan(dx, dy, height) {
      const a = this.axes(), s = 2 * this.distance * Math.tan(FIELD / 2) / height;
      this.target = this.target.map((t, k) => t + s * (dy * a.up[k] - dx * a.right[k]));
    }
    zoom(factor) {
      this.distance = Math.max(0.02 * this.radius, Math.min(60 * this.radius, this.distance * factor));
    }
    take(other) {
      ['azimuth', 'elevation', 'distance'].forEach((k) => { this[k] = other[k]; });
      this.target = other.target.slice();
    }
  }
  return Camera;
}());
