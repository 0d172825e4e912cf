// Curves of the page of a solution, and what both scripts use. Everything shown comes from the JSON in #data; text goes
// into text nodes only.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const byId = id => document.getElementById(id);
const number = (x, digits = 6) => x === null ? '–' : String(Number(x.toPrecision(digits)));

// An element with attributes and children; SVG if `tag` starts with "svg:".
function element(tag, attributes = {}, ...children) {
  const node = tag.startsWith('svg:') ? document.createElementNS('http://www.w3.org/2000/svg', tag.slice(4))
                                      : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

const {time, variables} = data;
let range = [Math.min(...extent(time)), Math.max(...extent(time))];
const whole = range;
const shown = new Map();  // index of a variable -> index of its colour
const strokes = slot => ({stroke: `var(--c${slot % 8})`, 'stroke-dasharray': ['', '7 4', '2 3'][Math.floor(slot / 8) % 3]});

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
  return low <= high ? [low, high] : [0, 1];
}

function show(j, isShown) {
  if (!isShown) shown.delete(j);
  else for (let slot = 0; !shown.has(j); ++slot) if (![...shown.values()].includes(slot)) shown.set(j, slot);
}

// About `count` round numbers between low and high, and how to write them.
function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(s => s * power >= raw * 0.999);
  const result = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; ++i) result.push(i * step);
  const digits = Math.max(1, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / step)) + 1);
  return result.map(v => [v, number(Math.abs(v) < step * 1e-6 ? 0 : v, Math.min(digits, 15))]);
}

// Lowest and highest value of every pixel column, in order, where there are more points than pixels.
function thinned(indices, x, values) {
  if (indices.length < 4000) return indices;
  const result = [];
  for (let i = 0; i < indices.length;) {
    const column = Math.floor(x(time[indices[i]]));
    const first = i;
    let low = i, high = i;
    for (; i < indices.length && Math.floor(x(time[indices[i]])) === column; ++i) {
      if (values[indices[i]] < values[indices[low]]) low = i;
      if (values[indices[i]] > values[indices[high]]) high = i;
    }
    result.push(...[...new Set([first, low, high, i - 1])].sort((a, b) => a - b).map(k => indices[k]));
  }
  return result;
}

function drawPanel(unit, members, width, height) {
  const left = 66, right = 12, top = 24, bottom = 24;
  const inside = time.map((_, k) => k).filter(k => time[k] >= range[0] && time[k] <= range[1]);
  const visible = inside.length ? [Math.max(0, inside[0] - 1), ...inside, Math.min(time.length - 1, inside.at(-1) + 1)] : [];
  let [low, high] = extent(members.flatMap(j => extent(inside.map(k => variables[j].values[k]))));
  const margin = (high - low) * 0.06 || Math.abs(high) * 0.1 || 1;
  low -= margin; high += margin;
  const x = t => left + (t - range[0]) / (range[1] - range[0] || 1) * (width - left - right);
  const y = v => top + (high - v) / (high - low) * (height - top - bottom);
  const svg = element('svg:svg', {class: 'panel', viewBox: `0 0 ${width} ${height}`, height, role: 'img', 'data-unit': unit});
  const clip = 'clip' + Math.random().toString(36).slice(2);
  svg.append(element('svg:clipPath', {id: clip},
                     element('svg:rect', {x: left, y: top, width: width - left - right, height: height - top - bottom})));
  for (const [v, text] of ticks(low, high, Math.max(2, height / 55)))
    svg.append(element('svg:line', {class: 'gridline', x1: left, x2: width - right, y1: y(v), y2: y(v)}),
               element('svg:text', {x: left - 8, y: y(v) + 4, 'text-anchor': 'end'}, text));
  for (const [t, text] of ticks(range[0], range[1] === range[0] ? range[0] + 1 : range[1], width / 110))
    svg.append(element('svg:line', {class: 'gridline', x1: x(t), x2: x(t), y1: top, y2: height - bottom}),
               element('svg:text', {x: x(t), y: height - bottom + 17, 'text-anchor': 'middle'}, text));
  svg.append(element('svg:rect', {class: 'axis', fill: 'none', x: left, y: top, width: width - left - right, height: height - top - bottom}));
  const names = members.length > 4 ? `${members.length} variables` : members.map(j => variables[j].name).join(', ');
  svg.append(element('svg:text', {class: 'heading', x: left, y: top - 8}, names + (unit ? `  in ${unit}` : '')),
             element('svg:text', {x: width - right, y: top - 8, 'text-anchor': 'end'}, 'time in s'));
  for (const j of members) {
    let path = '', pen = 'M';
    for (const k of thinned(visible, x, variables[j].values)) {
      const v = variables[j].values[k];
      if (v === null) { pen = 'M'; continue; }
      path += `${pen}${x(time[k]).toFixed(2)} ${y(v).toFixed(2)}`;
      pen = 'L';
    }
    svg.append(element('svg:path', {class: 'curve', d: path, 'clip-path': `url(#${clip})`, 'data-name': variables[j].name, ...strokes(shown.get(j))}));
  }
  const cursor = element('svg:line', {class: 'cursor', y1: top, y2: height - bottom, visibility: 'hidden'});
  const brush = element('svg:rect', {class: 'brush', y: top, height: height - top - bottom, width: 0});
  svg.append(cursor, brush);
  attachMouse(svg, {cursor, brush, x, left, plotWidth: width - left - right, width});
  return svg;
}

