// Part 5: a case: its planes beside the 3D page, the tools, and the panels.
function casePage(token) {
  const page = { name: 'case', token, tool: 'cross', at: [0, 0, 0], volume: null, info: null, window: { level: 40, width: 400 }, outlines: new Map(), measures: [], line: null, marks: true, timers: [], fields: [], tab: 'look', range: null, overlays: [] }
  const views = make('div', { class: 'views' }), tools = make('nav', { class: 'tools', 'aria-label': 'tools' }), tabs = make('div', { class: 'tabs', role: 'tablist' }), panel = make('div', { class: 'panel', id: 'panel' })
  page.panels = {}
  page.every = (f, ms) => page.timers.push(setInterval(f, ms))

  // ---- views
  const canvases = {}
  const box = (id, content) => {
    const b = make('div', { class: 'view', 'data-view': id }, content, make('button', { class: 'most', title: t('bigger'), 'aria-label': t('bigger'), click: () => {
      const one = views.classList.contains('one') && b.classList.contains('chosen')
      views.classList.toggle('one', !one)
      for (const other of views.children) other.classList.toggle('chosen', !one && other === b)
      page.redraw()
    } }))
    return b
  }
  for (const p of PLANES) canvases[p.id] = make('canvas', { id: p.id, tabIndex: 0, 'aria-label': t(p.id) })
  const solid = make('div', { class: 'wait', text: t('solid') }), wait = make('div', { class: 'wait', id: 'opening', text: t('opening') })
  const solidBox = box('solid', solid)
  views.append(box('axial', canvases.axial), box('coronal', canvases.coronal), box('sagittal', canvases.sagittal), solidBox)
  views.firstChild.append(wait)
  page.showSolid = () => {
    const c = desk.cases.find(c => c.case === token)
    const told = make('div', { class: 'wait', text: t(c && c.page ? 'page_comes' : 'no_page') })
    for (const old of solidBox.querySelectorAll('iframe, .wait')) old.remove()
    if (c && c.page) solidBox.append(make('iframe', { title: t('solid'), src: `case/${token}/report/view.html#framed`, sandbox: 'allow-scripts', load: () => { told.hidden = true } }))
    solidBox.append(told)
  }

  // ---- drawing
  let due = 0
  page.redraw = () => { due = due || requestAnimationFrame(() => { due = 0; draw() }) }
  let colours = new Map(), coloursOf = null
  const colourOf = name => {
    const all = page.info && page.info.now ? page.info.now.anatomies : []
    if (coloursOf !== all) coloursOf = all, colours = toldApart(all.filter(a => a.field))
    return colours.get(name) || '#ffffff'
  }
  page.colourOf = colourOf
  const draw = () => { if (page.volume) for (const p of page.volume.planes) drawPlane(p) }
  // HU to grey, once a window: a slice is then a look into a table.
  let grey = null, greyOf = ''
  const greys = () => {
    const { level, width } = page.window, key = level + ':' + width
    if (greyOf === key) return grey
    grey = grey || new Uint32Array(65536)
    for (let i = 0; i < 65536; ++i) {
      const g = Math.max(0, Math.min(255, Math.round(((i - 32768 - level) / width + .5) * 255)))
      grey[i] = rgba(g, g, g)
    }
    greyOf = key
    return grey
  }
  function drawPlane(p) {
    const { volume } = page, canvas = canvases[p.id], index = page.at[p.n], began = performance.now()
    if (!canvas.clientWidth) return
    layOut(p, volume, canvas)
    const c = canvas.getContext('2d')
    const data = volume.has(p.n, index)
    if (!data) {
      volume.slice(p.n, index).then(page.redraw, e => { if (!(e instanceof Superseded)) problem(e.message) })
      if (!p.drawn) return
    } else if (p.shown !== index || p.window !== page.window.level + ':' + page.window.width || p.range !== page.range) {
      const table_ = greys(), range = page.range
      pixelsOf(p, volume, range ? at => data[at] >= range[0] && data[at] <= range[1] ? (table_[data[at] + 32768] & 0xff00ff00 | 0x00000000) | 0x30 : table_[data[at] + 32768] : at => table_[data[at] + 32768])
      p.shown = index, p.window = page.window.level + ':' + page.window.width, p.range = range
    }
    p.drawn = true
    c.fillStyle = '#000'
    c.fillRect(0, 0, p.w, p.h)
    c.imageSmoothingEnabled = p.k * Math.min(volume.spacing[p.u], volume.spacing[p.v]) < 4
    c.drawImage(p.voxels, p.left, p.top, p.wide, p.high)
    for (const overlay of page.overlays) overlay(p, c)
    // What is approved, and what is asked for as built, is the surface with its holes, not the field that it was made of.
    const built = page.asBuilt || page.tab === 'approve' ? (desk.cases.find(c => c.case === token) || {}).anatomies : null, asBuilt = new Set((built || []).map(a => a.name))
    for (const [name, on] of page.outlines) {
      if (!on || !page.fields.includes(name) || page.compared && page.tab === 'build' && page.compared.has(name)) continue  // drawn as it was and is
      const line = asBuilt.has(name) ? volume.cut('built', name, p.n, index) : volume.outline(name, p.n, index)
      if (line.then) line.then(page.redraw, () => {})
      else strokeOutline(c, p, line, colourOf(name))
    }
    const [i, j] = [p.X(page.at[p.u]), p.Y(page.at[p.v])]
    c.strokeStyle = 'rgba(90,200,255,.55)'
    c.lineWidth = p.r
    c.beginPath(), c.moveTo(i, 0), c.lineTo(i, p.h), c.moveTo(0, j), c.lineTo(p.w, j), c.stroke()
    c.font = `${12 * p.r}px system-ui, sans-serif`
    if (page.marks) drawMarks(p, c)
    for (const m of page.measures) if (m.plane === p.id && m.index === index) drawMeasure(p, c, m)
    if (page.line && page.line.plane === p.id && page.line.index === index) drawMeasure(p, c, page.line)
    const w = volume.toWorld(page.at), place = `${t(p.id)}  ${sided(w[p.patient], p.patient)} mm  ${index + 1}/${volume.size[p.n]}`
    for (const [text, x, y] of [[p.ends[0], 5 * p.r, p.h / 2], [p.ends[1], p.w - 15 * p.r, p.h / 2], [p.ends[2], p.w / 2, 15 * p.r], [p.ends[3], p.w / 2, p.h - 6 * p.r], [place, 5 * p.r, p.h - 6 * p.r]]) inked(c, text, x, y, '#c5d4e3', p.r)
    desk.stats.draw = performance.now() - began
    desk.stats.draws = (desk.stats.draws || 0) + 1
  }
  const strokeOutline = page.strokeOutline = (c, p, line, colour, dash = []) => {
    const swap = p.u > p.v
    c.setLineDash(dash.map(d => d * p.r))
    c.strokeStyle = colour
    c.lineWidth = 1.4 * p.r
    c.beginPath()
    for (let i = 0; i < line.length; i += 4) {
      const a = swap ? 1 : 0, b = 1 - a
      c.moveTo(p.X(line[i + a]), p.Y(line[i + b]))
      c.lineTo(p.X(line[i + 2 + a]), p.Y(line[i + 2 + b]))
    }
    // What is dashed lies on bone and on air: a dark rim lets it be seen on both.
    if (dash.length) {
      c.lineWidth = 3.4 * p.r, c.strokeStyle = 'rgba(0,0,0,.75)', c.stroke()
      c.lineWidth = 1.6 * p.r, c.strokeStyle = colour
    }
    c.stroke()
    c.setLineDash([])
  }
  // Until an outline is there on all three planes.
  page.outlinesDrawn = name => Promise.all(page.volume.planes.map(p => page.volume.outline(name, p.n, page.at[p.n])))
  const inked = (c, text, x, y, colour, r) => {
    c.lineWidth = 3 * r
    c.strokeStyle = 'rgba(0,0,0,.8)'
    c.strokeText(text, x, y)
    c.fillStyle = colour
    c.fillText(text, x, y)
  }
  page.inked = inked
  const drawMarks = (p, c) => {
    const taken = []
    for (const m of page.allMarks()) {
      const at = page.volume.toIndex(m.position_mm), off = Math.abs(at[p.n] - page.at[p.n]) * page.volume.spacing[p.n]
      if (off > 3) continue
      c.fillStyle = m.colour
      c.globalAlpha = off < 1 ? 1 : .55
      c.beginPath(), c.arc(p.X(at[p.u]), p.Y(at[p.v]), 4 * p.r, 0, 7), c.fill()
      c.globalAlpha = 1
      // Labels of neighbours stand below each other.
      const text = label(m.name), x = p.X(at[p.u]) + 7 * p.r, wide = c.measureText(text).width, high = 14 * p.r
      let y = p.Y(at[p.v]) + 4 * p.r
      while (taken.some(b => x < b.x + b.wide && b.x < x + wide && Math.abs(y - b.y) < high)) y += high / 2
      taken.push({ x, y, wide })
      inked(c, text, x, y, '#fff', p.r)
    }
  }
  const drawMeasure = (p, c, m) => {
    const [x0, y0, x1, y1] = [p.X(m.from[p.u]), p.Y(m.from[p.v]), p.X(m.to[p.u]), p.Y(m.to[p.v])]
    c.strokeStyle = m === page.line ? '#f0c45c' : '#7cf0a0'
    c.lineWidth = 1.6 * p.r
    c.beginPath(), c.moveTo(x0, y0), c.lineTo(x1, y1), c.stroke()
    inked(c, digits(m.mm, 1) + ' mm', x1 + 6 * p.r, y1 - 6 * p.r, c.strokeStyle, p.r)
  }
  // As the case was built; of one that was not, as they are found now.
  page.foundMarks = () => page.info && page.info.built ? page.info.built.landmarks : page.found || []
  page.allMarks = () => {
    const marks = []
    const built = page.info && page.info.built, now = page.info && page.info.now
    const given = now ? now.landmarks : {}
    for (const l of page.foundMarks()) if (!given[l.name]) marks.push({ name: l.name, position_mm: l.position_mm, colour: '#ffd84a' })
    for (const [name, position_mm] of Object.entries(given)) marks.push({ name, position_mm, colour: '#ff9c3c' })
    for (const target of built ? built.targets : []) if (!given[target.name] && !marks.some(m => m.name === target.name)) marks.push({ name: target.name, position_mm: target.position_mm, colour: '#7cf0a0' })
    for (const h of built ? built.holes : []) marks.push({ name: h.name, position_mm: h.position_mm, colour: '#ff6a5c' })
    return marks.concat(page.more ? page.more() : [])
  }

  // ---- where one looks
  page.go = p => {
    for (let a = 0; a < 3; ++a) page.at[a] = Math.max(0, Math.min(page.volume.size[a] - 1, Math.round(p[a])))
    page.redraw()
    page.told && page.told()
    if (page.begun && page.begun.tool.move) page.begun.tool.move(page.begun.p, [...page.at])
    remember()
  }
  page.goWorld = w => page.volume && page.go(page.volume.toIndex(w))
  const step = (p, n) => {
    const to = [...page.at]
    to[p.n] += n
    page.go(to)
    for (const ahead of [1, 2]) {
      const index = page.at[p.n] + Math.sign(n) * ahead
      if (index >= 0 && index < page.volume.size[p.n]) Promise.resolve(page.volume.slice(p.n, index)).catch(() => {})
    }
  }
  page.setWindow = (level, width) => {
    page.window = { level: Math.round(level), width: Math.max(1, Math.round(width)) }
    page.redraw()
    page.told && page.told()
    remember()
  }
  let remembering = 0
  const remember = page.remember = () => {
    clearTimeout(remembering)
    if (!page.restored) return  // what was kept is not read yet
    remembering = setTimeout(() => desk.config && tellBytes('keep', { case: token, what: 'view' }, JSON.stringify({ at: page.at, window: page.window, tool: page.tool, tab: page.tab, off: [...page.outlines].filter(o => !o[1]).map(o => o[0]), edit: page.heldEdit ? page.heldEdit() : null })).catch(() => {}), 700)
  }

  handsOf(page, canvases, step)

  // ---- tools
  const length = (a, b) => Math.hypot(...[0, 1, 2].map(k => (a[k] - b[k]) * page.volume.spacing[k]))
  const ruler = done => {
    let m = null
    return {
      draws: true,
      stop: () => { if (m) m.mm = 0, done(m, true), m = null },
      down: (p, at) => { m = { plane: p.id, index: page.at[p.n], from: at, to: at, mm: 0 }, done(m, false) },
      move: (p, at) => { if (m) m.to = at, m.mm = length(m.from, at), page.redraw() },
      up: (p, at) => { if (m) m.to = at, m.mm = length(m.from, at), done(m, true), m = null, page.redraw() }
    }
  }
  let was = page.at
  page.tools = {
    cross: { key: 'x', down: (p, at) => { was = [...page.at], page.go(at) }, move: (p, at) => page.go(at), stop: () => page.go(was) },
    measure: { key: 'm', ...ruler((m, over) => { if (!over) page.measures.push(m); else { if (m.mm < .5) page.measures.pop(); page.show_('look') } }) },
    profile: { key: 'p', ...ruler((m, over) => { page.line = m; if (over) page.show_('look') }) }
  }
  page.pick = name => {
    page.tool = name
    for (const b of tools.querySelectorAll('[data-tool]')) b.setAttribute('aria-pressed', b.dataset.tool === name)
    page.redraw()
    remember()
  }
  page.listTools = () => tools.replaceChildren(...Object.entries(page.tools).map(([name, tool]) => make('button', { 'data-tool': name, 'aria-pressed': String(page.tool === name), click: () => page.pick(name) }, make('span', { text: t('t_' + name) }), make('kbd', { text: tool.key.toUpperCase() }))),
    make('button', { id: 'undo', click: doing(() => page.undo && page.undo()) }, make('span', { text: t('undo') }), make('kbd', { text: 'Ctrl Z' })), make('button', { id: 'redo', click: doing(() => page.redo && page.redo()) }, make('span', { text: t('redo') }), make('kbd', { text: 'Ctrl Y' })))
  page.keys = e => {
    // A list that was chosen from keeps the keyboard: a tool's letter must not choose another anatomy in it.
    if (e.target.matches('input, textarea') || (e.target.matches('select') && (e.key.length > 1 || e.key === ' '))) return
    const k = e.key.toLowerCase()
    if ((e.ctrlKey || e.metaKey) && (k === 'z' || k === 'y')) {
      e.preventDefault()
      doing(() => k === 'y' || e.shiftKey ? page.redo && page.redo() : page.undo && page.undo())()
      return
    }
    if (e.ctrlKey || e.metaKey || e.altKey) return
    const tool = Object.entries(page.tools).find(([, tool]) => tool.key === k)
    if (tool) e.preventDefault(), page.pick(tool[0])
    else if ((k === '[' || k === ']') && page.resize) e.preventDefault(), page.resize(k === ']' ? 1.25 : .8)
  }

  // ---- panels
  page.addPanel = (name, build) => { page.panels[name] = build }
  page.show_ = name => {
    // Whoever works by keyboard keeps the place: what had the focus is found again by its name.
    const had = panel.contains(document.activeElement) ? document.activeElement : null, scrolled = page.tab === name ? panel.scrollTop : 0
    const named = had && (had.id ? '#' + had.id : [...had.attributes].filter(a => a.name.startsWith('data-')).map(a => `[${a.name}="${CSS.escape(a.value)}"]`).join(''))
    if (page.tab !== name) page.redraw()  // a tab may have lines of its own
    page.tab = name
    for (const b of tabs.children) b.setAttribute('aria-selected', b.dataset.tab === name)
    page.told = null
    panel.replaceChildren(...[].concat(page.panels[name]()).flat(3).filter(x => x))
    panel.scrollTop = scrolled
    const again = named && panel.querySelector(named)
    if (again) again.focus({ preventScroll: true })
    remember()
  }
  page.listTabs = () => tabs.replaceChildren(...Object.keys(page.panels).map(name => make('button', { role: 'tab', 'data-tab': name, 'aria-selected': String(page.tab === name), text: t('tab_' + name), click: () => page.show_(name), keydown: e => {
    const to = e.key === 'ArrowRight' ? e.target.nextSibling : e.key === 'ArrowLeft' ? e.target.previousSibling : null
    if (to) e.preventDefault(), to.focus(), to.click()
  } })))

  page.reloadInfo = async () => {
    page.info = await askJson('case', { case: token })
    const at = page.info.built ? page.info.built.landmarks.length : 0
    desk.stats.landmarks = at
    page.redraw()
    if (page.tab) page.show_(page.tab)
  }
  // Saves something of the case; what the page knows of it is asked anew.
  page.save = async (path, body, why = '') => {
    await tell(path, { case: token, by: who(), why, base: page.info.base, ...body })
    hint(t('saved'))
    await page.reloadInfo()
    if (path === 'scene') page.opening(true).catch(e => problem(e.message)).finally(() => { $('busy').textContent = '' })
    else if (path === 'edit' || path === 'switch') page.refresh()
  }
  // The outlines as the configuration makes them now, computed behind what goes on.
  page.refresh = () => { page.opening('behind').catch(e => problem(e.message)).finally(() => { $('busy').textContent = '' }) }

  // ---- opening
  page.opening = async again => {
    wait.hidden = !!page.volume
    let fresh = again === true
    const query = again ? { case: token, again: again === true ? 1 : again } : { case: token }
    for (let first = true; desk.page === page; first = false) {
      const now = await askJson('open', first ? query : { case: token })
      if (now.state === 'failed' && !now.lattice) throw wait.textContent = now.fault, new Refused(now.fault)
      if (now.lattice && (!page.volume || fresh)) {
        const old = page.volume
        fresh = false
        page.volume = makeVolume(token, now.lattice)
        if (!old || String(old.size) !== String(page.volume.size)) page.at = page.volume.size.map(n => n >> 1)
        if (old) page.redraw()
        else await restore()
        wait.hidden = true
        page.opened && page.opened()
      }
      wait.textContent = `${t('opening')} ${now.doing ? ': ' + now.doing : ''}`
      if (String(now.fields) !== String(page.fields)) {
        page.fields = now.fields
        for (const f of now.fields) if (!page.outlines.has(f)) page.outlines.set(f, !(page.off || []).includes(f))
        if (page.tab === 'look' || page.tab === 'paint' && !panel.contains(document.activeElement)) page.show_(page.tab)
        page.redraw()
      }
      page.found = now.landmarks
      if (now.state !== 'opening') {
        // What was drawn meanwhile is of the case as it was.
        if (again === 'behind') now.fields.forEach(f => page.volume.forget(f + ':'))
        if (page.tab === 'place' && again !== 'behind' && !panel.contains(document.activeElement)) page.show_('place')
        page.redraw()
        if (now.fault) problem(now.fault)
        return
      }
      $('busy').textContent = `${t('opening')}: ${now.doing}`
      await new Promise(done => setTimeout(done, 250))
    }
  }
  const restore = async () => {
    try {
      const view = JSON.parse(new TextDecoder().decode(await askBytes('draft', { case: token, what: 'view' })) || '{}')
      if (view.at && page.volume.inside(view.at)) page.at = view.at
      if (view.window) page.window = view.window
      if (view.off) page.off = view.off
      if (view.edit && page.holdEdit) page.holdEdit(view.edit)
      if (page.tools[view.tool]) page.pick(view.tool)
      if (page.panels[view.tab]) page.tab = view.tab
    } catch (e) {}
    page.restored = true
    page.show_(page.tab)
  }
  page.leave = () => {
    page.timers.forEach(clearInterval)
    removeEventListener('resize', page.redraw)
    removeEventListener('keydown', page.keys)
    $('busy').textContent = ''
  }
  page.show = async () => {
    $('title').textContent = token
    $('page').replaceChildren(make('div', { class: 'work' }, tools, views, make('aside', {}, tabs, panel)))
    lookPanel(page), placePanel(page), paintPanel(page), valuesPanel(page), rerunPanel(page), approvePanel(page)
    page.listTools()
    page.listTabs()
    addEventListener('resize', page.redraw)
    addEventListener('keydown', page.keys)
    if (!desk.cases.length) await loadLibrary()
    page.showSolid()
    await page.reloadInfo()
    if (!desk.config) return wait.textContent = t('no_config')
    await page.opening(false)
    $('busy').textContent = ''
  }
  return page
}

