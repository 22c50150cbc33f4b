// A burr hole by hand: its entry and its target, the plane through both, how near it comes to what is shown, and what the
// run would make of it before it is saved.

const freshHole = diameter => ({ entry: null, target: null, diameter_mm: diameter, angle: 0, index: -1, tried: null })
const saidHoles = page => (page.info && page.info.now ? page.info.now.said_holes : [])
const cutsHoles = page => !!(page.info && page.info.now && page.info.now.cuts_holes)

function holeIsWhole(page) {
  const { planned } = page
  return !!(planned.hole.entry && planned.hole.target && holeDirection(page))
}

function entryToTarget(page) {
  const { planned } = page
  return Math.hypot(...planned.hole.target.map((v, k) => v - planned.hole.entry[k]))
}

function holeDirection(page) {
  const { planned } = page
  const d = planned.hole.target.map((v, k) => v - planned.hole.entry[k]),
    n = Math.hypot(...d)
  return n > 1e-6 ? d.map(v => v / n) : null
}

function setHolePoint(page, which, w) {
  const { planned } = page
  planned.hole[which] = w
  planned.hole.tried = null
  page.redraw()
  page.heldHole && page.heldHole()
}

// As a line of the configuration says it.
function holeLine(page) {
  const { planned } = page
  const rounded = (v, k) => v.map(x => Math.round(x * k) / k),
    old = saidHoles(page)[planned.hole.index] || {}
  const { at, side, along_mm, lateral_mm, toward, direction, target_mm, ...kept } = old
  return {
    ...kept,
    at: 'position',
    position_mm: rounded(planned.hole.entry, 1e4),
    target_mm: rounded(planned.hole.target, 1e4),
    diameter_mm: planned.hole.diameter_mm
  }
}

function holeLines(page) {
  const { planned } = page
  return planned.hole.index < 0
    ? [...saidHoles(page), holeLine(page)]
    : saidHoles(page).map((h, i) => (i === planned.hole.index ? holeLine(page) : h))
}

function needHole(page) {
  if (!holeIsWhole(page)) throw new Refused(t('entry_first'))
}

const holeName = (h, i) => h.name || `burr_hole_${i + 1}`
const builtHole = (page, h, i) => page.info && page.info.built && page.info.built.holes.find(b => b.name === holeName(h, i))

// Where a saved hole lies: as the configuration says; one by Kocher's rule as the case was built, else at the point that
// was found.
function placedHole(page, h, i) {
  const built = builtHole(page, h, i)
  const found = name =>
    ([...page.foundMarks(), ...(page.info.built ? page.info.built.targets : [])].find(l => l.name === name) || {}).position_mm
  const toward = h.target_mm ? h.target_mm.map(Number) : h.toward && (page.info.now.landmarks[h.toward] || found(h.toward))
  const kocher = `kocher_${h.side || 'right'}`
  const entry = h.position_mm
    ? h.position_mm.map(Number)
    : built
      ? built.position_mm
      : page.info.now.landmarks[kocher] || found(kocher)
  if (!entry) return null
  const d = h.direction ? h.direction.map(Number) : toward ? toward.map((v, k) => v - entry[k]) : built ? built.direction : null
  const n = d && Math.hypot(...d)
  return { entry, target: toward || (n ? entry.map((v, k) => v + (d[k] / n) * 60) : null) }
}

// Those that the configuration has and the case not yet, or elsewhere.
function waitingHoles(page) {
  const { planned } = page
  return saidHoles(page)
    .map((h, i) => ({ name: holeName(h, i), i, built: builtHole(page, h, i), at: placedHole(page, h, i) }))
    .filter(
      w =>
        w.at &&
        w.i !== planned.hole.index &&
        (!w.built ||
          w.built.diameter_mm !== (+saidHoles(page)[w.i].diameter_mm || 14) ||
          [w.at.entry, w.at.target].some(p => p && mmFromAxis(w.built, p) > 1.5))
    )
}

// The hole is cut from the surface of the bone on, so what was clicked lies on its axis, not at its begin.
function mmFromAxis(built, p) {
  const to = p.map((v, k) => v - built.position_mm[k]),
    along = to.reduce((sum, v, k) => sum + v * built.direction[k], 0)
  return Math.hypot(...to.map((v, k) => v - built.direction[k] * along))
}

