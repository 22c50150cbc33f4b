// Corrections that are no painting: a snake that is watched while it grows, a cut by a plane, a place that is smoothed. Each
// is kept as what it is, and the next run does it again. What it would give is drawn as a dashed line before it is saved.

function showEdit(page) {
  if (page.tab === 'paint') page.show_('paint')
}

function sayOfEdit(page, text, as = 'faint') {
  const { editing } = page
  editing.said = text
  editing.kindOfSaid = as
  if ($('edit-said')) {
    $('edit-said').textContent = text
    $('edit-said').className = as
  }
}

function hideEdit(page) {
  const { editing } = page
  editing.shown = false
  page.redraw()
}

function dropEdit(page, forget = true) {
  const { editing } = page
  if (forget && editing.kind) tell('snake', { forget: true }).catch(() => {})
  editing.kind = ''
  editing.edit = null
  editing.running = false
  editing.grown = null
  editing.steps = 0
  ++editing.asked
  hideEdit(page)
  sayOfEdit(page, '')
  showEdit(page)
  page.remember()
}

async function rangeAbout(page, seed_mm, radius_mm) {
  const { volume } = page,
    p = volume.planes[0],
    at = volume.toIndex(seed_mm),
    [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
  const hu = await volume.slice(p.n, Math.round(at[p.n])),
    found = [],
    reach = [lo, hi].map(a => Math.ceil(radius_mm / volume.spacing[a]))
  for (let v = -reach[1]; v <= reach[1]; ++v)
    for (let u = -reach[0]; u <= reach[0]; ++u) {
      const i = Math.round(at[lo]) + u,
        j = Math.round(at[hi]) + v
      if (
        i >= 0 &&
        j >= 0 &&
        i < volume.size[lo] &&
        j < volume.size[hi] &&
        Math.hypot(u * volume.spacing[lo], v * volume.spacing[hi]) <= radius_mm
      )
        found.push(hu[j * volume.size[lo] + i])
    }
  if (!found.length) return null
  const mean = found.reduce((a, b) => a + b, 0) / found.length,
    deviation = Math.max(5, Math.sqrt(found.reduce((a, b) => a + (b - mean) ** 2, 0) / found.length))
  return [Math.round(mean - 3 * deviation), Math.round(mean + 3 * deviation)]
}

function beginEdit(page, name, place) {
  const { editing } = page
  const { last } = editing
  if (editing.kind !== name || name === 'snake') {
    if (editing.kind) tell('snake', { forget: true }).catch(() => {})
    editing.steps = 0
    editing.grown = null
  }
  editing.running = false
  ++editing.asked
  editing.kind = name
  editing.edit = { ...structuredClone(last[name]), ...place }
  page.remember()
  hideEdit(page)
  sayOfEdit(page, t('edit_' + name))
  showEdit(page)
}

const rounded = (v, k = 1e3) => v.map(x => Math.round(x * k) / k)

async function goToStep(page, n) {
  const { editing } = page
  const mine = ++editing.asked
  const now = await tell('snake', { case: page.token, snake: editing.edit, steps: n })
  if (mine !== editing.asked || desk.page !== page) return false
  editing.steps = now.steps
  editing.grown = now
  page.volume.forget('~edit')
  editing.shown = true
  desk.stats.snake = editing.steps
  page.remember()
  sayOfEdit(
    page,
    `${t('step')} ${editing.steps} · ${digits(now.volume_ml, 2)} ml · ${t('moves')} ${digits(now.change_mm, 3)} mm`,
    'good'
  )
  page.redraw()
  return true
}

// Each step is drawn before the next is asked for.
async function runSnake(page) {
  const { editing } = page
  const volumes = []
  editing.running = true
  showEdit(page)
  try {
    while (editing.running && editing.kind === 'snake' && desk.page === page && (await goToStep(page, editing.steps + 1))) {
      volumes.push(editing.grown.volume_ml)
      // Noise lets the surface flicker: it is at rest where its volume stays over ten steps.
      if (
        volumes.length > 10 &&
        Math.abs(editing.grown.volume_ml - volumes[volumes.length - 11]) <= 0.002 * editing.grown.volume_ml
      ) {
        sayOfEdit(page, `${$('edit-said') ? $('edit-said').textContent : ''} · ${t('at_rest')}`, 'good')
        break
      }
      if (editing.steps >= 2000) break
      await page.outlinesDrawn('~edit')
      await new Promise(done => requestAnimationFrame(done))
    }
  } catch (e) {
    problem(e.message)
  } finally {
    editing.running = false
    showEdit(page)
  }
}

function pauseSnake(page) {
  const { editing } = page
  editing.running = false
}

function stepBack(page, n) {
  const { editing } = page
  return async () => {
    editing.running = false
    await goToStep(page, Math.max(0, editing.steps - n))
  }
}

function wantedEdit(page) {
  const { editing } = page
  return editing.kind === 'snake' ? { snake: { ...editing.edit, steps_count: editing.steps } } : { [editing.kind]: editing.edit }
}

async function previewEdit(page) {
  const { editing } = page
  const mine = ++editing.asked
  sayOfEdit(page, t('previewing'))
  const now = await tell('try_edit', { case: page.token, anatomy: page.anatomy(), edit: wantedEdit(page) })
  if (mine !== editing.asked) return
  page.volume.forget('~edit')
  editing.shown = true
  desk.stats.previewed = (desk.stats.previewed || 0) + 1
  const what = [
    [now.added_ml, t('added')],
    [now.removed_ml, t('removed')]
  ]
    .filter(([ml]) => ml > 0)
    .map(([ml, w]) => `${digits(ml, 2)} ml ${w}`)
    .join(', ')
  sayOfEdit(page, [what || t('nothing'), ...now.warnings].join('\n'), what ? 'good' : 'warn')
  page.redraw()
}

async function saveEdit(page, why) {
  const { editing } = page
  const { last } = editing
  editing.running = false
  if (editing.kind === 'snake' && !editing.steps) throw new Refused(t('snake_first'))
  const { id } = await page.save('edit', { anatomy: page.anatomy(), edit: wantedEdit(page) }, why)
  Object.assign(last[editing.kind], editing.edit)
  page.canSwitch(id)
  dropEdit(page, false)
}

function holdEdit(page, held) {
  const { editing } = page
  const { fits } = editing
  if (!fits.test(held.kind)) return
  page.chooseAnatomy(held.anatomy)
  editing.kind = held.kind
  editing.edit = held.edit
  sayOfEdit(page, t('edit_' + editing.kind))
  if (editing.kind === 'snake' && held.steps)
    goToStep(page, held.steps).then(
      () => showEdit(page),
      e => problem(e.message)
    )
}

function editsOf(page) {
  const editing = (page.editing = {
    kind: '',
    edit: null,
    shown: false,
    said: '',
    kindOfSaid: 'faint',
    steps: 0,
    running: false,
    grown: null,
    asked: 0,
    fits: /^(snake|cut|smooth)$/,
    // Until a person sets a range, a snake begins with that of the voxels about its seed: their mean, and three deviations to
    // both sides.
    ownRange: false,
    // A line that is drawn on a slice is a plane across it; what lies to the right of the way that the line was drawn goes.
    line: null
  })
  const { fits } = editing
  const fresh = {
    snake: {
      removes: false,
      seed_mm: null,
      seed_radius_mm: 2,
      within_mm: 20,
      lower_hu: -40,
      upper_hu: 8,
      smoothing_sigma_mm: 0.7,
      curvature: 0.2
    },
    cut: { point_mm: null, normal: [0, 0, 1], within_mm: 20 },
    smooth: { point_mm: null, within_mm: 10, sigma_mm: 1.5 }
  }
  // What was set of such an edit last is where the next one begins.
  const last = structuredClone(fresh)
  editing.last = last
  page.heldEdit = () => editing.edit && { kind: editing.kind, edit: editing.edit, steps: editing.steps, anatomy: page.anatomy() }
  page.holdEdit = held => holdEdit(page, held)
  page.tools.snake = {
    key: 's',
    down: async (p, at) => {
      page.needAnatomy()
      if (!page.volume.inside(at.map(Math.round))) return
      const seed_mm = rounded(page.volume.toWorld(at)),
        wanted = page.rangeWanted(),
        about = editing.ownRange || 'lower_hu' in wanted ? null : await rangeAbout(page, seed_mm, last.snake.seed_radius_mm)
      beginEdit(page, 'snake', { seed_mm, ...(about ? { lower_hu: about[0], upper_hu: about[1] } : {}), ...wanted })
      page.redraw()
    }
  }
  page.tools.smooth = {
    key: 'o',
    down: (p, at) => {
      page.needAnatomy()
      beginEdit(page, 'smooth', { point_mm: rounded(page.volume.toWorld(at)) })
    }
  }
  page.tools.cut = {
    key: 'c',
    draws: true,
    stop: () => {
      editing.line = null
    },
    down: (p, at) => {
      page.needAnatomy()
      editing.line = { p, from: at, to: at }
    },
    move: (p, at) => {
      if (editing.line && editing.line.p === p) {
        editing.line.to = at
        page.redraw()
      }
    },
    up: () => {
      const drawn = editing.line
      editing.line = null
      if (!drawn) return
      const { volume } = page,
        a = volume.toWorld(drawn.from),
        b = volume.toWorld(drawn.to),
        d = b.map((v, k) => v - a[k]),
        n = Math.hypot(...d)
      if (n < 1) throw new Refused(t('cut_short'))
      const one = [0, 0, 0],
        zero = volume.toWorld([0, 0, 0])
      one[drawn.p.n] = 1
      const across = volume.toWorld(one).map((v, k) => v - zero[k]),
        cross = [d[1] * across[2] - d[2] * across[1], d[2] * across[0] - d[0] * across[2], d[0] * across[1] - d[1] * across[0]],
        m = Math.hypot(...cross)
      beginEdit(page, 'cut', {
        point_mm: rounded(a.map((v, k) => v + d[k] / 2)),
        normal: rounded(
          cross.map(v => v / m),
          1e6
        ),
        within_mm: Math.max(1, Math.round((n / 2) * 10) / 10)
      })
      previewEdit(page).catch(e => problem(e.message))
    }
  }
  page.overlays.push((p, c) => drawEdit(page, p, c))
  // With such a tool in hand: a step of the snake back, else the edit that is not saved goes.
  page.undoEdit = tool =>
    !fits.test(tool) || !editing.edit
      ? null
      : editing.kind === 'snake' && editing.steps
        ? stepBack(page, 1)().then(() => true)
        : (dropEdit(page), true)
  return { panel: (why, fixed) => editControls(page, why, fixed) }
}