function attachMouse(svg, {cursor, brush, x, left, plotWidth, width}) {
  let start = null;
  const at = event => {
    const box = svg.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, ((event.clientX - box.left) * width / box.width - left) / plotWidth));
    return range[0] + share * (range[1] - range[0]);
  };
  svg.addEventListener('pointerdown', event => { start = at(event); svg.setPointerCapture(event.pointerId); });
  svg.addEventListener('pointermove', event => {
    const t = at(event);
    let k = time.reduce((best, tk, i) => Math.abs(tk - t) < Math.abs(time[best] - t) ? i : best, 0);
    while (time[k + 1] === time[k]) ++k;  // after an event
    for (const [name, value] of [['x1', x(time[k])], ['x2', x(time[k])], ['visibility', 'visible']]) cursor.setAttribute(name, value);
    if (start !== null) { brush.setAttribute('x', x(Math.min(start, t))); brush.setAttribute('width', Math.abs(x(t) - x(start))); }
    hover(event, k);
  });
  svg.addEventListener('pointerup', event => {
    const ends = [start, at(event)].sort((a, b) => a - b);
    start = null;
    brush.setAttribute('width', 0);
    if (ends[1] - ends[0] > (range[1] - range[0]) * 0.01) { range = ends; draw(); byId('values').style.display = 'none'; }
  });
  svg.addEventListener('pointerleave', () => { cursor.setAttribute('visibility', 'hidden'); byId('values').style.display = 'none'; });
  svg.addEventListener('dblclick', () => { range = whole; draw(); });
}

function hover(event, k) {
  const box = byId('values');
  box.replaceChildren(element('div', {}, element('span', {class: 'name soft'}, 'time'), element('b', {}, number(time[k], 8))));
  for (const [j, slot] of [...shown].slice(0, 24))
    box.append(element('div', {'data-name': variables[j].name}, element('i', {style: `border-color: var(--c${slot % 8})`}),
                       element('span', {class: 'name'}, variables[j].name),
                       element('b', {}, number(variables[j].values[k], 8)), element('span', {class: 'soft'}, variables[j].unit)));
  box.style.display = 'block';
  box.style.left = Math.max(4, event.clientX + 18 + box.offsetWidth > innerWidth ? event.clientX - 18 - box.offsetWidth : event.clientX + 18) + 'px';
  box.style.top = Math.max(4, Math.min(event.clientY + 14, innerHeight - box.offsetHeight - 8)) + 'px';
}

function draw() {
  const units = new Map();
  for (const j of [...shown.keys()].sort((a, b) => a - b)) units.set(variables[j].unit, [...(units.get(variables[j].unit) ?? []), j]);
  const width = Math.max(320, byId('panels').clientWidth), height = units.size > 2 ? 190 : units.size === 2 ? 260 : 420;
  byId('panels').replaceChildren(...[...units].map(([unit, members]) => drawPanel(unit, members, width, height)));
  if (!units.size) byId('panels').append(element('p', {class: 'soft'}, 'Choose variables on the left.'));
  for (const label of byId('chooser').children) {
    const slot = shown.get(Number(label.dataset.index));
    label.querySelector('i').style.borderColor = slot === undefined ? 'transparent' : `var(--c${slot % 8})`;
  }
}

function fillChooser() {
  const varies = v => { const [low, high] = extent(v.values); return high > low; };
  const first = variables.map((v, j) => j).filter(j => !variables[j].discrete && varies(variables[j])).slice(0, 6);
  for (const j of first.length ? first : variables.map((v, j) => j).slice(0, 6)) show(j, true);
  variables.forEach((v, j) => {
    const box = element('input', {type: 'checkbox'});
    box.checked = shown.has(j);
    box.addEventListener('change', () => { show(j, box.checked); draw(); });
    byId('chooser').append(element('label', {'data-index': j, title: v.description}, box, element('i'),
                                   element('span', {class: 'name'}, v.name), element('span', {class: 'unit'}, v.unit)));
  });
  byId('search').addEventListener('input', event => {
    const wanted = event.target.value.toLowerCase();
    variables.forEach((v, j) => {
      byId('chooser').children[j].style.display = (v.name + ' ' + v.description).toLowerCase().includes(wanted) ? '' : 'none';
    });
  });
}

function saveCsv() {
  const field = s => /[",\r\n]/.test(s) ? '"' + s.replaceAll('"', '""') + '"' : s;
  const rows = [['time', ...variables.map(v => field(v.name))], ...time.map((t, k) => [t, ...variables.map(v => v.values[k] ?? 'nan')])];
  const url = URL.createObjectURL(new Blob([rows.map(r => r.join(',') + '\n').join('')], {type: 'text/csv'}));
  element('a', {href: url, download: data.model + '.csv'}).click();
  URL.revokeObjectURL(url);
}
