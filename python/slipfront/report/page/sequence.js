// Loads, extents, slip and slip rates of a sequence of events.

const eventWords = (event) => `event ${event.number}`;
const forceRatio = 'F<sub>S</sub> / F<sub>N</sub>';

/** Markers of the events, filled as their colour. */
function eventMarks(name, events, x, y, symbol, told) {
  return {type: 'scatter', mode: 'markers', name, x: events.map(x), y: events.map(y), text: events.map((event) => `${eventWords(event)} ${told}`),
    marker: {symbol, size: 9, color: events.map(({colour}) => colour), line: {color: '#111', width: 1}}, cliponaxis: false,
    hovertemplate: '%{text}: %{y:.4f} at %{x:.5g}<extra></extra>'};
}

/** The loads over time in one of the two panels. */
function loads({loading, events}, panel, values, before, after) {
  const line = {type: 'scatter', mode: 'lines', name: 'equilibria', x: loading.time, y: values, hoverinfo: 'skip',
    line: {color: '#555', width: 1.5}};
  const traces = [line, eventMarks('event begins', events, (e) => e.time, before, 'circle', 'begins'),
    eventMarks('at rest', events, (e) => e.time, after, 'circle-open', 'at rest')];
  return traces.map((trace) => ({...trace, xaxis: `x${panel}`, yaxis: `y${panel}`, showlegend: panel === ''}));
}

function drawForces(sequence) {
  const {units, loading, strength} = sequence;
  const traces = [...loads(sequence, '', loading.ratio, (e) => e.before, (e) => e.after),
    ...loads(sequence, '2', loading.force, (e) => e.force_before, (e) => e.force_after)];
  if (strength !== null) {
    traces.push({type: 'scatter', mode: 'lines', name: 'μ<sub>s</sub> of a node', x: [loading.time[0], loading.time.at(-1)], y: [strength, strength],
      hoverinfo: 'skip', line: {color: '#555', width: 1, dash: 'dash'}});
  }
  const time = `t since normal loading (${units.time})`;
  const layout = layoutWith({
    xaxis: axis(time, {domain: [0, 0.45], anchor: 'y'}), yaxis: axis(forceRatio, {rangemode: 'tozero'}),
    xaxis2: axis(time, {domain: [0.56, 1], anchor: 'y2'}), yaxis2: axis(`F<sub>S</sub> (${units.force})`, {rangemode: 'tozero', anchor: 'x2'}),
    hovermode: 'closest', legend: {x: 1.02, y: 1},
  });
  return Plotly.react('forces-plot', traces, layout, CONFIG);
}

/** Where the events slip, in one of the two panels: bars of a width in units of its axis. */
function extents(events, x, panel, width, unit) {
  return {type: 'bar', x: events.map(x), y: events.map(({from, to}) => to - from), base: events.map(({from}) => from), width,
    xaxis: `x${panel}`, yaxis: 'y', showlegend: false, marker: {color: events.map(({colour}) => colour), line: {width: 0}}, meta: {panel},
    hovertext: events.map((event) => `${eventWords(event)}: x = ${shown(event.from)} to ${shown(event.to)} ${unit}`),
    hovertemplate: '%{hovertext}<extra></extra>'};
}

function drawExtents({units, slip, events}) {
  const ratios = events.map((event) => event.before);
  const spread = most(ratios, 1) + most(ratios.map((ratio) => -ratio), 0);
  const panels = [['', (e) => e.before, 0.015 * spread || 0.01], ['2', (e) => e.number, 0.4]];
  const begins = (x, panel) => ({...eventMarks('slip begins', events, x, (e) => e.begin, 'diamond', 'begins'), xaxis: `x${panel}`, yaxis: 'y',
    marker: {symbol: 'diamond', size: 8, color: '#fff', line: {color: '#111', width: 1}}, showlegend: panel === '',
    hovertemplate: `%{text} at x = %{y:.4g} ${units.x}<extra></extra>`});
  const traces = panels.flatMap(([panel, x, width]) => [extents(events, x, panel, width, units.x), begins(x, panel)]);
  const layout = layoutWith({
    xaxis: axis(`${forceRatio} where the event begins`, {domain: [0, 0.48], anchor: 'y'}),
    xaxis2: axis('event', {domain: [0.52, 1], anchor: 'y', range: [0.5, events.length + 0.5], tickformat: 'd'}),
    yaxis: axis(`x (${units.x})`, {range: [slip.x[0], slip.x.at(-1)]}), barmode: 'overlay', hovermode: 'closest', legend: {x: 1.02, y: 1},
  });
  return Plotly.react('extents-plot', traces, layout, CONFIG);
}

