// Records of the probes over time, a panel for each component.

const PROBE_DASHES = ['solid', 'dash', 'dot', 'dashdot'];
let probeChoice = 0;
let probeChange = false;

const drawnChoices = (run) => run.probes.choices.filter(({parts}) => parts.length);

/** [times][probes] of a component, unpacked when it is first looked at. */
const recordOf = (part) => (part.unpacked ??= unpacked(part.values));

/** Whether a component is drawn as its change since the start. */
const isChange = (probes, part) => probeChange || (probes.are_changes && part.before === null);

/** What is added to a record: nothing where it is shown as it is. */
function offsetOf(probes, part, k) {
  if (probes.are_changes) return probeChange ? 0 : part.before ?? 0;
  return probeChange ? -recordOf(part)[0][k] : 0;
}

function probeTrace(run, part, panel, k) {
  const {names, x, y, time} = run.probes;
  const rows = recordOf(part);
  const before = offsetOf(run.probes, part, k);
  return {
    type: 'scatter', mode: 'lines', name: `${names[k]}, x = ${shown(x[k])}, y = ${shown(y[k])} ${run.units.x}`, legendgroup: `probe ${k}`,
    showlegend: panel === 0, x: time, y: rows.map((row) => row[k] + before), xaxis: 'x', yaxis: `y${panel === 0 ? '' : panel + 1}`,
    line: {color: KEPT_COLOURS[k % KEPT_COLOURS.length], width: 1.8, dash: PROBE_DASHES[Math.floor(k / KEPT_COLOURS.length) % PROBE_DASHES.length]},
    hovertemplate: `${names[k]}: %{y:.4g} at %{x:.4g}<extra></extra>`, meta: {probe: k, panel},
  };
}

function drawProbes() {
  const run = data.runs[0];
  const {names, time} = run.probes;
  const {parts, unit} = drawnChoices(run)[probeChoice];
  const layout = layoutWith({legend: {x: 1.02, y: 1}});
  parts.forEach((part, panel) => {
    const top = 1 - panel / parts.length;
    layout[`yaxis${panel === 0 ? '' : panel + 1}`] = axis(`${isChange(run.probes, part) ? 'Δ' : ''}${part.label} (${unit})`,
      {domain: [top - 0.9 / parts.length, top]});
  });
  layout.xaxis = axis(`t (${run.units.time})`, {range: [time[0], time.at(-1)], anchor: parts.length === 1 ? 'y' : `y${parts.length}`});
  const traces = parts.flatMap((part, panel) => names.map((_, k) => probeTrace(run, part, panel, k)));
  return Plotly.react('probes-plot', traces, layout, CONFIG);
}

function chooseProbes(index) {
  probeChoice = index;
  document.querySelectorAll('[data-probes]').forEach((button, k) => button.setAttribute('aria-pressed', String(k === index)));
  return drawProbes();
}

/** Nothing on a page without probes. */
function startProbes() {
  if (!byId('probes-plot')) return null;
  document.querySelectorAll('[data-probes]').forEach((button, k) => button.addEventListener('click', () => chooseProbes(k)));
  byId('probes-change')?.addEventListener('click', ({currentTarget}) => {
    probeChange = !probeChange;
    currentTarget.setAttribute('aria-pressed', String(probeChange));
    drawProbes();
  });
  return drawnChoices(data.runs[0]).length ? chooseProbes(0) : null;
}
