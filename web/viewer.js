// What the page shows, and its controls.

const shown = v => (v === undefined ? '' : v)
const digits = (v, n) =>
  typeof v === 'number' ? v.toLocaleString('en', { minimumFractionDigits: n, maximumFractionDigits: n }) : shown(v)
const label = name => name.replace(/_/g, ' ')
// What is less sure than one in two is no colour that says "here it is", and its name asks.
const isDoubtful = point => point.confidence < 0.5
const markOf = (point, colour) => ({
  label: label(point.name) + (isDoubtful(point) ? ' ?' : ''),
  p: point.position_mm,
  colour: isDoubtful(point) ? '#9aa7b5' : colour
})

function setWindow(viewer, level, width) {
  const { state, hu, window_ } = viewer
  window_.level = level
  window_.width = Math.max(1, width)
  state.grey = new Uint32Array(256)
  if (hu)
    hu.forEach((v, i) => {
      const g = Math.max(0, Math.min(255, Math.round(255 * ((v - window_.level) / window_.width + 0.5))))
      state.grey[i] = pixel(g, g, g, 255)
    })
  $('level').value = Math.round(window_.level)
  $('width').value = Math.round(window_.width)
}

// What is `whole` is as fine as it can be, however long that takes; else the rays through the CT become so when all is at rest.
function drawView(viewer, whole = false) {
  const { times, cam, clip, view, solid, over, root, painter } = viewer
  const r = Math.min(2, devicePixelRatio || 1),
    w = Math.max(1, (view.clientWidth * r) | 0),
    h = Math.max(1, (view.clientHeight * r) | 0),
    t = performance.now()
  for (const c of [solid, over])
    if (c.width !== w || c.height !== h) {
      c.width = w
      c.height = h
    }
  const ground = root.classList.contains('light') ? [0.95, 0.96, 0.97] : [0.1, 0.11, 0.13]
  const { heat, scale, moving, cast } = viewer
  clearTimeout(viewer.later)
  if (painter.draw({ cam, clip, heat, scale, ground, moving, cast, whole }))
    viewer.later = setTimeout(() => drawView(viewer, !viewer.moving), 300)
  times.frame = performance.now() - t
  drawMarks(viewer, over.getContext('2d'), w, h, r)
}

function drawMarks(viewer, c, w, h, r) {
  const { page, data, box, cam, at, state } = viewer
  const m = cam.matrix(w, h),
    to = p => cam.project(m, w, h, p)
  const stroke = (p, q, colour, width) => {
    c.strokeStyle = colour
    c.lineWidth = width * r
    c.beginPath()
    c.moveTo(...to(p))
    c.lineTo(...to(q))
    c.stroke()
  }
  c.clearRect(0, 0, w, h)
  for (let k = 0; k < 3; ++k) {
    const p = [...at],
      q = [...at]
    p[k] = box[k][0]
    q[k] = box[k][1]
    stroke(p, q, 'rgba(90,200,255,.6)', 1)
  }
  for (const b of data.burr_holes)
    stroke(
      b.position_mm.map((x, k) => x - 40 * b.direction[k]),
      b.position_mm.map((x, k) => x + 60 * b.direction[k]),
      '#ff7a3c',
      1.5
    )
  c.font = 11 * r + 'px sans-serif'
  if (state.showMarks)
    drawLabels(
      c,
      page.marks.map(l => {
        const [x, y] = to(l.p)
        return { x, y, mark: l }
      }),
      r
    )
  // Which way is left, posterior and superior.
  const { right, up } = cam.basis(),
    x0 = 40 * r,
    y0 = h - 90 * r
  'LPS'.split('').forEach((letter, k) => {
    const x = x0 + 28 * r * right[k],
      y = y0 - 28 * r * up[k]
    c.strokeStyle = c.fillStyle = ['#ff8a7a', '#8fd6a0', '#7cc4ff'][k]
    c.beginPath()
    c.moveTo(x0, y0)
    c.lineTo(x, y)
    c.stroke()
    c.fillText(letter, x + 3 * r * right[k] - 3 * r, y - 3 * r * up[k] + 4 * r)
  })
}

