// Magnitude of the particle velocity in the bodies, snapshot by snapshot.

const EMPTY = 255; // code of a pixel without material
const SCALE_END = 254;
const FRAME_MS = 350;
/** Matplotlib's magma, whose lightness tells the speed without colours. */
const DARK_TO_LIGHT = [[0, '#000004'], [0.125, '#1d1147'], [0.25, '#51127c'], [0.375, '#832681'], [0.5, '#b73779'],
  [0.625, '#e75263'], [0.75, '#fc8961'], [0.875, '#fec488'], [1, '#fcfdbf']];
let frame = 0;
let player = null;

const speedOf = (code, largest) => largest * (code / SCALE_END) ** 2;
const codeOf = (speed, largest) => SCALE_END * Math.sqrt(speed / largest);

/** Codes of a frame by rows, null without material. */
function rowsOf(snapshots, index) {
  const shown = snapshots.frames[index];
  const width = snapshots.x.length;
  shown.rows ??= ((bytes) => snapshots.y.map((_, row) => Array.from(bytes.subarray(row * width, (row + 1) * width),
    (code) => (code === EMPTY ? null : code))))(bytesOf(shown.codes));
  return shown.rows;
}

function tipTrace(snapshots, index) {
  const {tips} = snapshots.frames[index];
  return {type: 'scatter', mode: 'markers', x: tips.map((tip) => tip.x), y: tips.map(() => 0), text: tips.map((tip) => tip.label),
    hovertemplate: '%{text}<extra></extra>', cliponaxis: false,
    marker: {symbol: tips.map((tip) => triangle(tip.direction)), size: 15, color: tips.map((tip) => tip.colour), line: {color: '#fff', width: 2}}};
}

function drawSnapshot() {
  const {snapshots, units} = current;
  const largest = snapshots.largest;
  const rows = rowsOf(snapshots, frame);
  const ticks = [0, 0.1, 0.25, 0.5, 1].map((share) => Number((share * largest).toPrecision(2))).map((v) => Math.min(v, largest));
  const picture = {type: 'heatmap', x: snapshots.x, y: snapshots.y, z: rows, zmin: 0, zmax: SCALE_END, colorscale: DARK_TO_LIGHT,
    text: table(rows, (code) => (code === null ? '' : shown(speedOf(code, largest)))), hoverongaps: false,
    hovertemplate: `x = %{x:.4g}, y = %{y:.4g} ${units.x}<br>%{text} ${units.speed}<extra></extra>`,
    colorbar: {title: {text: `particle velocity |v| (${units.speed})`, side: 'right'}, thickness: 16, tickvals: ticks.map((v) => codeOf(v, largest)),
      ticktext: ticks.map((v, k) => (k === ticks.length - 1 ? `≥ ${shown(v)}` : shown(v)))}};
  const side = snapshots.x[1] - snapshots.x[0];
  const layout = layoutWith({
    xaxis: axis(`x (${units.x})`, {range: [snapshots.x[0] - side, snapshots.x.at(-1) + side], constrain: 'domain', showgrid: false}),
    yaxis: axis(`y (${units.x})`, {range: [snapshots.y[0] - side, snapshots.y.at(-1) + side], scaleanchor: 'x', constrain: 'domain', showgrid: false}),
    shapes: snapshots.two_bodies ? [{type: 'line', xref: 'paper', x0: 0, x1: 1, y0: 0, y1: 0, line: {color: '#fff', width: 1}}] : [],
    margin: {l: 80, r: 20, t: 40, b: 60}, uirevision: 'same', showlegend: false,
  });
  return Plotly.react('snapshots-plot', [picture, tipTrace(snapshots, frame)], layout, CONFIG);
}

function showFrame(index) {
  const {snapshots, units} = current;
  frame = index;
  byId('snapshots-time').value = index;
  byId('snapshots-now').textContent = `${shown(snapshots.frames[index].time)} ${units.time}`;
  return drawSnapshot();
}

function stop() {
  clearInterval(player);
  player = null;
  byId('snapshots-play').textContent = 'play';
}

function play() {
  if (player) return stop();
  byId('snapshots-play').textContent = 'stop';
  player = setInterval(() => showFrame((frame + 1) % current.snapshots.frames.length), FRAME_MS);
}

function resetSnapshots() {
  if (!byId('snapshots-plot')) return null;
  if (player) stop();
  byId('snapshots-time').max = current.snapshots.frames.length - 1;
  return showFrame(current.snapshots.opening);
}

function startSnapshots() {
  if (!byId('snapshots-plot')) return null;
  byId('snapshots-time').addEventListener('input', (event) => { if (player) stop(); showFrame(Number(event.target.value)); });
  byId('snapshots-play').addEventListener('click', play);
  return resetSnapshots();
}
