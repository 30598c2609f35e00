// A field along the interface over time, with the fronts and what would run at a wave speed.

const SLOWEST_SHARE = 1e-3; // of the largest slip rate: the scale is logarithmic from there

/** Plotly's scales that people without red or green receptors can read. */
const FIELDS = {
  slip_rate: {label: (units) => `slip rate |v| (${units.speed})`, colours: 'YlGnBu', reversed: true},
  ratio: {label: () => 't/p', colours: 'Viridis'},
  p: {label: (units) => `p (${units.traction})`, colours: 'Cividis'},
  slip: {label: (units) => `slip (${units.slip})`, colours: 'Viridis'},
};
let field = data.fields?.[0];

function powersOfTen(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9);
  const last = Math.floor(Math.log10(high) + 1e-9);
  return Array.from({length: last - first + 1}, (_, k) => first + k);
}

/** Numbers, limits and ticks of the colours of a field. */
function coloursOf(run, name) {
  const history = historyOf(run);
  if (name === 'slip_rate') {
    const high = quantile(history.slip_rate, 0.999) || 1;
    const low = SLOWEST_SHARE * high;
    const ticks = powersOfTen(low, high);
    return {
      z: table(history.slip_rate, (v, i, j) => (history.p[i][j] > 0 ? Math.log10(Math.max(Math.abs(v), low)) : null)),
      zmin: Math.log10(low), zmax: Math.log10(high), tickvals: ticks, ticktext: ticks.map((k) => shown(10 ** k)),
    };
  }
  const rows = history[name];
  const high = name === 'ratio' ? run.ratio_limit : quantile(rows, 0.999) || 1;
  const goesBack = rows.some((row) => row.some((v) => v < -0.02 * high));
  return {z: table(rows, (v) => v), zmin: goesBack ? -high : 0, zmax: high, tickvals: null, ticktext: null};
}

function cellTexts(run) {
  const {slip_rate, slip, p, ratio} = historyOf(run);
  const u = run.units;
  run.texts ??= table(slip_rate, (v, i, j) => `slip rate ${shown(v)} ${u.speed}<br>t/p ${shown(ratio[i][j])}, ` +
    `p ${shown(p[i][j])} ${u.traction}<br>slip ${shown(slip[i][j])} ${u.slip}`);
  return run.texts;
}

function heatmap(run) {
  const history = historyOf(run);
  const {z, zmin, zmax, tickvals, ticktext} = coloursOf(run, field);
  const {label, colours, reversed} = FIELDS[field];
  return {
    type: 'heatmap', name: field, x: history.x, y: history.time, z, zmin, zmax, text: cellTexts(run),
    hovertemplate: `x = %{x:.4g} ${run.units.x}, t = %{y:.4g} ${run.units.time}<br>%{text}<extra></extra>`,
    colorscale: colours, reversescale: Boolean(reversed), hoverongaps: false,
    colorbar: {title: {text: label(run.units), side: 'right'}, thickness: 16, tickvals, ticktext},
  };
}

/** A line on a wider white one, which is seen on any colour. */
function outlined(trace) {
  const {x, y, mode, legendgroup, line} = trace;
  return [{type: 'scatter', x, y, mode, legendgroup, showlegend: false, hoverinfo: 'skip', line: {color: '#fff', width: line.width + 2}}, trace];
}

function wavePaths(run) {
  if (!run.origin) return [];
  const [x0, t0] = run.origin;
  const [left, right] = [run.history.x[0], run.history.x.at(-1)];
  return run.waves.flatMap((wave) => outlined({
    type: 'scatter', mode: 'lines', name: `${waveName(wave.name)} = ${wave.m_per_s.toFixed(0)} m/s`,
    x: [left, x0, right], y: [t0 + (x0 - left) / wave.slope, t0, t0 + (right - x0) / wave.slope], legendgroup: wave.name,
    line: {color: waveColour(wave.name, '#333'), width: 1.5, dash: WAVE_DASHES[wave.name]}, hoverinfo: 'skip', meta: {wave: wave.name},
  }));
}

function frontPaths(run) {
  return run.fronts.flatMap((front, k) => outlined({
    type: 'scatter', mode: 'lines', name: front.label, x: front.x, y: front.time, meta: {front: k},
    line: {color: front.colour, width: front.main ? 3 : 1.8}, hoverinfo: 'none', legendgroup: `front ${k}`,
  }));
}

const openPatch = {type: 'scatter', mode: 'markers', name: 'contact open', x: [null], y: [null], hoverinfo: 'skip',
  marker: {symbol: 'square', size: 12, color: OPEN}};
const mark = {type: 'scatter', mode: 'markers', name: 'marked', x: [], y: [], showlegend: false, hoverinfo: 'skip',
  marker: {symbol: 'circle-open', size: 16, color: '#111', line: {width: 3}}, meta: {mark: true}};

function drawSpaceTime() {
  if (!byId('space-time-plot')) return null;
  const run = current;
  const history = historyOf(run);
  const [first, last] = [history.time[0], history.time.at(-1)];
  const layout = layoutWith({
    xaxis: xAxis(run, {range: [history.x[0], history.x.at(-1)], showgrid: false}),
    yaxis: axis(`t (${run.units.time})`, {range: [first, last], showgrid: false}), plot_bgcolor: OPEN,
    legend: {x: 1.16, y: 1, font: {size: 13}},
  });
  const traces = [heatmap(run), ...wavePaths(run), ...frontPaths(run), openPatch, mark];
  return Plotly.react('space-time-plot', traces, layout, CONFIG);
}

function chooseField(name) {
  field = name;
  document.querySelectorAll('[data-field]').forEach((button) =>
    button.setAttribute('aria-pressed', String(button.dataset.field === name)));
  return drawSpaceTime();
}

/** Nothing where all fields are the same everywhere. */
function startSpaceTime() {
  if (!byId('space-time-plot')) return null;
  const drawn = chooseField(field);
  document.querySelectorAll('[data-field]').forEach((button) =>
    button.addEventListener('click', () => chooseField(button.dataset.field)));
  const plot = byId('space-time-plot');
  plot.on('plotly_click', ({points: [point]}) => {
    const history = historyOf(current);
    showProfile(nearest(history.time, point.y));
  });
  plot.on('plotly_hover', ({points: [point]}) => {
    if (point.data.meta?.front !== undefined) highlight(current, point.data.meta.front, point.pointNumber);
  });
  return drawn;
}

/** Marks a node of a front of the run that is shown; nothing for another run. */
function markSpaceTime(run, front, point) {
  const plot = byId('space-time-plot');
  if (!plot?.data) return;
  const index = plot.data.findIndex((trace) => trace.meta?.mark);
  const here = run === current && front !== null ? run.fronts[front] : null;
  Plotly.restyle(plot, {x: [here ? [here.x[point]] : []], y: [here ? [here.time[point]] : []]}, [index]);
}

/** A line at a time. */
function markTime(time) {
  if (!byId('space-time-plot')) return;
  const line = {type: 'line', xref: 'paper', x0: 0, x1: 1, y0: time, y1: time};
  const shapes = [{...line, line: {color: '#fff', width: 3}}, {...line, line: {color: '#111', width: 1, dash: 'dot'}}];
  Plotly.relayout('space-time-plot', {shapes});
}
