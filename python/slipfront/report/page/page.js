// Draws all plots, and again where another run of the page is chosen.

function chooseRun(index) {
  current = data.runs[index];
  return Promise.all([drawSpaceTime(), resetProfiles(), drawEnergy(), resetSnapshots()]);
}

/** Pages with several runs have a list of them. */
function startRuns() {
  const list = byId('run');
  if (!list) return;
  list.replaceChildren(...data.runs.map((run, k) => new Option(run.name, String(k))));
  list.addEventListener('change', () => chooseRun(Number(list.value)));
}

async function start() {
  startRuns();
  await Promise.all([startSpaceTime(), startProfiles(), startCriteria(), startFracture(), drawEnergy(), startSnapshots(), startProbes(),
    startSequence()]);
  document.body.dataset.drawn = 'all';
}

start().catch((error) => {
  document.body.dataset.drawn = 'failed';
  const told = document.createElement('p');
  told.textContent = `This browser cannot draw the page: ${error.message}`;
  document.querySelector('h1').after(told);
  throw error;
});
