// A stage with its controls, scale and marks.
const Viewer = (function () {
  'use strict';
  const make = (tag, attributes, parent, text) => {
    const e = document.createElement(tag);
    Object.entries(attributes || {}).forEach(([k, v]) => e.setAttribute(k, v));
    if (text !== undefined) e.textContent = text;
    if (parent) parent.appendChild(e);
    return e;
  };
  // A number in at most four digits.
  const short = (v) => {
    if (v === 0 || !isFinite(v)) return String(v);
    const a = Math.abs(v);
    return a >= 1e5 || a < 1e-3 ? v.toExponential(2) : String(Number(v.toPrecision(4)));
  };

  class Viewer {
    // `all` are the viewers of a page, which are turned and played together.
    constructor(parent, run, all) {
      this.run = run;
      this.all = all;
      const frame = make('div', { class: 'stage' }, parent);
      const canvas = make('canvas', { tabindex: '0', role: 'img', 'aria-label': 'Deformed bodies and tools of ' + run.name }, frame);
      this.stage = new Stage(canvas, run.shapes);
      this.marks = make('div', { class: 'marks' }, frame);
      this.scale = make('div', { class: 'scale' }, frame);
      this.controls(make('div', { class: 'controls' }, parent));
      if (run.shapes.note) make('p', { class: 'note' }, parent, run.shapes.note);
      this.pointers(canvas);
      this.stage.drawn = () => this.place();
      this.labels = run.marks.map((mark) => {
        const label = make('button', { class: 'mark', title: mark.text }, this.marks, String(mark.number));
        label.addEventListener('click', () => document.getElementById('w' + run.index + '-' + mark.number).scrollIntoView({ block: 'center' }));
        return { mark: mark, label: label };
      });
    }

    async open() {
      await this.stage.open();
      await this.goto(this.run.shapes.steps.length - 1);
      new ResizeObserver(() => this.stage.draw()).observe(this.stage.canvas);
    }

    controls(parent) {
      const stage = this.stage, o = stage.options, steps = this.run.shapes.steps;
      const again = () => this.goto(stage.current), group = () => make('div', { class: 'group' }, parent);
      const choose = (into, label, entries, value, change) => {
        const select = make('select', {}, make('label', {}, into, label + ' '));
        entries.forEach((e) => make('option', { value: e[0] }, select, e[1]));
        select.value = value;
        select.addEventListener('change', () => change(select.value));
        return select;
      };
      const time = group();
      time.classList.add('time');
      this.play = make('button', { type: 'button', class: 'play', 'aria-label': 'Play' }, time, '▶');
      this.play.addEventListener('click', () => this.toggle());
      this.slider = make('input', { type: 'range', min: 0, max: steps.length - 1, step: 1, 'aria-label': 'Step' }, time);
      this.slider.addEventListener('input', () => this.together(Number(this.slider.value)));
      this.clock = make('span', { class: 'clock' }, time);
      const fields = ['displacement'];
      this.run.shapes.parts.forEach((p) => p.fields.forEach((f) => { if (!fields.includes(f)) fields.push(f); }));
      o.field = fields.includes('von_mises') ? 'von_mises' : 'displacement';
      const look = group();
      choose(look, 'Field', [['', 'none']].concat(fields.map((f) => [f, f.replace(/_/g, ' ')])), o.field, (v) => { o.field = v; again(); });
      choose(look, 'Scale of', [['all', 'all steps'], ['one', 'this step']], 'all', (v) => { o.every = v === 'all'; again(); });
      choose(look, 'Deformation ×', [1, 2, 5, 10, 50, 100, 0].map((f) => [f, String(f)]), '1', (v) => { o.factor = Number(v); again(); });
      const shape = group();
      choose(shape, 'Tools', [[1, 'solid'], [0.4, 'see-through'], [0, 'hidden']], '0.4', (v) => { o.tools = Number(v); stage.draw(); });
      choose(shape, 'Cut', [['', 'none'], ['x', 'x'], ['y', 'y'], ['z', 'z']], '', (v) => {
        o.cut = v;
        place.hidden = flip.hidden = v === '';
        stage.draw();
      });
      const place = make('input', { type: 'range', min: 0, max: 1, step: 0.005, value: 0.5, 'aria-label': 'Place of the cut' }, shape);
      place.addEventListener('input', () => { o.at = Number(place.value); stage.draw(); });
      const flip = make('button', { type: 'button' }, shape, 'other side');
      flip.addEventListener('click', () => { o.flip = !o.flip; stage.draw(); });
      place.hidden = flip.hidden = true;
      const view = group(), lines = make('input', { type: 'checkbox' }, make('label', { class: 'check' }, view));
      lines.checked = true;
      lines.parentNode.append(' Mesh');
      lines.addEventListener('change', () => { o.lines = lines.checked; stage.draw(); });
      [['iso', 'Reset'], ['x', 'x'], ['y', 'y'], ['z', 'z']].forEach((v) => {
        make('button', { type: 'button', title: 'View along ' + v[1] }, view, v[1])
          .addEventListener('click', () => { stage.camera.view(v[0]); this.moved(); });
      });
    }

    toggle() {
      if (this.timer) {
        clearInterval(this.timer);
        this.timer = null;
      } else {
        const n = this.run.shapes.steps.length, wait = Math.max(60, Math.min(400, 4000 / n));
        // A run of one step has nothing to play.
        this.timer = n > 1 ? setInterval(() => this.together((this.stage.current + 1) % n), wait) : null;
      }
      this.play.textContent = this.timer ? '❚❚' : '▶';
    }

    // Goes to a step; other runs go to their step nearest in time.
    together(k) {
      const time = this.run.shapes.steps[k].time;
      this.all.forEach((viewer) => {
        const steps = viewer.run.shapes.steps, far = (i) => Math.abs(steps[i].time - time);
        viewer.goto(viewer === this ? k : steps.reduce((best, _, i) => far(i) < far(best) ? i : best, 0));
      });
    }

    async goto(k) {
      await this.stage.show(k);
      const step = this.run.shapes.steps[k], [low, high] = this.stage.shown;
      this.slider.value = k;
      this.clock.textContent = 'step ' + step.step + ', time ' + short(step.time);
      this.scale.replaceChildren();
      this.scale.hidden = this.stage.options.field === '';
      make('div', { class: 'name' }, this.scale, this.stage.options.field.replace(/_/g, ' '));
      make('div', { class: 'bar', style: 'background:' + Stage.css }, this.scale);
      const ticks = make('div', { class: 'ticks' }, this.scale);
      [0, 0.5, 1].forEach((t) => make('span', {}, ticks, short(low + t * (high - low))));
    }

    place() {
      this.labels.forEach((l) => {
        const at = this.stage.project(l.mark.at);
        l.label.hidden = !at || at[0] < 0 || at[0] > 1 || at[1] < 0 || at[1] > 1;
        if (at) { l.label.style.left = 100 * at[0] + '%'; l.label.style.top = 100 * at[1] + '%'; }
      });
    }

    moved() {
      this.all.forEach((viewer) => {
        if (viewer !== this) viewer.stage.camera.take(this.stage.camera);
        viewer.stage.draw();
      });
    }

    pointers(canvas) {
      const down = new Map(), camera = this.stage.camera;
      canvas.addEventListener('pointerdown', (e) => {
        canvas.setPointerCapture(e.pointerId);
        down.set(e.pointerId, [e.clientX, e.clientY]);
      });
      ['pointerup', 'pointercancel'].forEach((name) => canvas.addEventListener(name, (e) => down.delete(e.pointerId)));
      canvas.addEventListener('pointermove', (e) => {
        const from = down.get(e.pointerId);
        if (!from) return;
        const dx = e.clientX - from[0], dy = e.clientY - from[1];
        if (down.size === 2) {
          const other = Array.from(down).find(([id]) => id !== e.pointerId)[1];
          const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
          camera.zoom(far(from) / far([e.clientX, e.clientY]));
          camera.pan(dx / 2, dy / 2, canvas.clientHeight);
        } else if (e.shiftKey || e.buttons & 6) {
          camera.pan(dx, dy, canvas.clientHeight);
        } else {
          camera.turn(dx, dy);
        }
        down.set(e.pointerId, [e.clientX, e.clientY]);
        this.moved();
      });
      canvas.addEventListener('wheel', (e) => {
        // A page is scrolled over a stage that is not in use.
        if (document.activeElement !== canvas && !e.ctrlKey) return;
        e.preventDefault();
        camera.zoom(Math.exp(0.0012 * e.deltaY));
        this.moved();
      }, { passive: false });
      canvas.addEventListener('contextmenu', (e) => e.preventDefault());
      canvas.addEventListener('dblclick', () => { camera.view('iso'); this.moved(); });
      canvas.addEventListener('keydown', (e) => {
        const turn = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] }[e.key];
        if (turn) camera.turn(turn[0], turn[1]);
        else if (e.key === '+' || e.key === '-') camera.zoom(e.key === '+' ? 0.85 : 1.18);
        else if (e.key === ' ') this.toggle();
        else return;
        e.preventDefault();
        this.moved();
      });
    }
  }
  Viewer.make = make;
  Viewer.short = short;
  return Viewer;
}());
