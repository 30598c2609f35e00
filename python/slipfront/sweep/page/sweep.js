// SPDX-License-Identifier: BSD-3-Clause
// The maps of a sweep: choices above, one plot, the facts of the point that was clicked.

const sweep = JSON.parse(document.getElementById('sweep-data').textContent);
const part = (name) => document.getElementById(`sweep-${name}`);
const MOST_TICKS = 7; // values of a key that are all written at its axis
const COLOURS = ['#0072b2', '#d55e00', '#e8c35a', '#117733', '#dddddd'];

/** Points at which all keys but those of the axes have the values chosen. */
function chosenPoints(axes) {
  const others = sweep.keys.filter((key) => !axes.includes(key.name));
  if (!sweep.is_grid) return sweep.points;
  return sweep.points.filter((point) => others.every((key) => point.values[key.name] === fixed[key.name]));
}

const fixed = Object.fromEntries(sweep.keys.map((key) => [key.name, key.axis[0]]));

const MOST_CELLS = 100; // of a map whose values are written into it
const LINES = ''; // chosen in place of a key that goes up
const LINE_COLOURS = ['#0072b2', '#d55e00', '#117733', '#aa4499', '#e69f00', '#56b4e9', '#882255', '#555555'];
const named = (quantity) => (quantity.unit === '1' ? quantity.long_name : `${quantity.long_name} (${quantity.unit})`);

/** A value of a key in the unit of its label. */
const scaled = (key, value) => (typeof value === 'number' ? Number((key.factor * value).toPrecision(6)) : value);

/** Words become their place in the quantity's list, what is undefined null. */
function number(quantity, point) {
  const value = point.cells[quantity.name];
  if (!quantity.words.length) return value === null ? null : quantity.factor * value;
  const place = quantity.words.indexOf(value);
  return place < 0 ? null : place;
}

function text(quantity, point) {
  return point.texts[quantity.name];
}

/** The step of four to seven ticks over a range: 1, 2 or 5 times a power of ten. */
function stepOver(range) {
  const power = 10 ** Math.floor(Math.log10(range / 7));
  return power * ([1, 2, 5].find((k) => k * power >= range / 7) ?? 10);
}

const CLOSE = 0.05; // over the length of the bar: closer ticks have one label

/** Limits of the colours of a speed, out to the next wave speeds below and above; none of its own for all else. */
function limitsWithWaves({name, waves}) {
  const values = sweep.points.map((p) => p.cells[name]).filter((v) => v !== null);
  if (!waves.length || !values.length) return [undefined, undefined];
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const levels = waves.map(({level}) => level);
  return [Math.max(...levels.filter((v) => v < low), -Infinity), Math.min(...levels.filter((v) => v > high), Infinity)]
    .map((v, k) => (Number.isFinite(v) ? v : [low, high][k]));
}

/** Ticks of a bar of colours with wave speeds among them; none of its own where there are none to mark. */
function ticksWithWaves(quantity) {
  const [low, high] = limitsWithWaves(quantity);
  const inside = quantity.waves.filter(({level}) => level >= low && level <= high);
  if (!inside.length || high <= low) return {};
  const groups = [];
  for (const wave of inside) {
    const last = groups.at(-1);
    if (last && wave.level - last.at(-1).level < CLOSE * (high - low)) last.push(wave);
    else groups.push([wave]);
  }
  const marks = groups.map((group) => [group.reduce((sum, {level}) => sum + level, 0) / group.length,
    `${group.map((wave) => `c<sub>${wave.name.slice(2)}</sub>`).join(', ')} (${group.map(({level}) => Number(level.toPrecision(3))).join(', ')})`]);
  const step = stepOver(high - low);
  const first = Math.ceil(low / step);
  const numbers = Array.from({length: Math.floor(high / step) - first + 1}, (_, k) => Number(((first + k) * step).toPrecision(6)));
  const free = numbers.filter((v) => marks.every(([level]) => Math.abs(v - level) >= CLOSE * (high - low)));
  return {tickvals: [...marks.map(([level]) => level), ...free], ticktext: [...marks.map(([, text]) => text), ...free.map(String)]};
}

