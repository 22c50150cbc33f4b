// Part 4 of 4: what the page shows, and its controls.
async function start() {
  const began = performance.now(), page = await readCase(), { data, meshes } = page, times = { decoded: performance.now() - began }
  const shown = v => v === undefined ? '' : v
  const digits = (v, n) => typeof v === 'number' ? v.toLocaleString('en', { minimumFractionDigits: n, maximumFractionDigits: n }) : shown(v)
  const label = name => name.replace(/_/g, ' ')
  $('title').textContent = data.case
  document.title = data.case

  // ---- where everything lies
  const box = [[Infinity, -Infinity], [Infinity, -Infinity], [Infinity, -Infinity]]
  for (const m of meshes) if (!m.tool) for (let i = 0; i < m.pos.length; ++i) {
    const b = box[i % 3]
    b[0] = Math.min(b[0], m.pos[i]), b[1] = Math.max(b[1], m.pos[i])
  }
  const volume = page.ct || page.felt
  for (let k = 0; k < 3; ++k) if (!(box[k][0] < box[k][1])) box[k] = volume ? reach(volume, k) : [-1, 1]
  const centre = box.map(b => (b[0] + b[1]) / 2), radius = Math.hypot(...box.map(b => b[1] - b[0])) / 2
  for (const m of meshes) {
    m.size = m.tool ? Infinity : 0
    for (let i = 0; i < m.pos.length && !m.tool; i += 3) m.size = Math.max(m.size, Math.hypot(m.pos[i] - centre[0], m.pos[i + 1] - centre[1], m.pos[i + 2] - centre[2]))
  }
  // What lies outside is seen through, so that what lies inside is seen.
  const inward = meshes.filter(m => !m.tool).sort((a, b) => b.size - a.size)
  inward.forEach((m, i) => { if (inward.length > 1) m.opacity *= .25 + .75 * (i / (inward.length - 1)) ** 1.5 })

  const cam = makeCamera(centre, radius), clip = { axis: -1, mm: 0, keep: 1 }
  const mark = (name, p, colour, note) => ({ name, label: label(name), p, colour, note })
  page.marks = [
    ...data.burr_holes.map(h => mark(h.name, h.position_mm, '#ff7a3c', h.diameter_mm + ' mm')),
    ...data.targets.map(t => mark(t.name, t.position_mm, '#7cf0a0', 'target')),
    ...data.landmarks.filter(l => !data.targets.some(t => t.name === l.name)).map(l => mark(l.name, l.position_mm, '#ffd84a', l.source))
  ]
  const innermost = inward[inward.length - 1], at = [...centre]
  if (innermost) for (let k = 0; k < 3; ++k) {
    let low = Infinity, high = -Infinity
    for (let i = k; i < innermost.pos.length; i += 3) low = Math.min(low, innermost.pos[i]), high = Math.max(high, innermost.pos[i])
    at[k] = (low + high) / 2
  }
  const state = { at, meshes, showCuts: true, showMarks: true, showFelt: false, reach: box.map((b, k) => volume ? reach(volume, k).map((v, i) => i ? Math.max(v, b[1]) : Math.min(v, b[0])) : b) }
  const hu = data.ct && huOfLevels(data.ct.levels), window_ = { level: 40, width: 400 }
  const setWindow = (level, width) => {
    window_.level = level, window_.width = Math.max(1, width)
    state.grey = new Uint32Array(256)
    if (hu) hu.forEach((v, i) => {
      const g = Math.max(0, Math.min(255, Math.round(255 * ((v - window_.level) / window_.width + .5))))
      state.grey[i] = pixel(g, g, g, 255)
    })
    $('level').value = Math.round(window_.level), $('width').value = Math.round(window_.width)
  }
  state.feltColours = new Uint32Array(256)
  if (data.felt) for (const s of data.felt.shapes) state.feltColours[s.number] = pixel(...s.colour_rgb.map(c => c * 255 | 0), page.ct ? 120 : 200)
  setWindow(40, 400)

  // ---- drawing
  const view = $('view'), solid = $('solid'), over = $('over'), root = document.documentElement
  const wanted = location.hash === '#processor' ? null : glPainter(solid, meshes), painter = wanted || softPainter(solid, meshes)
  if (!wanted) $('mode').textContent = (location.hash === '#processor' ? '' : 'no WebGL2 here: ') + 'drawn by the processor'
  // A library's page leads here with this word. Whoever opens the page alone may have no library beside it.
  $('library').hidden = location.hash !== '#library'
  // The desk shows the surfaces alone while its frame is small: it has slices of its own.
  root.classList.toggle('framed', location.hash === '#framed')
  let heat = null, scale = 1, moving = false
  const render = () => {
    const r = Math.min(2, devicePixelRatio || 1), w = Math.max(1, view.clientWidth * r | 0), h = Math.max(1, view.clientHeight * r | 0), t = performance.now()
    for (const c of [solid, over]) if (c.width !== w || c.height !== h) c.width = w, c.height = h
    const ground = root.classList.contains('light') ? [.95, .96, .97] : [.1, .11, .13]
    painter.draw({ cam, clip, heat, scale, ground, moving })
    times.frame = performance.now() - t
    drawOver(over.getContext('2d'), w, h, r)
  }
  function drawOver(c, w, h, r) {
    const m = cam.matrix(w, h), to = p => cam.project(m, w, h, p)
    const stroke = (p, q, colour, width) => {
      c.strokeStyle = colour, c.lineWidth = width * r
      c.beginPath(), c.moveTo(...to(p)), c.lineTo(...to(q)), c.stroke()
    }
    c.clearRect(0, 0, w, h)
    for (let k = 0; k < 3; ++k) {
      const p = [...at], q = [...at]
      p[k] = box[k][0], q[k] = box[k][1]
      stroke(p, q, 'rgba(90,200,255,.6)', 1)
    }
    for (const b of data.burr_holes) stroke(b.position_mm.map((x, k) => x - 40 * b.direction[k]), b.position_mm.map((x, k) => x + 60 * b.direction[k]), '#ff7a3c', 1.5)
    c.font = 11 * r + 'px sans-serif'
    if (state.showMarks) drawLabels(c, page.marks.map(l => {
      const [x, y] = to(l.p)
      return { x, y, mark: l }
    }), r)
    // Which way is left, posterior and superior.
    const { right, up } = cam.basis(), x0 = 40 * r, y0 = h - 90 * r
    'LPS'.split('').forEach((letter, k) => {
      const x = x0 + 28 * r * right[k], y = y0 - 28 * r * up[k]
      c.strokeStyle = c.fillStyle = ['#ff8a7a', '#8fd6a0', '#7cc4ff'][k]
      c.beginPath(), c.moveTo(x0, y0), c.lineTo(x, y), c.stroke()
      c.fillText(letter, x + 3 * r * right[k] - 3 * r, y - 3 * r * up[k] + 4 * r)
    })
  }
  const slices = () => {
    const t = performance.now()
    for (const p of planes) drawSlice(p, page, state)
    times.slices = performance.now() - t
    $('where').textContent = `cross-hair: L ${at[0].toFixed(1)}, P ${at[1].toFixed(1)}, S ${at[2].toFixed(1)} mm` + (hu ? huText() : '')
  }
  const huText = () => {
    const i = at.map((v, k) => Math.round((v - page.ct.origin[k]) / page.ct.spacing[k]))
    return i.some((v, k) => v < 0 || v >= page.ct.size[k]) ? '' : `, ${Math.round(hu[page.ct.voxels[i[0] + page.ct.size[0] * (i[1] + page.ct.size[1] * i[2])]])} HU`
  }
  let due = 0, dueSlices = 0
  const redraw = () => { due = due || requestAnimationFrame(() => { due = 0; render() }) }
  const reslice = () => { dueSlices = dueSlices || requestAnimationFrame(() => { dueSlices = 0; slices() }) }
  const both = () => { redraw(), reslice() }
  const go = p => {
    for (let k = 0; k < 3; ++k) at[k] = p[k]
    if (clip.axis >= 0) clip.mm = at[clip.axis]
    both()
  }
  solid.addEventListener('webglcontextlost', e => e.preventDefault())
  solid.addEventListener('webglcontextrestored', () => { painter.upload(), redraw() })

  // ---- the view: mouse, touch, keys
  const pointers = new Map()
  let pinch = 0, travelled = 0
  const spread = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]) }
  const local = e => { const b = view.getBoundingClientRect(); return [e.clientX - b.left, e.clientY - b.top] }
  const click = (x, y) => {
    const w = view.clientWidth, h = view.clientHeight, m = cam.matrix(w, h)
    const near = state.showMarks && page.marks.find(l => { const [a, b] = cam.project(m, w, h, l.p); return Math.hypot(a - x, b - y) < 7 })
    const p = near ? near.p : pick(meshes, clip, cam.ray(x, y, w, h))
    if (p) go(p)
  }
  view.addEventListener('pointerdown', e => {
    if (e.target !== solid) return
    view.setPointerCapture(e.pointerId)
    pointers.set(e.pointerId, [e.clientX, e.clientY])
    travelled = pointers.size === 1 ? 0 : 99
    pinch = pointers.size === 2 ? spread() : 0
    view.focus()
  })
  view.addEventListener('pointermove', e => {
    const old = pointers.get(e.pointerId)
    if (!old) return
    const dx = e.clientX - old[0], dy = e.clientY - old[1], mm = cam.mmPerPixel(view.clientWidth, view.clientHeight)
    pointers.set(e.pointerId, [e.clientX, e.clientY])
    travelled += Math.abs(dx) + Math.abs(dy)
    if (travelled < 4) return
    moving = true
    if (pointers.size === 2) {
      const d = spread()
      if (pinch && d) cam.dist *= pinch / d
      pinch = d
      cam.pan[0] += dx * mm / 2, cam.pan[1] -= dy * mm / 2
    } else if (e.shiftKey || e.buttons & 6) cam.pan[0] += dx * mm, cam.pan[1] -= dy * mm
    else turn(-dx * .008, dy * .008)
    redraw()
  })
  const release = e => {
    if (!pointers.delete(e.pointerId)) return
    pinch = 0
    if (moving) { moving = false, redraw() } else if (e.type === 'pointerup' && e.button === 0 && travelled < 4) click(...local(e))
  }
  view.addEventListener('pointerup', release)
  view.addEventListener('pointercancel', release)
  view.addEventListener('contextmenu', e => e.preventDefault())
  view.addEventListener('wheel', e => { e.preventDefault(), zoom(Math.exp(Math.sign(e.deltaY) * .08)) }, { passive: false })
  const turn = (az, el) => { cam.az += az, cam.el = Math.max(-1.55, Math.min(1.55, cam.el + el)), redraw() }
  const zoom = factor => { cam.dist = Math.max(radius * .05, Math.min(radius * 40, cam.dist * factor)), redraw() }
  const sides = { a: [0, 0], p: [Math.PI, 0], l: [Math.PI / 2, 0], r: [-Math.PI / 2, 0], s: [0, 1.55], i: [0, -1.55] }
  const side = name => {
    if (name === 'home') cam.reset()
    else [cam.az, cam.el] = sides[name]
    redraw()
  }
  for (const b of document.querySelectorAll('#views button')) b.addEventListener('click', () => side(b.dataset.view))
  const keys = { arrowleft: () => turn(.1, 0), arrowright: () => turn(-.1, 0), arrowup: () => turn(0, .1), arrowdown: () => turn(0, -.1), '+': () => zoom(.9), '-': () => zoom(1 / .9), 0: () => side('home') }
  addEventListener('keydown', e => {
    if (e.target.matches('input,select,canvas.slice,button,tr') || e.ctrlKey || e.metaKey || e.altKey) return
    const k = e.key.toLowerCase(), n = +k
    if (sides[k]) side(k)
    else if (keys[k]) keys[k]()
    else if (n && meshes[n - 1]) meshes[n - 1].box.click()
    else return
    e.preventDefault()
  })

  // ---- the slices: a click sets the cross-hair, a drag or the wheel scrolls, a right drag sets the window
  for (const p of planes) {
    const canvas = $(p.id), spacing = volume ? volume.spacing[p.axis] : 1
    let from = null
    const step = n => {
      const q = [...at], [low, high] = state.reach[p.axis]
      q[p.axis] = Math.max(low, Math.min(high, q[p.axis] + n * spacing))
      go(q)
    }
    canvas.addEventListener('pointerdown', e => {
      canvas.setPointerCapture(e.pointerId)
      from = { x: e.clientX, y: e.clientY, moved: false, rest: 0, window: { ...window_ } }
    })
    canvas.addEventListener('pointermove', e => {
      if (!from) return
      const dx = e.clientX - from.x, dy = e.clientY - from.y
      if (!from.moved && Math.hypot(dx, dy) < 4) return
      from.moved = true
      if (e.buttons & 2) {
        setWindow(from.window.level - dy, from.window.width + 2 * dx)
        $('window').value = 'free'
        reslice()
      } else {
        const n = Math.trunc(-dy / 3) - from.rest
        from.rest += n
        if (n) step(n)
      }
    })
    canvas.addEventListener('pointerup', e => {
      if (from && !from.moved && e.button === 0) {
        const b = canvas.getBoundingClientRect(), q = [...at];
        [q[p.u], q[p.v]] = p.back(e.clientX - b.left, e.clientY - b.top)
        go(q)
      }
      from = null
    })
    canvas.addEventListener('pointercancel', () => { from = null })
    canvas.addEventListener('contextmenu', e => e.preventDefault())
    canvas.addEventListener('wheel', e => { e.preventDefault(), step(e.deltaY > 0 ? -1 : 1) }, { passive: false })
    canvas.addEventListener('keydown', e => {
      const n = { ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5 }[e.key]
      if (n) e.preventDefault(), step(n)
    })
  }

  // ---- panel
  const listen = (id, event, f) => $(id).addEventListener(event, f)
  const hex = rgb => '#' + rgb.map(c => Math.round(255 * c).toString(16).padStart(2, '0')).join('')
  meshes.forEach((m, i) => {
    const row = make('div', 'row'), on = m.box = make('input'), colour = make('input'), opacity = make('input'), name = make('label', '', `${i + 1} ${label(m.name)}`)
    on.type = 'checkbox', on.checked = true, on.id = 'on-' + i, name.htmlFor = on.id
    on.addEventListener('change', () => { m.visible = on.checked, both() })
    colour.type = 'color', colour.value = hex(m.rgb), colour.id = 'colour-' + i, colour.setAttribute('aria-label', 'colour of ' + label(m.name))
    colour.addEventListener('input', () => { m.rgb = [1, 3, 5].map(k => parseInt(colour.value.slice(k, k + 2), 16) / 255), both() })
    opacity.type = 'range', opacity.min = 0, opacity.max = 1, opacity.step = .01, opacity.value = m.opacity, opacity.id = 'opacity-' + i
    opacity.setAttribute('aria-label', 'opacity of ' + label(m.name))
    opacity.addEventListener('input', () => { m.opacity = +opacity.value, redraw() })
    row.append(on, colour, name, opacity)
    if (m.dev) {
      const b = m.heatButton = make('button', '', 'deviation')
      b.type = 'button', b.id = 'deviation-' + i
      b.addEventListener('click', () => {
        heat = heat === m ? null : m
        for (const x of meshes) if (x.heatButton) x.heatButton.classList.toggle('on', x === heat)
        $('bar').hidden = !heat
        if (heat) m.opacity = opacity.value = 1
        if (heat) $('scale').max = Math.max(.05, 2 * m.p99), setScale(Math.max(.01, m.p99))
        redraw()
      })
      row.append(b)
    }
    $('anatomies').append(row)
  })
  const setScale = mm => {
    scale = mm
    $('scale').value = mm
    $('bar-name').textContent = heat ? 'deviation of ' + label(heat.name) : ''
    $('bar-low').textContent = '−' + mm.toFixed(2), $('bar-high').textContent = '+' + mm.toFixed(2) + ' mm'
  }
  listen('scale', 'input', e => { setScale(+e.target.value), redraw() })
  listen('clip', 'change', e => { clip.axis = +e.target.value, clip.mm = at[clip.axis] || 0, redraw() })
  listen('clip-what', 'change', e => { for (const m of meshes) m.clip = !m.tool && (e.target.value === 'all' || m !== innermost); redraw() })
  listen('flip', 'click', () => { clip.keep *= -1, redraw() })
  listen('show-marks', 'change', e => { state.showMarks = e.target.checked, both() })
  listen('show-cuts', 'change', e => { state.showCuts = e.target.checked, reslice() })
  listen('show-felt', 'change', e => { state.showFelt = e.target.checked, reslice() })
  listen('window', 'change', e => { if (e.target.value !== 'free') setWindow(...e.target.value.split(',').map(Number)), reslice() })
  for (const id of ['level', 'width']) listen(id, 'change', () => { $('window').value = 'free', setWindow(+$('level').value, +$('width').value), reslice() })
  listen('theme', 'click', () => { $('theme').textContent = root.classList.toggle('light') ? 'dark' : 'light', redraw() })
  for (const id of ['window', 'level', 'width']) $(id).disabled = !page.ct
  $('show-felt').disabled = !page.felt || !page.ct
  $('show-felt').checked = !!page.felt && !page.ct

  // ---- texts and tables; a cell's title holds the value as case.json has it
  const table = (id, head, rows) => {
    const t = make('table'), top = make('tr')
    for (const x of head) top.append(make('th', '', x))
    t.append(top)
    for (const { cells, jump } of rows) {
      const tr = make('tr', jump ? 'jump' : '')
      for (const [text, exact] of cells) {
        const td = make('td', typeof exact === 'number' || exact === undefined && text === '' ? 'number' : '', text)
        if (exact !== undefined) td.title = String(exact)
        tr.append(td)
      }
      if (jump) {
        tr.tabIndex = 0
        tr.addEventListener('click', () => go(jump))
        tr.addEventListener('keydown', e => { if (e.key === 'Enter') go(jump) })
      }
      t.append(tr)
    }
    $(id).append(t)
  }
  const voxels = mm => mm.map(v => +v.toFixed(2)).join(' × ')
  const cell = (v, n) => [digits(v, n), v], values = o => Object.entries(o).map(([k, v]) => ({ cells: [[label(k)], [typeof v === 'number' ? digits(v, Number.isInteger(v) ? 0 : 3) : String(v), v]] }))
  $('source').textContent = page.ct ? `Slices: ${data.ct.from === 'ct' ? 'the CT of the case' : 'the HU of the haptic volume'}, on voxels of ${voxels(data.ct.spacing_mm)} mm; the case has ${voxels(data.ct.of_spacing_mm)} mm.` : page.felt ? 'Slices: the shapes of the haptic volume; the case holds no CT.' : 'The case holds neither CT nor haptic volume.'
  for (const w of data.warnings) $('warnings').append(make('p', 'bad', w))
  if (!data.warnings.length) $('warnings').append(make('p', 'good', 'No warnings.'))
  table('surfaces', ['surface', 'triangles', 'ml', 'cm²', 'max', 'p99', 'RMS', 'used'], data.anatomies.map(a => {
    const d = a.deviation_mm || {}, b = a.budget_mm || {}
    return { cells: [[label(a.name)], cell(a.case_triangles, 0), cell(a.volume_ml, 1), cell(a.area_cm2, 1), cell(d.max, 3), cell(d.p99, 3), cell(d.rms, 3), cell(b.used, 3)] }
  }))
  $('surfaces').append(make('p', 'faint', 'max, p99, RMS: two-sided deviation from the surface before decimation, mm; used: of the error budget, mm.'))
  for (const a of data.anatomies) {
    if (a.from === 'haptic') $('surfaces').append(make('p', 'faint', `${label(a.name)} is displayed from the haptic volume; here contoured coarsely (${digits(a.triangles, 0)} triangles).`))
    if (a.from === 'none') $('surfaces').append(make('p', 'faint', `${label(a.name)} has no surface here.`))
  }
  const where = p => [p.map(x => x.toFixed(1)).join('\u00a0 '), p.join(', ')]
  table('landmarks', ['landmark', 'L P S, mm', 'sure', 'source'], [
    ...data.landmarks.filter(l => !data.targets.some(t => t.name === l.name)).map(l => ({ cells: [[label(l.name), l.name], where(l.position_mm), cell(l.confidence, 2), [l.source]], jump: l.position_mm })),
    ...data.targets.map(t => ({ cells: [[label(t.name), t.name], where(t.position_mm), cell(t.confidence, 2), [((data.landmarks.find(l => l.name === t.name) || {}).source || '') + ' target' + (t.anatomy ? ' in ' + label(t.anatomy) : '')]], jump: t.position_mm }))
  ])
  if (data.burr_holes.length) $('holes').append(make('h2', '', 'Burr holes'))
  for (const b of data.burr_holes) {
    table('holes', ['burr hole', 'L P S, mm', 'direction', 'mm'], [{ cells: [[label(b.name)], where(b.position_mm), [b.direction.map(x => x.toFixed(2)).join(', '), b.direction.join(', ')], cell(b.diameter_mm, 1)], jump: b.position_mm }])
    table('holes', [], values({ cut_from: b.cut.join(', '), ...b.figures }))
  }
  table('figures', [], values(data.figures))
  table('provenance', [], values({ program: data.provenance.program, input_sha256: data.provenance.input_sha256, face: data.face.policy + (data.face.reason ? ': ' + data.face.reason : '') }))
  const more = make('details'), parameters = make('div')
  parameters.id = 'parameters'
  more.append(make('summary', '', 'effective parameters'), parameters)
  $('provenance').append(more)
  table('parameters', [], values(data.provenance.parameters))
  if (data.trade) drawTrade(data.trade)

  new ResizeObserver(both).observe(view)
  render()
  slices()
  times.first = performance.now() - began
  // For tests and the curious.
  window.trephine = { page, data, meshes, cam, at, clip, state, times, planes, render, slices, go, pick, cutSurface, kind: painter.kind }
  root.dataset.ready = '1'
}

