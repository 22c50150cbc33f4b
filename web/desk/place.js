// Part 7: landmarks and burr holes by mouse. Each is saved at once as a line of the case's configuration; undo saves what stood
// there before.
function placePanel(page) {
  const done = [], undone = []
  let chosen = null, hole = { entry: null, target: null, diameter_mm: 14, angle: 0, index: -1 }
  const given = () => page.info && page.info.now ? page.info.now.landmarks : {}
  const names = () => {
    const all = new Set(page.info && page.info.now ? page.info.now.known_landmarks : [])
    for (const name of Object.keys(given())) all.add(name)
    for (const l of page.info && page.info.built ? page.info.built.landmarks : []) all.add(l.name)
    return [...all].sort()
  }
  const placeOf = name => given()[name] || (page.info.built ? (page.info.built.landmarks.find(l => l.name === name) || {}).position_mm : null)
  const put = async (name, position_mm) => {
    const before = given()[name] || null
    await page.save('landmark', { name, position_mm })
    done.push({ name, before, after: position_mm }), undone.length = 0
  }
  page.undoPlace = async () => {
    const last = done.pop()
    if (!last) return
    await page.save('landmark', { name: last.name, position_mm: last.before }, 'undo')
    undone.push(last)
  }
  page.redoPlace = async () => {
    const next = undone.pop()
    if (!next) return
    await page.save('landmark', { name: next.name, position_mm: next.after }, 'redo')
    done.push(next)
  }
  page.undo = () => /^(add|remove|erase|fill|grow)$/.test(page.tool) ? page.undoPaint() : page.undoPlace()
  page.redo = () => /^(add|remove|erase|fill|grow)$/.test(page.tool) ? page.redoPaint() : page.redoPlace()
  const needed = () => { if (!chosen) throw page.show_('place'), new Refused(t('choose_first')) }
  page.tools.landmark = {
    key: 'l',
    down: (p, at) => { needed(), page.dragged = at, page.redraw() },
    move: (p, at) => { page.dragged = at, page.redraw() },
    up: async (p, at) => {
      if (!page.dragged) return
      page.dragged = null
      if (page.volume.inside(at.map(Math.round))) await put(chosen, page.volume.toWorld(at))
    }
  }
  for (const which of ['entry', 'target'])
    page.tools[which] = { key: which === 'entry' ? 'e' : 'z', down: (p, at) => setHole(which, page.volume.toWorld(at)), move: (p, at) => setHole(which, page.volume.toWorld(at)), up: () => { if (page.tab !== 'place') page.show_('place') } }
  const setHole = (which, w) => {
    hole[which] = w
    page.redraw()
    page.heldHole && page.heldHole()
  }
  page.more = () => [
    ...page.dragged ? [{ name: chosen, position_mm: page.volume.toWorld(page.dragged), colour: '#ffffff' }] : [],
    ...['entry', 'target'].filter(k => hole[k]).map(k => ({ name: t(k), position_mm: hole[k], colour: '#7cc4ff' }))]
  const direction = () => {
    const d = hole.target.map((v, k) => v - hole.entry[k]), n = Math.hypot(...d)
    return n > 1e-6 ? d.map(v => v / n) : null
  }
  page.overlays.push((p, c) => {
    if (!hole.entry || !hole.target) return
    const a = page.volume.toIndex(hole.entry), b = page.volume.toIndex(hole.target)
    c.strokeStyle = '#7cc4ff'
    c.lineWidth = 1.5 * p.r
    c.setLineDash([6 * p.r, 4 * p.r])
    c.beginPath(), c.moveTo(p.X(a[p.u]), p.Y(a[p.v])), c.lineTo(p.X(b[p.u]), p.Y(b[p.v])), c.stroke()
    c.setLineDash([])
  })

  page.addPanel('place', () => {
    const fixed = page.info && (page.info.fixed || !page.info.now), built = page.info && page.info.built
    const rows = names().map(name => {
      const at = placeOf(name), found = built && built.landmarks.find(l => l.name === name)
      const row = make('tr', { class: 'jump' + (name === chosen ? ' chosen' : ''), tabIndex: 0, 'data-landmark': name }, make('td', { text: label(name) }), make('td', { text: given()[name] ? t('given') : found ? `${t('found')} ${digits(found.confidence * 100, 0)} %` : '' }), make('td', { class: 'number', text: at ? at.map(v => v.toFixed(1)).join(', ') : '' }))
      const choose = () => { chosen = name, at && page.goWorld(at), page.show_('place') }
      row.addEventListener('click', choose)
      row.addEventListener('keydown', e => { if (e.key === 'Enter') choose() })
      return row
    })
    const holes = page.info && page.info.now ? page.info.now.said_holes : []
    return [
      fixed ? make('p', { class: 'warn', text: page.info.fixed || t('no_config') }) : null,
      make('h2', { text: t('landmarks') }), table([[t('name'), 0], [t('source'), 0], ['L, P, S mm', 1]], rows),
      make('div', { class: 'row' }, button('here', async () => { needed(); await put(chosen, page.volume.toWorld(page.at)) }, { id: 'here', disabled: !!fixed }), button('as_found', async () => { needed(); await put(chosen, null) }, { id: 'as-found', disabled: !!fixed })),
      make('h2', { text: t('holes') }),
      holes.map((h, i) => make('div', { class: 'row' }, make('span', { class: 'tag', text: `${h.name || i + 1}: ${h.at === 'position' ? t('entry') : t('kocher')} ${h.side || ''} ${h.diameter_mm || ''}` }), button('show', () => { if (h.position_mm) hole.entry = h.position_mm.map(Number), page.goWorld(hole.entry), page.show_('place') }, { disabled: !h.position_mm }), button('remove', () => page.save('holes', { holes: holes.filter((_, k) => k !== i) }), { disabled: !!fixed }))),
      holePanel(fixed, holes)
    ].flat(2)
  })

  function holePanel(fixed, holes) {
    const told = make('p', { class: 'faint', id: 'hole' }), canvas = make('canvas', { class: 'cut', width: 360, height: 360 }), clear = make('div')
    const angle = make('input', { type: 'range', min: 0, max: 180, value: hole.angle, 'aria-label': t('turn'), input: e => { hole.angle = +e.target.value, drawCut() } })
    let asked = 0
    const drawCut = async () => {
      const d = hole.entry && hole.target && page.volume && direction()
      if (!d) return
      const side = 180, mm = 1, turn = hole.angle * Math.PI / 180
      // Across the trajectory, turned about it.
      const up = Math.abs(d[2]) < .9 ? [0, 0, 1] : [0, 1, 0], cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], unit = a => a.map(v => v / Math.hypot(...a))
      const e = unit(cross(d, up)), f = cross(d, e), right = e.map((v, k) => v * Math.cos(turn) + f[k] * Math.sin(turn)), corner = hole.entry.map((v, k) => v - right[k] * side / 2 * mm - d[k] * 40)
      const query = { case: page.token, side }
      for (const [name, v] of [['corner', corner], ['right', right], ['down', d]]) 'xyz'.split('').forEach((axis, k) => { query[`${name}_${axis}`] = v[k] })
      const number = ++asked, data = new Int16Array(await askBytes('plane', query))
      if (number !== asked) return
      const image = new ImageData(side, side), px = new Uint32Array(image.data.buffer), { level, width } = page.window
      for (let i = 0; i < px.length; ++i) {
        const g = Math.max(0, Math.min(255, Math.round(((data[i] - level) / width + .5) * 255)))
        px[i] = data[i] === -32768 ? rgba(20, 26, 38) : rgba(g, g, g)
      }
      const small = make('canvas', { width: side, height: side }), c = canvas.getContext('2d'), k = canvas.width / side
      small.getContext('2d').putImageData(image, 0, 0)
      c.drawImage(small, 0, 0, canvas.width, canvas.height)
      c.strokeStyle = '#7cc4ff'
      const x = side / 2 * k, r = hole.diameter_mm / 2 * k, end = 40 + Math.hypot(...hole.target.map((v, i) => v - hole.entry[i]))
      c.beginPath(), c.moveTo(x, 0), c.lineTo(x, end * k), c.stroke()
      c.strokeStyle = '#ff9c3c'
      c.beginPath(), c.moveTo(x - r, 30 * k), c.lineTo(x - r, 60 * k), c.moveTo(x + r, 30 * k), c.lineTo(x + r, 60 * k), c.stroke()
      clear.replaceChildren(...await distances(d))
    }
    // How far the line from entry to target stays from the outline of each anatomy that is shown: seen in the axial slices that
    // it passes.
    const distances = async d => {
      const { volume } = page, p = volume.planes[0], rows = [], [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u], all = Math.hypot(...hole.target.map((v, k) => v - hole.entry[k]))
      for (const name of page.fields.filter(f => page.outlines.get(f))) {
        let least = Infinity
        for (let s = 0; s <= 24; ++s) {
          const at = volume.toIndex(hole.entry.map((v, k) => v + d[k] * all * s / 24)), index = Math.round(at[p.n])
          if (index < 0 || index >= volume.size[p.n]) continue
          const line = await volume.outline(name, p.n, index)
          for (let i = 0; i < line.length; i += 2) least = Math.min(least, Math.hypot((line[i] - at[lo]) * volume.spacing[lo], (line[i + 1] - at[hi]) * volume.spacing[hi]))
        }
        if (isFinite(least)) rows.push(make('tr', {}, make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)), make('td', { class: 'number', text: digits(least, 1) + ' mm' })))
      }
      return rows.length ? [table([[t('anatomy'), 0], ['≥', 1]], rows)] : []
    }
    let later = 0
    page.heldHole = () => {
      told.textContent = hole.entry && hole.target ? `${t('entry')} ${hole.entry.map(v => v.toFixed(1)).join(', ')} · ${t('target')} ${hole.target.map(v => v.toFixed(1)).join(', ')} · ${t('length')} ${digits(Math.hypot(...hole.target.map((v, k) => v - hole.entry[k])), 1)} mm` : t('entry_first')
      canvas.hidden = !(hole.entry && hole.target)
      clearTimeout(later)
      later = setTimeout(() => drawCut().catch(e => problem(e.message)), 60)
    }
    page.heldHole()
    return [told, make('div', { class: 'row' }, field('diameter', make('input', { type: 'number', id: 'diameter', min: 1, max: 60, value: hole.diameter_mm, change: e => { hole.diameter_mm = +e.target.value, page.heldHole() } })), field('turn', angle),
      button('add_hole', async () => {
        const d = hole.entry && hole.target && direction()
        if (!d) throw new Refused(t('entry_first'))
        const round = v => Math.round(v * 1e4) / 1e4
        await page.save('holes', { holes: [...holes, { at: 'position', position_mm: hole.entry.map(round), direction: d.map(v => Math.round(v * 1e6) / 1e6), diameter_mm: hole.diameter_mm }] })
        hole = { entry: null, target: null, diameter_mm: hole.diameter_mm, angle: 0 }
        page.show_('place')
      }, { id: 'save-hole', disabled: !!fixed })), make('h2', { text: t('cut') }), canvas, clear]
  }
}
