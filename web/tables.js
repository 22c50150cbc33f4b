// The texts and tables beside the view.

const voxelText = mm => mm.map(v => +v.toFixed(2)).join(' × ')
const cell = (v, n) => [digits(v, n), v]
const valueRows = o =>
  Object.entries(o).map(([k, v]) => ({
    cells: [[label(k)], [typeof v === 'number' ? digits(v, Number.isInteger(v) ? 0 : 3) : String(v), v]]
  }))
const whereCell = p => [p.map(x => x.toFixed(1)).join('\u00a0 '), p.join(', ')]

function addTable(viewer, id, head, rows) {
  const t = make('table'),
    top = make('tr')
  for (const x of head) top.append(make('th', '', x))
  t.append(top)
  for (const { cells, jump } of rows) {
    const tr = make('tr', jump ? 'jump' : '')
    for (const [text, exact] of cells) {
      const td = make('td', typeof exact === 'number' || (exact === undefined && text === '') ? 'number' : '', text)
      if (exact !== undefined) td.title = String(exact)
      tr.append(td)
    }
    if (jump) {
      tr.tabIndex = 0
      tr.addEventListener('click', () => goTo(viewer, jump))
      tr.addEventListener('keydown', e => {
        if (e.key === 'Enter') goTo(viewer, jump)
      })
    }
    t.append(tr)
  }
  $(id).append(t)
}

// A cell's title holds the value as case.json has it.
function fillTables(viewer) {
  const { page, data } = viewer
  $('source').textContent = page.ct
    ? `Slices: ${data.ct.from === 'ct' ? 'the CT of the case' : 'the HU of the haptic volume'}, on voxels of ` +
      `${voxelText(data.ct.spacing_mm)} mm; the case has ${voxelText(data.ct.of_spacing_mm)} mm.`
    : page.felt
      ? 'Slices: the shapes of the haptic volume; the case holds no CT.'
      : 'The case holds neither CT nor haptic volume.'
  const { verdict, ...figures } = data.figures
  if (verdict) $('verdict').append(make('h2', '', 'Verdict'), make('p', '', verdict))
  data.warnings.forEach((w, n) => $('warnings').append(make('p', data.severities[n], w)))
  if (!data.warnings.length) $('warnings').append(make('p', 'good', 'No warnings.'))
  addTable(
    viewer,
    'surfaces',
    ['surface', 'triangles', 'ml', 'cm²', 'max', 'p99', 'RMS', 'used'],
    data.anatomies.map(a => {
      const d = a.deviation_mm || {},
        b = a.budget_mm || {}
      return {
        cells: [
          [label(a.name)],
          cell(a.case_triangles, 0),
          cell(a.volume_ml, 1),
          cell(a.area_cm2, 1),
          cell(d.max, 3),
          cell(d.p99, 3),
          cell(d.rms, 3),
          cell(b.used, 3)
        ]
      }
    })
  )
  $('surfaces').append(
    make(
      'p',
      'faint',
      'max, p99, RMS: two-sided deviation from the surface before decimation, mm; used: of the error budget, mm.'
    )
  )
  for (const a of data.anatomies) {
    if (a.from === 'haptic')
      $('surfaces').append(
        make(
          'p',
          'faint',
          `${label(a.name)} is displayed from the haptic volume; here contoured coarsely (${digits(a.triangles, 0)} triangles).`
        )
      )
    if (a.from === 'none') $('surfaces').append(make('p', 'faint', `${label(a.name)} has no surface here.`))
  }
  addTable(
    viewer,
    'landmarks',
    ['landmark', 'L P S, mm', 'sure', 'source'],
    [
      ...data.landmarks
        .filter(l => !data.targets.some(t => t.name === l.name))
        .map(l => ({
          cells: [[label(l.name), l.name], whereCell(l.position_mm), cell(l.confidence, 2), [l.source]],
          jump: l.position_mm
        })),
      ...data.targets.map(t => ({
        cells: [
          [label(t.name), t.name],
          whereCell(t.position_mm),
          cell(t.confidence, 2),
          [
            ((data.landmarks.find(l => l.name === t.name) || {}).source || '') +
              ' target' +
              (t.anatomy ? ' in ' + label(t.anatomy) : '')
          ]
        ],
        jump: t.position_mm
      }))
    ]
  )
  if (data.burr_holes.length) $('holes').append(make('h2', '', 'Burr holes'))
  for (const b of data.burr_holes) {
    addTable(
      viewer,
      'holes',
      ['burr hole', 'L P S, mm', 'direction', 'mm'],
      [
        {
          cells: [
            [label(b.name)],
            whereCell(b.position_mm),
            [b.direction.map(x => x.toFixed(2)).join(', '), b.direction.join(', ')],
            cell(b.diameter_mm, 1)
          ],
          jump: b.position_mm
        }
      ]
    )
    addTable(viewer, 'holes', [], valueRows({ cut_from: b.cut.join(', '), ...b.figures }))
  }
  addTable(viewer, 'figures', [], valueRows(figures))
  addTable(
    viewer,
    'provenance',
    [],
    valueRows({
      program: data.provenance.program,
      input_sha256: data.provenance.input_sha256,
      face: data.face.policy + (data.face.reason ? ': ' + data.face.reason : '')
    })
  )
  const more = make('details'),
    parameters = make('div')
  parameters.id = 'parameters'
  more.append(make('summary', '', 'effective parameters'), parameters)
  $('provenance').append(more)
  addTable(viewer, 'parameters', [], valueRows(data.provenance.parameters))
  if (data.trade) drawTrade(data.trade)
}