function colours(quantity) {
  const n = quantity.words.length;
  if (!n) {
    const unit = quantity.unit === '1' ? '' : quantity.unit;
    return {colorscale: 'Viridis', colorbar: {title: {text: unit}, ...ticksWithWaves(quantity)}};
  }
  const used = quantity.words.at(-1) === 'none' ? [...COLOURS.slice(0, n - 1), COLOURS.at(-1)] : COLOURS.slice(0, n);
  return {
    colorscale: used.flatMap((colour, k) => [[k / n, colour], [(k + 1) / n, colour]]),
    colorbar: {tickvals: quantity.words.map((_, k) => k), ticktext: quantity.words.map((w) => w.replaceAll('_', ' '))},
  };
}

function axisOf(key) {
  const values = key.axis.map((v) => scaled(key, v));
  const numeric = values.every((v) => typeof v === 'number');
  const least = Math.min(...values);
  const log = numeric && least > 0 && Math.max(...values) / least >= 20;
  const ticks = numeric && values.length <= MOST_TICKS ? {tickvals: values, ticktext: values.map((v) => String(Number(v.toPrecision(4))))} : {};
  return {title: {text: key.label}, type: numeric ? (log ? 'log' : 'linear') : 'category', ...ticks};
}

function hoverOf(quantity, point) {
  const values = sweep.keys.map((key) => `${key.label}: ${scaled(key, point.values[key.name])}`).join('<br>');
  return `${values}<br>${named(quantity)}: ${point.status === 'done' ? text(quantity, point) : point.status}`;
}

/** Cells of a grid, else a dot for each point. */
function mapOf(quantity, x, y, points) {
  const look = colours(quantity);
  const range = quantity.words.length ? [-0.5, quantity.words.length - 0.5] : limitsWithWaves(quantity);
  const found = new Set(points.map((p) => number(quantity, p)).filter((v) => v !== null));
  const showscale = found.size > 1;
  if (!sweep.is_grid) {
    return {type: 'scatter', mode: 'markers', x: points.map((p) => scaled(x, p.values[x.name])),
      y: points.map((p) => scaled(y, p.values[y.name])), marker: {size: 11, color: points.map((p) => number(quantity, p)), cmin: range[0], cmax: range[1],
        colorscale: look.colorscale, colorbar: look.colorbar, showscale},
      customdata: points.map((p) => p.index), text: points.map((p) => hoverOf(quantity, p)), hoverinfo: 'text'};
  }
  const at = new Map(points.map((p) => [JSON.stringify([p.values[y.name], p.values[x.name]]), p]));
  const rows = y.axis.map((v) => x.axis.map((u) => at.get(JSON.stringify([v, u]))));
  const each = (f) => rows.map((row) => row.map((p) => (p ? f(p) : null)));
  const written = points.length <= MOST_CELLS;
  return {type: 'heatmap', x: x.axis.map((v) => scaled(x, v)), y: y.axis.map((v) => scaled(y, v)), showscale, z: each((p) => number(quantity, p)), zmin: range[0], zmax: range[1],
    colorscale: look.colorscale, colorbar: look.colorbar, customdata: each((p) => p.index),
    ...(written && {text: each((p) => (p.status === 'done' ? text(quantity, p) : p.status)), texttemplate: '%{text}'}),
    hovertext: each((p) => hoverOf(quantity, p)), hoverinfo: 'text', xgap: 0.5, ygap: 0.5};
}

/** A result over one key: of a grid a line for each value of the first other key, else dots. */
function linesOf(quantity, x, points) {
  const other = sweep.is_grid ? sweep.keys.find((key) => key !== x) : undefined;
  const groups = other ? other.axis : [null];
  const isNumeric = x.axis.every((v) => typeof v === 'number');
  return groups.map((value, k) => {
    const own = points.filter((p) => !other || p.values[other.name] === value);
    if (isNumeric) own.sort((a, b) => a.values[x.name] - b.values[x.name]);
    const colour = LINE_COLOURS[k % LINE_COLOURS.length];
    return {type: 'scatter', mode: sweep.is_grid && isNumeric ? 'lines+markers' : 'markers', name: other ? `${other.label}: ${scaled(other, value)}` : '',
      showlegend: Boolean(other), x: own.map((p) => scaled(x, p.values[x.name])), y: own.map((p) => number(quantity, p)),
      line: {color: colour, width: 1.5}, marker: {color: colour, size: 8},
      customdata: own.map((p) => p.index), text: own.map((p) => hoverOf(quantity, p)), hoverinfo: 'text'};
  });
}

