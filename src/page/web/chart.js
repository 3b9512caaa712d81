// Curves over a common axis, with the values under the pointer.
const Chart = (function () {
  'use strict';
  const NAMESPACE = 'http://www.w3.org/2000/svg';
  const draw = (tag, attributes, parent, text) => {
    const e = document.createElementNS(NAMESPACE, tag);
    Object.entries(attributes).forEach(([k, v]) => e.setAttribute(k, v));
    if (text !== undefined) e.textContent = text;
    parent.appendChild(e);
    return e;
  };
  const LEFT = 62, RIGHT = 12, TOP = 10, BOTTOM = 40, HEIGHT = 280;

  // Round numbers from `low` to `high`.
  function ticks(low, high, most) {
    const rough = (high - low) / most, power = Math.pow(10, Math.floor(Math.log10(rough)));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
    const out = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(k * step);
    return out;
  }
  function tick(v, step) {
    const a = Math.abs(v);
    if (a < 1e-9 * step) return '0';
    if (a >= 1e5 || step < 1e-4) return v.toExponential(Math.max(0, Math.min(3, Math.floor(Math.log10(a)) - Math.floor(Math.log10(step)))));
    return v.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  }

  class Chart {
    // `spec`: title, x (its name), series of {name, x, y, dash}.
    constructor(parent, spec) {
      this.spec = spec;
      const figure = Viewer.make('figure', {}, parent);
      this.title = Viewer.make('figcaption', { class: 'title' }, figure, spec.title);
      this.body = Viewer.make('div', { class: 'plot' }, figure);
      this.legend = Viewer.make('div', { class: 'legend' }, figure);
      this.value = Viewer.make('div', { class: 'value' }, figure);
      new ResizeObserver(() => this.paint()).observe(this.body);
      this.body.addEventListener('pointermove', (e) => this.hover(e));
      this.body.addEventListener('pointerleave', () => { this.value.textContent = ''; this.cursor.setAttribute('visibility', 'hidden'); });
      this.set(spec);
    }
    set(spec) {
      this.spec = spec;
      this.title.textContent = spec.title;
      this.legend.replaceChildren();
      spec.series.forEach((s, k) => {
        const item = Viewer.make('span', { class: 'c' + k % 8 }, this.legend);
        const key = draw('svg', { width: 22, height: 8 }, item);
        draw('line', { x1: 0, x2: 22, y1: 4, y2: 4, class: 'l' + (s.dash ? ' dash' : '') }, key);
        item.append(' ' + s.name);
      });
      this.paint();
    }
    span(values) {
      let low = Infinity, high = -Infinity;
      values.forEach((v) => { if (v !== null && isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); } });
      if (low > high) return [0, 1];
      const pad = high > low ? 0.04 * (high - low) : Math.abs(high) * 0.1 || 1;
      return [low - pad, high + pad];
    }
    paint() {
      const width = this.body.clientWidth;
      if (!width) return;
      this.body.replaceChildren();
      const svg = draw('svg', { width: width, height: HEIGHT, role: 'img', 'aria-label': this.spec.title }, this.body);
      const all = (axis) => [].concat.apply([], this.spec.series.map((s) => s[axis]));
      const [x0, x1] = this.span(all('x')), [y0, y1] = this.span(all('y'));
      const px = (x) => LEFT + (x - x0) / (x1 - x0) * (width - LEFT - RIGHT);
      const py = (y) => HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM);
      const xs = ticks(x0, x1, Math.max(2, width / 90)), ys = ticks(y0, y1, 5);
      xs.forEach((x) => {
        draw('line', { x1: px(x), x2: px(x), y1: TOP, y2: HEIGHT - BOTTOM, class: 'grid' }, svg);
        draw('text', { x: px(x), y: HEIGHT - BOTTOM + 16, class: 'soft mid' }, svg, tick(x, xs[1] - xs[0] || 1));
      });
      ys.forEach((y) => {
        draw('line', { x1: LEFT, x2: width - RIGHT, y1: py(y), y2: py(y), class: 'grid' }, svg);
        draw('text', { x: LEFT - 6, y: py(y) + 4, class: 'soft end' }, svg, tick(y, ys[1] - ys[0] || 1));
      });
      draw('text', { x: (LEFT + width - RIGHT) / 2, y: HEIGHT - 6, class: 'mid' }, svg, this.spec.x);
      this.spec.series.forEach((s, k) => {
        let path = '', pen = 'M', points = 0;
        s.y.forEach((y, i) => {
          if (y === null || s.x[i] === null) { pen = 'M'; return; }
          path += pen + px(s.x[i]).toFixed(1) + ' ' + py(y).toFixed(1);
          pen = 'L';
          points++;
        });
        const group = draw('g', { class: 'c' + k % 8 }, svg);
        draw('path', { d: path, class: 'l' + (s.dash ? ' dash' : '') }, group);
        // Few points are shown one by one; a curve under others still shows at its own ones.
        const every = Math.max(1, Math.ceil(points / 40)), start = k % every;
        s.y.forEach((y, i) => {
          if (y !== null && s.x[i] !== null && i % every === start) draw('circle', { cx: px(s.x[i]), cy: py(y), r: 3.2 - 0.25 * Math.min(k, 6), class: 'm' }, group);
        });
      });
      this.cursor = draw('line', { y1: TOP, y2: HEIGHT - BOTTOM, class: 'ref', visibility: 'hidden' }, svg);
      this.inverse = (p) => x0 + (p - LEFT) / (width - LEFT - RIGHT) * (x1 - x0);
      this.px = px;
    }
    hover(e) {
      const at = this.inverse(e.clientX - this.body.getBoundingClientRect().left);
      const nearest = this.spec.series.map((s) => s.x.reduce((best, x, i) =>
        x !== null && s.y[i] !== null && (best < 0 || Math.abs(x - at) < Math.abs(s.x[best] - at)) ? i : best, -1));
      const first = nearest.findIndex((i) => i >= 0);
      if (first < 0) return;
      const x = this.px(this.spec.series[first].x[nearest[first]]);
      ['x1', 'x2'].forEach((k) => this.cursor.setAttribute(k, x));
      this.cursor.setAttribute('visibility', 'visible');
      this.value.textContent = this.spec.x + ' ' + Viewer.short(this.spec.series[first].x[nearest[first]]) + ': ' +
        this.spec.series.map((s, k) => nearest[k] < 0 ? '' : s.name + ' ' + Viewer.short(s.y[nearest[k]])).filter(Boolean).join(', ');
    }
  }
  return Chart;
}());