function changeHole(page, i) {
  const { planned } = page
  const at = placedHole(page, saidHoles(page)[i], i)
  if (!at) throw new Refused(t('hole_unknown'))
  planned.hole = { ...freshHole(+saidHoles(page)[i].diameter_mm || 14), ...at, index: i }
  page.goWorld(planned.hole.entry)
  page.show_('place')
}

function holeMarks(page) {
  const { planned } = page
  return [
    ...['entry', 'target']
      .filter(k => planned.hole[k])
      .map(k => ({ name: t(k), position_mm: planned.hole[k], colour: '#7cc4ff' })),
    ...waitingHoles(page).map(w => ({ name: `${label(w.name)} (${t('not_yet')})`, position_mm: w.at.entry, colour: '#ff9c8f' }))
  ]
}

// The run's own placing, on the surfaces of the last build where they are the same.
async function checkHole(page) {
  const { planned } = page
  needHole(page)
  planned.hole.tried = { text: t('checking'), kind: 'faint', rows: [] }
  page.show_('place')
  const mine = planned.hole,
    all = holeLines(page)
  let now
  try {
    now = await page.tryIt({ holes: all, hole: planned.hole.index < 0 ? all.length - 1 : planned.hole.index }, what => {
      if ($('hole-tried')) $('hole-tried').textContent = `${t('checking')}: ${what}`
    })
  } catch (e) {
    if (mine === planned.hole) {
      mine.tried = { text: e.message, kind: 'bad', rows: [] }
      page.show_('place')
    }
    return
  }
  if (mine !== planned.hole || !now) return
  const [report] = now.reports
  mine.tried = now.fault
    ? { text: now.fault, kind: 'bad', rows: [] }
    : {
        text: t('hole_good'),
        kind: 'good',
        rows: report ? Object.entries(report.figures).filter(([, v]) => typeof v === 'number') : []
      }
  const near = saidHoles(page)
    .map((h, i) => ({
      name: holeName(h, i),
      i,
      at: placedHole(page, h, i),
      mm: (+h.diameter_mm || 14) / 2 + mine.diameter_mm / 2
    }))
    .find(o => o.i !== mine.index && o.at && Math.hypot(...o.at.entry.map((v, k) => v - mine.entry[k])) < o.mm)
  if (!now.fault && near) mine.tried = { ...mine.tried, text: `${t('overlaps')} ${label(near.name)}`, kind: 'warn' }
  else if (report && !now.fault && report.warnings.length)
    mine.tried = { ...mine.tried, text: report.warnings.join('\n'), kind: 'warn' }
  page.show_('place')
}

// A hole of the configuration as a line of the list.
function holeRow(page, list, no, h, i) {
  const { planned } = page
  const from = h.at === 'position' ? t('by_hand') : `${t('kocher')} ${h.side ? t(h.side) : t('right')}`
  return make(
    'div',
    { class: 'row hole' + (i === planned.hole.index ? ' chosen' : ''), 'data-hole': String(i) },
    make('span', {
      class: 'grow',
      text: `${h.name ? label(h.name) : `${t('hole')} ${i + 1}`}: ${from}, ${h.diameter_mm || 14} mm`
    }),
    button('show', () => {
      const at = placedHole(page, h, i)
      if (!at) throw new Refused(t('hole_unknown'))
      page.goWorld(at.entry)
    }),
    button('change_it', () => changeHole(page, i), { disabled: no, 'data-change': String(i) }),
    button('remove', () => page.change('holes', { holes: list }, { holes: list.filter((_, k) => k !== i) }), {
      disabled: no,
      'data-remove': String(i)
    })
  )
}

