// Front speed against position and three criteria. A node that is pointed at is marked wherever it is drawn.

const LABELS = {
  x: (run) => `x (${run.units.x})`,
  static: () => 'static ratio t<sub>s</sub>/p<sub>s</sub>',
  dynamic: () => 'dynamic ratio t<sub>d</sub>/p<sub>d</sub>',
  rise: () => 'rise of the energy density (U<sub>r</sub> − U<sub>s</sub>)/U<sub>s</sub>',
};
let unfolded = !data.folded;

/** Those of the page that are shown now. */
const panelsNow = () => (data.panels ?? []).slice(0, unfolded ? undefined : 1)
  .map((measure, k) => ({measure, value: 'v', axis: k === 0 ? '' : String(k + 1), label: LABELS[measure]}));
const PALE = 0.22;
let pinned = false;

/** All fronts of the page, of all its runs, main fronts last, so that they are on top. */
const everyFront = data.runs.flatMap((run) => run.fronts.map((_, front) => ({run, front})))
  .sort((a, b) => a.run.fronts[a.front].main - b.run.fronts[b.front].main);

function pointsOf({run, front}, panel, isFirst) {
  const f = run.fronts[front];
  return {
    type: 'scatter', mode: 'markers', name: run.name ? `${run.name}: ${f.label}` : f.label, x: f[panel.measure], y: f[panel.value],
    xaxis: `x${panel.axis}`, yaxis: `y${panel.axis}`, legendgroup: `${run.name}:${f.id}`, showlegend: isFirst,
    marker: {color: f.colour, symbol: f.symbol, size: f.main ? 5 : 4, opacity: f.counts.map((c) => (c ? 0.9 : PALE))},
    selected: {marker: {opacity: 1, size: 9}}, unselected: {marker: {opacity: 0.08}},
    hoverinfo: 'none', meta: {run: data.runs.indexOf(run), front},
  };
}

function lineIn(panel, name, x, y, line, more) {
  return {type: 'scatter', mode: 'lines', name, x, y, xaxis: `x${panel.axis}`, yaxis: `y${panel.axis}`, line,
    hoverinfo: 'skip', ...more};
}

function waveLevels(run, panel, isFirst) {
  return run.waves.filter((wave) => wave.over_c_L <= topSpeed()).map(({name, over_c_L}) =>
    lineIn(panel, waveName(name), [-1e6, 1e6], [over_c_L, over_c_L],
      {color: waveColour(name, '#555'), width: 1, dash: WAVE_DASHES[name]}, {legendgroup: name, showlegend: isFirst}));
}

/** The paper's law and others of its form, where the page has them: V/c_L = a + b exp(-c sqrt(rise)). */
function fitCurves(panel) {
  if (panel.measure !== 'rise') return [];
  const r = Array.from({length: 200}, (_, k) => 5 * (k / 199) ** 2);
  return (data.fits ?? []).map(({name, a, b, c, colour, dash}) =>
    lineIn(panel, name, r, r.map((v) => a + b * Math.exp(-c * Math.sqrt(v))), {color: colour, dash, width: 2}));
}

function panelMark(panel) {
  return {...mark, xaxis: `x${panel.axis}`, yaxis: `y${panel.axis}`, meta: {mark: panel}};
}

const countedValues = (measure) => everyFront.flatMap(({run, front}) => {
  const f = run.fronts[front];
  return f[measure].filter((v, k) => v !== null && f.v[k] !== null && (f.counts[k] || !f.main));
});
const most = (values, fallback) => values.reduce((a, b) => Math.max(a, b), -Infinity) || fallback;

/** End of the axes of the speed over c_L. */
function topSpeed() {
  const v = most(countedValues('v'), 1);
  return Math.min(Math.max(1.15, 1.08 * (Number.isFinite(v) ? v : 1)), data.runs[0].highest_v);
}

function criteriaLayout(panels) {
  const run = data.runs[0];
  const top = topSpeed();
  const ranges = {x: [run.static.x[0], run.static.x.at(-1)]};
  for (const measure of ['static', 'dynamic', 'rise']) {
    const right = most(countedValues(measure), 1);
    ranges[measure] = [0, Math.min(Number.isFinite(right) ? 1.05 * right : 1, measure === 'rise' ? run.largest_rise : 1e9)];
  }
  const rows = panels.length > 3 ? 2 : 1;
  const columns = Math.ceil(panels.length / rows);
  byId('criteria-plot').style.height = rows > 1 ? '46em' : '28em';
  const layout = layoutWith({grid: {rows, columns, pattern: 'independent', xgap: 0.12, ygap: 0.3},
    legend: {orientation: 'h', y: rows > 1 ? -0.17 : -0.3}, dragmode: 'zoom', hovermode: 'closest'});
  for (const panel of panels) {
    layout[`xaxis${panel.axis}`] = axis(panel.label(run), {range: ranges[panel.measure]});
    layout[`yaxis${panel.axis}`] = axis('V<sub>tip</sub> / c<sub>L</sub>', {range: [0, top], ...(panel.axis && {matches: 'y'})});
  }
  return layout;
}

