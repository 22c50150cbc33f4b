// Correcting by brush. What is painted is a byte a voxel of the scan: 1 added, 2 removed. It stays in the page, and as a
// draft on the desk, until it is saved as a patch of the case.

function needPaint(page) {
  const { paint } = page
  if (!paint.anatomy) throw (page.show_('paint'), new Refused(t('no_field')))
  if (!paint.bytes) paint.bytes = new Uint8Array(page.volume.count)
}

function writeVoxel(page, n, value, at) {
  const { paint } = page
  const { box } = paint
  const old = paint.bytes[n]
  if (old === value) return
  if (paint.stroke && !paint.stroke.has(n)) paint.stroke.set(n, old)
  paint.bytes[n] = value
  if (old) --paint.count[old - 1]
  if (value) {
    ++paint.count[value - 1]
    for (let a = 0; a < 3; ++a) {
      box.low[a] = Math.min(box.low[a], at[a])
      box.high[a] = Math.max(box.high[a], at[a])
    }
  }
}

const voxelOf = (page, n) => [
  n % page.volume.size[0],
  Math.floor(n / page.volume.size[0]) % page.volume.size[1],
  Math.floor(n / page.volume.size[0] / page.volume.size[1])
]

function huAt(page, p, data, at) {
  const [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
  return data[at[hi] * page.volume.size[lo] + at[lo]]
}

function inRange(page, hu) {
  const { brush } = page.paint
  return hu >= brush.low && hu <= brush.high
}

// A disc in the plane, or a ball; voxel centres within the radius, and always the one that is pointed at.
function dab(page, { p, centre, value }) {
  const { brush } = page.paint
  const { volume } = page,
    { size, spacing } = volume,
    c = centre.map(Math.round)
  const reach = [0, 1, 2].map(a => (a === p.n && !brush.ball ? 0 : Math.floor(brush.radius / spacing[a]))),
    at = [0, 0, 0],
    lo = [],
    hi = []
  for (let a = 0; a < 3; ++a) {
    lo[a] = Math.max(0, c[a] - reach[a])
    hi[a] = Math.min(size[a] - 1, c[a] + reach[a])
  }
  for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2])
    for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1])
      for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) {
        let d = 0
        for (let a = 0; a < 3; ++a) d += ((at[a] - (a === p.n && !brush.ball ? c[a] : centre[a])) * spacing[a]) ** 2
        if (d > brush.radius ** 2 && (at[0] !== c[0] || at[1] !== c[1] || at[2] !== c[2])) continue
        if (brush.within && value && !inRange(page, huAt(page, p, volume.has(p.n, at[p.n]), at))) continue
        writeVoxel(page, volume.at(...at), value, at)
      }
}

function slicesOf(page, { p, centre, value }) {
  const { brush } = page.paint
  const reach = brush.ball ? Math.floor(brush.radius / page.volume.spacing[p.n]) : 0,
    c = Math.round(centre[p.n]),
    all = []
  if (brush.within && value)
    for (let i = Math.max(0, c - reach); i <= Math.min(page.volume.size[p.n] - 1, c + reach); ++i)
      if (!page.volume.has(p.n, i)) all.push(page.volume.slice(p.n, i))
  return all
}

async function paintWaiting(page) {
  const { paint } = page
  const { waiting } = paint
  if (paint.fetching) return
  while (waiting.length) {
    const missing = slicesOf(page, waiting[0])
    if (missing.length) {
      paint.fetching = true
      try {
        await Promise.all(missing)
      } catch (e) {
        waiting.length = 0
        problem(e.message)
      } finally {
        paint.fetching = false
      }
      continue
    }
    dab(page, waiting.shift())
  }
  page.redraw()
  if (paint.over) finishStroke(page)
}

function painter(page, key, value) {
  const { paint } = page
  const { brush, waiting } = paint
  let last = null
  return {
    key,
    hover: true,
    down: (p, at) => {
      needPaint(page)
      const began = performance.now()
      if (!paint.over || paint.fetching) return
      paint.stroke = new Map()
      last = at
      paint.over = false
      waiting.push({ p, centre: at, value })
      paintWaiting(page)
      requestAnimationFrame(() =>
        requestAnimationFrame(() => {
          desk.stats.brush = performance.now() - began
        })
      )
    },
    move: (p, at) => {
      if (!paint.stroke || !last) return
      const way = Math.hypot(...[0, 1, 2].map(a => (at[a] - last[a]) * page.volume.spacing[a])),
        n = Math.max(1, Math.ceil(way / Math.max(0.3, brush.radius / 2)))
      const from = last
      for (let i = 1; i <= n; ++i) waiting.push({ p, centre: from.map((v, a) => v + ((at[a] - v) * i) / n), value })
      last = at
      paintWaiting(page)
    },
    up: () => {
      if (!last) return
      last = null
      paint.over = true
      if (!paint.fetching) paintWaiting(page)
    },
    // A second finger: the touch was meant for looking, and what it painted goes.
    stop: () => {
      if (!last) return
      last = null
      waiting.length = 0
      paint.over = true
      if (paint.stroke && paint.stroke.size) {
        finishStroke(page)
        page.undoPaint()
      }
      paint.stroke = null
    }
  }
}

function finishStroke(page) {
  const { paint } = page
  const { done, undone } = paint
  if (paint.stroke && paint.stroke.size) {
    done.push(paint.stroke)
    undone.length = 0
    if (done.length > 100) done.shift()
  }
  paint.stroke = null
  tellCount(page)
  keepDraft(page)
}

