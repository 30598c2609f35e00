// What each term gives to the rest, stacked, and what the books leave open.

function stacked(energy, term, side) {
  const values = term.values.map((v) => (side > 0 ? Math.max(v, 0) : Math.min(v, 0)));
  if (values.every((v) => v === 0)) return null;
  const pattern = term.striped ? {shape: '/', size: 8, solidity: 0.35, fgcolor: '#fff', fillmode: 'replace', bgcolor: term.colour} : undefined;
  return {type: 'scatter', mode: 'lines', name: term.label, legendgroup: term.label, x: energy.time, y: values,
    stackgroup: side > 0 ? 'from' : 'to', line: {color: term.colour, width: 1}, fillcolor: term.colour, fillpattern: pattern,
    hovertemplate: `${term.label}: %{y:.4g} J/m<extra></extra>`, meta: {side}};
}

/** Both sides of every term; a term of both signs is in the legend once. */
function stackedTerms(energy) {
  const seen = new Set();
  return [1, -1].flatMap((side) => energy.terms.map((term) => stacked(energy, term, side))).filter(Boolean).map((trace) => {
    const showlegend = !seen.has(trace.name);
    seen.add(trace.name);
    return {...trace, showlegend};
  });
}

function drawEnergy() {
  if (!byId('energy-plot')) return null;
  const {energy, units} = current;
  const positive = (values) => values.map((v) => (v > 0 ? v : null));
  const line = (name, y, color, dash) => ({type: 'scatter', mode: 'lines+markers', name, x: energy.time, y: positive(y),
    xaxis: 'x', yaxis: 'y2', line: {color, dash, width: 1.5}, marker: {size: 5}, hovertemplate: `${name}: %{y:.2e}<extra></extra>`});
  const traces = [...stackedTerms(energy), line('imbalance / largest term', energy.imbalance, '#cc3311', 'solid'),
    ...(energy.coupling.some((v) => v > 0) ? [line('sub-steps / largest term', energy.coupling, '#555', 'dot')] : [])];
  const note = (text, y, yanchor) => ({text, xref: 'paper', x: 0.01, xanchor: 'left', yref: 'paper', y, yanchor, showarrow: false});
  const layout = layoutWith({
    xaxis: axis(`t (${units.time})`, {anchor: 'y2', range: [energy.time[0], energy.time.at(-1)]}),
    yaxis: axis('energy (J/m)', {domain: [0.4, 1], zeroline: true, zerolinecolor: '#111'}),
    yaxis2: axis('magnitude / largest', {domain: [0, 0.32], type: 'log', range: [-16, 0], exponentformat: 'power', dtick: 4, tickfont: {size: 11}}),
    annotations: [note('▲ comes from', 0.98, 'top'), note('▼ goes into', 0.42, 'bottom')],
    hovermode: 'x unified', legend: {x: 1.02, y: 1},
  });
  return Plotly.react('energy-plot', traces, layout, CONFIG);
}
