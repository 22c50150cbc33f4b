// A library's page: its cases in one list that can be searched, filtered and sorted. Only the rows that are seen are laid out.

function tell(text) {
  $('problem').hidden = false
  $('problem').textContent = text
}

const number = (v, n) =>
  typeof v === 'number' ? v.toLocaleString('en', { minimumFractionDigits: n, maximumFractionDigits: n }) : ''

function caseFits(c) {
  const find = $('find').value.toLowerCase(),
    of = $('class').value,
    state = $('state').value,
    most = parseFloat($('most').value)
  return (
    (!find || c.text.includes(find)) &&
    (!of || c.class === of) &&
    !(c.deviation_mm > most) &&
    (!state || (state === 'good' ? !c.warned && !c.state : state === 'warned' ? c.warned > 0 : !!c.state))
  )
}

function listCases(index) {
  const { cases, height, controls, drawn } = index
  const sign = index.down ? -1 : 1,
    missing = v => v === undefined || v === ''
  index.shown = cases.filter(caseFits).sort((a, b) => {
    const x = a[index.by],
      y = b[index.by]
    if (missing(x) || missing(y)) return missing(x) - missing(y)
    return sign * (x < y ? -1 : x > y ? 1 : 0) || (a.case < b.case ? -1 : 1)
  })
  $('count').textContent = `${index.shown.length} of ${cases.length} cases`
  $('all').style.height = index.shown.length * height + 'px'
  for (const b of $('head').querySelectorAll('button')) {
    b.className = b.dataset.key === index.by ? 'by' : ''
    b.setAttribute('aria-sort', b.dataset.key === index.by ? (index.down ? 'descending' : 'ascending') : 'none')
  }
  const state = new URLSearchParams({ by: index.by, down: index.down ? '1' : '0' })
  for (const id of controls) if ($(id).value) state.set(id, $(id).value)
  history.replaceState(null, '', '#' + state)
  drawn.forEach(row => row.remove())
  drawn.clear()
  drawRows(index)
}

const link = (c, file) => encodeURIComponent(c.case) + '/' + file

function rowOf(index, c, i) {
  const { columns, grid, height } = index
  const row = make('div', 'row'),
    pair = make('div', 'pair')
  row.style.gridTemplateColumns = grid
  row.style.top = i * height + 'px'
  for (const picture of c.pictures) {
    const image = make('img')
    image.alt = ''
    image.src = link(c, picture)
    pair.append(image)
  }
  row.append(pair)
  for (const column of columns) {
    const v = c[column.key]
    if (column.key === 'case' && c.page) {
      const a = make('a', '', c.case)
      a.href = link(c, 'report/view.html') + '#library'
      row.append(a)
    } else
      row.append(
        make(
          'span',
          column.digits === undefined
            ? column.key === 'state'
              ? 'bad'
              : ''
            : column.key === 'warned' && v
              ? 'number bad'
              : 'number',
          column.digits === undefined
            ? v
            : number(v, column.digits) + (column.key === 'warned' && c.wrong ? ` (${c.wrong} wrong)` : '')
        )
      )
  }
  row.addEventListener('click', e => {
    if (e.target.tagName !== 'A') showDetail(c)
  })
  return row
}

function drawRows(index) {
  const { height, drawn } = index
  const box = $('rows'),
    first = Math.max(0, Math.floor(box.scrollTop / height) - 4),
    last = Math.min(index.shown.length, Math.ceil((box.scrollTop + box.clientHeight) / height) + 4)
  for (const [i, row] of drawn)
    if (i < first || i >= last) {
      row.remove()
      drawn.delete(i)
    }
  for (let i = first; i < last; ++i)
    if (!drawn.has(i)) {
      const row = rowOf(index, index.shown[i], i)
      drawn.set(i, row)
      $('all').append(row)
    }
}