// What the desk made of it, as one stroke.
function takeMade(page, answer, valueOf) {
  const { paint } = page
  const [x, y, z, nx, ny] = new Int32Array(answer, 0, 6),
    made = new Uint8Array(answer, 24)
  const before = paint.count[0] + paint.count[1]
  paint.stroke = new Map()
  for (let n = 0; n < made.length; ++n)
    if (made[n]) {
      const q = [x + (n % nx), y + (Math.floor(n / nx) % ny), z + Math.floor(n / nx / ny)]
      writeVoxel(page, page.volume.at(...q), valueOf(made[n]), q)
    }
  finishStroke(page)
  page.redraw()
  return paint.count[0] + paint.count[1] - before
}

// The slices between painted ones, along the axis of the chosen plane.
async function fillBetween(page) {
  const { paint } = page
  const { brush } = paint
  needPaint(page)
  const body = packPaint(page),
    p = page.volume.planes.find(p => p.id === brush.plane)
  if (!body) throw new Refused(t('nothing'))
  const value = paint.count[0] ? 1 : 2
  const answer = await tellForBytes('between', { case: page.token, axis: p.n, value }, body)
  hint(`${t('filled')} ${takeMade(page, answer, v => v)}`)
}

function moveStroke(page, from, to) {
  const { paint } = page
  const change = from.pop()
  if (!change) return
  paint.stroke = new Map()
  for (const [n, old] of change) writeVoxel(page, n, old, voxelOf(page, n))
  to.push(paint.stroke)
  paint.stroke = null
  tellCount(page)
  keepDraft(page)
  page.redraw()
}

function resizeBrush(page, factor) {
  const { brush } = page.paint
  brush.radius = Math.max(0.3, Math.min(60, Math.round(brush.radius * factor * 10) / 10))
  if (page.tab === 'paint') page.show_('paint')
  page.redraw()
}

function needAnatomy(page) {
  const { paint } = page
  if (!paint.anatomy || page.tab !== 'paint') page.show_('paint')
  if (!paint.anatomy) throw new Refused(t('no_field'))
}

function paintPanel(page) {
  const paint = (page.paint = {
    brush: { radius: 3, ball: false, within: false, low: 226, high: 3071, grow: 15, plane: 'axial' },
    anatomy: '',
    bytes: null,
    count: [0, 0],
    stroke: null,
    keeping: 0,
    restored: false,
    box: { low: [1e9, 1e9, 1e9], high: [-1, -1, -1] },
    done: [],
    undone: [],
    // A ball in a range of HU reaches into slices that were not fetched yet: dabs wait for them, in their order.
    waiting: [],
    fetching: false,
    over: true,
    // The draft begins with the anatomy's name in 64 bytes.
    // One at a time: on a slow machine many of them would fill the page's memory.
    sending: false,
    counted: null
  })
  const { brush, done, undone } = paint
  // The HU that the configuration says of an anatomy, where one of its steps has such values; the last step counts.
  page.rangeOf = name => rangeOf(page, name)
  page.tools.add = painter(page, 'b', 1)
  page.tools.remove = painter(page, 'r', 2)
  page.tools.erase = painter(page, 'u', 0)
  // The part of the slice that hangs together with the clicked place: of the same paint, and of the range of HU where one is
  // asked for.
  page.tools.fill = {
    key: 'f',
    down: (p, at) => {
      needPaint(page)
      const { volume } = page,
        start = at.map(Math.round),
        data = volume.has(p.n, page.at[p.n])
      if (!volume.inside(start)) return
      const was = paint.bytes[volume.at(...start)],
        fits = q => paint.bytes[volume.at(...q)] === was && (!brush.within || inRange(page, huAt(page, p, data, q)))
      const open = [start],
        found = []
      const seen = new Set([volume.at(...start)])
      while (open.length) {
        const q = open.pop()
        if (!fits(q)) continue
        found.push(q)
        for (const [a, d] of [
          [p.u, 1],
          [p.u, -1],
          [p.v, 1],
          [p.v, -1]
        ]) {
          const next = [...q]
          next[a] += d
          if (next[a] < 0 || next[a] >= volume.size[a]) {
            if (!brush.within) throw new Refused(t('fill_open'))
          } else if (!seen.has(volume.at(...next))) {
            seen.add(volume.at(...next))
            open.push(next)
          }
        }
      }
      paint.stroke = new Map()
      for (const q of found) writeVoxel(page, volume.at(...q), 1, q)
      finishStroke(page)
      page.redraw()
    }
  }
  page.tools.grow = {
    key: 'g',
    down: async (p, at) => {
      needPaint(page)
      const [i, j, k] = at.map(Math.round),
        { volume } = page
      if (!volume.inside([i, j, k])) return
      const answer = await askBytes('grow', {
        case: page.token,
        i,
        j,
        k,
        radius_mm: brush.grow,
        lower_hu: brush.low,
        upper_hu: brush.high
      })
      takeMade(page, answer, () => 1)
    }
  }
  page.resize = factor => resizeBrush(page, factor)
  page.undoPaint = () => moveStroke(page, done, undone)
  page.redoPaint = () => moveStroke(page, undone, done)
  page.overlays.push((p, c) => drawPaint(page, p, c))
  page.anatomy = () => paint.anatomy
  page.chooseAnatomy = name => {
    paint.anatomy = name
  }
  page.needAnatomy = () => needAnatomy(page)
  page.rangeWanted = () => (brush.within ? { lower_hu: brush.low, upper_hu: brush.high } : {})
  const edits = editsOf(page)
  paint.edits = edits
  page.opened = () => restoreDraft(page)
  page.addPanel('paint', () => paintControls(page))
}
