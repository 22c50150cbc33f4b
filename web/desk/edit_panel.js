// What is drawn of an edit, and its part of the panel.

function drawEdit(page, p, c) {
  const { editing } = page
  const { volume } = page
  if (editing.line && editing.line.p === p) {
    c.strokeStyle = '#ff9c3c'
    c.lineWidth = 2 * p.r
    c.beginPath()
    c.moveTo(p.X(editing.line.from[p.u]), p.Y(editing.line.from[p.v]))
    c.lineTo(p.X(editing.line.to[p.u]), p.Y(editing.line.to[p.v]))
    c.stroke()
  }
  if (!editing.edit) return
  const centre = volume.toIndex(editing.edit.seed_mm || editing.edit.point_mm),
    off = (page.at[p.n] - centre[p.n]) * volume.spacing[p.n]
  const circle = (radius, colour, dash) => {
    const r2 = radius * radius - off * off
    if (!(r2 > 0)) return
    c.setLineDash(dash.map(d => d * p.r))
    c.strokeStyle = colour
    c.lineWidth = 1.3 * p.r
    c.beginPath()
    c.arc(p.X(centre[p.u]), p.Y(centre[p.v]), Math.sqrt(r2) * p.k, 0, 7)
    c.stroke()
    c.setLineDash([])
  }
  circle(editing.edit.within_mm, 'rgba(255,255,255,.55)', [2, 5])
  if (editing.kind === 'snake' && !editing.steps) circle(editing.edit.seed_radius_mm, '#7cf0a0', [])
  if (editing.kind === 'cut') {
    // Where the plane meets the slice, within the ball, and an arrow to the side that goes.
    const zero = volume.toWorld([0, 0, 0]),
      along = a => {
        const one = [0, 0, 0]
        one[a] = 1
        return volume.toWorld(one).map((v, k) => (v - zero[k]) / volume.spacing[a])
      }
    const nu = along(p.u).reduce((s, v, k) => s + v * editing.edit.normal[k], 0),
      nv = along(p.v).reduce((s, v, k) => s + v * editing.edit.normal[k], 0),
      nn = along(p.n).reduce((s, v, k) => s + v * editing.edit.normal[k], 0),
      h = Math.hypot(nu, nv)
    if (h > 0.05) {
      const shift = (-nn * off) / (h * h),
        u0 = centre[p.u] + (nu * shift) / volume.spacing[p.u],
        v0 = centre[p.v] + (nv * shift) / volume.spacing[p.v]
      const half2 = editing.edit.within_mm ** 2 - off * off - (h * shift) ** 2
      if (half2 > 0) {
        const half = Math.sqrt(half2),
          X = (s, w) => p.X(u0 + (-nv * s + nu * w) / h / volume.spacing[p.u]),
          Y = (s, w) => p.Y(v0 + (nu * s + nv * w) / h / volume.spacing[p.v])
        c.strokeStyle = '#ff9c3c'
        c.lineWidth = 2 * p.r
        c.beginPath()
        c.moveTo(X(-half, 0), Y(-half, 0))
        c.lineTo(X(half, 0), Y(half, 0))
        c.moveTo(X(0, 0), Y(0, 0))
        c.lineTo(X(0, half / 3), Y(0, half / 3))
        c.stroke()
        page.inked(c, t('goes'), X(0, half / 3 + 1), Y(0, half / 3 + 1), '#ff9c3c', p.r)
      }
    }
  }
  if (!editing.shown) return
  const outline = volume.outline('~edit', p.n, page.at[p.n])
  if (outline.then)
    outline.then(page.redraw, () => {
      editing.shown = false
    })
  else page.strokeOutline(c, p, outline, editing.kind === 'snake' && editing.edit.removes ? '#ff9c3c' : '#ffffff', [5, 4])
}

function editControls(page, why, fixed) {
  const { editing } = page
  const head = heading('shapes'),
    how = para('faint', t('shapes_how'))
  if (!editing.edit) return [head, how]
  const changed = () => {
    editing.asked++
    editing.running = false
    if (editing.kind === 'snake') {
      editing.steps = 0
      editing.grown = null
    }
    hideEdit(page)
    sayOfEdit(page, t('edit_' + editing.kind))
    showEdit(page)
  }
  const number = (key, name, given = {}) =>
    field(
      name,
      make('input', {
        type: 'number',
        'data-edit': key,
        value: editing.edit[key],
        ...given,
        change: e => {
          if (isFinite(e.target.valueAsNumber)) editing.edit[key] = e.target.valueAsNumber
          if (key.endsWith('_hu')) editing.ownRange = true
          changed()
        }
      })
    )
  const kinds = { snake: 'n_snake', cut: 'n_cut', smooth: 'n_smooth' }
  const at = (editing.edit.seed_mm || editing.edit.point_mm).map(v => v.toFixed(1)).join(', ')
  return [
    head,
    make('p', { id: 'edit-what', text: `${t(kinds[editing.kind])} · ${at} mm` }),
    inRow(
      number('within_mm', 'e_within', { min: 1, max: editing.kind === 'snake' ? 60 : 1000 }),
      faint('mm'),
      editing.kind === 'snake' ? number('seed_radius_mm', 'e_seed', { min: 0.1, max: 30, step: 0.5 }) : null,
      editing.kind === 'smooth' ? number('sigma_mm', 'e_sigma', { min: 0.1, max: 10, step: 0.1 }) : null
    ),
    editing.kind === 'snake'
      ? [
          inRow(number('lower_hu', 'hu_low'), number('upper_hu', 'hu_high')),
          inRow(
            number('smoothing_sigma_mm', 'e_noise', { min: 0, max: 5, step: 0.1 }),
            number('curvature', 'e_curvature', { min: 0, max: 10, step: 0.1 }),
            tick(t('e_removes'), {
              'data-edit': 'removes',
              checked: editing.edit.removes,
              change: e => {
                editing.edit.removes = e.target.checked
                page.redraw()
              }
            })
          )
        ]
      : null,
    editing.kind === 'snake'
      ? inRow(
          editing.running
            ? button('pause', () => pauseSnake(page), { id: 'snake-pause' })
            : button(
                'grow_it',
                () => {
                  runSnake(page)
                },
                { id: 'snake-run', class: 'main' }
              ),
          button(
            'one_step',
            async () => {
              editing.running = false
              await goToStep(page, editing.steps + 1)
            },
            { id: 'snake-step' }
          ),
          button('one_back', stepBack(page, 1), { id: 'snake-back' }),
          button('ten_back', stepBack(page, 10))
        )
      : null,
    editing.kind === 'cut'
      ? inRow(
          button(
            'flip',
            () => {
              editing.edit.normal = editing.edit.normal.map(v => -v || 0)
              hideEdit(page)
              return previewEdit(page)
            },
            { id: 'flip' }
          )
        )
      : null,
    make('p', { id: 'edit-said', class: editing.kindOfSaid, text: editing.said, role: 'status' }),
    inRow(
      button('preview', () => previewEdit(page), { id: 'edit-preview' }),
      button('save_edit', () => saveEdit(page, why.value), {
        id: 'save-edit',
        class: editing.kind === 'snake' ? '' : 'main',
        disabled: !!fixed
      }),
      button('cancel', () => dropEdit(page), { id: 'cancel-edit' })
    )
  ].flat(2)
}
