// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
'use strict';
const crowd = 300;  // rows, above which dots would cover each other
const data = JSON.parse(document.getElementById('data').textContent), perPage = 100;
const byId = (id) => document.getElementById(id);
const make = (name, text, parent) => {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (parent) parent.append(element);
  return element;
};
const drawn = (name, attributes, parent) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
};
const numberOf = (text) => (text === '' || text === 'n/a' || text === undefined ? NaN : Number(text));
const short = (text) => {
  const n = numberOf(text);
  return Number.isNaN(n) || Number.isInteger(n) ? text : String(Number(n.toPrecision(3)));
};
const nameOf = (row) => row.cells.slice(0, data.fixed - 1).filter((x) => x).join(' ');
const state = data.fixed - 1;
const search = byId('search'), flagged = byId('flagged'), set = byId('set');
const head = document.querySelector('thead tr'), body = document.querySelector('tbody');
let sorted = -1, up = true, page = 0;

const middleOf = (sorted) => (sorted[Math.floor((sorted.length - 1) / 2)] + sorted[Math.floor(sorted.length / 2)]) / 2;

// What lies where among the rows.  A few that lie far off must not press all others together: an
// axis holds what is within 4 robust deviations (1.4826 MAD) of the median; what lies beyond stands at its end.
const spread = data.columns.map((column, c) => {
  if (c < data.fixed) return null;
  const values = data.rows.map((r) => numberOf(r.cells[c])).filter((v) => Number.isFinite(v)).sort((a, b) => a - b);
  if (values.length < 2 || values[0] === values[values.length - 1]) return null;
  const count = values.length, median = middleOf(values), least = values[0], most = values[count - 1];
  const off = 4 * 1.4826 * middleOf(values.map((v) => Math.abs(v - median)).sort((a, b) => a - b));
  // Where most rows are equal there is no such deviation: then all that there is.
  const near = off > 0 ? values.filter((v) => Math.abs(v - median) <= off) : values;
  const low = near[0], high = near[near.length - 1];
  return { low, high, least, most, median, count };
});
const outside = (c, value) => (value < spread[c].low ? -1 : value > spread[c].high ? 1 : 0);
const placeOf = (c, value) => (spread[c] ? Math.min(1, Math.max(0, (value - spread[c].low) / (spread[c].high - spread[c].low))) : NaN);

// How many rows lie where, as the outline of an area that stands on a line.
function shapeOf(c, left, width, bottom, height, rows = data.rows) {
  const bins = 40, counts = new Array(bins).fill(0);
  for (const row of rows) {
    const value = numberOf(row.cells[c]), place = placeOf(c, value);
    if (Number.isFinite(place) && !outside(c, value)) ++counts[Math.min(bins - 1, Math.floor(bins * place))];
  }
  const most = Math.max(...counts, 1), step = width / bins;
  return 'M' + left + ' ' + bottom + counts.map((n) => 'V' + (bottom - height * n / most).toFixed(1) + 'h' + step).join('') + 'V' + bottom + 'Z';
}

function showFailures() {
  const failed = data.rows.filter((r) => r.cells[state] !== 'done');
  if (failed.length === 0) return;
  make('h2', failed.length === 1 ? 'One result needs review' : failed.length + ' results need review', byId('failures'));
  const list = make('div', undefined, byId('failures'));
  list.className = 'list';
  list.tabIndex = 0;
  for (const row of failed.slice(0, 50)) {
    const box = make('div', undefined, list);
    box.className = 'failure';
    make('b', nameOf(row) + ' ', box);
    box.append(row.cells[state] + ' ');
    if (row.report) { const link = make('a', 'report', box); link.href = row.report; }
  }
  if (failed.length > 50) make('p', 'The others are in the table below: sort by state.', byId('failures'));
}

