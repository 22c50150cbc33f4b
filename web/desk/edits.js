// Part 9b: corrections that are no painting: a snake that is watched while it grows, a cut by a plane, a place that is smoothed. Each
// is kept as what it is, and the next run does it again. What it would give is drawn as a dashed line before it is saved.
function editsOf(page) {
  const fresh = { snake: { removes: false, seed_mm: null, seed_radius_mm: 2, within_mm: 20, lower_hu: -40, upper_hu: 8, smoothing_sigma_mm: .7, curvature: .2 }, cut: { point_mm: null, normal: [0, 0, 1], within_mm: 20 }, smooth: { point_mm: null, within_mm: 10, sigma_mm: 1.5 } }
  let kind = '', edit = null, shown = false, said = '', kindOfSaid = 'faint'
  let steps = 0, running = false, grown = null, asked = 0
  const fits = /^(snake|cut|smooth)$/
  const told = () => { if (page.tab === 'paint') page.show_('paint') }
  const say = (text, as = 'faint') => {
    said = text, kindOfSaid = as
    if ($('edit-said')) $('edit-said').textContent = text, $('edit-said').className = as
  }
  const hide = () => { shown = false, page.redraw() }
  const drop = (forget = true) => {
    if (forget && kind) tell('snake', { forget: true }).catch(() => {})
    kind = '', edit = null, running = false, grown = null, steps = 0, ++asked
    hide(), say(''), told()
    page.remember()
  }
  // What was set of such an edit last is where the next one begins.
  const last = structuredClone(fresh)
  // Until a person sets a range, a snake begins with that of the voxels about its seed: their mean, and three deviations to both sides.
  let ownRange = false
  const rangeAbout = async (seed_mm, radius_mm) => {
    const { volume } = page, p = volume.planes[0], at = volume.toIndex(seed_mm), [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
    const hu = await volume.slice(p.n, Math.round(at[p.n])), found = [], reach = [lo, hi].map(a => Math.ceil(radius_mm / volume.spacing[a]))
    for (let v = -reach[1]; v <= reach[1]; ++v) for (let u = -reach[0]; u <= reach[0]; ++u) {
      const i = Math.round(at[lo]) + u, j = Math.round(at[hi]) + v
      if (i >= 0 && j >= 0 && i < volume.size[lo] && j < volume.size[hi] && Math.hypot(u * volume.spacing[lo], v * volume.spacing[hi]) <= radius_mm) found.push(hu[j * volume.size[lo] + i])
    }
    if (!found.length) return null
    const mean = found.reduce((a, b) => a + b, 0) / found.length, deviation = Math.max(5, Math.sqrt(found.reduce((a, b) => a + (b - mean) ** 2, 0) / found.length))
    return [Math.round(mean - 3 * deviation), Math.round(mean + 3 * deviation)]
  }
  const begin = (name, place) => {
    if (kind !== name || name === 'snake') { if (kind) tell('snake', { forget: true }).catch(() => {}); steps = 0, grown = null }
    running = false, ++asked
    kind = name, edit = { ...structuredClone(last[name]), ...place }
    page.remember()
    hide(), say(t('edit_' + name)), told()
  }
  const rounded = (v, k = 1e3) => v.map(x => Math.round(x * k) / k)

  // ---- the snake, a step at a time; what the desk holds in memory is only where it stands
  const goTo = async n => {
    const mine = ++asked
    const now = await tell('snake', { case: page.token, snake: edit, steps: n })
    if (mine !== asked || desk.page !== page) return false
    steps = now.steps, grown = now
    page.volume.forget('~edit')
    shown = true
    desk.stats.snake = steps
    page.remember()
    say(`${t('step')} ${steps} · ${digits(now.volume_ml, 2)} ml · ${t('moves')} ${digits(now.change_mm, 3)} mm`, 'good')
    page.redraw()
    return true
  }
  // Each step is drawn before the next is asked for.
  const run = async () => {
    const volumes = []
    running = true
    told()
    try {
      while (running && kind === 'snake' && desk.page === page && await goTo(steps + 1)) {
        volumes.push(grown.volume_ml)
        // Noise lets the surface flicker: it is at rest where its volume stays over ten steps.
        if (volumes.length > 10 && Math.abs(grown.volume_ml - volumes[volumes.length - 11]) <= .002 * grown.volume_ml) { say(`${$('edit-said') ? $('edit-said').textContent : ''} · ${t('at_rest')}`, 'good'); break }
        if (steps >= 2000) break
        await page.outlinesDrawn('~edit')
        await new Promise(done => requestAnimationFrame(done))
      }
    } catch (e) { problem(e.message) } finally { running = false, told() }
  }
  const pause = () => { running = false }
  const back = n => async () => { running = false; await goTo(Math.max(0, steps - n)) }

  // ---- what is in hand outlives a reload, and a desk that ends: the snake is grown again to where it was
  page.heldEdit = () => edit && { kind, edit, steps, anatomy: page.anatomy() }
  page.holdEdit = held => {
    if (!fits.test(held.kind)) return
    page.chooseAnatomy(held.anatomy)
    kind = held.kind, edit = held.edit
    say(t('edit_' + kind))
    if (kind === 'snake' && held.steps) goTo(held.steps).then(told, e => problem(e.message))
  }

  // ---- tools
  page.tools.snake = { key: 's', down: async (p, at) => {
    page.needAnatomy()
    if (!page.volume.inside(at.map(Math.round))) return
    const seed_mm = rounded(page.volume.toWorld(at)), wanted = page.rangeWanted(), about = ownRange || 'lower_hu' in wanted ? null : await rangeAbout(seed_mm, last.snake.seed_radius_mm)
    begin('snake', { seed_mm, ...about ? { lower_hu: about[0], upper_hu: about[1] } : {}, ...wanted })
    page.redraw()
  } }
  page.tools.smooth = { key: 'o', down: (p, at) => { page.needAnatomy(); begin('smooth', { point_mm: rounded(page.volume.toWorld(at)) }) } }
  // A line that is drawn on a slice is a plane across it; what lies to the right of the way that the line was drawn goes.
  let line = null
  page.tools.cut = {
    key: 'c', draws: true,
    stop: () => { line = null },
    down: (p, at) => { page.needAnatomy(); line = { p, from: at, to: at } },
    move: (p, at) => { if (line && line.p === p) line.to = at, page.redraw() },
    up: () => {
      const drawn = line
      line = null
      if (!drawn) return
      const { volume } = page, a = volume.toWorld(drawn.from), b = volume.toWorld(drawn.to), d = b.map((v, k) => v - a[k]), n = Math.hypot(...d)
      if (n < 1) throw new Refused(t('cut_short'))
      const one = [0, 0, 0], zero = volume.toWorld([0, 0, 0])
      one[drawn.p.n] = 1
      const across = volume.toWorld(one).map((v, k) => v - zero[k]), cross = [d[1] * across[2] - d[2] * across[1], d[2] * across[0] - d[0] * across[2], d[0] * across[1] - d[1] * across[0]], m = Math.hypot(...cross)
      begin('cut', { point_mm: rounded(a.map((v, k) => v + d[k] / 2)), normal: rounded(cross.map(v => v / m), 1e6), within_mm: Math.max(1, Math.round(n / 2 * 10) / 10) })
      preview().catch(e => problem(e.message))
    }
  }

  const wanted = () => kind === 'snake' ? { snake: { ...edit, steps_count: steps } } : { [kind]: edit }
  const preview = async () => {
    const mine = ++asked
    say(t('previewing'))
    const now = await tell('try_edit', { case: page.token, anatomy: page.anatomy(), edit: wanted() })
    if (mine !== asked) return
    page.volume.forget('~edit')
    shown = true
    desk.stats.previewed = (desk.stats.previewed || 0) + 1
    const what = [[now.added_ml, t('added')], [now.removed_ml, t('removed')]].filter(([ml]) => ml > 0).map(([ml, w]) => `${digits(ml, 2)} ml ${w}`).join(', ')
    say([what || t('nothing'), ...now.warnings].join('\n'), what ? 'good' : 'warn')
    page.redraw()
  }
  const save = async why => {
    running = false
    if (kind === 'snake' && !steps) throw new Refused(t('snake_first'))
    await page.save('edit', { anatomy: page.anatomy(), edit: wanted() }, why)
    Object.assign(last[kind], edit)
    page.canSwitch(Math.max(...page.info.journal.map(e => e.id)))
    drop(false)
  }

  // ---- drawn over the slices
  page.overlays.push((p, c) => {
    const { volume } = page
    if (line && line.p === p) {
      c.strokeStyle = '#ff9c3c', c.lineWidth = 2 * p.r
      c.beginPath(), c.moveTo(p.X(line.from[p.u]), p.Y(line.from[p.v])), c.lineTo(p.X(line.to[p.u]), p.Y(line.to[p.v])), c.stroke()
    }
    if (!edit) return
    const centre = volume.toIndex(edit.seed_mm || edit.point_mm), off = (page.at[p.n] - centre[p.n]) * volume.spacing[p.n]
    const circle = (radius, colour, dash) => {
      const r2 = radius * radius - off * off
      if (!(r2 > 0)) return
      c.setLineDash(dash.map(d => d * p.r)), c.strokeStyle = colour, c.lineWidth = 1.3 * p.r
      c.beginPath(), c.arc(p.X(centre[p.u]), p.Y(centre[p.v]), Math.sqrt(r2) * p.k, 0, 7), c.stroke(), c.setLineDash([])
    }
    circle(edit.within_mm, 'rgba(255,255,255,.55)', [2, 5])
    if (kind === 'snake' && !steps) circle(edit.seed_radius_mm, '#7cf0a0', [])
    if (kind === 'cut') {
      // Where the plane meets the slice, within the ball, and an arrow to the side that goes.
      const zero = volume.toWorld([0, 0, 0]), along = a => { const one = [0, 0, 0]; one[a] = 1; return volume.toWorld(one).map((v, k) => (v - zero[k]) / volume.spacing[a]) }
      const nu = along(p.u).reduce((s, v, k) => s + v * edit.normal[k], 0), nv = along(p.v).reduce((s, v, k) => s + v * edit.normal[k], 0), nn = along(p.n).reduce((s, v, k) => s + v * edit.normal[k], 0), h = Math.hypot(nu, nv)
      if (h > .05) {
        const shift = -nn * off / (h * h), u0 = centre[p.u] + nu * shift / volume.spacing[p.u], v0 = centre[p.v] + nv * shift / volume.spacing[p.v]
        const half2 = edit.within_mm ** 2 - off * off - (h * shift) ** 2
        if (half2 > 0) {
          const half = Math.sqrt(half2), X = (s, w) => p.X(u0 + (-nv * s + nu * w) / h / volume.spacing[p.u]), Y = (s, w) => p.Y(v0 + (nu * s + nv * w) / h / volume.spacing[p.v])
          c.strokeStyle = '#ff9c3c', c.lineWidth = 2 * p.r
          c.beginPath(), c.moveTo(X(-half, 0), Y(-half, 0)), c.lineTo(X(half, 0), Y(half, 0)), c.moveTo(X(0, 0), Y(0, 0)), c.lineTo(X(0, half / 3), Y(0, half / 3)), c.stroke()
          page.inked(c, t('goes'), X(0, half / 3 + 1), Y(0, half / 3 + 1), '#ff9c3c', p.r)
        }
      }
    }
    if (!shown) return
    const outline = volume.outline('~edit', p.n, page.at[p.n])
    if (outline.then) outline.then(page.redraw, () => { shown = false })
    else page.strokeOutline(c, p, outline, kind === 'snake' && edit.removes ? '#ff9c3c' : '#ffffff', [5, 4])
  })

  const panel = (why, fixed) => {
    const head = make('h2', { text: t('shapes') }), how = make('p', { class: 'faint', text: t('shapes_how') })
    if (!edit) return [head, how]
    const changed = () => { asked++, running = false; if (kind === 'snake') steps = 0, grown = null; hide(), say(t('edit_' + kind)), told() }
    const number = (key, name, given = {}) => field(name, make('input', { type: 'number', 'data-edit': key, value: edit[key], ...given, change: e => { if (isFinite(e.target.valueAsNumber)) edit[key] = e.target.valueAsNumber; if (key.endsWith('_hu')) ownRange = true; changed() } }))
    const kinds = { snake: 'n_snake', cut: 'n_cut', smooth: 'n_smooth' }
    const at = (edit.seed_mm || edit.point_mm).map(v => v.toFixed(1)).join(', ')
    return [head, make('p', { id: 'edit-what', text: `${t(kinds[kind])} · ${at} mm` }),
      make('div', { class: 'row' }, number('within_mm', 'e_within', { min: 1, max: kind === 'snake' ? 60 : 1000 }), make('span', { class: 'faint', text: 'mm' }), kind === 'snake' ? number('seed_radius_mm', 'e_seed', { min: .1, max: 30, step: .5 }) : null, kind === 'smooth' ? number('sigma_mm', 'e_sigma', { min: .1, max: 10, step: .1 }) : null),
      kind === 'snake' ? [make('div', { class: 'row' }, number('lower_hu', 'hu_low'), number('upper_hu', 'hu_high')), make('div', { class: 'row' }, number('smoothing_sigma_mm', 'e_noise', { min: 0, max: 5, step: .1 }), number('curvature', 'e_curvature', { min: 0, max: 10, step: .1 }), make('label', {}, make('input', { type: 'checkbox', 'data-edit': 'removes', checked: edit.removes, change: e => { edit.removes = e.target.checked, page.redraw() } }), make('span', { text: t('e_removes') })))] : null,
      kind === 'snake' ? make('div', { class: 'row' }, running ? button('pause', pause, { id: 'snake-pause' }) : button('grow_it', () => { run() }, { id: 'snake-run', class: 'main' }), button('one_step', async () => { running = false; await goTo(steps + 1) }, { id: 'snake-step' }), button('one_back', back(1), { id: 'snake-back' }), button('ten_back', back(10))) : null,
      kind === 'cut' ? make('div', { class: 'row' }, button('flip', () => { edit.normal = edit.normal.map(v => -v || 0); hide(); return preview() }, { id: 'flip' })) : null,
      make('p', { id: 'edit-said', class: kindOfSaid, text: said, role: 'status' }),
      make('div', { class: 'row' }, button('preview', preview, { id: 'edit-preview' }), button('save_edit', () => save(why.value), { id: 'save-edit', class: kind === 'snake' ? '' : 'main', disabled: !!fixed }), button('cancel', () => drop(), { id: 'cancel-edit' }))].flat(2)
  }
  // With such a tool in hand: a step of the snake back, else the edit that is not saved goes.
  page.undoEdit = tool => !fits.test(tool) || !edit ? null : kind === 'snake' && steps ? back(1)().then(() => true) : (drop(), true)
  return { panel }
}
