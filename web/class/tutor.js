/** The tiles of a class: what each student's world does now. */
const PERIOD = 2000;

/** @type {Map<string, {tile: HTMLElement, set: (student: any) => void}>} */
const tiles = new Map();
const part = (id) => document.getElementById(id);

function element(tag, text = '', className = '') {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}

async function act(name, action) {
  await fetch(`students/${encodeURIComponent(name)}/${action}`, {method: 'POST'});
  await refresh();
}

/** The address of a student's editor, under the name by which this page was opened. */
function join(link) {
  const url = new URL(link);
  url.hostname = location.hostname;
  return url.href;
}

function makeTile(name) {
  const tile = element('article');
  const list = element('dl');
  const values = Object.fromEntries(['State', 'World', 'Sim time', 'Real time factor', 'Browsers', 'Memory', 'Mark']
    .map((label) => {
      const value = element('dd');
      list.append(element('dt', label), value);
      return [label, value];
    }));
  const error = element('p', '', 'error');
  const picture = element('img');
  const link = element('a', 'Join');
  link.target = '_blank';
  link.rel = 'noopener noreferrer';
  const start = element('button', 'Start');
  const stop = element('button', 'Stop');
  start.addEventListener('click', () => act(name, 'start'));
  stop.addEventListener('click', () => act(name, 'stop'));
  tile.append(element('h2', name), picture, list, error, link, start, stop);
  const set = (student) => {
    const runs = student.state === 'running';
    picture.alt = runs ? `World of ${name}` : '';
    // Tiles outside of the window load no pictures.
    const {top, bottom} = tile.getBoundingClientRect();
    if (!runs) picture.removeAttribute('src');
    else if (bottom > 0 && top < innerHeight) picture.src = `students/${encodeURIComponent(name)}/picture.svg?at=${Date.now()}`;
    tile.className = student.error ? `${student.state} fault` : student.state;
    values.State.textContent = runs && student.paused ? 'paused' : student.state;
    values.World.textContent = student.world ? `${student.world}, ${student.models} models` : '–';
    values['Sim time'].textContent = runs ? `${student.time.toFixed(1)} s` : '–';
    values['Real time factor'].textContent = runs && !student.paused ? student.factor.toFixed(2) : '–';
    values.Browsers.textContent = String(student.people);
    values.Memory.textContent = `${Math.round(student.memory_mb)} MB`;
    const mark = element('a', student.mark ? `${student.mark.points} of ${student.mark.most}` : '–');
    if (student.mark) mark.href = `marks/students/${encodeURIComponent(name)}/index.html`;
    values.Mark.replaceChildren(mark);
    error.textContent = student.error || student.reason;
    link.href = join(student.link);
    start.disabled = runs || student.state === 'starting';
    stop.disabled = !runs && student.state !== 'starting';
  };
  part('tiles').append(tile);
  return {tile, set};
}

async function refresh() {
  try {
    const answer = await fetch('status.json');
    if (!answer.ok) throw new Error(await answer.text());
    const found = await answer.json();
    document.title = found.class;
    part('name').textContent = found.class;
    for (const student of found.students) {
      if (!tiles.has(student.name)) tiles.set(student.name, makeTile(student.name));
      tiles.get(student.name).set(student);
    }
    part('note').textContent = '';
  } catch (fault) {
    part('note').textContent = `The class does not answer: ${fault.message}`;
  }
}

refresh();
setInterval(refresh, PERIOD);
