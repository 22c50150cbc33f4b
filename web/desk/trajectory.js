// The plane through a hole's entry and target, and how near it comes to what is shown.

async function drawTrajectory(page, canvas, clear) {
  const { planned } = page
  const d = holeIsWhole(page) && page.volume && holeDirection(page)
  if (!d) return
  const mine = planned.hole,
    { entry } = planned.hole,
    all = entryToTarget(page) // what is drawn; meanwhile the hole may be cancelled
  const side = 180,
    turn = (planned.hole.angle * Math.PI) / 180
  const up = Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0]
  const e = unit(crossProduct(d, up)),
    f = crossProduct(d, e),
    right = e.map((v, k) => v * Math.cos(turn) + f[k] * Math.sin(turn)),
    corner = entry.map((v, k) => v - (right[k] * side) / 2 - d[k] * 40)
  const query = { case: page.token, side }
  for (const [name, v] of [
    ['corner', corner],
    ['right', right],
    ['down', d]
  ])
    'xyz'.split('').forEach((axis, k) => {
      query[`${name}_${axis}`] = v[k]
    })
  const number = ++planned.asked,
    data = new Int16Array(await askBytes('plane', query))
  if (number !== planned.asked || mine !== planned.hole) return
  const image = new ImageData(side, side),
    px = new Uint32Array(image.data.buffer),
    { level, width } = page.window
  for (let i = 0; i < px.length; ++i) {
    const g = Math.max(0, Math.min(255, Math.round(((data[i] - level) / width + 0.5) * 255)))
    px[i] = data[i] === -32768 ? rgba(20, 26, 38) : rgba(g, g, g)
  }
  const small = make('canvas', { width: side, height: side }),
    c = canvas.getContext('2d'),
    k = canvas.width / side
  small.getContext('2d').putImageData(image, 0, 0)
  c.drawImage(small, 0, 0, canvas.width, canvas.height)
  const x = (side / 2) * k,
    r = (planned.hole.diameter_mm / 2) * k,
    end = 40 + all
  c.lineWidth = 1.5
  c.strokeStyle = '#7cc4ff'
  c.beginPath()
  c.moveTo(x, 0)
  c.lineTo(x, end * k)
  c.stroke()
  c.beginPath()
  c.arc(x, end * k, 4, 0, 7)
  c.stroke()
  c.strokeStyle = '#ff9c3c'
  c.beginPath()
  c.moveTo(x - r, 30 * k)
  c.lineTo(x - r, 60 * k)
  c.moveTo(x + r, 30 * k)
  c.lineTo(x + r, 60 * k)
  c.stroke()
  c.font = '12px system-ui, sans-serif'
  page.inked(c, t('entry'), x + r + 6, 40 * k + 4, '#ff9c3c', 1)
  page.inked(c, t('target'), x + 9, Math.min(canvas.height - 6, end * k + 4), '#7cc4ff', 1)
  page.inked(c, '10 mm', 10, canvas.height - 14, '#c5d4e3', 1)
  c.strokeStyle = '#c5d4e3'
  c.beginPath()
  c.moveTo(10, canvas.height - 8)
  c.lineTo(10 + 10 * k, canvas.height - 8)
  c.stroke()
  clear.replaceChildren(...(await holeDistances(page, d, entry, all)))
  canvas.dataset.drawn = number
}

const crossProduct = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
const unit = a => a.map(v => v / Math.hypot(...a))

// How far the entry lies before the coronal suture, along the midline, as craniometry::before_suture_mm counts it (the suture is
// known where it crosses the midline: in the bregma), and beside the midline, along which the sagittal suture runs.
function mmToSutures(page, entry) {
  const at = name => (page.allMarks().find(m => m.name === name) || {}).position_mm,
    [nasion, bregma, inion] = ['nasion', 'bregma', 'inion'].map(at)
  if (!nasion || !bregma || !inion) return []
  const less = (a, b) => a.map((v, k) => v - b[k]),
    dot = (a, b) => a.reduce((sum, v, k) => sum + v * b[k], 0)
  const centre = nasion.map((v, k) => (v + inion[k]) / 2),
    out = unit(less(bregma, centre)),
    ahead = less(nasion, centre)
  const forwards = unit(ahead.map((v, k) => v - out[k] * dot(ahead, out))),
    left = unit(crossProduct(out, forwards))
  const before = dot(less(entry, bregma), forwards),
    beside = dot(less(entry, bregma), left)
  const found = page.info.now.landmarks.bregma ? null : page.foundMarks().find(l => l.name === 'bregma'),
    unsure = found && found.confidence < 0.5
  const row = (name, mm, where, doubt) =>
    make(
      'tr',
      { 'data-skull': name },
      make('td', { text: t(name) }),
      make('td', { class: 'number', text: digits(Math.abs(mm), 1) }),
      make('td', {
        class: doubt ? 'warn' : '',
        text: t(where) + (doubt ? ` (${label('bregma')}: ${digits(found.confidence * 100, 0)} %)` : '')
      })
    )
  return [
    row('coronal_suture', before, before < 0 ? 'behind_it' : 'before_it', unsure),
    row('midline_sagittal', beside, beside < 0 ? 'right' : 'left', false)
  ]
}

