// The slices. Axial as seen from the feet, coronal from the front (the patient's right on the left), sagittal with
// the nose on the left.
const planes = [
  { id: 'sagittal', axis: 0, u: 1, v: 2, ends: 'APSI', zoom: 1, pan: [0, 0] },
  { id: 'coronal', axis: 1, u: 0, v: 2, ends: 'RLSI', zoom: 1, pan: [0, 0] },
  { id: 'axial', axis: 2, u: 0, v: 1, ends: 'RLAP', zoom: 1, pan: [0, 0] }
]

// The exact cut of a surface with the plane where coordinate `axis` is mm: calls line(u0, v0, u1, v1) in mm for every triangle
// that crosses it.
function cutSurface(m, axis, mm, u, v, line) {
  const { pos, idx } = m
  for (let t = 0; t < idx.length; t += 3) {
    const a = 3 * idx[t],
      b = 3 * idx[t + 1],
      c = 3 * idx[t + 2],
      over = pos[a + axis] > mm,
      ob = pos[b + axis] > mm,
      oc = pos[c + axis] > mm
    if (over === ob && ob === oc) continue
    const lone = over === ob ? c : over === oc ? b : a,
      p = lone === a ? b : a,
      q = lone === c ? b : c
    const f = (mm - pos[lone + axis]) / (pos[p + axis] - pos[lone + axis]),
      g = (mm - pos[lone + axis]) / (pos[q + axis] - pos[lone + axis])
    line(
      pos[lone + u] + f * (pos[p + u] - pos[lone + u]),
      pos[lone + v] + f * (pos[p + v] - pos[lone + v]),
      pos[lone + u] + g * (pos[q + u] - pos[lone + u]),
      pos[lone + v] + g * (pos[q + v] - pos[lone + v])
    )
  }
}

// A measure lies in one slice: from and to are its (u, v) there, in mm.
const lengthOf = m => Math.hypot(m.to[0] - m.from[0], m.to[1] - m.from[1])

// Where the middle of the first and of the last voxel lie.
const reach = (volume, axis) => [volume.origin[axis], volume.origin[axis] + volume.spacing[axis] * (volume.size[axis] - 1)]

// A slice's picture from a volume: colour(level) gives a pixel (as one 32-bit number) for each level. Row 0 is at the top.
function sliceImage(volume, plane, mm, colour) {
  const { size, spacing, origin, voxels } = volume,
    { axis, u, v } = plane
  const i = Math.round((mm - origin[axis]) / spacing[axis])
  if (i < 0 || i >= size[axis]) return null
  const step = [1, size[0], size[0] * size[1]],
    w = size[u],
    h = size[v],
    image = new ImageData(w, h),
    px = new Uint32Array(image.data.buffer)
  for (let y = 0, n = 0; y < h; ++y) {
    let at = i * step[axis] + (v === 2 ? h - 1 - y : y) * step[v]
    for (let x = 0; x < w; ++x, at += step[u]) px[n++] = colour[voxels[at]]
  }
  const canvas = document.createElement('canvas')
  canvas.width = w
  canvas.height = h
  canvas.getContext('2d').putImageData(image, 0, 0)
  return canvas
}

const pixel = (r, g, b, a) => ((a << 24) | (b << 16) | (g << 8) | r) >>> 0

