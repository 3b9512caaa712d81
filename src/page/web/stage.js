// The parts of a run drawn at a step.
const Stage = (function () {
  'use strict';
  // Colours of a field from its smallest to its largest value (viridis, of matplotlib).
  const STOPS = [
    [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
    [170, 220, 50], [253, 231, 37]];
  const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const NONE = 255;

  function colour(t) {
    const x = Math.min(1, Math.max(0, t)) * (STOPS.length - 1), i = Math.min(STOPS.length - 2, Math.floor(x));
    return [0, 1, 2].map((k) => Math.round(STOPS[i][k] + (x - i) * (STOPS[i + 1][k] - STOPS[i][k])));
  }

  function rgb(name) {
    const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
  }

  class Stage {
    constructor(canvas, shapes) {
      const gl = canvas.getContext('webgl2', { alpha: false, antialias: true, preserveDrawingBuffer: true });
      if (!gl) throw new Error('this browser has no WebGL 2');
      this.gl = gl;
      this.canvas = canvas;
      this.shapes = shapes;
      this.camera = new Camera(shapes.bounds);
      this.camera.aspect = canvas.clientWidth / canvas.clientHeight || 1.5;
      this.camera.view('iso');
      this.options = { field: '', every: true, factor: 1, cut: '', at: 0.5, flip: false, lines: true, tools: 0.4 };
      this.parts = [];
      this.cache = new Map();
      this.current = -1;
      this.program = this.link();
      this.colours = this.palette();
    }

    link() {
      const gl = this.gl, program = gl.createProgram();
      [['faces-vert', gl.VERTEX_SHADER], ['faces-frag', gl.FRAGMENT_SHADER]].forEach((s) => {
        const shader = gl.createShader(s[1]);
        gl.shaderSource(shader, document.getElementById(s[0]).textContent.trim());
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
      });
      ['position', 'normal', 'value'].forEach((name, k) => gl.bindAttribLocation(program, k, name));
      gl.linkProgram(program);
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      gl.useProgram(program);
      this.at = {};
      ['pose', 'camera', 'cut', 'eye', 'plain', 'nothing', 'kind', 'colours'].forEach((name) => {
        this.at[name] = gl.getUniformLocation(program, name);
      });
      return program;
    }

    palette() {
      const gl = this.gl, texture = gl.createTexture(), data = new Uint8Array(4 * 256);
      for (let i = 0; i < 256; i++) data.set(colour(i / 255).concat(255), 4 * i);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, data);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
      return texture;
    }

    // Reads what does not change and makes buffers for it.
    async open() {
      for (const shape of this.shapes.parts) {
        const [points, quads, edges] = shape.counts;
        const read = Unpack.reader(await Unpack.chunk(shape.chunk));
        const whole = read(points, 3, 3), base = new Float32Array(3 * points), unit = shape.scale / 0x7fffff;
        for (let i = 0; i < base.length; i++) base[i] = shape.origin[i % 3] + whole[i] * unit;
        const corners = read(quads, 4, 4), triangles = new Uint32Array(6 * quads);
        for (let q = 0; q < quads; q++) {
          const [a, b, c, d] = corners.subarray(4 * q, 4 * q + 4);
          triangles.set([a, b, c, a, c, d], 6 * q);
        }
        const lines = new Uint32Array(read(edges, 2, 4));
        const normals = shape.rigid ? Float32Array.from(read(points, 3, 1), (n) => n / 127) : null;
        this.parts.push(this.buffers(shape, base, triangles, lines, normals));
      }
    }

    buffers(shape, base, triangles, lines, normals) {
      const gl = this.gl, make = (target, data, use) => {
        const buffer = gl.createBuffer();
        gl.bindBuffer(target, buffer);
        gl.bufferData(target, data, use);
        return buffer;
      };
      const part = { shape: shape, base: base, triangles: triangles.length, lines: lines.length, pose: IDENTITY };
      part.array = gl.createVertexArray();
      gl.bindVertexArray(part.array);
      part.position = make(gl.ARRAY_BUFFER, base, shape.rigid ? gl.STATIC_DRAW : gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      if (normals) {
        make(gl.ARRAY_BUFFER, normals, gl.STATIC_DRAW);
        gl.enableVertexAttribArray(1);
        gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
      } else {
        part.value = make(gl.ARRAY_BUFFER, new Float32Array(2 * base.length / 3), gl.DYNAMIC_DRAW);
        gl.enableVertexAttribArray(2);
        gl.vertexAttribPointer(2, 2, gl.FLOAT, false, 0, 0);
      }
      part.faces = make(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
      part.edges = make(gl.ELEMENT_ARRAY_BUFFER, lines, gl.STATIC_DRAW);
      gl.bindVertexArray(null);
      return part;
    }

    // Displacements and fields of a step.
    async load(k) {
      if (!this.cache.has(k)) {
        this.cache.set(k, Unpack.chunk(this.shapes.steps[k].chunk).then((raw) => {
          const read = Unpack.reader(raw);
          return this.shapes.steps[k].states.map((state, p) => {
            if (!state.spans) return null;
            const shape = this.shapes.parts[p], n = shape.counts[0], unit = state.scale / 0x7fff;
            const u = Float32Array.from(read(n, 3, 2), (v) => v * unit);
            const fields = shape.fields.map(() => Uint8Array.from(read(n, 1, 1)));
            return { u: u, fields: fields };
          });
        }));
      }
      return this.cache.get(k);
    }

    // Smallest and largest value of the field, in this step or in all.
    range(k) {
      const name = this.options.field, steps = this.options.every ? this.shapes.steps : [this.shapes.steps[k]];
      let low = Infinity, high = -Infinity;
      const take = (a, b) => { low = Math.min(low, a); high = Math.max(high, b); };
      steps.forEach((step) => step.states.forEach((state, p) => {
        if (!state.spans) return;
        if (name === 'displacement') { take(0, state.largest); return; }
        const f = this.shapes.parts[p].fields.indexOf(name);
        if (f >= 0) take(state.spans[f][0], state.spans[f][1]);
      }));
      return low <= high ? [low, high] : [0, 0];
    }

    async show(k) {
      const loaded = await this.load(k);
      this.current = k;
      const gl = this.gl, step = this.shapes.steps[k], [low, high] = this.range(k), width = high - low || 1;
      this.shown = [low, high];
      step.states.forEach((state, p) => {
        const part = this.parts[p];
        part.absent = !state.spans && !state.pose;
        if (state.pose) {
          const m = state.pose;
          part.pose = new Float32Array([m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, m[3], m[7], m[11], 1]);
        }
        const body = loaded[p];
        if (!body) return;
        const n = part.shape.counts[0], at = new Float32Array(3 * n), value = new Float32Array(2 * n);
        for (let i = 0; i < at.length; i++) at[i] = part.base[i] + this.options.factor * body.u[i];
        const f = part.shape.fields.indexOf(this.options.field);
        part.plain = f < 0 && this.options.field !== 'displacement';
        for (let i = 0; i < n && !part.plain; i++) {
          let v;
          if (f < 0) {
            v = Math.hypot(body.u[3 * i], body.u[3 * i + 1], body.u[3 * i + 2]);
          } else if (body.fields[f][i] === NONE) {
            continue;
          } else {
            v = state.spans[f][0] + (state.spans[f][1] - state.spans[f][0]) * body.fields[f][i] / (NONE - 1);
          }
          value[2 * i] = (v - low) / width;
          value[2 * i + 1] = 1;
        }
        gl.bindBuffer(gl.ARRAY_BUFFER, part.position);
        gl.bufferSubData(gl.ARRAY_BUFFER, 0, at);
        gl.bindBuffer(gl.ARRAY_BUFFER, part.value);
        gl.bufferSubData(gl.ARRAY_BUFFER, 0, value);
      });
      this.draw();
    }

    plane() {
      const axis = 'xyz'.indexOf(this.options.cut);
      if (this.options.cut === '' || axis < 0) return [0, 0, 0, 1];
      const b = this.shapes.bounds, margin = 1e-3 * this.camera.radius, side = this.options.flip ? -1 : 1;
      const at = b[0][axis] - margin + this.options.at * (b[1][axis] - b[0][axis] + 2 * margin);
      const plane = [0, 0, 0, side * at];
      plane[axis] = side;
      return plane;
    }

    draw() {
      const gl = this.gl, canvas = this.canvas, ratio = Math.min(2, window.devicePixelRatio || 1);
      const w = Math.max(1, Math.round(canvas.clientWidth * ratio)), h = Math.max(1, Math.round(canvas.clientHeight * ratio));
      if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
      gl.viewport(0, 0, w, h);
      const ground = rgb('--ground'), ink = rgb('--ink'), muted = rgb('--muted'), grid = rgb('--front');
      gl.clearColor(ground[0], ground[1], ground[2], 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      this.camera.aspect = w / h;
      this.matrix = this.camera.matrix(w / h);
      gl.uniformMatrix4fv(this.at.camera, false, this.matrix);
      gl.uniform3fv(this.at.eye, this.camera.eye());
      gl.uniform4fv(this.at.cut, this.plane());
      gl.uniform3fv(this.at.nothing, grid);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, this.colours);
      gl.uniform1i(this.at.colours, 0);
      const faces = (part, kind, colour, alpha) => {
        gl.bindVertexArray(part.array);
        gl.uniformMatrix4fv(this.at.pose, false, part.pose);
        gl.uniform1i(this.at.kind, kind);
        gl.uniform4f(this.at.plain, colour[0], colour[1], colour[2], alpha);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, kind === 0 ? part.edges : part.faces);
        gl.drawElements(kind === 0 ? gl.LINES : gl.TRIANGLES, kind === 0 ? part.lines : part.triangles, gl.UNSIGNED_INT, 0);
      };
      const shown = this.parts.filter((part) => !part.absent);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
      shown.filter((p) => !p.shape.rigid).forEach((part) => faces(part, part.plain ? 3 : 2, muted, 1));
      gl.disable(gl.POLYGON_OFFSET_FILL);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      if (this.options.lines) shown.filter((p) => !p.shape.rigid).forEach((part) => faces(part, 0, ink, 0.35));
      const alpha = this.options.tools, tools = shown.filter((p) => p.shape.rigid && alpha > 0);
      // Of a tool that is seen through, only what is in front: its depth first, its colour then.
      if (alpha < 1) {
        gl.colorMask(false, false, false, false);
        tools.forEach((part) => faces(part, 1, grid, alpha));
        gl.colorMask(true, true, true, true);
        gl.depthFunc(gl.LEQUAL);
      }
      tools.forEach((part) => faces(part, 1, grid, alpha));
      gl.depthFunc(gl.LESS);
      gl.disable(gl.BLEND);
      gl.bindVertexArray(null);
      if (this.drawn) this.drawn();
    }

    // Place of a point in the picture, in parts of its width and height; none behind the eye.
    project(x) {
      const m = this.matrix, at = (r) => m[r] * x[0] + m[4 + r] * x[1] + m[8 + r] * x[2] + m[12 + r];
      const w = at(3);
      return w > 0 ? [0.5 + 0.5 * at(0) / w, 0.5 - 0.5 * at(1) / w] : null;
    }
  }
  Stage.css = 'linear-gradient(to right,' + STOPS.map((c) => 'rgb(' + c.join(',') + ')').join(',') + ')';
  return Stage;
}());