// 12.3 mm to the left is L 12.3, and to the right R 12.3.
const sided = (v, axis) => `${(v < 0 ? 'RAI' : 'LPS')[axis]} ${Math.abs(v).toFixed(1)}`

// Lines on grey: the recipe's hues at full strength, for tissue is too pale. Of two of nearly one hue the second is lighter.
function toldApart(anatomies) {
  const hue = rgb => {
    const low = Math.min(...rgb), range = Math.max(...rgb) - low
    if (range < .02) return null
    const [r, g, b] = rgb.map(c => (c - low) / range)
    return (r === 1 ? (g - b + 6) % 6 : g === 1 ? b - r + 2 : r - g + 4) * 60
  }
  const out = new Map(), taken = []
  for (const { name, colour_rgb } of anatomies) {
    const own = hue(colour_rgb)
    let step = 0
    while (taken.some(([h, s]) => s === step && (h === null || own === null ? h === own : Math.min(Math.abs(h - own), 360 - Math.abs(h - own)) < 15)) && step < 3) ++step
    taken.push([own, step])
    const low = Math.min(...colour_rgb), range = Math.max(...colour_rgb) - low
    const full = own === null ? [1, 1, 1] : colour_rgb.map(c => .15 + .85 * (c - low) / range)
    out.set(name, `rgb(${full.map(c => Math.round(255 * (own === null ? c * (1 - .3 * step) : c + (1 - c) * Math.min(.8, .5 * step))))})`)
  }
  return out
}