// Groups by a column of participants.tsv that has few different values, in colours for the colour-blind.
const groupColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const groupsOf = (c) => [...new Set(data.rows.map((r) => cell(r, c)).filter((v) => v !== 'n/a'))].sort();
const by = byId('by');
function offerGroups() {
  data.columns.forEach((column, c) => {
    if (column.kind !== 'about') return;
    const count = groupsOf(c).length;
    if (count > 1 && count <= groupColours.length) by.add(new Option(column.words, c));
  });
  by.parentElement.hidden = by.options.length < 2;
  by.addEventListener('change', showStrips);
}
function showStrips() {
  byId('strips').textContent = byId('groups').textContent = '';
  (by.value ? groupsOf(by.value) : []).forEach((group, n) => {
    make('span', group, byId('groups')).style.borderColor = groupColours[n];
  });
  data.columns.forEach((column, c) => { if (column.compared && column.kind !== 'region' && spread[c]) showStrip(c); });
}

// One line of dots a number; dots that would cover each other move aside, always the same way.
function showStrip(c) {
  const column = data.columns[c], box = make('div', undefined, byId('strips'));
  box.className = 'strip';
  make('h3', column.words + (column.unit ? ', ' + column.unit : ''), box);
  const svg = drawn('svg', { viewBox: '0 0 300 62', role: 'img', 'aria-label': column.words + ': from ' + short(String(spread[c].least)) + ' to ' + short(String(spread[c].most)) + ', median ' + short(String(spread[c].median)) }, box);
  drawn('line', { x1: 8, x2: 292, y1: 46, y2: 46 }, svg);
  const at = (value) => 8 + 284 * placeOf(c, value);
  drawn('line', { class: 'median', x1: at(spread[c].median), x2: at(spread[c].median), y1: 4, y2: 46 }, svg);
  const endOf = (side, end, last) => {
    const beyond = data.rows.filter((r) => outside(c, numberOf(r.cells[c])) === side).length;
    return short(String(end)) + (beyond ? ' (' + beyond + ' beyond, to ' + short(String(last)) + ')' : '');
  };
  drawn('text', { x: 8, y: 59 }, svg).textContent = endOf(-1, spread[c].low, spread[c].least);
  drawn('text', { x: 292, y: 59, 'text-anchor': 'end' }, svg).textContent = endOf(1, spread[c].high, spread[c].most);
  const taken = new Map(), crowded = spread[c].count > crowd;
  if (crowded) drawn('path', { class: 'spread', d: shapeOf(c, 8, 284, 46, 40) }, svg);
  const groups = by.value ? groupsOf(by.value) : [];
  if (crowded) {
    groups.forEach((group, n) => {
      const d = shapeOf(c, 8, 284, 46, 40, data.rows.filter((r) => cell(r, by.value) === group));
      drawn('path', { class: 'group', d, style: 'stroke:' + groupColours[n] }, svg);
    });
  }
  for (const row of data.rows) {
    const value = numberOf(row.cells[c]);
    if (!Number.isFinite(value) || (crowded && !row.flags[c])) continue;
    const bin = Math.round(at(value) / 3), count = taken.get(bin) || 0;
    taken.set(bin, count + 1);
    const x = at(value), y = 42 - 4 * (count % 10), r = row.flags[c] ? 4 : 2.6, beyond = outside(c, value);
    const dot = beyond ? drawn('path', { class: 'beyond', d: 'M' + (x + beyond * 7) + ' ' + y + 'l' + -beyond * 8 + ' -4v8z' }, svg)
      : drawn('circle', { cx: x.toFixed(1), cy: y, r }, svg);
    if (row.flags[c]) dot.classList.add('odd');
    const group = groups.indexOf(by.value ? cell(row, by.value) : '');
    if (group >= 0) dot.style.fill = groupColours[group];
    drawn('title', {}, dot).textContent = nameOf(row) + ': ' + short(row.cells[c]) + (row.flags[c] ? ' (' + row.flags[c] + ')' : '');
    dot.addEventListener('click', () => { search.value = row.cells[0]; page = 0; draw(); search.scrollIntoView(); });
  }
}