// How near the line from entry to target comes to the outline of each anatomy that is shown, in the axial slices that it passes.
async function holeDistances(page, d, entry, all) {
  const { volume } = page,
    p = volume.planes[0],
    rows = [],
    [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
  for (const name of page.fields.filter(f => page.outlines.get(f))) {
    let least = Infinity,
      enters = false
    for (let s = 0; s <= 24; ++s) {
      const at = volume.toIndex(entry.map((v, k) => v + (d[k] * all * s) / 24)),
        index = Math.round(at[p.n])
      if (index < 0 || index >= volume.size[p.n]) continue
      const line = await volume.outline(name, p.n, index)
      // Even and odd: how often a ray from the point meets the outline.
      let met = 0
      for (let i = 0; i < line.length; i += 4)
        if (
          line[i + 1] > at[hi] !== line[i + 3] > at[hi] &&
          at[lo] < line[i] + ((at[hi] - line[i + 1]) / (line[i + 3] - line[i + 1])) * (line[i + 2] - line[i])
        )
          ++met
      enters = enters || met % 2 === 1
      for (let i = 0; i < line.length; i += 2)
        least = Math.min(least, Math.hypot((line[i] - at[lo]) * volume.spacing[lo], (line[i + 1] - at[hi]) * volume.spacing[hi]))
    }
    if (isFinite(least))
      rows.push(
        make(
          'tr',
          {},
          make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)),
          make('td', { class: 'number', 'data-clear': name, text: enters ? t('passes_through') : digits(least, 1) })
        )
      )
  }
  // Where no outline is: points, such as the bregma, in which the sutures meet.
  const skull = mmToSutures(page, entry)
  const near = page
    .allMarks()
    .filter(m => m.name !== t('entry') && m.name !== t('target') && m.colour !== '#ff6a5c')
    .map(m => {
      const to = m.position_mm.map((v, k) => v - entry[k]),
        s = Math.max(
          0,
          Math.min(
            all,
            to.reduce((sum, v, k) => sum + v * d[k], 0)
          )
        )
      return { name: m.name, from: Math.hypot(...to), line: Math.hypot(...to.map((v, k) => v - d[k] * s)) }
    })
    .sort((a, b) => a.line - b.line)
  const points = near.map(m =>
    make(
      'tr',
      { 'data-near': m.name },
      make('td', { text: label(m.name) }),
      make('td', { class: 'number', text: digits(m.from, 1) }),
      make('td', { class: 'number', text: digits(m.line, 1) })
    )
  )
  return [
    ...(skull.length
      ? [
          heading('on_the_skull'),
          table(
            [
              ['', 0],
              [t('mm'), 1],
              ['', 0]
            ],
            skull
          )
        ]
      : []),
    ...(rows.length
      ? [
          heading('clearances'),
          table(
            [
              [t('anatomy'), 0],
              [t('mm'), 1]
            ],
            rows
          )
        ]
      : []),
    ...(points.length
      ? [
          heading('to_points'),
          table(
            [
              [t('name'), 0],
              [t('from_entry'), 1],
              [t('from_line'), 1]
            ],
            points
          )
        ]
      : [])
  ]
}

function drawHole(page, p, c) {
  const { planned } = page
  for (const [line, colour] of [[planned.hole, '#7cc4ff'], ...waitingHoles(page).map(w => [w.at, '#ff9c8f'])]) {
    if (!line.entry || !line.target) continue
    const a = page.volume.toIndex(line.entry),
      b = page.volume.toIndex(line.target)
    c.strokeStyle = colour
    c.lineWidth = 1.5 * p.r
    c.setLineDash([6 * p.r, 4 * p.r])
    c.beginPath()
    c.moveTo(p.X(a[p.u]), p.Y(a[p.v]))
    c.lineTo(p.X(b[p.u]), p.Y(b[p.v]))
    c.stroke()
    c.setLineDash([])
  }
}
