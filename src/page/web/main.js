// Puts viewers and curves where the page has room for them.
(function () {
  'use strict';
  const runs = JSON.parse(document.getElementById('head').textContent);
  const several = runs.length > 1, MOST = 6;

  const column = (run, name) => { const k = run.history.columns.indexOf(name); return k < 0 ? null : run.history.rows.map((r) => r[k]); };
  const peak = (values) => values.reduce((m, v) => v === null ? m : Math.max(m, Math.abs(v)), 0);
  const label = (run, name) => several ? run.name + ': ' + name : name;

  // Of the columns `start.NAME.x`, `.y`, `.z` of every name the one with the largest values.
  function dominant(run, start) {
    const best = new Map();
    run.history.columns.forEach((name) => {
      const parts = name.startsWith(start + '.') && /^(.*)\.([xyz])$/.exec(name.slice(start.length + 1));
      if (!parts) return;
      const size = peak(column(run, name)), before = best.get(parts[1]);
      if (size > 0 && (!before || size > before.size)) best.set(parts[1], { name: parts[1], column: name, size: size });
    });
    return Array.from(best.values()).sort((a, b) => b.size - a.size);
  }

  // The way of the tool that moves farthest, else time.
  function travel(run) {
    const way = dominant(run, 'way')[0] || dominant(run, 'displacement')[0];
    return way ? way.column : 'time';
  }

  function curves(title, x, wanted) {
    const series = [];
    let axis = '';
    runs.forEach((run, k) => {
      const base = typeof x === 'function' ? x(run) : x, values = column(run, base);
      if (!values) return;
      axis = axis || base;
      wanted(run).slice(0, MOST).forEach((name) => {
        const y = column(run, name);
        if (y && y.some((v) => v !== null)) series.push({ name: label(run, name), x: values, y: y, dash: k > 0 });
      });
    });
    return series.length ? { title: title, x: axis, series: series } : null;
  }

  function charts(parent) {
    const named = (list) => (run) => list.filter((n) => run.history.columns.includes(n));
    const starting = (start) => (run) => run.history.columns.filter((n) => n.startsWith(start) && peak(column(run, n)) > 0);
    // Tools that move come first, then contacts between bodies, then supports and tools at rest.
    const forces = (run) => {
      const moves = (f) => ['x', 'y', 'z', 'angle'].some((a) => run.history.columns.includes('way.' + f.name + '.' + a));
      const all = dominant(run, 'force');
      return all.filter(moves).concat(dominant(run, 'slave.force'), all.filter((f) => !moves(f))).map((f) => f.column);
    };
    const all = [
      curves('Forces', travel, forces),
      curves('Iterations', 'step', named(['iterations', 'iterations.failed', 'cuts'])),
      curves('Energies', 'time', starting('energy.')),
      curves('Points in contact', 'time', named(['points.active', 'points.stick', 'points.slip'])),
      curves('Penetration', 'time', named(['penetration.max'])),
      curves('Largest pressure', 'time', named(['pressure.max'])),
      curves('Probes', 'time', starting('probe.')),
    ];
    all.filter(Boolean).forEach((spec) => new Chart(parent, spec));
    own(parent);
  }

  // Any column against any other.
  function own(parent) {
    const names = [];
    runs.forEach((run) => run.history.columns.forEach((n) => { if (!names.includes(n)) names.push(n); }));
    if (!names.length) return;
    const box = Viewer.make('div', { class: 'own' }, parent), line = Viewer.make('div', { class: 'controls' }, box), selects = [];
    const spec = () => curves('A curve of your choice', selects[1].value, () => [selects[0].value]) ||
      { title: 'A curve of your choice', x: selects[1].value, series: [] };
    const defaults = ['gap.min', 'time'];
    ['Curve', 'over'].forEach((text, k) => {
      const select = Viewer.make('select', {}, Viewer.make('label', {}, line, text + ' '));
      names.forEach((n) => Viewer.make('option', {}, select, n));
      select.value = names.includes(defaults[k]) ? defaults[k] : names[0];
      selects.push(select);
      select.addEventListener('change', () => chart.set(spec()));
    });
    const chart = new Chart(box, spec());
  }

  async function start() {
    for (const run of runs) {
      run.history = { columns: [], rows: [] };
      if (run.table) run.history = JSON.parse(new TextDecoder().decode(await Unpack.chunk(run.table)));
    }
    // The curves first: until a browser without a graphics card draws in 3-D takes it half a second.
    charts(document.getElementById('charts'));
    document.documentElement.dataset.opened = String(Math.round(performance.now()));
    const viewers = [];
    for (const run of runs) {
      const parent = document.getElementById('view' + run.index);
      if (!run.shapes.steps.length) {
        parent.append(run.shapes.note || 'The run wrote no fields.');
        continue;
      }
      try {
        const viewer = new Viewer(parent, run, viewers);
        await viewer.open();
        viewers.push(viewer);
      } catch (e) {
        parent.replaceChildren('The 3-D view cannot be shown: ' + e.message);
      }
    }
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => viewers.forEach((v) => v.stage.draw()));
    document.documentElement.dataset.ready = String(Math.round(performance.now()));
  }
  start().catch((e) => { document.getElementById('charts').replaceChildren('The page cannot be shown: ' + e.message); console.error(e); });
}());