// Seconds against deviation of the points that were measured, and the one that the case's settings come from.
function drawTrade(trade) {
  const points = trade.points.filter(p => !p.refused && p.seconds > 0 && p.deviation_rms_mm > 0), w = 340, h = 190
  const space = 'http://www.w3.org/2000/svg', svg = document.createElementNS(space, 'svg')
  const add = (tag, attributes, text) => {
    const e = document.createElementNS(space, tag)
    for (const k in attributes) e.setAttribute(k, attributes[k])
    if (text !== undefined) e.textContent = text
    svg.append(e)
    return e
  }
  $('trade').append(make('h2', '', 'Speed against accuracy'), make('p', 'faint', `${trade.rule}: point ${trade.chosen}, ${trade.why}`))
  if (!points.length) return
  svg.setAttribute('viewBox', `0 0 ${w} ${h}`)
  const axis = (values, from, to) => {
    const low = Math.min(...values), high = Math.max(...values)
    return { low, high, at: v => high > low ? from + (to - from) * Math.log(v / low) / Math.log(high / low) : (from + to) / 2 }
  }
  const x = axis(points.map(p => p.seconds), 45, w - 20), y = axis(points.map(p => p.deviation_rms_mm), h - 32, 15)
  add('path', { d: `M40 8V${h - 26}H${w - 8}` })
  add('text', { x: w / 2 - 30, y: h - 3, class: 'axis' }, 'seconds (log)')
  add('text', { x: 44, y: 12, class: 'axis' }, 'RMS mm (log)')
  for (const v of [x.low, x.high]) add('text', { x: x.at(v) - 10, y: h - 15, class: 'axis' }, v.toFixed(1))
  for (const v of [y.low, y.high]) add('text', { x: 4, y: y.at(v) + 4, class: 'axis' }, v.toFixed(2))
  for (const p of points) {
    const chosen = p.name === trade.chosen, dot = add('circle', { cx: x.at(p.seconds), cy: y.at(p.deviation_rms_mm), r: chosen ? 6 : 3.5, class: chosen ? 'chosen' : 'point' })
    const title = document.createElementNS(space, 'title')
    title.textContent = `${p.name}: ${p.seconds} s, ${p.deviation_rms_mm} mm, ${p.triangles_count} triangles`
    dot.append(title)
  }
  $('trade').append(svg)
}

addEventListener('error', e => tell(e.message || 'The page failed.'))
addEventListener('DOMContentLoaded', () => {
  if (!window.DecompressionStream) return tell('This browser is too old for this page: it needs Chromium 80, Firefox 113 or Safari 16.4, or a later one.')
  start().catch(e => tell(e.message))
})
