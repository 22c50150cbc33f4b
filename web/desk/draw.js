// What is drawn on a plane: the slice in grey, outlines, marks, measures.

function redraw(page) {
  const { frame } = page
  frame.due =
    frame.due ||
    requestAnimationFrame(() => {
      frame.due = 0
      drawPlanes(page)
    })
}

function colourOf(page, name) {
  const { frame } = page
  const all = page.info && page.info.now ? page.info.now.anatomies : []
  if (frame.coloursOf !== all) {
    frame.coloursOf = all
    frame.colours = toldApart(all.filter(a => a.field))
  }
  return frame.colours.get(name) || '#ffffff'
}

function drawPlanes(page) {
  if (page.volume) for (const p of page.volume.planes) drawPlane(page, p)
}

function greys(page) {
  const { frame } = page
  const { level, width } = page.window,
    key = level + ':' + width
  if (frame.greyOf === key) return frame.grey
  frame.grey = frame.grey || new Uint32Array(65536)
  for (let i = 0; i < 65536; ++i) {
    const g = Math.max(0, Math.min(255, Math.round(((i - 32768 - level) / width + 0.5) * 255)))
    frame.grey[i] = rgba(g, g, g)
  }
  frame.greyOf = key
  return frame.grey
}

function drawPlane(page, p) {
  const { canvases } = page.frame
  const { volume } = page,
    canvas = canvases[p.id],
    index = page.at[p.n],
    began = performance.now()
  if (!canvas.clientWidth) return
  layOut(p, volume, canvas)
  const c = canvas.getContext('2d')
  const data = volume.has(p.n, index)
  if (!data) {
    volume.slice(p.n, index).then(page.redraw, e => {
      if (!(e instanceof Superseded)) problem(e.message)
    })
    if (!p.drawn) return
  } else if (p.shown !== index || p.window !== page.window.level + ':' + page.window.width || p.range !== page.range) {
    const table_ = greys(page),
      range = page.range
    pixelsOf(
      p,
      volume,
      range
        ? at =>
            data[at] >= range[0] && data[at] <= range[1]
              ? (table_[data[at] + 32768] & 0xff00ff00) | 0x00000000 | 0x30
              : table_[data[at] + 32768]
        : at => table_[data[at] + 32768]
    )
    p.shown = index
    p.window = page.window.level + ':' + page.window.width
    p.range = range
  }
  p.drawn = true
  c.fillStyle = '#000'
  c.fillRect(0, 0, p.w, p.h)
  c.imageSmoothingEnabled = p.k * Math.min(volume.spacing[p.u], volume.spacing[p.v]) < 4
  c.drawImage(p.voxels, p.left, p.top, p.wide, p.high)
  for (const overlay of page.overlays) overlay(p, c)
  // What is approved, and what is asked for as built, is the surface with its holes, not the field that it was made of.
  const built = page.asBuilt || page.tab === 'approve' ? (desk.cases.find(c => c.case === page.token) || {}).anatomies : null,
    asBuilt = new Set((built || []).map(a => a.name))
  for (const [name, on] of page.outlines) {
    if (!on || !page.fields.includes(name) || (page.compared && page.tab === 'build' && page.compared.has(name))) continue
    const line = asBuilt.has(name) ? volume.cut('built', name, p.n, index) : volume.outline(name, p.n, index)
    if (line.then) line.then(page.redraw, () => {})
    else strokeOutline(c, p, line, colourOf(page, name))
  }
  const [i, j] = [p.X(page.at[p.u]), p.Y(page.at[p.v])]
  c.strokeStyle = 'rgba(90,200,255,.55)'
  c.lineWidth = p.r
  c.beginPath()
  c.moveTo(i, 0)
  c.lineTo(i, p.h)
  c.moveTo(0, j)
  c.lineTo(p.w, j)
  c.stroke()
  c.font = `${12 * p.r}px system-ui, sans-serif`
  if (page.marks) drawMarks(page, p, c)
  for (const m of page.measures) if (m.plane === p.id && m.index === index) drawMeasure(page, p, c, m)
  if (page.line && page.line.plane === p.id && page.line.index === index) drawMeasure(page, p, c, page.line)
  const w = volume.toWorld(page.at),
    place = `${t(p.id)}  ${sided(w[p.patient], p.patient)} mm  ${index + 1}/${volume.size[p.n]}`
  for (const [text, x, y] of [
    [p.ends[0], 5 * p.r, p.h / 2],
    [p.ends[1], p.w - 15 * p.r, p.h / 2],
    [p.ends[2], p.w / 2, 15 * p.r],
    [p.ends[3], p.w / 2, p.h - 6 * p.r],
    [place, 5 * p.r, p.h - 6 * p.r]
  ])
    inked(c, text, x, y, '#c5d4e3', p.r)
  desk.stats.draw = performance.now() - began
  desk.stats.draws = (desk.stats.draws || 0) + 1
}

