'use strict'
// A library's page: its cases in one list that can be searched, filtered and sorted. Only the rows that are seen are laid out.
addEventListener('DOMContentLoaded', () => {
  const $ = id => document.getElementById(id)
  const make = (tag, name, text) => {
    const e = document.createElement(tag)
    if (name) e.className = name
    if (text !== undefined) e.textContent = text
    return e
  }
  const tell = text => { $('problem').hidden = false, $('problem').textContent = text }
  let data
  try {
    data = JSON.parse($('cases').textContent)
  } catch (e) {}
  if (!data || !$('end')) return tell('This page is cut off or damaged. Make it again: trephine library list LIBRARY --sheet.')

  // ---- columns; a volume for each anatomy that cases have
  const cases = data.cases, number = (v, n) => typeof v === 'number' ? v.toLocaleString('en', { minimumFractionDigits: n, maximumFractionDigits: n }) : ''
  for (const c of cases) {
    c.text = [c.case, c.class, c.fault, ...c.warnings].join('\n').toLowerCase()
    c.warned = c.warnings.length
    for (const a of c.anatomies) c['ml ' + a.name] = a.volume_ml
  }
  const columns = [
    { key: 'case', name: 'case', wide: 'minmax(9em, 2fr)' }, { key: 'class', name: 'class', wide: 'minmax(6em, 1fr)' },
    ...data.volumes.map(name => ({ key: 'ml ' + name, name: name.replace(/_/g, ' ') + ' ml', digits: 1 })),
    { key: 'evans', name: 'Evans', digits: 2 }, { key: 'shift_mm', name: 'shift mm', digits: 1 }, { key: 'triangles', name: 'triangles', digits: 0 },
    { key: 'deviation_mm', name: 'max mm', digits: 2 }, { key: 'warned', name: 'warnings', digits: 0 }, { key: 'state', name: 'state', wide: 'minmax(6em, 1fr)' }
  ]
  const grid = '180px ' + columns.map(c => c.wide || 'minmax(4.5em, .7fr)').join(' '), height = 64
  for (const name of [...new Set(cases.map(c => c.class))].sort()) if (name) {
    const o = make('option', '', name)
    o.value = name
    $('class').append(o)
  }

  // ---- what is shown, also kept in the address so that a link leads to the same list
  const asked = new URLSearchParams(location.hash.slice(1)), controls = ['find', 'class', 'state', 'most']
  for (const id of controls) $(id).value = asked.get(id) || ''
  let by = columns.some(c => c.key === asked.get('by')) ? asked.get('by') : 'case', down = asked.get('down') === '1', shown = []
  const fits = c => {
    const find = $('find').value.toLowerCase(), of = $('class').value, state = $('state').value, most = parseFloat($('most').value)
    return (!find || c.text.includes(find)) && (!of || c.class === of) && !(c.deviation_mm > most) && (!state || (state === 'good' ? !c.warned && !c.state : state === 'warned' ? c.warned > 0 : !!c.state))
  }
  const list = () => {
    const sign = down ? -1 : 1, missing = v => v === undefined || v === ''
    shown = cases.filter(fits).sort((a, b) => {
      const x = a[by], y = b[by]
      if (missing(x) || missing(y)) return missing(x) - missing(y)
      return sign * (x < y ? -1 : x > y ? 1 : 0) || (a.case < b.case ? -1 : 1)
    })
    $('count').textContent = `${shown.length} of ${cases.length} cases`
    $('all').style.height = shown.length * height + 'px'
    for (const b of $('head').querySelectorAll('button')) {
      b.className = b.dataset.key === by ? 'by' : ''
      b.setAttribute('aria-sort', b.dataset.key === by ? down ? 'descending' : 'ascending' : 'none')
    }
    const state = new URLSearchParams({ by, down: down ? '1' : '0' })
    for (const id of controls) if ($(id).value) state.set(id, $(id).value)
    history.replaceState(null, '', '#' + state)
    drawn.forEach(row => row.remove())
    drawn.clear()
    draw()
  }

  // ---- rows
  const link = (c, file) => encodeURIComponent(c.case) + '/' + file, drawn = new Map()
  const rowOf = (c, i) => {
    const row = make('div', 'row'), pair = make('div', 'pair')
    row.style.gridTemplateColumns = grid
    row.style.top = i * height + 'px'
    for (const picture of c.pictures) {
      const image = make('img')
      image.alt = '', image.src = link(c, picture)
      pair.append(image)
    }
    row.append(pair)
    for (const column of columns) {
      const v = c[column.key]
      if (column.key === 'case' && c.page) {
        const a = make('a', '', c.case)
        a.href = link(c, 'report/view.html') + '#library'
        row.append(a)
      } else row.append(make('span', column.digits === undefined ? column.key === 'state' ? 'bad' : '' : column.key === 'warned' && v ? 'number bad' : 'number', column.digits === undefined ? v : number(v, column.digits)))
    }
    row.addEventListener('click', e => { if (e.target.tagName !== 'A') detail(c) })
    return row
  }
  const draw = () => {
    const box = $('rows'), first = Math.max(0, Math.floor(box.scrollTop / height) - 4), last = Math.min(shown.length, Math.ceil((box.scrollTop + box.clientHeight) / height) + 4)
    for (const [i, row] of drawn) if (i < first || i >= last) row.remove(), drawn.delete(i)
    for (let i = first; i < last; ++i) if (!drawn.has(i)) {
      const row = rowOf(shown[i], i)
      drawn.set(i, row)
      $('all').append(row)
    }
  }
  const detail = c => {
    const table = make('table'), top = make('tr'), head = make('strong', '', c.case + ' ')
    for (const name of ['surface', 'triangles', 'ml', 'max mm']) top.append(make('th', '', name))
    table.append(top)
    for (const a of c.anatomies) {
      const row = make('tr')
      row.append(make('td', '', a.name), make('td', '', number(a.triangles, 0)), make('td', '', number(a.volume_ml, 1)), make('td', '', number(a.deviation_mm, 2)))
      table.append(row)
    }
    $('detail').replaceChildren(head, ...[c.fault, ...c.warnings].filter(t => t).map(t => make('p', 'bad', t)), table)
    $('detail').hidden = false
  }
  $('head').style.gridTemplateColumns = grid
  $('head').append(make('span'))
  for (const c of columns) {
    const cell = make('span', c.digits === undefined ? '' : 'number'), b = make('button', '', c.name)
    b.type = 'button', b.dataset.key = c.key
    b.addEventListener('click', () => {
      down = by === c.key ? !down : false
      by = c.key
      list()
    })
    cell.append(b)
    $('head').append(cell)
  }
  for (const id of controls) $(id).addEventListener('input', list)
  $('rows').addEventListener('scroll', () => requestAnimationFrame(draw))
  addEventListener('resize', draw)
  $('theme').addEventListener('click', () => { $('theme').textContent = document.documentElement.classList.toggle('light') ? 'dark' : 'light' })
  list()
  document.documentElement.dataset.ready = '1'
})
