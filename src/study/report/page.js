(function () {
  'use strict';
  var root = document.documentElement, tip = document.getElementById('tip'), pinned = null, marked = [];
  var byRun = {};
  document.querySelectorAll('[data-r]').forEach(function (e) {
    var title = e.querySelector(':scope > title');
    if (title) { e.tip = title.textContent; title.remove(); }
    (byRun[e.dataset.r] = byRun[e.dataset.r] || []).push(e);
  });
  root.classList.add('hints');
  function mark(run) {
    marked.forEach(function (e) { e.classList.remove('hot'); });
    marked = run === null ? [] : byRun[run] || [];
    marked.forEach(function (e) { e.classList.add('hot'); });
    root.classList.toggle('some', marked.length > 0);
  }
  function over(target) {
    return target && target.closest ? target.closest('[data-r]') : null;
  }
  document.addEventListener('mouseover', function (event) {
    var e = over(event.target);
    if (pinned === null) { mark(e ? e.dataset.r : null); }
    tip.style.display = e && e.tip ? 'block' : 'none';
    if (e && e.tip) { tip.textContent = e.tip; }
  });
  document.addEventListener('mousemove', function (event) {
    if (tip.style.display !== 'block') { return; }
    var x = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
    var y = event.clientY + 18;
    if (y + tip.offsetHeight > innerHeight) { y = event.clientY - tip.offsetHeight - 12; }
    tip.style.left = Math.max(4, x) + 'px';
    tip.style.top = y + 'px';
  });
  document.addEventListener('click', function (event) {
    var e = over(event.target);
    pinned = e && e.dataset.r !== pinned ? e.dataset.r : null;
    mark(e ? e.dataset.r : null);
  });
  document.addEventListener('keydown', function (event) {
    if (event.key === 'Escape') { pinned = null; mark(null); tip.style.display = 'none'; }
  });
  var table = document.getElementById('runs');
  if (!table) { return; }
  var body = table.tBodies[0];
  Array.prototype.forEach.call(table.tHead.rows[0].cells, function (head, column) {
    head.classList.add('sortable');
    head.tabIndex = 0;
    function key(row) {
      var cell = row.cells[column], v = cell.dataset.v;
      return v === undefined ? (cell.textContent === '' || head.classList.contains('n') ? null : cell.textContent) : parseFloat(v);
    }
    function sort() {
      var up = head.getAttribute('aria-sort') !== 'ascending';
      var rows = Array.prototype.map.call(body.rows, function (row, place) { return [key(row), place, row]; });
      rows.sort(function (a, b) {
        if (a[0] === null || b[0] === null) { return (a[0] === null) - (b[0] === null) || a[1] - b[1]; }
        var order = typeof a[0] === 'number' ? a[0] - b[0] : a[0].localeCompare(b[0], undefined, { numeric: true });
        return (up ? order : -order) || a[1] - b[1];
      });
      rows.forEach(function (row) { body.appendChild(row[2]); });
      Array.prototype.forEach.call(table.tHead.rows[0].cells, function (h) { h.removeAttribute('aria-sort'); });
      head.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    }
    head.addEventListener('click', sort);
    head.addEventListener('keydown', function (event) {
      if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); sort(); }
    });
  });
}());
