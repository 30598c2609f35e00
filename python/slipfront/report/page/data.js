// The page's numbers, and what all plots share.

const data = JSON.parse(document.getElementById('data').textContent);
const byId = (id) => document.getElementById(id);

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
}

/** The value of a half-precision number, which not every browser can read from an array. */
function half(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 0x1f;
  const fraction = bits & 0x3ff;
  if (exponent === 0) return sign * 2 ** -24 * fraction;
  return sign * 2 ** (exponent - 15) * (1 + fraction / 1024);
}

/** Rows of numbers. [times][nodes] */
function unpacked(packed) {
  const bytes = bytesOf(packed.f2);
  const view = new DataView(bytes.buffer);
  const [nRows, nColumns] = packed.shape;
  return Array.from({length: nRows}, (_, row) => Float64Array.from({length: nColumns},
    (_, column) => packed.largest * half(view.getUint16(2 * (row * nColumns + column), true))));
}

/** A number with three digits, as a person would write it. */
function shown(value) {
  if (value === null || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(2);
  return String(Number(value.toPrecision(3)));
}

/** [rows][columns] of a function of both. */
const table = (rows, f) => rows.map((row, i) => Array.from(row, (value, j) => f(value, i, j)));

/** A run's history, unpacked when it is first looked at; t/p is null where the contact is open. */
function historyOf(run) {
  if (!run.unpacked) {
    const [slip_rate, slip, t, p] = ['slip_rate', 'slip', 't', 'p'].map((name) => unpacked(run.history[name]));
    const ratio = table(t, (value, i, j) => (p[i][j] > 0 ? value / p[i][j] : null));
    run.unpacked = {slip_rate, slip, t, p, ratio, x: run.history.x, time: run.history.time};
  }
  return run.unpacked;
}

/** The number that a share of all numbers is below; null ones do not count. */
function signedQuantile(rows, share) {
  const all = rows.flatMap((row) => Array.from(row)).filter((v) => v !== null).sort((a, b) => a - b);
  return all.length ? all[Math.min(all.length - 1, Math.floor(share * all.length))] : 0;
}

/** The same of magnitudes. */
const quantile = (rows, share) => signedQuantile(table(rows, (v) => (v === null ? null : Math.abs(v))), share);

const CONFIG = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ['autoScale2d']};
const FONT = {family: 'system-ui, sans-serif', size: 14, color: '#111'};
const OPEN = '#cccccc';
const LOW_SHARE = 0.005; // of the numbers of a diagram that may lie below its axis
const WAVE_DASHES = {c_L: 'solid', c_S: 'dash', c_R: 'dot', c_GR: 'dashdot', 'c_L of the base': 'solid', 'c_S of the base': 'dash'};
const BASE_COLOUR = '#a0522d';
const waveColour = (wave, own) => (wave.endsWith('base') ? BASE_COLOUR : own);

/** c_GR and `c_L of the base` with their subscripts. */
const waveName = (wave) => wave.replace(/^c_(\w+)/, 'c<sub>$1</sub>');

function layoutWith(more) {
  return {font: FONT, paper_bgcolor: '#fff', plot_bgcolor: '#fff', margin: {l: 80, r: 20, t: 40, b: 60},
    hoverlabel: {font: {size: 14}}, ...more};
}

function axis(title, more) {
  return {title: {text: title}, ticks: 'outside', showline: true, mirror: 'all', linecolor: '#555', zeroline: false,
    gridcolor: '#e4e4e4', ...more};
}

const xAxis = (run, more) => axis(`x (${run.units.x})`, more);
const triangle = (direction) => (direction > 0 ? 'triangle-right' : 'triangle-left');

/** The run that the page shows now, of those it has; none on the page of a sequence. */
let current = data.runs[0];