function drawSlips({units, slip, events}) {
  const drawn = slip.events.map((number) => events[number - 1]);
  const traces = drawn.map((event, k) => ({type: 'scatter', mode: 'lines', name: `after ${eventWords(event)}`, x: slip.x, y: slip.after[k],
    line: {color: event.colour, width: 1.5}, meta: {event: event.number},
    hovertemplate: `after ${eventWords(event)}: %{y:.4g} ${units.slip} at x = %{x:.4g} ${units.x}<extra></extra>`}));
  const layout = layoutWith({xaxis: axis(`x (${units.x})`, {range: [slip.x[0], slip.x.at(-1)]}), yaxis: axis(`slip so far (${units.slip})`, {rangemode: 'tozero'}),
    hovermode: 'closest', legend: {x: 1.02, y: 1}});
  return Plotly.react('slips-plot', traces, layout, CONFIG);
}

const NO_CONTACT = 255; // code of a node where contact is open
const MOST_LABELS = 24;

/** Slow slip and events alternately, each from a whole number to the next. */
function drawPhases({units, phases, events}) {
  const {x, borders, time, powers: [low, high]} = phases;
  const codes = bytesOf(phases.rates);
  const z = time.map((_, i) => Array.from(codes.subarray(i * x.length, (i + 1) * x.length),
    (code) => (code === NO_CONTACT ? null : low + (high - low) * code / (NO_CONTACT - 1))));
  const told = z.map((row, i) => row.map((v) => `t = ${time[i]} s, ${v === null ? 'open' : `slip rate ${(10 ** v).toExponential(1)} m/s`}`));
  const ticks = powersOfTen(10 ** low, 10 ** high).filter((k) => k % 2 === 0);
  const picture = {type: 'heatmap', x, y: borders, z, zmin: low, zmax: high, text: told, colorscale: FIELDS.slip_rate.colours, reversescale: true,
    hovertemplate: `x = %{x:.4g} ${units.x}, %{text}<extra></extra>`, hoverongaps: false,
    colorbar: {title: {text: 'slip rate |v| (m/s)', side: 'right'}, thickness: 16, tickvals: ticks, ticktext: ticks.map((k) => `10<sup>${k}</sup>`)}};
  const named = events.filter((_, k) => k % Math.ceil(events.length / MOST_LABELS) === 0);
  const shapes = Array.from({length: borders.at(-1) - 1}, (_, k) => ({type: 'line', xref: 'paper', x0: 0, x1: 1, y0: k + 1, y1: k + 1,
    line: {color: k % 2 === 0 ? '#d55e00' : '#111', width: 1}}));
  const layout = layoutWith({
    xaxis: axis(`x (${units.x})`, {range: [x[0], x.at(-1)], showgrid: false}),
    yaxis: axis('', {range: [0, borders.at(-1)], showgrid: false, tickvals: named.map(({number}) => 2 * number - 0.5),
      ticktext: named.map((event) => `${eventWords(event)}: ${event.time} ${units.time}`), automargin: true}),
    shapes, plot_bgcolor: OPEN, hovermode: 'closest',
  });
  return Plotly.react('phases-plot', [picture], layout, CONFIG);
}

/** The plots that the page has; nothing on other pages. */
function startSequence() {
  const plots = {'forces-plot': drawForces, 'extents-plot': drawExtents, 'slips-plot': drawSlips, 'phases-plot': drawPhases};
  return Promise.all(Object.entries(plots).filter(([id]) => byId(id)).map(([, draw]) => draw(data.sequence)));
}
