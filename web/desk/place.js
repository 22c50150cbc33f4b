// Landmarks and burr holes by mouse. Each is saved as a line of the case's configuration; undo saves what stood there
// before.

const givenLandmarks = page => (page.info && page.info.now ? page.info.now.landmarks : {})

function landmarkNames(page) {
  const all = new Set(page.info && page.info.now ? page.info.now.known_landmarks : [])
  for (const name of Object.keys(givenLandmarks(page))) all.add(name)
  for (const l of page.foundMarks()) all.add(l.name)
  return [...all].sort()
}

const landmarkPlace = (page, name) =>
  givenLandmarks(page)[name] || (page.foundMarks().find(l => l.name === name) || {}).position_mm || null

// What a change of this tab acts on, as it is now; by it is known whether another tab, or another person, changed it since.
function stateOf(page, { path, after }) {
  const { now, journal } = page.info
  if (path === 'landmark') return now.landmarks[after.name] || null
  if (path === 'holes') return now.said_holes
  if (path === 'switch') return (journal.find(e => e.id === after.id) || {}).on
  if (path === 'value')
    return (after.values || [after]).map(v => (now.values.find(known => known.path === v.path) || {}).value)
  return null
}
const isAsLeft = (page, change) => JSON.stringify(stateOf(page, change)) === JSON.stringify(change.left)

// Undo takes back what this tab did, and only as long as it stands as this tab left it.
async function moveChange(page, from, to, which, why) {
  const change = from[from.length - 1]
  if (!change) return hint(t('nothing_' + why))
  await page.reloadInfo()
  if (!isAsLeft(page, change)) {
    from.pop()
    throw new Refused(t('changed_since'))
  }
  await page.save(change.path, change[which], why)
  change.left = stateOf(page, change)
  to.push(from.pop())
}

const isPainting = page => /^(add|remove|erase|fill|grow)$/.test(page.tool)

async function putLandmark(page, name, position_mm) {
  await page.change('landmark', { name, position_mm: givenLandmarks(page)[name] || null }, { name, position_mm })
  // The patient's left is L, greater x: a pair that lies the other way round has one of its points on the wrong side.
  const other = name.includes('left')
      ? name.replace('left', 'right')
      : name.includes('right')
        ? name.replace('right', 'left')
        : null,
    at = position_mm && other && landmarkPlace(page, other)
  if (at && (position_mm[0] - at[0]) * (name.includes('left') ? 1 : -1) < 0)
    throw new Refused(`${label(name)}: ${t('other_side')} ${label(other)}. ${t('saved_all_the_same')}`)
}

function neededLandmark(page) {
  const { placing } = page
  if (!placing.chosen) throw (page.show_('place'), new Refused(t('choose_first')))
}

function dragLandmark(page, p, at) {
  const { placing } = page
  page.dragged = page.withinSlice(p, at, landmarkPlace(page, placing.chosen))
  page.redraw()
}

function chooseLandmark(page, name) {
  const { placing } = page
  placing.chosen = name
  landmarkPlace(page, name) && page.goWorld(landmarkPlace(page, name))
  page.show_('place')
}

async function changeValue(page, path, before, after) {
  const { done, undone } = page.placing
  await page.save(path, after)
  const change = { path, before, after }
  change.left = stateOf(page, change)
  done.push(change)
  undone.length = 0
}

function canSwitch(page, id) {
  const { done, undone } = page.placing
  const change = { path: 'switch', before: { id, on: false }, after: { id, on: true } }
  change.left = stateOf(page, change)
  done.push(change)
  undone.length = 0
}

function withinSlice(page, p, at, was) {
  const old = was && page.volume.toIndex(was),
    to = [...at]
  if (old && Math.round(old[p.n]) === page.at[p.n]) to[p.n] = old[p.n]
  return to
}

function placeMarks(page) {
  const { placing } = page
  const { holes } = placing
  return [
    ...(page.dragged ? [{ name: placing.chosen, position_mm: page.volume.toWorld(page.dragged), colour: '#ffffff' }] : []),
    ...holes.marks()
  ]
}

function placeControls(page) {
  const { placing } = page
  const { holes, boxes } = placing
  const fixed = page.info && (page.info.fixed || !page.info.now)
  const rows = landmarkNames(page).map(name => {
    const at = landmarkPlace(page, name),
      found = page.foundMarks().find(l => l.name === name)
    const row = make(
      'tr',
      { class: 'jump' + (name === placing.chosen ? ' chosen' : ''), tabIndex: 0, 'data-landmark': name },
      make('td', { text: label(name) }),
      make('td', {
        text: givenLandmarks(page)[name]
          ? t('given')
          : found
            ? `${t('found')} ${digits(found.confidence * 100, 0)} %`
            : t('not_found')
      }),
      make('td', { class: 'number', text: at ? at.map(v => v.toFixed(1)).join(', ') : '' })
    )
    const choose = () => {
      placing.chosen = name
      at && page.goWorld(at)
      page.show_('place')
    }
    row.addEventListener('click', choose)
    row.addEventListener('keydown', e => {
      if (e.key === 'Enter') choose()
    })
    return row
  })
  return [
    fixed ? para('warn', page.info.fixed || t('no_config')) : null,
    heading('landmarks'),
    para('faint', t('landmark_how')),
    table(
      [
        [t('name'), 0],
        [t('source'), 0],
        ['L, P, S mm', 1]
      ],
      rows
    ),
    inRow(
      button(
        'here',
        async () => {
          neededLandmark(page)
          await putLandmark(page, placing.chosen, page.volume.toWorld(page.at))
        },
        { id: 'here', disabled: !!fixed }
      ),
      button(
        'as_found',
        async () => {
          neededLandmark(page)
          await putLandmark(page, placing.chosen, null)
        },
        { id: 'as-found', disabled: !!fixed }
      )
    ),
    holes.panel(fixed),
    boxes.panel(fixed)
  ].flat(2)
}

function placePanel(page) {
  const placing = (page.placing = { done: [], undone: [], chosen: null })
  const { done, undone } = placing
  page.landmarkNames = () => landmarkNames(page)
  page.chooseLandmark = name => chooseLandmark(page, name)
  page.change = (path, before, after) => changeValue(page, path, before, after)
  page.undoPlace = () => moveChange(page, done, undone, 'before', 'undo')
  page.redoPlace = () => moveChange(page, undone, done, 'after', 'redo')
  // Of what is switched on and off, the other state is what was before.
  page.canSwitch = id => canSwitch(page, id)
  page.undo = () => (isPainting(page) ? page.undoPaint() : page.undoEdit(page.tool) || page.undoPlace())
  page.redo = () => (isPainting(page) ? page.redoPaint() : page.redoPlace())
  // What is dragged on a slice that it lies in keeps its place across the slice, to a fraction of a voxel.
  page.withinSlice = (p, at, was) => withinSlice(page, p, at, was)
  page.tools.landmark = {
    key: 'l',
    down: (p, at) => {
      neededLandmark(page)
      dragLandmark(page, p, at)
    },
    move: (p, at) => {
      if (page.dragged) dragLandmark(page, p, at)
    },
    stop: () => {
      page.dragged = null
      page.redraw()
    },
    up: async () => {
      const at = page.dragged
      page.dragged = null
      if (at && page.volume.inside(at.map(Math.round))) await putLandmark(page, placing.chosen, page.volume.toWorld(at))
    }
  }
  const holes = holesOf(page),
    boxes = boxesOf(page)
  Object.assign(placing, { holes, boxes })
  page.more = () => placeMarks(page)
  page.addPanel('place', () => placeControls(page))
}