function drawSlices(viewer) {
  const { page, times, at, state, hu } = viewer
  const t = performance.now()
  for (const p of planes) drawSlice(p, page, state)
  times.slices = performance.now() - t
  $('where').textContent =
    `cross-hair: L ${at[0].toFixed(1)}, P ${at[1].toFixed(1)}, S ${at[2].toFixed(1)} mm` + (hu ? huText(viewer) : '')
}

function huText(viewer) {
  const { page, at, hu } = viewer
  const i = at.map((v, k) => Math.round((v - page.ct.origin[k]) / page.ct.spacing[k]))
  return i.some((v, k) => v < 0 || v >= page.ct.size[k])
    ? ''
    : `, ${Math.round(hu[page.ct.voxels[i[0] + page.ct.size[0] * (i[1] + page.ct.size[1] * i[2])]])} HU`
}

function redraw(viewer) {
  viewer.due =
    viewer.due ||
    requestAnimationFrame(() => {
      viewer.due = 0
      drawView(viewer)
    })
}

function reslice(viewer) {
  viewer.dueSlices =
    viewer.dueSlices ||
    requestAnimationFrame(() => {
      viewer.dueSlices = 0
      drawSlices(viewer)
    })
}

function redrawAll(viewer) {
  redraw(viewer)
  reslice(viewer)
}

function goTo(viewer, p) {
  const { clip, at } = viewer
  for (let k = 0; k < 3; ++k) at[k] = p[k]
  if (clip.axis >= 0) clip.mm = at[clip.axis]
  redrawAll(viewer)
}

// Where everything lies.
function layOutScene(viewer) {
  const { page, data, meshes } = viewer
  const box = [
    [Infinity, -Infinity],
    [Infinity, -Infinity],
    [Infinity, -Infinity]
  ]
  viewer.box = box
  for (const m of meshes)
    if (!m.tool)
      for (let i = 0; i < m.pos.length; ++i) {
        const b = box[i % 3]
        b[0] = Math.min(b[0], m.pos[i])
        b[1] = Math.max(b[1], m.pos[i])
      }
  const volume = page.ct || page.felt
  viewer.volume = volume
  for (let k = 0; k < 3; ++k) if (!(box[k][0] < box[k][1])) box[k] = volume ? reach(volume, k) : [-1, 1]
  const centre = box.map(b => (b[0] + b[1]) / 2),
    radius = Math.hypot(...box.map(b => b[1] - b[0])) / 2
  viewer.radius = radius
  for (const m of meshes) {
    m.size = m.tool ? Infinity : 0
    for (let i = 0; i < m.pos.length && !m.tool; i += 3)
      m.size = Math.max(m.size, Math.hypot(m.pos[i] - centre[0], m.pos[i + 1] - centre[1], m.pos[i + 2] - centre[2]))
  }
  // What lies outside is seen through, so that what lies inside is seen.
  const inward = meshes.filter(m => !m.tool).sort((a, b) => b.size - a.size)
  inward.forEach((m, i) => {
    if (inward.length > 1) m.opacity *= 0.25 + 0.75 * (i / (inward.length - 1)) ** 1.5
  })
  const cam = makeCamera(centre, radius)
  viewer.cam = cam
  page.marks = [
    ...data.burr_holes.map(h => markOf(h, '#ff7a3c')),
    ...data.targets.map(t => markOf(t, '#7cf0a0')),
    ...data.landmarks.filter(l => !data.targets.some(t => t.name === l.name)).map(l => markOf(l, '#ffd84a'))
  ]
  const innermost = inward[inward.length - 1],
    at = [...centre]
  Object.assign(viewer, { innermost, at })
  if (innermost)
    for (let k = 0; k < 3; ++k) {
      let low = Infinity,
        high = -Infinity
      for (let i = k; i < innermost.pos.length; i += 3) {
        low = Math.min(low, innermost.pos[i])
        high = Math.max(high, innermost.pos[i])
      }
      at[k] = (low + high) / 2
    }
  const state = {
    at,
    meshes,
    showCuts: true,
    showMarks: true,
    showFelt: false,
    measures: [],
    reach: box.map((b, k) => (volume ? reach(volume, k).map((v, i) => (i ? Math.max(v, b[1]) : Math.min(v, b[0]))) : b))
  }
  viewer.state = state
}

