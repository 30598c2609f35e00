// t/p and slip rate along the interface at the time of the slider.

const KEPT_COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const KEPT_DASHES = ['dash', 'dot', 'dashdot', 'longdash', 'longdashdot', 'solid'];
let kept = [];
let profileIndex = 0;

function nearest(values, value) {
  return values.reduce((best, v, k) => (Math.abs(v - value) < Math.abs(values[best] - value) ? k : best), 0);
}

const timeWords = (run, time) => `${shown(time)} ${run.units.time}`;

function curves(run, index, look, name) {
  const history = historyOf(run);
  const common = {type: 'scatter', mode: 'lines', x: history.x, line: look, legendgroup: name,
    hovertemplate: '%{y:.3g} at %{x:.4g}'};
  return [
    {...common, name, y: Array.from(history.ratio[index])},
    {...common, name, y: Array.from(history.slip_rate[index]), yaxis: 'y2', showlegend: false},
  ];
}

function backgroundCurves(run) {
  const dashes = {mu_s: 'dash', mu_k: 'dot'};
  const names = {mu_s: 'μ<sub>s</sub>', mu_k: 'μ<sub>k</sub>'};
  return [
    {type: 'scatter', mode: 'lines', name: 'before the event', x: run.static.x, y: run.static.ratio,
      line: {color: '#999', width: 3}, hovertemplate: '%{y:.3g} at %{x:.4g}'},
    ...run.static.coefficients.map(({name, x, values}) => ({type: 'scatter', mode: 'lines', name: names[name], x,
      y: values, line: {color: '#555', width: 1, dash: dashes[name]}, hoverinfo: 'skip'})),
  ];
}

/** Where a front is at a time, linear between onsets; null before and after. */
function tipAt(front, time) {
  const k = front.time.findIndex((t) => t >= time);
  if (k < 0 || (k === 0 && front.time[0] > time)) return null;
  if (k === 0) return front.x[0];
  const share = (time - front.time[k - 1]) / ((front.time[k] - front.time[k - 1]) || 1);
  return front.x[k - 1] + share * (front.x[k] - front.x[k - 1]);
}

function tipMarks(run, time) {
  const tips = run.fronts.map((front) => ({front, x: tipAt(front, time)})).filter(({x}) => x !== null);
  return {type: 'scatter', mode: 'markers', name: 'tips', x: tips.map(({x}) => x), y: tips.map(() => lowestRatio(run)), cliponaxis: false,
    text: tips.map(({front}) => front.label), hovertemplate: '%{text}<extra></extra>',
    marker: {symbol: tips.map(({front}) => triangle(front.direction)), size: 13, color: tips.map(({front}) => front.colour),
      line: {color: '#fff', width: 1}}};
}

/** The same axes at all times. */
const lowestRatio = (run) => (run.lowestRatio ??= Math.max(-run.ratio_limit,
  Math.min(0, 1.1 * signedQuantile(historyOf(run).ratio, LOW_SHARE))));

function speedRange(run) {
  const {slip_rate} = historyOf(run);
  const fastest = 1.05 * signedQuantile(slip_rate, 0.999) || 1;
  run.speedRange ??= [Math.min(1.1 * signedQuantile(slip_rate, LOW_SHARE), -0.05 * fastest), fastest];
  return run.speedRange;
}

function drawProfiles() {
  const run = current;
  const history = historyOf(run);
  const time = history.time[profileIndex];
  const [slowest, fastest] = speedRange(run);
  const layout = layoutWith({
    xaxis: xAxis(run, {range: [history.x[0], history.x.at(-1)], anchor: 'y2'}),
    yaxis: axis('t/p', {domain: [0.46, 1], range: [lowestRatio(run), run.ratio_limit]}),
    yaxis2: axis(`slip rate (${run.units.speed})`, {domain: [0, 0.4], range: [slowest, fastest]}),
    legend: {x: 1.02, y: 1}, uirevision: 'same',
  });
  const now = curves(run, profileIndex, {color: '#111', width: 2}, timeWords(run, time));
  const earlier = kept.flatMap((index, k) => curves(run, index,
    {color: KEPT_COLOURS[k % KEPT_COLOURS.length], dash: KEPT_DASHES[k % KEPT_DASHES.length], width: 2},
    timeWords(run, history.time[index])));
  return Plotly.react('profiles-plot', [...backgroundCurves(run), ...earlier, ...now, tipMarks(run, time)], layout, CONFIG);
}

function showProfile(index) {
  profileIndex = index;
  const time = historyOf(current).time[index];
  byId('profiles-time').value = index;
  byId('profiles-now').textContent = timeWords(current, time);
  markTime(time);
  return drawProfiles();
}

function resetProfiles() {
  kept = [];
  byId('profiles-time').max = historyOf(current).time.length - 1;
  return showProfile(nearest(historyOf(current).time, current.opening));
}

function startProfiles() {
  if (!byId('profiles-plot')) return null;
  byId('profiles-time').addEventListener('input', (event) => showProfile(Number(event.target.value)));
  byId('profiles-keep').addEventListener('click', () => { kept = [...new Set([...kept, profileIndex])]; drawProfiles(); });
  byId('profiles-clear').addEventListener('click', () => { kept = []; drawProfiles(); });
  return resetProfiles();
}