function holeControls(page, fixed) {
  const { planned } = page
  const list = saidHoles(page),
    no = !!fixed || !cutsHoles(page)
  const told = make('p', { class: 'faint', id: 'hole' }),
    canvas = make('canvas', { class: 'cut', width: 360, height: 360, 'aria-label': t('cut') }),
    clear = make('div'),
    cut = make('div', {}, heading('cut'), canvas)
  const draw = () => {
    clearTimeout(planned.drawLater)
    planned.drawLater = setTimeout(() => drawTrajectory(page, canvas, clear).catch(e => problem(e.message)), 40)
  }
  const angle = make('input', {
    type: 'range',
    min: 0,
    max: 180,
    value: planned.hole.angle,
    input: e => {
      planned.hole.angle = +e.target.value
      draw()
    }
  })
  page.heldHole = () => {
    const place = which => (planned.hole[which] ? planned.hole[which].map(v => v.toFixed(1)).join(', ') : '–')
    told.textContent =
      planned.hole.entry || planned.hole.target
        ? `${t('entry')} ${place('entry')} · ${t('target')} ${place('target')}` +
          (holeIsWhole(page) ? ` · ${t('length')} ${digits(entryToTarget(page), 1)} mm` : '')
        : t('entry_first')
    cut.hidden = !holeIsWhole(page)
    for (const id of ['save-hole', 'check-hole']) if ($(id)) $(id).disabled = no || !holeIsWhole(page)
    draw()
  }
  const save = async () => {
    needHole(page)
    await page.change('holes', { holes: list }, { holes: holeLines(page) })
    planned.hole = freshHole(planned.hole.diameter_mm)
    page.show_('place')
  }
  const at = which =>
    button(which + '_here', () => setHolePoint(page, which, page.volume.toWorld(page.at)), {
      id: which + '-here',
      disabled: !!fixed
    })
  const tried = planned.hole.tried
  setTimeout(() => page.heldHole(), 0)
  return [
    heading('holes'),
    cutsHoles(page) || fixed ? null : [para('warn', t('no_holes')), page.sceneChoice(s => s.cuts_holes)],
    list.map((h, i) => holeRow(page, list, no, h, i)),
    cutsHoles(page) && !list.length ? para('warn', t('no_hole_yet')) : null,
    make('h2', { text: planned.hole.index < 0 ? t('add_hole') : `${t('change_it')}: ${t('hole')} ${planned.hole.index + 1}` }),
    told,
    inRow(
      at('entry'),
      at('target'),
      field(
        'diameter',
        make('input', {
          type: 'number',
          id: 'diameter',
          min: 1,
          max: 60,
          value: planned.hole.diameter_mm,
          change: e => {
            if (e.target.valueAsNumber > 0) planned.hole.diameter_mm = e.target.valueAsNumber
            else e.target.value = planned.hole.diameter_mm
            planned.hole.tried = null
            page.heldHole()
          }
        }),
        make('span', { text: t('mm') })
      )
    ),
    inRow(
      button('check_hole', () => checkHole(page), { id: 'check-hole' }),
      button('save_hole', save, { id: 'save-hole', class: 'main' }),
      planned.hole.entry || planned.hole.target
        ? button(
            'cancel',
            () => {
              planned.hole = freshHole(planned.hole.diameter_mm)
              page.show_('place')
              page.redraw()
            },
            { id: 'cancel-hole' }
          )
        : null
    ),
    tried ? make('p', { class: tried.kind, id: 'hole-tried', text: tried.text }) : null,
    tried && tried.rows.length
      ? table(
          [
            ['', 0],
            ['', 1]
          ],
          tried.rows.map(([name, v]) =>
            make('tr', {}, make('td', { text: label(name) }), make('td', { class: 'number', text: digits(v, 1) }))
          )
        )
      : null,
    (cut.append(inRow(field('turn', angle))), cut),
    clear
  ]
}

function holesOf(page) {
  const planned = (page.planned = { drawLater: 0, asked: 0 })
  planned.hole = freshHole(14)
  for (const which of ['entry', 'target']) {
    const put = (p, at) => setHolePoint(page, which, page.volume.toWorld(page.withinSlice(p, at, planned.hole[which])))
    page.tools[which] = { key: which === 'entry' ? 'e' : 'z', down: put, move: put, up: () => page.show_('place') }
  }
  page.changeHole = i =>
    saidHoles(page)[i] && placedHole(page, saidHoles(page)[i], i) ? changeHole(page, i) : page.show_('place')
  page.overlays.push((p, c) => drawHole(page, p, c))
  return { marks: () => holeMarks(page), panel: fixed => holeControls(page, fixed) }
}
