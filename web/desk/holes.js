// Part 8: a burr hole by hand: its entry and its target, the plane through both, how near it comes to what is shown, and what the
// run would make of it before it is saved.
function holesOf(page) {
  const fresh = diameter => ({ entry: null, target: null, diameter_mm: diameter, angle: 0, index: -1, tried: null })
  let hole = fresh(14), drawLater = 0, asked = 0
  const said = () => page.info && page.info.now ? page.info.now.said_holes : []
  const cuts = () => !!(page.info && page.info.now && page.info.now.cuts_holes)
  const whole = () => !!(hole.entry && hole.target && direction())
  const between = () => Math.hypot(...hole.target.map((v, k) => v - hole.entry[k]))
  const direction = () => {
    const d = hole.target.map((v, k) => v - hole.entry[k]), n = Math.hypot(...d)
    return n > 1e-6 ? d.map(v => v / n) : null
  }
  const set = (which, w) => {
    hole[which] = w
    hole.tried = null
    page.redraw()
    page.heldHole && page.heldHole()
  }
  for (const which of ['entry', 'target']) {
    const put = (p, at) => set(which, page.volume.toWorld(page.withinSlice(p, at, hole[which])))
    page.tools[which] = { key: which === 'entry' ? 'e' : 'z', down: put, move: put, up: () => page.show_('place') }
  }

  // As a line of the configuration says it.
  const line = () => {
    const rounded = (v, k) => v.map(x => Math.round(x * k) / k), old = said()[hole.index] || {}
    const { at, side, along_mm, lateral_mm, toward, direction, target_mm, ...kept } = old
    return { ...kept, at: 'position', position_mm: rounded(hole.entry, 1e4), target_mm: rounded(hole.target, 1e4), diameter_mm: hole.diameter_mm }
  }
  const lines = () => hole.index < 0 ? [...said(), line()] : said().map((h, i) => i === hole.index ? line() : h)
  const need = () => { if (!whole()) throw new Refused(t('entry_first')) }

  const nameOf = (h, i) => h.name || `burr_hole_${i + 1}`
  const builtOf = (h, i) => page.info && page.info.built && page.info.built.holes.find(b => b.name === nameOf(h, i))
  // Where a saved hole lies: as the configuration says; one by Kocher's rule as the case was built, else at the point that was found.
  const placed = (h, i) => {
    const built = builtOf(h, i)
    const found = name => ([...page.foundMarks(), ...page.info.built ? page.info.built.targets : []].find(l => l.name === name) || {}).position_mm
    const toward = h.target_mm ? h.target_mm.map(Number) : h.toward && (page.info.now.landmarks[h.toward] || found(h.toward))
    const kocher = `kocher_${h.side || 'right'}`
    const entry = h.position_mm ? h.position_mm.map(Number) : built ? built.position_mm : page.info.now.landmarks[kocher] || found(kocher)
    if (!entry) return null
    const d = h.direction ? h.direction.map(Number) : toward ? toward.map((v, k) => v - entry[k]) : built ? built.direction : null
    const n = d && Math.hypot(...d)
    return { entry, target: toward || (n ? entry.map((v, k) => v + d[k] / n * 60) : null) }
  }
  // Those that the configuration has and the case not yet, or elsewhere.
  const waiting = () => said().map((h, i) => ({ name: nameOf(h, i), i, built: builtOf(h, i), at: placed(h, i) })).filter(w => w.at && w.i !== hole.index && (!w.built || w.built.diameter_mm !== (+said()[w.i].diameter_mm || 14) || [w.at.entry, w.at.target].some(p => p && fromAxis(w.built, p) > 1.5)))
  // The hole is cut from the surface of the bone on, so what was clicked lies on its axis, not at its begin.
  const fromAxis = (built, p) => {
    const to = p.map((v, k) => v - built.position_mm[k]), along = to.reduce((sum, v, k) => sum + v * built.direction[k], 0)
    return Math.hypot(...to.map((v, k) => v - built.direction[k] * along))
  }
  page.changeHole = i => said()[i] && placed(said()[i], i) ? change(i) : page.show_('place')
  const change = i => {
    const at = placed(said()[i], i)
    if (!at) throw new Refused(t('hole_unknown'))
    hole = { ...fresh(+said()[i].diameter_mm || 14), ...at, index: i }
    page.goWorld(hole.entry)
    page.show_('place')
  }

  const marks = () => [...['entry', 'target'].filter(k => hole[k]).map(k => ({ name: t(k), position_mm: hole[k], colour: '#7cc4ff' })),
    ...waiting().map(w => ({ name: `${label(w.name)} (${t('not_yet')})`, position_mm: w.at.entry, colour: '#ff9c8f' }))]
  page.overlays.push((p, c) => {
    for (const [line, colour] of [[hole, '#7cc4ff'], ...waiting().map(w => [w.at, '#ff9c8f'])]) {
      if (!line.entry || !line.target) continue
      const a = page.volume.toIndex(line.entry), b = page.volume.toIndex(line.target)
      c.strokeStyle = colour
      c.lineWidth = 1.5 * p.r
      c.setLineDash([6 * p.r, 4 * p.r])
      c.beginPath(), c.moveTo(p.X(a[p.u]), p.Y(a[p.v])), c.lineTo(p.X(b[p.u]), p.Y(b[p.v])), c.stroke()
      c.setLineDash([])
    }
  })

  // The run's own placing, on the surfaces of the last build where they are the same.
  const check = async () => {
    need()
    hole.tried = { text: t('checking'), kind: 'faint', rows: [] }
    page.show_('place')
    const mine = hole, all = lines()
    let now
    try {
      now = await page.tryIt({ holes: all, hole: hole.index < 0 ? all.length - 1 : hole.index }, what => { if ($('hole-tried')) $('hole-tried').textContent = `${t('checking')}: ${what}` })
    } catch (e) {
      if (mine === hole) mine.tried = { text: e.message, kind: 'bad', rows: [] }, page.show_('place')
      return
    }
    if (mine !== hole || !now) return
    const [report] = now.reports
    mine.tried = now.fault ? { text: now.fault, kind: 'bad', rows: [] } : { text: t('hole_good'), kind: 'good', rows: report ? Object.entries(report.figures).filter(([, v]) => typeof v === 'number') : [] }
    const near = said().map((h, i) => ({ name: nameOf(h, i), i, at: placed(h, i), mm: (+h.diameter_mm || 14) / 2 + mine.diameter_mm / 2 })).find(o => o.i !== mine.index && o.at && Math.hypot(...o.at.entry.map((v, k) => v - mine.entry[k])) < o.mm)
    if (!now.fault && near) mine.tried = { ...mine.tried, text: `${t('overlaps')} ${label(near.name)}`, kind: 'warn' }
    else if (report && !now.fault && report.warnings.length) mine.tried = { ...mine.tried, text: report.warnings.join('\n'), kind: 'warn' }
    page.show_('place')
  }

  // ---- the plane of the trajectory, across it and turned about it
  const drawCut = async (canvas, clear) => {
    const d = whole() && page.volume && direction()
    if (!d) return
    const mine = hole, { entry } = hole, all = between()  // what is drawn; meanwhile the hole may be cancelled
    const side = 180, turn = hole.angle * Math.PI / 180
    const up = Math.abs(d[2]) < .9 ? [0, 0, 1] : [0, 1, 0]
    const e = unit(cross(d, up)), f = cross(d, e), right = e.map((v, k) => v * Math.cos(turn) + f[k] * Math.sin(turn)), corner = entry.map((v, k) => v - right[k] * side / 2 - d[k] * 40)
    const query = { case: page.token, side }
    for (const [name, v] of [['corner', corner], ['right', right], ['down', d]]) 'xyz'.split('').forEach((axis, k) => { query[`${name}_${axis}`] = v[k] })
    const number = ++asked, data = new Int16Array(await askBytes('plane', query))
    if (number !== asked || mine !== hole) return
    const image = new ImageData(side, side), px = new Uint32Array(image.data.buffer), { level, width } = page.window
    for (let i = 0; i < px.length; ++i) {
      const g = Math.max(0, Math.min(255, Math.round(((data[i] - level) / width + .5) * 255)))
      px[i] = data[i] === -32768 ? rgba(20, 26, 38) : rgba(g, g, g)
    }
    const small = make('canvas', { width: side, height: side }), c = canvas.getContext('2d'), k = canvas.width / side
    small.getContext('2d').putImageData(image, 0, 0)
    c.drawImage(small, 0, 0, canvas.width, canvas.height)
    const x = side / 2 * k, r = hole.diameter_mm / 2 * k, end = 40 + all
    c.lineWidth = 1.5
    c.strokeStyle = '#7cc4ff'
    c.beginPath(), c.moveTo(x, 0), c.lineTo(x, end * k), c.stroke()
    c.beginPath(), c.arc(x, end * k, 4, 0, 7), c.stroke()
    c.strokeStyle = '#ff9c3c'
    c.beginPath(), c.moveTo(x - r, 30 * k), c.lineTo(x - r, 60 * k), c.moveTo(x + r, 30 * k), c.lineTo(x + r, 60 * k), c.stroke()
    c.font = '12px system-ui, sans-serif'
    page.inked(c, t('entry'), x + r + 6, 40 * k + 4, '#ff9c3c', 1)
    page.inked(c, t('target'), x + 9, Math.min(canvas.height - 6, end * k + 4), '#7cc4ff', 1)
    page.inked(c, '10 mm', 10, canvas.height - 14, '#c5d4e3', 1)
    c.strokeStyle = '#c5d4e3'
    c.beginPath(), c.moveTo(10, canvas.height - 8), c.lineTo(10 + 10 * k, canvas.height - 8), c.stroke()
    clear.replaceChildren(...await distances(d, entry, all))
    canvas.dataset.drawn = number
  }
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], unit = a => a.map(v => v / Math.hypot(...a))
  // How far the entry lies before the coronal suture, along the midline, as craniometry::before_suture_mm counts it (the suture is
  // known where it crosses the midline: in the bregma), and beside the midline, along which the sagittal suture runs.
  const toSutures = entry => {
    const at = name => (page.allMarks().find(m => m.name === name) || {}).position_mm, [nasion, bregma, inion] = ['nasion', 'bregma', 'inion'].map(at)
    if (!nasion || !bregma || !inion) return []
    const less = (a, b) => a.map((v, k) => v - b[k]), dot = (a, b) => a.reduce((sum, v, k) => sum + v * b[k], 0)
    const centre = nasion.map((v, k) => (v + inion[k]) / 2), out = unit(less(bregma, centre)), ahead = less(nasion, centre)
    const forwards = unit(ahead.map((v, k) => v - out[k] * dot(ahead, out))), left = unit(cross(out, forwards))
    const before = dot(less(entry, bregma), forwards), beside = dot(less(entry, bregma), left)
    const found = page.info.now.landmarks.bregma ? null : page.foundMarks().find(l => l.name === 'bregma'), unsure = found && found.confidence < .5
    const row = (name, mm, where, doubt) => make('tr', { 'data-skull': name }, make('td', { text: t(name) }), make('td', { class: 'number', text: digits(Math.abs(mm), 1) }), make('td', { class: doubt ? 'warn' : '', text: t(where) + (doubt ? ` (${label('bregma')}: ${digits(found.confidence * 100, 0)} %)` : '') }))
    return [row('coronal_suture', before, before < 0 ? 'behind_it' : 'before_it', unsure), row('midline_sagittal', beside, beside < 0 ? 'right' : 'left', false)]
  }
  // How near the line from entry to target comes to the outline of each anatomy that is shown, in the axial slices that it passes.
  const distances = async (d, entry, all) => {
    const { volume } = page, p = volume.planes[0], rows = [], [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
    for (const name of page.fields.filter(f => page.outlines.get(f))) {
      let least = Infinity, enters = false
      for (let s = 0; s <= 24; ++s) {
        const at = volume.toIndex(entry.map((v, k) => v + d[k] * all * s / 24)), index = Math.round(at[p.n])
        if (index < 0 || index >= volume.size[p.n]) continue
        const line = await volume.outline(name, p.n, index)
        // Even and odd: how often a ray from the point meets the outline.
        let met = 0
        for (let i = 0; i < line.length; i += 4) if (line[i + 1] > at[hi] !== line[i + 3] > at[hi] && at[lo] < line[i] + (at[hi] - line[i + 1]) / (line[i + 3] - line[i + 1]) * (line[i + 2] - line[i])) ++met
        enters = enters || met % 2 === 1
        for (let i = 0; i < line.length; i += 2) least = Math.min(least, Math.hypot((line[i] - at[lo]) * volume.spacing[lo], (line[i + 1] - at[hi]) * volume.spacing[hi]))
      }
      if (isFinite(least)) rows.push(make('tr', {}, make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)), make('td', { class: 'number', 'data-clear': name, text: enters ? t('passes_through') : digits(least, 1) })))
    }
    // Where no outline is: points, such as the bregma, in which the sutures meet.
    const skull = toSutures(entry)
    const near = page.allMarks().filter(m => m.name !== t('entry') && m.name !== t('target') && m.colour !== '#ff6a5c').map(m => {
      const to = m.position_mm.map((v, k) => v - entry[k]), s = Math.max(0, Math.min(all, to.reduce((sum, v, k) => sum + v * d[k], 0)))
      return { name: m.name, from: Math.hypot(...to), line: Math.hypot(...to.map((v, k) => v - d[k] * s)) }
    }).sort((a, b) => a.line - b.line)
    const points = near.map(m => make('tr', { 'data-near': m.name }, make('td', { text: label(m.name) }), make('td', { class: 'number', text: digits(m.from, 1) }), make('td', { class: 'number', text: digits(m.line, 1) })))
    return [...skull.length ? [make('h2', { text: t('on_the_skull') }), table([['', 0], [t('mm'), 1], ['', 0]], skull)] : [],
      ...rows.length ? [make('h2', { text: t('clearances') }), table([[t('anatomy'), 0], [t('mm'), 1]], rows)] : [],
      ...points.length ? [make('h2', { text: t('to_points') }), table([[t('name'), 0], [t('from_entry'), 1], [t('from_line'), 1]], points)] : []]
  }

  const panel = fixed => {
    const list = said(), no = !!fixed || !cuts()
    const told = make('p', { class: 'faint', id: 'hole' }), canvas = make('canvas', { class: 'cut', width: 360, height: 360, 'aria-label': t('cut') }), clear = make('div'), cut = make('div', {}, make('h2', { text: t('cut') }), canvas)
    const draw = () => {
      clearTimeout(drawLater)
      drawLater = setTimeout(() => drawCut(canvas, clear).catch(e => problem(e.message)), 40)
    }
    const angle = make('input', { type: 'range', min: 0, max: 180, value: hole.angle, input: e => { hole.angle = +e.target.value, draw() } })
    page.heldHole = () => {
      const place = which => hole[which] ? hole[which].map(v => v.toFixed(1)).join(', ') : '–'
      told.textContent = hole.entry || hole.target ? `${t('entry')} ${place('entry')} · ${t('target')} ${place('target')}` + (whole() ? ` · ${t('length')} ${digits(between(), 1)} mm` : '') : t('entry_first')
      cut.hidden = !whole()
      for (const id of ['save-hole', 'check-hole']) if ($(id)) $(id).disabled = no || !whole()
      draw()
    }
    const row = (h, i) => make('div', { class: 'row hole' + (i === hole.index ? ' chosen' : ''), 'data-hole': String(i) }, make('span', { class: 'grow', text: `${h.name ? label(h.name) : `${t('hole')} ${i + 1}`}: ${h.at === 'position' ? t('by_hand') : `${t('kocher')} ${h.side ? t(h.side) : t('right')}`}, ${h.diameter_mm || 14} mm` }),
      button('show', () => { const at = placed(h, i); if (!at) throw new Refused(t('hole_unknown')); page.goWorld(at.entry) }), button('change_it', () => change(i), { disabled: no, 'data-change': String(i) }),
      button('remove', () => page.change('holes', { holes: list }, { holes: list.filter((_, k) => k !== i) }), { disabled: no, 'data-remove': String(i) }))
    const save = async () => {
      need()
      await page.change('holes', { holes: list }, { holes: lines() })
      hole = fresh(hole.diameter_mm)
      page.show_('place')
    }
    const at = which => button(which + '_here', () => set(which, page.volume.toWorld(page.at)), { id: which + '-here', disabled: !!fixed })
    const tried = hole.tried
    setTimeout(() => page.heldHole(), 0)
    return [make('h2', { text: t('holes') }), cuts() || fixed ? null : [make('p', { class: 'warn', text: t('no_holes') }), page.sceneChoice(s => s.cuts_holes)], list.map(row), cuts() && !list.length ? make('p', { class: 'warn', text: t('no_hole_yet') }) : null,
      make('h2', { text: hole.index < 0 ? t('add_hole') : `${t('change_it')}: ${t('hole')} ${hole.index + 1}` }), told,
      make('div', { class: 'row' }, at('entry'), at('target'), field('diameter', make('input', { type: 'number', id: 'diameter', min: 1, max: 60, value: hole.diameter_mm, change: e => { if (e.target.valueAsNumber > 0) hole.diameter_mm = e.target.valueAsNumber; else e.target.value = hole.diameter_mm; hole.tried = null, page.heldHole() } }), make('span', { text: t('mm') }))),
      make('div', { class: 'row' }, button('check_hole', check, { id: 'check-hole' }), button('save_hole', save, { id: 'save-hole', class: 'main' }), hole.entry || hole.target ? button('cancel', () => { hole = fresh(hole.diameter_mm), page.show_('place'), page.redraw() }, { id: 'cancel-hole' }) : null),
      tried ? make('p', { class: tried.kind, id: 'hole-tried', text: tried.text }) : null, tried && tried.rows.length ? table([['', 0], ['', 1]], tried.rows.map(([name, v]) => make('tr', {}, make('td', { text: label(name) }), make('td', { class: 'number', text: digits(v, 1) })))) : null,
      (cut.append(make('div', { class: 'row' }, field('turn', angle))), cut), clear]
  }
  return { marks, panel }
}