function drawCriteria() {
  const panels = panelsNow();
  const traces = panels.flatMap((panel, k) => [
    ...waveLevels(data.runs[0], panel, k === 0), ...fitCurves(panel),
    ...everyFront.map((which) => pointsOf(which, panel, k === 0)), panelMark(panel)]);
  const config = {...CONFIG, modeBarButtonsToAdd: ['select2d', 'lasso2d']};
  return Plotly.react('criteria-plot', traces, criteriaLayout(panels), config);
}

function pointWords(run, front, point) {
  const f = run.fronts[front];
  const speed = f.v[point];
  const inMetres = speed === null ? '–' : `${shown(speed * run.waves[0].m_per_s)} m/s = ${shown(speed)} c_L`;
  return `${run.name ? `${run.name}, ` : ''}${f.label}: x = ${shown(f.x[point])} ${run.units.x} at ` +
    `t = ${shown(f.time[point])} ${run.units.time}; V_tip = ${inMetres}; t_s/p_s = ${shown(f.static[point])}, ` +
    `t_d/p_d = ${shown(f.dynamic[point])}, (U_r − U_s)/U_s = ${shown(f.rise[point])}` +
    (f.gamma ? `; Γ = ${shown(f.gamma[point])} J/m², G by slip = ${shown(f.g_slip[point])} J/m²` : '');
}

/** Marks a node of a front in every panel and in the diagram over space and time. */
function highlight(run, front, point) {
  const plots = ['criteria-plot', 'fracture-plot'].map(byId).filter((plot) => plot?.data);
  if (plots.length === 0 || pinned) return;
  const f = run.fronts[front];
  for (const plot of plots) {
    const marks = plot.data.map((trace, k) => [trace.meta?.mark, k]).filter(([panel]) => panel);
    const places = marks.map(([{measure, value}]) => [f[measure][point], f[value][point]])
      .map((place) => (place.includes(null) ? [[], []] : place.map((v) => [v])));
    Plotly.restyle(plot, {x: places.map(([x]) => x), y: places.map(([, y]) => y)}, marks.map(([, k]) => k));
  }
  for (const readout of document.querySelectorAll('.readout')) readout.textContent = pointWords(run, front, point);
  markSpaceTime(run, front, point);
}

/** Nodes that are pointed at or clicked in a plot are marked. */
function startMarking(plot) {
  const mark = ({points}) => {
    const point = points.find(({data: {meta}}) => meta?.front !== undefined);
    if (point) highlight(data.runs[point.data.meta.run], point.data.meta.front, point.pointNumber);
    return Boolean(point);
  };
  plot.on('plotly_hover', mark);
  plot.on('plotly_click', (event) => {
    pinned = false;
    pinned = mark(event);
  });
  plot.on('plotly_doubleclick', () => { pinned = false; });
}

/** The points that were selected in one panel are selected in all; null: none is. */
function selectEverywhere(points) {
  const plot = byId('criteria-plot');
  const chosen = {};
  for (const {data: {meta}, pointNumber} of points ?? []) if (meta?.front !== undefined) (chosen[`${meta.run}:${meta.front}`] ??= []).push(pointNumber);
  const drawn = plot.data.map((trace, k) => [trace.meta, k]).filter(([meta]) => meta?.front !== undefined);
  const selected = drawn.map(([meta]) => (points ? chosen[`${meta.run}:${meta.front}`] ?? [] : null));
  Plotly.restyle(plot, {selectedpoints: selected}, drawn.map(([, k]) => k));
}

/** Nothing where no front has a speed. */
function startCriteria() {
  if (!byId('criteria-plot')) return null;
  byId('criteria-more')?.addEventListener('click', ({currentTarget}) => {
    unfolded = !unfolded;
    currentTarget.setAttribute('aria-pressed', String(unfolded));
    drawCriteria();
  });
  const drawn = drawCriteria();
  const plot = byId('criteria-plot');
  startMarking(plot);
  plot.on('plotly_selected', (event) => selectEverywhere(event?.points ?? null));
  plot.on('plotly_deselect', () => selectEverywhere(null));
  return drawn;
}