function cell(tag, content) {
  const element = document.createElement(tag);
  element.textContent = content;
  return element;
}

/** Everything known of a point, below the map. */
function showPoint(index) {
  const point = sweep.points[index];
  const rows = [...sweep.keys.map((key) => [key.label, String(scaled(key, point.values[key.name]))]), ['status', point.status],
    ['results', point.folder], ...(point.message ? [['message', point.message]] : []),
    ...sweep.quantities.map((q) => [named(q), text(q, point)])];
  const table = document.createElement('table');
  table.className = 'facts';
  for (const [name, value] of rows) {
    const row = table.insertRow();
    row.append(cell('th', name), cell('td', value));
  }
  part('point').replaceChildren(table);
  if (!point.report) return;
  const link = cell('a', 'report of this run');
  link.href = point.report;
  part('point').prepend(link);
}

function keyNamed(name) {
  return sweep.keys.find((key) => key.name === name);
}

async function draw() {
  const quantity = sweep.quantities.find((q) => q.name === part('quantity').value);
  const x = keyNamed(part('x').value);
  const y = keyNamed(part('y').value);
  const two = y !== undefined && x !== y;
  const among = two || !sweep.is_grid ? y : sweep.keys.find((key) => key !== x);
  for (const key of sweep.keys) {
    const choice = document.getElementById(`sweep-at-${key.name}`);
    if (choice) choice.parentElement.hidden = !sweep.is_grid || key === x || key === among;
  }
  const points = chosenPoints([x.name, among?.name]);
  const yAxis = two ? axisOf(y) : {title: {text: named(quantity)}};
  if (!two && quantity.words.length) Object.assign(yAxis, {tickvals: quantity.words.map((_, k) => k), ticktext: quantity.words});
  const traces = two ? [mapOf(quantity, x, y, points)] : linesOf(quantity, x, points);
  const shapes = two ? [] : quantity.waves.map(({level}) => ({type: 'line', xref: 'paper', x0: 0, x1: 1, y0: level, y1: level, line: {color: '#555', width: 1}}));
  const annotations = two ? [] : quantity.waves.map(({name, level}) => ({text: `c<sub>${name.slice(2)}</sub>`, xref: 'paper', x: 1, xanchor: 'left',
    y: level, yanchor: name === 'c_R' ? 'top' : 'bottom', showarrow: false}));
  const layout = {shapes, annotations, xaxis: axisOf(x), yaxis: yAxis, height: 520, margin: {t: 40, r: 40}, title: {text: named(quantity), font: {size: 14}}};
  await Plotly.react(part('plot'), traces, layout, {responsive: true, displaylogo: false});
}

function fill(name, entries, chosen) {
  part(name).replaceChildren(...entries.map(([value, label]) => new Option(label, value, false, value === chosen)));
  part(name).addEventListener('change', draw);
}

function startFixed() {
  if (sweep.keys.length < 3 || !sweep.is_grid) return;
  for (const key of sweep.keys) {
    const label = cell('label', `${key.label} `);
    const choice = document.createElement('select');
    choice.id = `sweep-at-${key.name}`;
    choice.replaceChildren(...key.axis.map((value, k) => new Option(String(scaled(key, value)), String(k))));
    choice.addEventListener('change', () => {
      fixed[key.name] = key.axis[Number(choice.value)];
      draw();
    });
    label.append(choice);
    part('fixed').append(label);
  }
}

async function start() {
  const names = sweep.keys.map((key) => [key.name, key.label]);
  fill('quantity', sweep.quantities.filter((q) => q.constant === null).map((q) => [q.name, q.long_name]), sweep.first);
  fill('x', names, names[Math.min(1, names.length - 1)][0]);
  fill('y', [...names, [LINES, 'the result, as lines']], names.length > 1 ? names[0][0] : LINES);
  startFixed();
  await draw();
  part('plot').on('plotly_click', (event) => {
    const index = event.points[0].customdata;
    if (index !== null && index !== undefined) showPoint(index);
  });
  document.body.dataset.sweep = 'drawn';
}

start().catch((error) => {
  document.body.dataset.sweep = 'failed';
  part('point').textContent = `This browser cannot draw the map: ${error.message}`;
  throw error;
});