// Draws one plane, at its zoom and pan. state: at, window, meshes, marks, measures, showCuts, showMarks, showFelt. It leaves in
// the plane how its pixels and mm belong together: place(u, v) in mm to pixels, and back(x, y).
function drawSlice(plane, page, state) {
  const canvas = $(plane.id),
    r = Math.min(2, devicePixelRatio || 1),
    w = (canvas.width = Math.max(1, (canvas.clientWidth * r) | 0)),
    h = (canvas.height = Math.max(1, (canvas.clientHeight * r) | 0))
  const c = canvas.getContext('2d'),
    { axis, u, v } = plane,
    up = v === 2 ? -1 : 1,
    [u0, u1] = state.reach[u],
    [v0, v1] = state.reach[v]
  const k = Math.min(w / (u1 - u0), h / (v1 - v0)) * 0.97 * plane.zoom
  const left = w / 2 + plane.pan[0] * r,
    top = h / 2 + plane.pan[1] * r
  const X = mm => left + (mm - (u0 + u1) / 2) * k,
    Y = mm => top + (mm - (v0 + v1) / 2) * k * up
  plane.place = (a, b) => [X(a) / r, Y(b) / r]
  plane.back = (x, y) => [(x * r - left) / k + (u0 + u1) / 2, ((y * r - top) / k) * up + (v0 + v1) / 2]
  c.fillStyle = '#000'
  c.fillRect(0, 0, w, h)
  const paint = (volume, colour, smooth) => {
    const image = volume && sliceImage(volume, plane, state.at[axis], colour)
    if (!image) return
    const { spacing: s, size: n, origin: o } = volume,
      top = up < 0 ? o[v] + s[v] * (n[v] - 0.5) : o[v] - s[v] / 2
    c.imageSmoothingEnabled = smooth
    c.drawImage(image, X(o[u] - s[u] / 2), Y(top), n[u] * s[u] * k, n[v] * s[v] * k)
  }
  paint(page.ct, state.grey, true)
  if (state.showFelt || !page.ct) paint(page.felt, state.feltColours, false)
  if (state.showCuts)
    for (const m of page.meshes) {
      if (!m.visible) continue
      c.strokeStyle = lineColour(m.rgb)
      c.lineWidth = 1.4 * r
      c.beginPath()
      cutSurface(m, axis, state.at[axis], u, v, (a, b, d, e) => {
        c.moveTo(X(a), Y(b))
        c.lineTo(X(d), Y(e))
      })
      c.stroke()
    }
  c.strokeStyle = 'rgba(90,200,255,.6)'
  c.lineWidth = r
  c.beginPath()
  c.moveTo(X(state.at[u]), 0)
  c.lineTo(X(state.at[u]), h)
  c.moveTo(0, Y(state.at[v]))
  c.lineTo(w, Y(state.at[v]))
  c.stroke()
  c.font = 11 * r + 'px sans-serif'
  const where = `${plane.id} ${'LPS'[axis]} ${state.at[axis].toFixed(1)} mm`,
    low = h - 4 * r
  const places = [
    [plane.ends[0], 4 * r, h / 2],
    [plane.ends[1], w - 13 * r, h / 2],
    [plane.ends[2], w / 2, 12 * r],
    [plane.ends[3], Math.max(w / 2, c.measureText(where).width + 12 * r), low],
    [where, 4 * r, low]
  ]
  for (const [text, left, base] of places) inked(c, text, left, base, '#b9cadb', r)
  for (const m of state.measures)
    if (m.plane === plane && Math.abs(m.mm - state.at[axis]) < 1e-3) {
      c.strokeStyle = '#7dffb0'
      c.lineWidth = 1.5 * r
      c.beginPath()
      c.moveTo(X(m.from[0]), Y(m.from[1]))
      c.lineTo(X(m.to[0]), Y(m.to[1]))
      c.stroke()
      inked(c, lengthOf(m).toFixed(1) + ' mm', X(m.to[0]) + 6 * r, Y(m.to[1]), '#7dffb0', r)
    }
  if (state.showMarks) {
    const near = page.marks.filter(l => Math.abs(l.p[axis] - state.at[axis]) < 3)
    drawLabels(
      c,
      near.map(l => ({ x: X(l.p[u]), y: Y(l.p[v]), mark: l })),
      r,
      places.map(p => boxOf(c, ...p, r))
    )
  }
}

// Legible on bright bone and on black air.
function inked(c, text, left, base, colour, r) {
  c.lineWidth = 3 * r
  c.strokeStyle = 'rgba(0,0,0,.75)'
  c.strokeText(text, left, base)
  c.fillStyle = colour
  c.fillText(text, left, base)
}
const boxOf = (c, text, left, base, r) => [left, base - 10 * r, left + c.measureText(text).width, base + 2 * r]

// The surface's hue at full strength: tissue is too pale for lines on grey.
function lineColour(rgb) {
  const low = Math.min(...rgb),
    range = Math.max(...rgb) - low
  const strong = range < 0.02 ? [1, 1, 1] : rgb.map(c => 0.1 + (0.9 * (c - low)) / range)
  return `rgb(${strong.map(c => Math.round(255 * c))})`
}

// Dots with their names; a name that would cover another one, or a box that is taken, is left out (the dot and the table still
// say it).
function drawLabels(c, places, r, taken = []) {
  for (const { x, y, mark } of places) {
    c.fillStyle = mark.colour
    c.beginPath()
    c.arc(x, y, 3.5 * r, 0, 7)
    c.fill()
    taken.push([x - 4 * r, y - 4 * r, x + 4 * r, y + 4 * r])
  }
  for (const { x, y, mark } of places) {
    const width = c.measureText(mark.label).width
    for (const [left, base] of [
      [x + 7 * r, y + 4 * r],
      [x - 7 * r - width, y + 4 * r],
      [x - width / 2, y - 8 * r],
      [x - width / 2, y + 16 * r]
    ]) {
      const box = boxOf(c, mark.label, left, base, r)
      if (taken.some(t => t[0] < box[2] && box[0] < t[2] && t[1] < box[3] && box[1] < t[3])) continue
      taken.push(box)
      inked(c, mark.label, left, base, '#fff', r)
      break
    }
  }
}