// The greys of the CT, and the colours of the shapes that are felt.
function chooseGreys(viewer) {
  const { page, data, state } = viewer
  const hu = data.ct && huOfLevels(data.ct.levels)
  viewer.hu = hu
  fillFelt(viewer, page.ct ? 0.47 : 0.78)
  setWindow(viewer, 40, 400)
}

// The shapes that are felt, laid over the slices: 0 shows none of them, 1 nothing else.
function fillFelt(viewer, opacity) {
  const { data, state } = viewer
  state.feltColours = new Uint32Array(256)
  for (const s of data.felt ? data.felt.shapes : [])
    state.feltColours[s.number] = pixel(...s.colour_rgb.map(c => (c * 255) | 0), Math.round(255 * opacity))
  $('fill').value = opacity
}

function openView(viewer) {
  const { meshes, page, hu, data } = viewer
  const view = $('view'),
    solid = $('solid'),
    over = $('over'),
    root = document.documentElement
  const sources = { ct: () => huSource(page.ct, hu), felt: () => shapeSource(page.felt, data.felt.shapes) },
    wanted = location.hash === '#processor' ? null : glPainter(solid, meshes, sources),
    painter = wanted || softPainter(solid, meshes)
  Object.assign(viewer, { view, solid, over, root, painter })
  if (!wanted) $('mode').textContent = (location.hash === '#processor' ? '' : 'no WebGL2 here: ') + 'drawn by the processor'
  // A library's page leads here with this word. Whoever opens the page alone may have no library beside it.
  $('library').hidden = location.hash !== '#library'
  // The desk shows the surfaces alone while its frame is small: it has slices of its own.
  root.classList.toggle('framed', location.hash === '#framed')
  solid.addEventListener('webglcontextlost', e => e.preventDefault())
  solid.addEventListener('webglcontextrestored', () => {
    painter.upload()
    redraw(viewer)
  })
}

async function start() {
  const viewer = {
    clip: { axis: -1, mm: 0, keep: 1 },
    window_: { level: 40, width: 400 },
    heat: null,
    cast: null,
    scale: 1,
    moving: false,
    due: 0,
    dueSlices: 0,
    pointers: new Map(),
    pinch: 0,
    travelled: 0
  }
  const began = performance.now(),
    page = await readCase(),
    { data, meshes } = page,
    times = { decoded: performance.now() - began }
  Object.assign(viewer, { began, page, data, meshes, times })
  $('title').textContent = data.case
  document.title = data.case
  layOutScene(viewer)
  chooseGreys(viewer)
  openView(viewer)
  listenToView(viewer)
  listenToSlices(viewer)
  listSurfaces(viewer)
  listenToPanel(viewer)
  fillTables(viewer)
  const { cam, clip, at, state, view, root, painter } = viewer
  new ResizeObserver(() => redrawAll(viewer)).observe(view)
  drawView(viewer)
  drawSlices(viewer)
  times.first = performance.now() - began
  // For tests and the curious.
  window.trephine = {
    page,
    data,
    meshes,
    cam,
    at,
    clip,
    state,
    times,
    planes,
    render: () => drawView(viewer, true),
    slices: () => drawSlices(viewer),
    go: p => goTo(viewer, p),
    pick,
    cutSurface,
    kind: painter.kind,
    viewer
  }
  root.dataset.ready = '1'
}

addEventListener('error', e => tell(e.message || 'The page failed.'))
addEventListener('DOMContentLoaded', () => {
  if (!window.DecompressionStream)
    return tell('This browser is too old for this page: it needs Chromium 80, Firefox 113 or Safari 16.4, or a later one.')
  start().catch(e => tell(e.message))
})
