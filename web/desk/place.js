// Part 7: landmarks and burr holes by mouse. Each is saved as a line of the case's configuration; undo saves what stood there
// before.
function placePanel(page) {
  const done = [], undone = []
  let chosen = null
  const given = () => page.info && page.info.now ? page.info.now.landmarks : {}
  const names = () => {
    const all = new Set(page.info && page.info.now ? page.info.now.known_landmarks : [])
    for (const name of Object.keys(given())) all.add(name)
    for (const l of page.foundMarks()) all.add(l.name)
    return [...all].sort()
  }
  const placeOf = name => given()[name] || (page.foundMarks().find(l => l.name === name) || {}).position_mm || null

  page.landmarkNames = names
  page.chooseLandmark = name => { chosen = name, placeOf(name) && page.goWorld(placeOf(name)), page.show_('place') }

  // ---- what was saved, and can be taken back
  page.change = async (path, before, after) => {
    await page.save(path, after)
    done.push({ path, before, after }), undone.length = 0
  }
  const step = async (from, to, which, why) => {
    const change = from[from.length - 1]
    if (!change) return hint(t('nothing_' + why))
    await page.save(change.path, change[which], why)
    to.push(from.pop())
  }
  page.undoPlace = () => step(done, undone, 'before', 'undo')
  page.redoPlace = () => step(undone, done, 'after', 'redo')
  const paints = () => /^(add|remove|erase|fill|grow)$/.test(page.tool)
  // Of what is switched on and off, the other state is what was before.
  page.canSwitch = id => { done.push({ path: 'switch', before: { id, on: false }, after: { id, on: true } }), undone.length = 0 }
  page.undo = () => paints() ? page.undoPaint() : page.undoEdit(page.tool) || page.undoPlace()
  page.redo = () => paints() ? page.redoPaint() : page.redoPlace()

  const put = async (name, position_mm) => {
    await page.change('landmark', { name, position_mm: given()[name] || null }, { name, position_mm })
    // The patient's left is L, greater x: a pair that lies the other way round has one of its points on the wrong side.
    const other = name.includes('left') ? name.replace('left', 'right') : name.includes('right') ? name.replace('right', 'left') : null, at = position_mm && other && placeOf(other)
    if (at && (position_mm[0] - at[0]) * (name.includes('left') ? 1 : -1) < 0) throw new Refused(`${label(name)}: ${t('other_side')} ${label(other)}. ${t('saved_all_the_same')}`)
  }
  const needed = () => { if (!chosen) throw page.show_('place'), new Refused(t('choose_first')) }
  // What is dragged on a slice that it lies in keeps its place across the slice, to a fraction of a voxel.
  page.withinSlice = (p, at, was) => {
    const old = was && page.volume.toIndex(was), to = [...at]
    if (old && Math.round(old[p.n]) === page.at[p.n]) to[p.n] = old[p.n]
    return to
  }
  const drag = (p, at) => { page.dragged = page.withinSlice(p, at, placeOf(chosen)), page.redraw() }
  page.tools.landmark = {
    key: 'l',
    down: (p, at) => { needed(), drag(p, at) },
    move: (p, at) => { if (page.dragged) drag(p, at) },
    stop: () => { page.dragged = null, page.redraw() },
    up: async () => {
      const at = page.dragged
      page.dragged = null
      if (at && page.volume.inside(at.map(Math.round))) await put(chosen, page.volume.toWorld(at))
    }
  }
  const holes = holesOf(page), boxes = boxesOf(page)
  page.more = () => [...page.dragged ? [{ name: chosen, position_mm: page.volume.toWorld(page.dragged), colour: '#ffffff' }] : [], ...holes.marks()]

  page.addPanel('place', () => {
    const fixed = page.info && (page.info.fixed || !page.info.now)
    const rows = names().map(name => {
      const at = placeOf(name), found = page.foundMarks().find(l => l.name === name)
      const row = make('tr', { class: 'jump' + (name === chosen ? ' chosen' : ''), tabIndex: 0, 'data-landmark': name }, make('td', { text: label(name) }), make('td', { text: given()[name] ? t('given') : found ? `${t('found')} ${digits(found.confidence * 100, 0)} %` : t('not_found') }), make('td', { class: 'number', text: at ? at.map(v => v.toFixed(1)).join(', ') : '' }))
      const choose = () => { chosen = name, at && page.goWorld(at), page.show_('place') }
      row.addEventListener('click', choose)
      row.addEventListener('keydown', e => { if (e.key === 'Enter') choose() })
      return row
    })
    return [
      fixed ? make('p', { class: 'warn', text: page.info.fixed || t('no_config') }) : null,
      make('h2', { text: t('landmarks') }), make('p', { class: 'faint', text: t('landmark_how') }), table([[t('name'), 0], [t('source'), 0], ['L, P, S mm', 1]], rows),
      make('div', { class: 'row' }, button('here', async () => { needed(); await put(chosen, page.volume.toWorld(page.at)) }, { id: 'here', disabled: !!fixed }), button('as_found', async () => { needed(); await put(chosen, null) }, { id: 'as-found', disabled: !!fixed })),
      holes.panel(fixed), boxes.panel(fixed)
    ].flat(2)
  })
}
