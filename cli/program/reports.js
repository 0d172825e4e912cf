// Reports of the page of a solution; its curves and common functions are in curves.js, which comes before.

// What was kept, dropped, and rounding, of every rank decision, relative to the data on a logarithmic axis.
function drawDecisions(all) {
  const rows = [...all].sort((a, b) => a.gap - b.gap).slice(0, 16);
  const lowest = -18, left = 310, right = 96, line = 22, width = 960, height = rows.length * line + 34;
  const x = v => left + (width - left - right) * (Math.min(2, Math.max(lowest, v > 0 ? Math.log10(v) : lowest)) - lowest) / (2 - lowest);
  const svg = element('svg:svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', id: 'picture'});
  for (let p = lowest; p <= 2; p += 4)
    svg.append(element('svg:line', {class: 'gridline', x1: x(10 ** p), x2: x(10 ** p), y1: 0, y2: height - 26}),
               element('svg:text', {x: x(10 ** p), y: height - 8, 'text-anchor': 'middle'}, p === lowest ? '0' : p === 0 ? '1' : `1e${p}`));
  rows.forEach((d, i) => {
    const y = i * line + 12, unclear = d.verdict === 'unclear' ? ' unclear' : '';
    const text = `level ${d.level}: ${d.subject}, ${d.rows}×${d.columns}, rank ${d.rank}`;
    const group = element('svg:g', {}, element('svg:title', {}, `${text}: kept ${number(d.kept, 3)}, dropped ${number(d.dropped, 3)}, rounding ${number(d.noise, 3)}`));
    group.append(element('svg:text', {x: 0, y: y + 4}, text.length > 52 ? text.slice(0, 51) + '…' : text));
    if (d.kept > 0) group.append(element('svg:line', {class: 'between' + unclear, x1: x(Math.max(d.dropped, d.noise)), x2: x(d.kept), y1: y, y2: y}));
    group.append(element('svg:line', {class: 'noise', x1: x(d.noise), x2: x(d.noise), y1: y - 6, y2: y + 6}),
                 element('svg:line', {class: 'threshold', x1: x(d.threshold), x2: x(d.threshold), y1: y - 8, y2: y + 8}),
                 element('svg:circle', {class: 'dropped', cx: x(d.dropped), cy: y, r: 4}));
    if (d.kept > 0) group.append(element('svg:circle', {class: 'kept', cx: x(d.kept), cy: y, r: 5}));
    group.append(element('svg:text', {x: width - right + 14, y: y + 4}, d.verdict));
    svg.append(group);
  });
  const sign = (shape, text) => element('span', {}, element('svg:svg', {viewBox: '0 0 16 14'}, shape), text);
  byId('decisions').append(
    element('div', {class: 'legend'}, sign(element('svg:circle', {class: 'kept', cx: 8, cy: 7, r: 5}), 'smallest value kept'),
            sign(element('svg:circle', {class: 'dropped', cx: 8, cy: 7, r: 4}), 'largest value dropped'),
            sign(element('svg:line', {class: 'noise', x1: 8, x2: 8, y1: 1, y2: 13}), 'rounding errors'),
            sign(element('svg:line', {class: 'threshold', x1: 8, x2: 8, y1: 0, y2: 14}), 'below this line: zero')), svg);
  if (all.length > rows.length) byId('decisions').append(element('p', {class: 'soft'}, `The ${rows.length} closest of ${all.length} decisions; all are in the report.`));
}

// head: names of columns, numbers right-aligned where a name starts with '#'.
function fillTable(id, head, rows) {
  byId(id).hidden = !rows.length;
  const cells = (tag, row) => row.map((cell, j) => element(tag, head[j].startsWith('#') ? {class: 'number'} : {}, cell));
  byId(id).lastElementChild.append(element('table', {}, element('thead', {}, element('tr', {}, ...cells('th', head.map(h => h.replace('#', ''))))),
                                           element('tbody', {}, ...rows.map(row => element('tr', {}, ...cells('td', row))))));
}

function fillReports() {
  byId('name').textContent = data.model;
  byId('outcome').textContent = data.outcome;
  for (const id of ['outcome', 'message']) byId(id).classList.toggle('solved', data.outcome === 'solved');
  byId('description').textContent = data.description;
  byId('headline').textContent = data.headline.slice(data.model.length + 2);
  byId('message').textContent = data.message;
  byId('message').hidden = !data.message;
  const s = data.statistics, index = data.index;
  const tiles = index ? [[index.differentiation_index ?? '–', 'index'], [index.differential, 'free initial values'], [index.algebraic, 'constraints']] : [];
  tiles.push([s.unknowns, 'unknowns'], [s.eliminated || null, 'found by substitution'], [data.events.length || null, 'events']);
  if (s.steps) tiles.push([s.steps, 'steps'], [s.error_failures + s.other_failures, 'rejected steps']);
  tiles.push([s.evaluations || null, 'evaluations'], [s.factorizations || null, 'factorizations']);
  byId('tiles').append(...tiles.filter(tile => tile[0] !== null).map(([value, name]) => element('div', {class: 'tile', 'data-name': name}, element('b', {}, String(value)), element('span', {}, name))));
  byId('index').hidden = !index && !data.decisions.length;
  if (index) byId('words').append(...index.words.concat(index.safety).map(text => element('p', {}, text)));
  if (data.decisions.length) drawDecisions(data.decisions);
  byId('report').hidden = !data.report;
  byId('report').lastElementChild.textContent = data.report;
  const ends = v => time.length > 1 ? [number(v.values[0], 9), number(v.values.at(-1), 9)] : v.values.slice(0, 1).map(x => number(x, 9));
  fillTable('final', time.length > 1 ? ['name', 'unit', '#first', '#last'] : ['name', 'unit', '#value'], time.length ? variables.map(v => [v.name, v.unit, ...ends(v)]) : []);
  fillTable('parameters', ['name', 'unit', '#value', 'meaning'], data.parameters.map(p => [p.name, p.unit, number(p.value, 9) + (p.given ? ' (set)' : ''), p.description]));
  fillTable('events', ['#time', 'what'], data.events.slice(0, 1000).map(e => [number(e.time, 9), e.text]));
  byId('warnings').hidden = !data.warnings.length;
  byId('warnings').lastElementChild.append(element('ul', {}, ...data.warnings.map(text => element('li', {}, text))));
  byId('footer').textContent = `${data.file}, solved by sfdae ${data.sfdae}`;
}

fillReports();
byId('curves').hidden = time.length < 2 || !variables.length;
if (!byId('curves').hidden) {
  fillChooser();
  draw();
  addEventListener('resize', draw);
  byId('all').addEventListener('click', () => { range = whole; draw(); });
  byId('csv').addEventListener('click', saveCsv);
}