const wanted = () => data.columns.map((column, c) => c).filter((c) => {
  const kind = data.columns[c].kind;
  return kind === 'fixed' || set.value === 'all' || (set.value === 'regions' ? kind === 'region' : kind === 'first');
});
const cell = (row, c) => (row.cells[c] === undefined ? 'n/a' : row.cells[c]);
function chosenRows() {
  const words = search.value.toLowerCase().split(/\s+/).filter((w) => w);
  const list = data.rows.filter((r) => (!flagged.checked || Object.keys(r.flags).length) && words.every((w) => r.text.includes(w)));
  if (sorted < 0) return list;
  return list.slice().sort((a, b) => {
    const x = cell(a, sorted), y = cell(b, sorted), m = numberOf(x), n = numberOf(y);
    if (Number.isNaN(m) !== Number.isNaN(n)) return Number.isNaN(m) ? 1 : -1;
    return (up ? 1 : -1) * (Number.isNaN(m) ? x.localeCompare(y) : m - n);
  });
}
function drawHead(columns) {
  head.textContent = '';
  for (const c of columns) {
    const th = make('th', undefined, head), button = make('button', data.columns[c].words, th);
    th.scope = 'col';
    button.type = 'button';
    if (c < data.fixed) th.className = 't';
    if (data.columns[c].unit) make('small', data.columns[c].unit, th);
    button.onclick = () => { up = sorted === c ? !up : true; sorted = c; page = 0; draw(); };
    if (sorted === c) th.setAttribute('aria-sort', up ? 'ascending' : 'descending');
  }
}
function drawCell(row, c, tr) {
  const td = make('td', undefined, tr), value = cell(row, c);
  if (c < data.fixed) td.className = c === state && value !== 'done' ? 't state' : 't';
  if (c === 0 && row.report) {
    const link = make('a', undefined, td);
    link.href = row.report;
    if (row.thumbnail) {
      const image = make('img', undefined, link);
      image.src = row.thumbnail;
      image.loading = 'lazy';
      image.alt = '';
    }
    link.append(value);
  } else {
    td.textContent = short(value);
  }
  const place = data.columns[c].compared ? placeOf(c, numberOf(value)) : NaN;
  if (Number.isFinite(place)) {
    td.classList.add('number');
    const svg = drawn('svg', { viewBox: '0 0 100 16', preserveAspectRatio: 'none', 'aria-hidden': 'true' }, td);
    drawn('use', { href: '#spread' + c }, svg);
    drawn('rect', { x: (1 + 98 * place - 0.8).toFixed(1), y: 0, width: 1.6, height: 16 }, svg);
  }
  if (row.flags[c]) {
    td.classList.add(row.flags[c].startsWith('robust') ? 'odd' : 'bad');
    td.title = row.flags[c] + (value === td.textContent ? '' : ' (' + value + ')');
  } else if (value !== td.textContent && c >= data.fixed) {
    td.title = value;
  }
}
function draw() {
  const columns = wanted(), list = chosenRows(), pages = Math.max(1, Math.ceil(list.length / perPage));
  page = Math.min(page, pages - 1);
  drawHead(columns);
  body.textContent = '';
  for (const row of list.slice(page * perPage, (page + 1) * perPage)) {
    const tr = make('tr', undefined, body);
    for (const c of columns) drawCell(row, c, tr);
  }
  byId('shown').textContent = list.length + ' rows' + (pages > 1 ? ', page ' + (page + 1) + ' of ' + pages : '');
  byId('before').disabled = page === 0;
  byId('after').disabled = page >= pages - 1;
}