function showDetail(c) {
  const table = make('table'),
    top = make('tr'),
    head = make('strong', '', c.case + ' ')
  for (const name of ['surface', 'triangles', 'ml', 'max mm']) top.append(make('th', '', name))
  table.append(top)
  for (const a of c.anatomies) {
    const row = make('tr')
    row.append(
      make('td', '', a.name),
      make('td', '', number(a.triangles, 0)),
      make('td', '', number(a.volume_ml, 1)),
      make('td', '', number(a.deviation_mm, 2))
    )
    table.append(row)
  }
  const warnings = c.warnings.map((text, i) => (c.severities[i] ? c.severities[i] + ': ' : '') + text)
  $('detail').replaceChildren(head, ...[c.fault, ...warnings].filter(t => t).map(t => make('p', 'bad', t)), table)
  $('detail').hidden = false
}

// The columns; a volume for each anatomy that cases have.
function readCases(index) {
  const { controls } = index
  const cases = index.data.cases
  index.cases = cases
  for (const c of cases) {
    c.text = [c.case, c.class, c.fault, ...c.warnings].join('\n').toLowerCase()
    c.warned = c.warnings.length
    c.wrong = c.severities.filter(s => s === 'wrong').length
    for (const a of c.anatomies) c['ml ' + a.name] = a.volume_ml
  }
  const columns = [
    { key: 'case', name: 'case', wide: 'minmax(9em, 2fr)' },
    { key: 'class', name: 'class', wide: 'minmax(6em, 1fr)' },
    ...index.data.volumes.map(name => ({ key: 'ml ' + name, name: name.replace(/_/g, ' ') + ' ml', digits: 1 })),
    { key: 'evans', name: 'Evans', digits: 2 },
    { key: 'shift_mm', name: 'shift mm', digits: 1 },
    { key: 'triangles', name: 'triangles', digits: 0 },
    { key: 'deviation_mm', name: 'max mm', digits: 2 },
    { key: 'warned', name: 'warnings', digits: 0, wide: 'minmax(7em, .9fr)' },
    { key: 'state', name: 'state', wide: 'minmax(6em, 1fr)' }
  ]
  const grid = '180px ' + columns.map(c => c.wide || 'minmax(4.5em, .7fr)').join(' ')
  Object.assign(index, { columns, grid })
  for (const name of [...new Set(cases.map(c => c.class))].sort())
    if (name) {
      const o = make('option', '', name)
      o.value = name
      $('class').append(o)
    }
  const asked = new URLSearchParams(location.hash.slice(1))
  for (const id of controls) $(id).value = asked.get(id) || ''
  index.by = columns.some(c => c.key === asked.get('by')) ? asked.get('by') : 'case'
  index.down = asked.get('down') === '1'
}

function listenToIndex(index) {
  const { columns, grid, controls } = index
  $('head').style.gridTemplateColumns = grid
  $('head').append(make('span'))
  for (const c of columns) {
    const cell = make('span', c.digits === undefined ? '' : 'number'),
      b = make('button', '', c.name)
    b.type = 'button'
    b.dataset.key = c.key
    b.addEventListener('click', () => {
      index.down = index.by === c.key ? !index.down : false
      index.by = c.key
      listCases(index)
    })
    cell.append(b)
    $('head').append(cell)
  }
  for (const id of controls) $(id).addEventListener('input', () => listCases(index))
  $('rows').addEventListener('scroll', () => requestAnimationFrame(() => drawRows(index)))
  addEventListener('resize', () => drawRows(index))
  listenToTheme(() => {})
}

function startIndex() {
  const index = { data: undefined, height: 64, controls: ['find', 'class', 'state', 'most'], shown: [], drawn: new Map() }
  try {
    index.data = JSON.parse($('cases').textContent)
  } catch (e) {}
  if (!index.data || !$('end'))
    return tell('This page is cut off or damaged. Make it again: trephine library list LIBRARY --sheet.')
  readCases(index)
  listenToIndex(index)
  listCases(index)
  document.documentElement.dataset.ready = '1'
}

addEventListener('DOMContentLoaded', startIndex)