function strokeOutline(c, p, line, colour, dash = []) {
  const swap = p.u > p.v
  c.setLineDash(dash.map(d => d * p.r))
  c.strokeStyle = colour
  c.lineWidth = 1.4 * p.r
  c.beginPath()
  for (let i = 0; i < line.length; i += 4) {
    const a = swap ? 1 : 0,
      b = 1 - a
    c.moveTo(p.X(line[i + a]), p.Y(line[i + b]))
    c.lineTo(p.X(line[i + 2 + a]), p.Y(line[i + 2 + b]))
  }
  // What is dashed lies on bone and on air: a dark rim lets it be seen on both.
  if (dash.length) {
    c.lineWidth = 3.4 * p.r
    c.strokeStyle = 'rgba(0,0,0,.75)'
    c.stroke()
    c.lineWidth = 1.6 * p.r
    c.strokeStyle = colour
  }
  c.stroke()
  c.setLineDash([])
}

function inked(c, text, x, y, colour, r) {
  c.lineWidth = 3 * r
  c.strokeStyle = 'rgba(0,0,0,.8)'
  c.strokeText(text, x, y)
  c.fillStyle = colour
  c.fillText(text, x, y)
}

function drawMarks(page, p, c) {
  const taken = []
  for (const m of page.allMarks()) {
    const at = page.volume.toIndex(m.position_mm),
      off = Math.abs(at[p.n] - page.at[p.n]) * page.volume.spacing[p.n]
    if (off > 3) continue
    c.fillStyle = m.colour
    c.globalAlpha = off < 1 ? 1 : 0.55
    c.beginPath()
    c.arc(p.X(at[p.u]), p.Y(at[p.v]), 4 * p.r, 0, 7)
    c.fill()
    c.globalAlpha = 1
    // Labels of neighbours stand below each other.
    const text = label(m.name) + (m.unsure ? ' ?' : ''),
      x = p.X(at[p.u]) + 7 * p.r,
      wide = c.measureText(text).width,
      high = 14 * p.r
    let y = p.Y(at[p.v]) + 4 * p.r
    while (taken.some(b => x < b.x + b.wide && b.x < x + wide && Math.abs(y - b.y) < high)) y += high / 2
    taken.push({ x, y, wide })
    inked(c, text, x, y, '#fff', p.r)
  }
}

function drawMeasure(page, p, c, m) {
  const [x0, y0, x1, y1] = [p.X(m.from[p.u]), p.Y(m.from[p.v]), p.X(m.to[p.u]), p.Y(m.to[p.v])]
  c.strokeStyle = m === page.line ? '#f0c45c' : '#7cf0a0'
  c.lineWidth = 1.6 * p.r
  c.beginPath()
  c.moveTo(x0, y0)
  c.lineTo(x1, y1)
  c.stroke()
  inked(c, digits(m.mm, 1) + ' mm', x1 + 6 * p.r, y1 - 6 * p.r, c.strokeStyle, p.r)
}

// What is less sure than one in two is no colour that says "here it is", and its name asks.
function foundMark({ name, position_mm, confidence }, colour) {
  const unsure = confidence < 0.5
  return { name, position_mm, unsure, colour: unsure ? '#9aa7b5' : colour }
}

function allMarks(page) {
  const marks = []
  const built = page.info && page.info.built,
    now = page.info && page.info.now
  const given = now ? now.landmarks : {}
  for (const l of page.foundMarks())
    if (!given[l.name]) marks.push(foundMark(l, '#ffd84a'))
  for (const [name, position_mm] of Object.entries(given)) marks.push({ name, position_mm, colour: '#ff9c3c' })
  for (const target of built ? built.targets : [])
    if (!given[target.name] && !marks.some(m => m.name === target.name)) marks.push(foundMark(target, '#7cf0a0'))
  for (const h of built ? built.holes : []) marks.push({ name: h.name, position_mm: h.position_mm, colour: '#ff6a5c' })
  return marks.concat(page.more ? page.more() : [])
}

// 12.3 mm to the left is L 12.3, and to the right R 12.3.
const sided = (v, axis) => `${(v < 0 ? 'RAI' : 'LPS')[axis]} ${Math.abs(v).toFixed(1)}`

// Lines on grey: the recipe's hues at full strength, for tissue is too pale. Of two of nearly one hue the second is lighter.
function toldApart(anatomies) {
  const hue = rgb => {
    const low = Math.min(...rgb),
      range = Math.max(...rgb) - low
    if (range < 0.02) return null
    const [r, g, b] = rgb.map(c => (c - low) / range)
    return (r === 1 ? (g - b + 6) % 6 : g === 1 ? b - r + 2 : r - g + 4) * 60
  }
  const out = new Map(),
    taken = []
  for (const { name, colour_rgb } of anatomies) {
    const own = hue(colour_rgb)
    let step = 0
    while (
      taken.some(
        ([h, s]) =>
          s === step && (h === null || own === null ? h === own : Math.min(Math.abs(h - own), 360 - Math.abs(h - own)) < 15)
      ) &&
      step < 3
    )
      ++step
    taken.push([own, step])
    const low = Math.min(...colour_rgb),
      range = Math.max(...colour_rgb) - low
    const full = own === null ? [1, 1, 1] : colour_rgb.map(c => 0.15 + (0.85 * (c - low)) / range)
    out.set(
      name,
      `rgb(${full.map(c => Math.round(255 * (own === null ? c * (1 - 0.3 * step) : c + (1 - c) * Math.min(0.8, 0.5 * step))))})`
    )
  }
  return out
}
