// The panel of the brush, and what is painted as it lies over a slice.

const paintChoices = page =>
  page.info && page.info.now ? page.info.now.anatomies.filter(a => a.field && page.fields.includes(a.name)) : []

function rangeOf(page, name) {
  const said = end =>
    page.info && page.info.now
      ? page.info.now.values
          .filter(v => v.path.startsWith(name + '.') && v.path.endsWith('.' + end))
          .map(v => +v.value)
          .filter(isFinite)
          .pop()
      : undefined
  const low = said('lower_hu'),
    high = said('upper_hu')
  return low === undefined && high === undefined ? null : [low === undefined ? -1024 : low, high === undefined ? 3071 : high]
}

function usualRange(page) {
  const { paint } = page
  const { brush } = paint
  const usual = brush.own ? null : page.rangeOf(paint.anatomy)
  if (usual) [brush.low, brush.high] = usual
}

function tellCount(page) {
  const { paint } = page
  desk.stats.painted = [...paint.count]
  const ml = page.volume ? (page.volume.spacing[0] * page.volume.spacing[1] * page.volume.spacing[2]) / 1000 : 0
  if (paint.counted)
    paint.counted.textContent =
      paint.count[0] + paint.count[1]
        ? [
            [paint.count[0], t('to_add')],
            [paint.count[1], t('to_remove')]
          ]
            .filter(c => c[0])
            .map(([n, what]) => `${digits(n * ml, 2)} ml ${what} (${n} ${t('voxels')})`)
            .join(', ')
        : t('nothing')
}

function drawPaint(page, p, c) {
  const { paint } = page
  const { brush, box } = paint
  const { volume } = page
  if (paint.bytes && paint.count[0] + paint.count[1] && page.at[p.n] >= box.low[p.n] && page.at[p.n] <= box.high[p.n]) {
    const strides = [1, volume.size[0], volume.size[0] * volume.size[1]],
      base = page.at[p.n] * strides[p.n],
      su = strides[p.u],
      sv = strides[p.v]
    const u0 = Math.max(0, box.low[p.u]),
      u1 = box.high[p.u],
      v0 = Math.max(0, box.low[p.v]),
      v1 = box.high[p.v],
      image = new ImageData(u1 - u0 + 1, v1 - v0 + 1),
      px = new Uint32Array(image.data.buffer)
    const colours = [0, rgba(0, 140, 255, 120), rgba(255, 120, 0, 130)],
      nu = u1 - u0 + 1,
      nv = v1 - v0 + 1
    for (let y = 0, n = 0; y < nv; ++y)
      for (let x = 0; x < nu; ++x, ++n)
        px[n] = colours[paint.bytes[base + (p.flipU ? u1 - x : u0 + x) * su + (p.flipV ? v1 - y : v0 + y) * sv]]
    p.paint = p.paint || document.createElement('canvas')
    p.paint.width = nu
    p.paint.height = nv
    p.paint.getContext('2d').putImageData(image, 0, 0)
    const smooth = c.imageSmoothingEnabled,
      x0 = Math.min(p.X(u0), p.X(u1)) - (volume.spacing[p.u] * p.k) / 2,
      y0 = Math.min(p.Y(v0), p.Y(v1)) - (volume.spacing[p.v] * p.k) / 2
    c.imageSmoothingEnabled = false
    c.drawImage(p.paint, x0, y0, nu * volume.spacing[p.u] * p.k, nv * volume.spacing[p.v] * p.k)
    c.imageSmoothingEnabled = smooth
  }
  if (page.tools[page.tool].hover && page.pointer && page.pointer.plane === p) {
    c.strokeStyle = page.tool === 'add' ? '#4db1ff' : page.tool === 'remove' ? '#ff9c3c' : '#ffffff'
    c.lineWidth = p.r
    c.beginPath()
    c.arc(p.X(page.pointer.at[p.u]), p.Y(page.pointer.at[p.v]), Math.max(2, brush.radius * p.k), 0, 7)
    c.stroke()
  }
}

