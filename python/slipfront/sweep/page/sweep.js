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

/** Words become their place in the quantity's list, what is undefined null. */
function number(quantity, point) {
  const value = point.cells[quantity.name];
  if (!quantity.words.length) return value;
  const place = quantity.words.indexOf(value);
  return place < 0 ? null : place;
}

function text(quantity, point) {
  const value = point.cells[quantity.name];
  if (value === null || value === '') return 'undefined';
  return quantity.words.length ? value.replaceAll('_', ' ') : Number(value).toPrecision(4);
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
    const unit = quantity.unit === '1' ? '' : quantity.unit.replace(' m-1', '/m');
    return {colorscale: 'Viridis', colorbar: {title: {text: unit}, ...ticksWithWaves(quantity)}};
  }
  const used = quantity.words.at(-1) === 'none' ? [...COLOURS.slice(0, n - 1), COLOURS.at(-1)] : COLOURS.slice(0, n);
  return {
    colorscale: used.flatMap((colour, k) => [[k / n, colour], [(k + 1) / n, colour]]),
    colorbar: {tickvals: quantity.words.map((_, k) => k), ticktext: quantity.words.map((w) => w.replaceAll('_', ' '))},
  };
}

function axisOf(key) {
  const values = key.axis;
  const numeric = values.every((v) => typeof v === 'number');
  const least = Math.min(...values);
  const log = numeric && least > 0 && Math.max(...values) / least >= 20;
  const ticks = numeric && values.length <= MOST_TICKS ? {tickvals: values, ticktext: values.map((v) => String(Number(v.toPrecision(4))))} : {};
  return {title: {text: key.name}, type: numeric ? (log ? 'log' : 'linear') : 'category', ...ticks};
}

function hoverOf(quantity, point) {
  const values = sweep.keys.map((key) => `${key.name} = ${point.values[key.name]}`).join('<br>');
  return `${values}<br>${point.status === 'done' ? text(quantity, point) : point.status}`;
}

/** Cells of a grid, else a dot for each point. */
function mapOf(quantity, x, y, points) {
  const look = colours(quantity);
  const range = quantity.words.length ? [-0.5, quantity.words.length - 0.5] : limitsWithWaves(quantity);
  if (!sweep.is_grid) {
    return {type: 'scatter', mode: 'markers', x: points.map((p) => p.values[x.name]), y: points.map((p) => p.values[y.name]),
      marker: {size: 11, color: points.map((p) => number(quantity, p)), cmin: range[0], cmax: range[1],
        colorscale: look.colorscale, colorbar: look.colorbar, showscale: true},
      customdata: points.map((p) => p.index), text: points.map((p) => hoverOf(quantity, p)), hoverinfo: 'text'};
  }
  const at = new Map(points.map((p) => [JSON.stringify([p.values[y.name], p.values[x.name]]), p]));
  const rows = y.axis.map((v) => x.axis.map((u) => at.get(JSON.stringify([v, u]))));
  const each = (f) => rows.map((row) => row.map((p) => (p ? f(p) : null)));
  return {type: 'heatmap', x: x.axis, y: y.axis, z: each((p) => number(quantity, p)), zmin: range[0], zmax: range[1],
    colorscale: look.colorscale, colorbar: look.colorbar, customdata: each((p) => p.index),
    text: each((p) => hoverOf(quantity, p)), hoverinfo: 'text', xgap: 0.5, ygap: 0.5};
}

function lineOf(quantity, x, points) {
  return {type: 'scatter', mode: 'markers', x: points.map((p) => p.values[x.name]), y: points.map((p) => number(quantity, p)),
    customdata: points.map((p) => p.index), text: points.map((p) => hoverOf(quantity, p)), hoverinfo: 'text'};
}

function cell(tag, content) {
  const element = document.createElement(tag);
  element.textContent = content;
  return element;
}

/** Everything known of a point, below the map. */
function showPoint(index) {
  const point = sweep.points[index];
  const rows = [...sweep.keys.map((key) => [key.name, String(point.values[key.name])]), ['status', point.status],
    ['results', point.folder], ...(point.message ? [['message', point.message]] : []),
    ...sweep.quantities.map((q) => [q.unit && q.unit !== '1' ? `${q.long_name} (${q.unit})` : q.long_name, text(q, point)])];
  const table = document.createElement('table');
  table.className = 'facts';
  for (const [name, value] of rows) {
    const row = table.insertRow();
    row.append(cell('th', name), cell('td', value));
  }
  part('point').replaceChildren(table);
}

function keyNamed(name) {
  return sweep.keys.find((key) => key.name === name);
}

async function draw() {
  const quantity = sweep.quantities.find((q) => q.name === part('quantity').value);
  const x = keyNamed(part('x').value);
  const y = keyNamed(part('y').value);
  const two = x !== y;
  for (const key of sweep.keys) {
    const choice = document.getElementById(`sweep-at-${key.name}`);
    if (choice) choice.parentElement.hidden = !sweep.is_grid || key === x || key === y;
  }
  const points = chosenPoints([x.name, y.name]);
  const yAxis = two ? axisOf(y) : {title: {text: quantity.long_name}};
  if (!two && quantity.words.length) Object.assign(yAxis, {tickvals: quantity.words.map((_, k) => k), ticktext: quantity.words});
  const trace = two ? mapOf(quantity, x, y, points) : lineOf(quantity, x, points);
  const shapes = two ? [] : quantity.waves.map(({level}) => ({type: 'line', xref: 'paper', x0: 0, x1: 1, y0: level, y1: level, line: {color: '#555', width: 1}}));
  const annotations = two ? [] : quantity.waves.map(({name, level}) => ({text: `c<sub>${name.slice(2)}</sub>`, xref: 'paper', x: 1, xanchor: 'left',
    y: level, yanchor: name === 'c_R' ? 'top' : 'bottom', showarrow: false}));
  const layout = {shapes, annotations, xaxis: axisOf(x), yaxis: yAxis, height: 520, margin: {t: 40, r: 40}, title: {text: quantity.long_name, font: {size: 14}}};
  await Plotly.react(part('plot'), [trace], layout, {responsive: true, displaylogo: false});
}

function fill(name, entries, chosen) {
  part(name).replaceChildren(...entries.map(([value, label]) => new Option(label, value, false, value === chosen)));
  part(name).addEventListener('change', draw);
}

function startFixed() {
  if (sweep.keys.length < 3 || !sweep.is_grid) return;
  for (const key of sweep.keys) {
    const label = cell('label', `${key.name} `);
    const choice = document.createElement('select');
    choice.id = `sweep-at-${key.name}`;
    choice.replaceChildren(...key.axis.map((value, k) => new Option(String(value), String(k))));
    choice.addEventListener('change', () => {
      fixed[key.name] = key.axis[Number(choice.value)];
      draw();
    });
    label.append(choice);
    part('fixed').append(label);
  }
}

async function start() {
  const names = sweep.keys.map((key) => [key.name, key.name]);
  fill('quantity', sweep.quantities.map((q) => [q.name, q.long_name]), sweep.first);
  fill('x', names, names[Math.min(1, names.length - 1)][0]);
  fill('y', names, names[0][0]);
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
