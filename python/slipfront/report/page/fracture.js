// Energy release rate against fracture energy, and the speeds that these predict.

const ENERGIES = {measure: 'x', value: 'gamma', axis: ''};
const SPEEDS = {measure: 'x', value: 'v', axis: '2'};

function predictedCurves({x, at_rest, v, arrests}) {
  return [
    lineIn(ENERGIES, 'G at rest, predicted', x, at_rest, {color: '#111', width: 1, dash: 'dash'}),
    lineIn(SPEEDS, 'V<sub>tip</sub>, predicted', x, v, {color: '#111', width: 2}),
    ...(arrests.length ? [{...lineIn(SPEEDS, 'arrest, predicted', arrests, arrests.map(() => 0)), mode: 'markers', cliponaxis: false,
      marker: {symbol: 'x', size: 11, color: '#111'}}] : []),
  ];
}

/** Nothing where no front's breakdown came to its end. */
function startFracture() {
  const plot = byId('fracture-plot');
  if (!plot) return null;
  const run = data.runs[0];
  const {prediction, is_log, range} = run.fracture;
  const bySlip = run.fronts.filter((f) => f.g_slip.some((g) => g !== null)).map((f, k) =>
    lineIn(ENERGIES, 'G by slip', f.x, f.g_slip, {color: f.colour, width: 1.5}, {legendgroup: 'g_slip', showlegend: k === 0}));
  const waves = waveLevels(run, SPEEDS, true).map((wave) => ({...wave, legendrank: 1001}));
  const fronts = (panel, isFirst) => [...everyFront.map((which) => pointsOf(which, panel, isFirst)), panelMark(panel)];
  const traces = [...fronts(ENERGIES, true), ...bySlip, ...waves, ...fronts(SPEEDS, false),
    ...(prediction ? predictedCurves(prediction) : [])];
  const x = {range: [run.static.x[0], run.static.x.at(-1)]};
  const layout = layoutWith({
    xaxis: axis('', {...x, anchor: 'y', matches: 'x2', showticklabels: false}),
    xaxis2: axis(`x (${run.units.x})`, {...x, anchor: 'y2'}),
    yaxis: axis('Γ, G (J/m²)', {domain: [0.53, 1], range: is_log ? range.map(Math.log10) : range, type: is_log ? 'log' : 'linear'}),
    yaxis2: axis('V<sub>tip</sub> / c<sub>L</sub>', {domain: [0, 0.47], anchor: 'x2', range: [0, topSpeed()]}),
    legend: {x: 1.02, y: 1}, hovermode: 'closest',
  });
  const drawn = Plotly.newPlot(plot, traces, layout, CONFIG);
  startMarking(plot);
  return drawn;
}