// Saves what is painted as a patch of the case.
async function savePatch(page, why) {
  const { paint } = page
  needOpen(page)
  const body = paint.bytes && packPaint(page)
  if (!body) throw new Refused(t('nothing'))
  const said = await tellBytes('patch', { case: page.token, anatomy: paint.anatomy, by: who(), why, base: page.info.base }, body)
  clearPaint(page)
  hint(said.done + (said.was_so_ml > 0 ? `; ${digits(said.was_so_ml, 2)} ml ${t('was_so')}` : ''))
  await page.reloadInfo()
  page.refresh()
}

function patchRows(page) {
  const patches = ((page.info && page.info.journal) || []).filter(e => e.file || e.edit)
  return [
    heading('patches'),
    patches.length ? para('faint', t('patches_how')) : null,
    patches.length
      ? patches.map(e =>
          inRow(
            tick(t('on'), {
              'data-patch': String(e.id),
              checked: e.on,
              change: doing(ev => page.save('switch', { id: e.id, on: ev.target.checked }))
            }),
            make('span', { text: e.what }),
            faint(`${e.by} ${e.when}${e.why ? ': ' + e.why : ''}`)
          )
        )
      : para('faint', t('nothing'))
  ]
}

function paintControls(page) {
  const { paint } = page
  const { brush, edits } = paint
  const list = paintChoices(page)
  if (!paint.anatomy && list.length) paint.anatomy = (list.find(a => a.shown) || list[0]).name
  usualRange(page)
  const select = make(
    'select',
    {
      id: 'anatomy',
      change: e => {
        paint.anatomy = e.target.value
        usualRange(page)
        $('low').value = brush.low
        $('high').value = brush.high
        range()
        page.redraw()
      }
    },
    list.map(a => make('option', { value: a.name, text: label(a.name) }))
  )
  select.value = paint.anatomy
  const number = (key, name, given) =>
    make('input', {
      type: 'number',
      value: brush[key],
      'aria-label': t(name),
      ...given,
      change: e => {
        if (isFinite(e.target.valueAsNumber)) brush[key] = e.target.valueAsNumber
        if (key === 'low' || key === 'high') brush.own = true
        range()
        page.redraw()
      }
    })
  const showing = make('input', {
    type: 'checkbox',
    id: 'show-range',
    checked: !!page.range,
    change: () => {
      range()
      page.redraw()
    }
  })
  const range = () => {
    page.range = showing.checked ? [brush.low, brush.high] : null
  }
  const plane = make(
    'select',
    {
      id: 'plane',
      change: e => {
        brush.plane = e.target.value
      }
    },
    PLANES.map(p => make('option', { value: p.id, text: t(p.id) }))
  )
  plane.value = brush.plane
  paint.counted = make('span', { id: 'painted' })
  tellCount(page)
  const why = make('textarea', { id: 'why', maxLength: 400 }),
    fixed = !page.info || page.info.fixed || !page.info.now
  return [
    fixed && page.info && page.info.fixed ? para('warn', page.info.fixed) : null,
    heading('anatomy'),
    inRow(list.length ? select : faint(t('no_field'))),
    heading('brush'),
    inRow(
      field('radius_', number('radius', 'radius_', { id: 'radius', min: 0.3, max: 60, step: 0.5 }), faint(t('mm'))),
      tick(t('ball'), {
        id: 'ball',
        checked: brush.ball,
        change: e => {
          brush.ball = e.target.checked
        }
      })
    ),
    inRow(
      tick(t('within'), {
        id: 'within',
        checked: brush.within,
        change: e => {
          brush.within = e.target.checked
        }
      }),
      number('low', 'hu_low', { id: 'low' }),
      make('span', { text: t('to') }),
      number('high', 'hu_high', { id: 'high' }),
      faint('HU')
    ),
    inRow(make('label', {}, showing, make('span', { text: t('show_range') }))),
    inRow(field('grow_within', number('grow', 'grow_within', { id: 'grow', min: 1, max: 200 }), faint(t('mm')))),
    para('faint', t('grow_how')),
    inRow(
      field('between_', plane),
      button('between', () => fillBetween(page), { id: 'between' })
    ),
    heading('painted'),
    inRow(paint.counted),
    field('why', why),
    inRow(
      button('save_patch', () => savePatch(page, why.value), { id: 'save-patch', class: 'main', disabled: !!fixed }),
      button('throw_', () => throwAway(page), { id: 'throw' })
    ),
    edits.panel(why, fixed),
    patchRows(page)
  ].flat(2)
}