// Mean and deviation of each region and side, drawn on one axis.
function showRegions() {
  const columns = data.columns.map((column, c) => c).filter((c) => data.columns[c].kind === 'region');
  const sides = [...new Set(data.rows.map((r) => r.cells[1]))].sort();
  if (columns.length === 0) { byId('regions').remove(); set.querySelector('[value=regions]').remove(); return; }
  const statistics = columns.map((c) => sides.map((side) => {
    const values = data.rows.filter((r) => r.cells[1] === side).map((r) => numberOf(r.cells[c])).filter((v) => Number.isFinite(v));
    const mean = values.reduce((a, b) => a + b, 0) / values.length;
    const sd = Math.sqrt(values.reduce((a, b) => a + (b - mean) * (b - mean), 0) / Math.max(1, values.length - 1));
    return { n: values.length, mean, sd: values.length > 1 ? sd : NaN };
  }));
  const all = statistics.flat().filter((s) => s.n > 0);
  const low = Math.min(...all.map((s) => s.mean - (s.sd || 0))), high = Math.max(...all.map((s) => s.mean + (s.sd || 0)), low + 1e-9);
  const table = make('table', undefined, byId('regions').querySelector('.wide'));
  const titles = make('tr', undefined, make('thead', undefined, table));
  for (const text of ['region', ...sides.flatMap((s) => [s + ' mean', s + ' SD', s + ' n']), '']) {
    const th = make('th', text, titles);
    th.scope = 'col';
  }
  const picture = titles.lastChild;
  sides.forEach((side, n) => {
    const dot = drawn('svg', { width: 12, height: 12, 'aria-hidden': 'true' }, picture);
    drawn('circle', { cx: 6, cy: 7, r: 4, class: n ? 'second' : 'first' }, dot);
    picture.append(side + ' ');
  });
  picture.append(low.toFixed(1) + ' to ' + high.toFixed(1) + ' mm');
  const rows = make('tbody', undefined, table);
  columns.forEach((c, n) => {
    const tr = make('tr', undefined, rows), name = make('td', data.columns[c].words, tr);
    name.className = 't';
    for (const s of statistics[n]) {
      make('td', s.n ? s.mean.toFixed(2) : 'n/a', tr);
      make('td', Number.isFinite(s.sd) ? s.sd.toFixed(2) : 'n/a', tr);
      make('td', String(s.n), tr);
    }
    const svg = drawn('svg', { width: 260, height: 22, 'aria-hidden': 'true' }, make('td', undefined, tr));
    const at = (v) => 6 + 248 * (v - low) / (high - low);
    statistics[n].forEach((s, side) => {
      if (!s.n) return;
      const y = 7 + 8 * side, which = side ? 'second' : 'first';
      if (Number.isFinite(s.sd)) drawn('line', { x1: at(s.mean - s.sd), x2: at(s.mean + s.sd), y1: y, y2: y, class: which }, svg);
      drawn('circle', { cx: at(s.mean), cy: y, r: 3.5, class: which }, svg);
    });
  });
}

// The shapes that stand behind numbers, each drawn once.
const shapes = drawn('svg', { width: 0, height: 0, 'aria-hidden': 'true', style: 'position:absolute' }, document.body);
data.columns.forEach((column, c) => {
  if (column.compared && spread[c]) drawn('path', { id: 'spread' + c, d: shapeOf(c, 1, 98, 16, 15) }, shapes);
});
for (const row of data.rows) row.text = row.cells.slice(0, data.fixed).join(' ').toLowerCase();
search.oninput = flagged.onchange = set.onchange = () => { page = 0; draw(); };
byId('before').onclick = () => { --page; draw(); };
byId('after').onclick = () => { ++page; draw(); };
document.querySelector('form').onsubmit = (event) => event.preventDefault();
showFailures();
showRegions();
draw();
// The plots come after the table is on the screen.
requestAnimationFrame(() => setTimeout(() => {
  const people = new Set(data.rows.map((r) => r.cells[0])).size, fewest = 5;
  if (people < fewest) byId('distribution').remove();  // so few are read in the table
  else { offerGroups(); showStrips(); }
  document.body.dataset.ready = 'true';
}));