// Seconds against deviation of the points that were measured, and the one that the case's settings come from.
function drawTrade(trade) {
  const points = trade.points.filter(p => !p.refused && p.seconds > 0 && p.deviation_rms_mm > 0),
    w = 340,
    h = 190
  const space = 'http://www.w3.org/2000/svg',
    svg = document.createElementNS(space, 'svg')
  const add = (tag, attributes, text) => {
    const e = document.createElementNS(space, tag)
    for (const k in attributes) e.setAttribute(k, attributes[k])
    if (text !== undefined) e.textContent = text
    svg.append(e)
    return e
  }
  $('trade').append(
    make('h2', '', 'Speed against accuracy'),
    make('p', 'faint', `${trade.rule}: point ${trade.chosen}, ${trade.why}`)
  )
  if (!points.length) return
  svg.setAttribute('viewBox', `0 0 ${w} ${h}`)
  const axis = (values, from, to) => {
    const low = Math.min(...values),
      high = Math.max(...values)
    return {
      low,
      high,
      at: v => (high > low ? from + ((to - from) * Math.log(v / low)) / Math.log(high / low) : (from + to) / 2)
    }
  }
  const x = axis(
      points.map(p => p.seconds),
      45,
      w - 20
    ),
    y = axis(
      points.map(p => p.deviation_rms_mm),
      h - 32,
      15
    )
  add('path', { d: `M40 8V${h - 26}H${w - 8}` })
  add('text', { x: w / 2 - 30, y: h - 3, class: 'axis' }, 'seconds (log)')
  add('text', { x: 44, y: 12, class: 'axis' }, 'RMS mm (log)')
  for (const v of [x.low, x.high]) add('text', { x: x.at(v) - 10, y: h - 15, class: 'axis' }, v.toFixed(1))
  for (const v of [y.low, y.high]) add('text', { x: 4, y: y.at(v) + 4, class: 'axis' }, v.toFixed(2))
  for (const p of points) {
    const chosen = p.name === trade.chosen,
      dot = add('circle', {
        cx: x.at(p.seconds),
        cy: y.at(p.deviation_rms_mm),
        r: chosen ? 6 : 3.5,
        class: chosen ? 'chosen' : 'point'
      })
    const title = document.createElementNS(space, 'title')
    title.textContent = `${p.name}: ${p.seconds} s, ${p.deviation_rms_mm} mm, ${p.triangles_count} triangles`
    dot.append(title)
  }
  $('trade').append(svg)
}
