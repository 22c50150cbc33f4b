// The panel for looking: window, outlines, measures, profile, warnings with their places, figures.

// Where the cross-hair lies, and the window, as they are now.
function tellWhere(page, level, width, where) {
  level.value = page.window.level
  width.value = page.window.width
  if (!page.volume) return
  const w = page.volume.toWorld(page.at),
    p = page.volume.planes[0],
    data = page.volume.has(p.n, page.at[p.n])
  const [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
  where.textContent =
    `${[0, 1, 2].map(a => sided(w[a], a)).join(', ')} mm · ${t('voxel')} ${page.at.join(', ')}` +
    (data ? ` · ${data[page.at[hi] * page.volume.size[lo] + page.at[lo]]} HU` : '')
}

function outlineRows(page) {
  return page.fields.map(name =>
    inRow(
      make(
        'label',
        {},
        make('input', {
          type: 'checkbox',
          'data-outline': name,
          checked: !!page.outlines.get(name),
          change: e => {
            page.outlines.set(name, e.target.checked)
            page.redraw()
          }
        }),
        swatch(page.colourOf(name)),
        make('span', { text: label(name) })
      )
    )
  )
}

// What a step on the way to an anatomy gives, drawn as a dashed line; computed where it is in no cache.
function stepChoice(page) {
  const steps = page.info && page.info.now ? page.info.now.steps : []
  if (!steps.length || !page.volume) return null
  const told = make('span', {
    class: 'faint',
    id: 'step-said',
    role: 'status',
    text: page.stepShown ? t('preview_line_step') : ''
  })
  const select = make(
    'select',
    {
      id: 'step-of',
      change: doing(async e => {
        const step = (page.stepShown = e.target.value)
        page.tried = null
        page.redraw()
        if (!step) return (told.textContent = '')
        const now = await page.tryIt({ step }, what => {
          told.textContent = what
        })
        if (!now || page.stepShown !== step) return
        if (now.fault) throw ((page.stepShown = ''), new Refused(now.fault))
        page.volume.forget('~tried')
        page.tried = step
        told.textContent = t('preview_line_step')
        page.redraw()
      })
    },
    make('option', { value: '', text: '–' }),
    steps.map(s => make('option', { value: s, text: label(s) }))
  )
  select.value = page.stepShown || ''
  return inRow(field('step_of', select), told)
}

function lookPanel(page) {
  const presets = [
    ['soft', 40, 400],
    ['brain', 40, 80],
    ['bone', 500, 2000]
  ]
  page.addPanel('look', () => {
    const level = make('input', {
      type: 'number',
      id: 'level',
      step: 10,
      change: e => page.setWindow(+e.target.value, page.window.width)
    })
    const width = make('input', {
      type: 'number',
      id: 'width',
      step: 10,
      min: 1,
      change: e => page.setWindow(page.window.level, +e.target.value)
    })
    const where = make('p', { id: 'where', class: 'faint' })
    page.told = () => tellWhere(page, level, width, where)
    page.told()
    const outlines = outlineRows(page)
    const mine = desk.cases.find(c => c.case === page.token),
      refusal = mine && mine.last_code ? `${mine.last_code}: ${mine.last_reason}` : ''
    const info = page.info || {},
      { verdict, ...others } = info.built ? info.built.figures : {},
      figures = Object.entries(others)
    return [
      heading('at'),
      where,
      heading('window_'),
      inRow(
        presets.map(([key, l, w]) => make('button', { text: t(key), click: () => page.setWindow(l, w) })),
        field('level', level),
        field('width', width),
        button('reset', () => {
          if (page.volume)
            for (const p of page.volume.planes) {
              p.zoom = 1
              p.panX = p.panY = 0
            }
          page.redraw()
        })
      ),
      inRow(
        field(
          'right_drag',
          make(
            'select',
            { id: 'right-drag', change: e => keep('right-drag', e.target.value) },
            ['zoom', 'window'].map(how => make('option', { value: how, text: t('drag_' + how), selected: how === rightDrag() }))
          )
        )
      ),
      heading('outlines'),
      outlines.length ? outlines : para('faint', t('no_field')),
      info.built
        ? inRow(
            tick(t('as_built'), {
              id: 'as-built',
              checked: !!page.asBuilt,
              change: e => {
                page.asBuilt = e.target.checked
                page.redraw()
              }
            })
          )
        : null,
      stepChoice(page),
      inRow(
        tick(t('marks'), {
          checked: page.marks,
          change: e => {
            page.marks = e.target.checked
            page.redraw()
          }
        })
      ),
      page.measures.length
        ? [
            heading('measures'),
            inRow(
              page.measures.map(m => make('span', { class: 'tag', text: `${t(m.plane)} ${digits(m.mm, 1)} mm` })),
              button('clear', () => {
                page.measures = []
                page.show_('look')
                page.redraw()
              })
            )
          ]
        : null,
      heading('profile'),
      page.line ? chartOf(page) : para('faint', t('no_profile')),
      ...(verdict ? [heading('verdict'), para('', verdict)] : []),
      heading('warnings'),
      !info.built
        ? [para('warn', t('not_built')), refusal ? refusalLine(page, refusal) : null].flat()
        : info.warnings.length
          ? info.warnings.map(w => warningLine(page, w))
          : para('good', t('no_warnings')),
      info.fault ? para('bad', info.fault) : null,
      figures.length
        ? [
            heading('figures'),
            table(
              [
                ['', 0],
                ['', 1]
              ],
              figures.map(([name, v]) =>
                make(
                  'tr',
                  {},
                  make('td', { text: label(name) }),
                  make('td', { class: typeof v === 'number' ? 'number' : '', text: figure(v) })
                )
              )
            )
          ]
        : null
    ].flat()
  })
}
const swatch = colour => {
  const s = make('span', { class: 'swatch' })
  s.style.background = colour
  return s
}

// Why a case was refused, with the tools that reach what it names: a burr hole, and values that the line has in backquotes.
function refusalLine(page, text) {
  const now = page.info && page.info.now,
    links = []
  const link = (words, go) =>
    links.push(
      ' ',
      make('a', {
        href: '#',
        text: words,
        click: doing(async e => {
          e.preventDefault()
          go()
        })
      })
    )
  const hole = text.match(/burr_hole_?(\d*)/)
  if (now && now.cuts_holes && hole) link(t('to_hole'), () => page.changeHole(hole[1] ? hole[1] - 1 : 0))
  for (const name of new Set([...text.matchAll(/`([a-z_]+)`/g)].map(m => m[1]))) {
    const all = now ? now.values.filter(v => v.path.endsWith('.' + name)) : []
    // Those of the stage that the line names, else of its anatomy.
    const near = [v => v.path.slice(0, -name.length - 1), v => v.path.split('.')[0]]
      .map(of => all.filter(v => text.includes(of(v))))
      .find(found => found.length)
    if (near)
      link(`${t('to_value')} ${name}`, () =>
        page.findValue(near.length === 1 ? near[0].path : `${near[0].path.split('.')[0]} ${name}`)
      )
  }
  return make('p', { class: 'bad' }, text, links)
}

// A warning leads to its place: the point that it names in mm, else the landmark or hole that it names.
function warningLine(page, text) {
  const mm = text.match(/\(?\s*(-?\d+(?:\.\d+)?),\s*(-?\d+(?:\.\d+)?),\s*(-?\d+(?:\.\d+)?)\s*\)?\s*mm/),
    mark = page.allMarks().find(m => text.includes(m.name))
  const found = (page.info.built ? page.info.built.findings : []).find(f => text.includes(f.text))
  const at = mm ? mm.slice(1).map(Number) : found ? found.position_mm : mark && mark.position_mm
  // "doubtful ... 2 of dense_tissue": each leads to its own place.
  const several = /the report says where each is/.test(text)
    ? (page.info.built ? page.info.built.findings : []).filter(f => f.confidence < 0.5)
    : []
  const named = several.length ? null : page.fields.find(f => text.includes(f))
  const go = async () => {
    if (named) {
      page.outlines.set(named, true)
      page.redraw()
    }
    if (at) page.goWorld(at)
    else if (named) await goToField(page, named)
  }
  const link = (key, f) => [
    ' ',
    make('a', {
      href: '#',
      text: t(key),
      click: doing(async e => {
        e.preventDefault()
        await f()
      })
    })
  ]
  // What a run says of a line of the configuration, the desk has a tool for.
  const points = page
    .landmarkNames()
    .filter(name => text.includes(`landmarks: {${name}:`) || new RegExp(`(^|[ ,])${name}( and \\w+)* not found`).test(text))
  const said = points.length ? text.replace(/; look at it, or give it[^;]*landmarks: \{.*?\}, mm, LPS/, '') : text
  const tools = points.map(name => [
    ...link('place_it', () => {
      page.chooseLandmark(name)
      page.pick('landmark')
    }),
    points.length > 1 ? ` (${label(name)})` : ''
  ])
  const horn =
    !points.length &&
    /\b(horn|body) of the|ventricles' (volume|found)|frontal horn/.test(text) &&
    page.info.now &&
    page.info.now.anatomies.some(a => a.name === 'ventricles' && a.field)
  if (horn)
    tools.push(
      link('paint_it', () => {
        page.chooseAnatomy('ventricles')
        page.show_('paint')
      })
    )
  for (const f of several)
    tools.push([
      make('br'),
      make('a', {
        href: '#',
        text: f.text,
        click: doing(async e => {
          e.preventDefault()
          page.goWorld(f.position_mm)
        })
      })
    ])
  const end = text.match(/the scan ends (above|below)/)
  if (end && !at && !named && page.volume) {
    const p = page.volume.planes[0],
      up = page.volume.toWorld([0, 0, 0].map((v, k) => (k === p.n ? 1 : 0)))[2] > page.volume.toWorld([0, 0, 0])[2]
    tools.push(
      link('go_there', () => {
        const to = [...page.at]
        to[p.n] = (end[1] === 'above') === up ? page.volume.size[p.n] - 1 : 0
        page.go(to)
      })
    )
  }
  return make(
    'p',
    { class: 'warn' },
    at || named
      ? make('a', {
          href: '#',
          text: said,
          click: doing(async e => {
            e.preventDefault()
            await go()
          })
        })
      : said,
    tools.flat()
  )
}
// Looks at the slice in which most of an anatomy's outline is seen.
async function goToField(page, name) {
  const p = page.volume.planes[0],
    n = page.volume.size[p.n]
  let best = null
  for (let i = n >> 4; i < n; i += Math.max(1, n >> 4)) {
    const line = await page.volume.outline(name, p.n, i)
    if (line.length && (!best || line.length > best.line.length)) best = { line, i }
  }
  if (!best) return
  let a = 0,
    b = 0
  for (let k = 0; k < best.line.length; k += 2) {
    a += best.line[k]
    b += best.line[k + 1]
  }
  const to = [...page.at],
    [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]
  to[p.n] = best.i
  to[lo] = (2 * a) / best.line.length
  to[hi] = (2 * b) / best.line.length
  page.go(to)
}

// HU along the line, nearest voxel, drawn over its length in mm.
function chartOf(page) {
  const canvas = make('canvas', { class: 'chart', id: 'chart' }),
    m = page.line
  requestAnimationFrame(() => {
    const p = page.volume.planes.find(q => q.id === m.plane),
      data = page.volume.has(p.n, m.index)
    if (!data) return
    const r = Math.min(2, devicePixelRatio || 1),
      w = (canvas.width = (canvas.clientWidth * r) | 0),
      h = (canvas.height = (canvas.clientHeight * r) | 0),
      c = canvas.getContext('2d')
    const [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u],
      n = Math.max(2, Math.min(1000, Math.ceil((m.mm / Math.min(...page.volume.spacing)) * 2))),
      values = []
    for (let i = 0; i < n; ++i) {
      const at = [0, 1, 2].map(k => Math.round(m.from[k] + ((m.to[k] - m.from[k]) * i) / (n - 1)))
      values.push(page.volume.inside(at) ? data[at[hi] * page.volume.size[lo] + at[lo]] : -1024)
    }
    const low = Math.min(...values),
      high = Math.max(...values, low + 1),
      y = v => h - 20 * r - ((v - low) / (high - low)) * (h - 40 * r)
    c.strokeStyle = '#f0c45c'
    c.lineWidth = 1.5 * r
    c.beginPath()
    values.forEach((v, i) => c.lineTo(8 * r + (i / (n - 1)) * (w - 16 * r), y(v)))
    c.stroke()
    c.font = `${11 * r}px system-ui, sans-serif`
    for (const [text, left, base] of [
      [high + ' HU', 6 * r, 14 * r],
      [low + ' HU', 6 * r, h - 6 * r],
      [digits(m.mm, 1) + ' mm', w - 60 * r, h - 6 * r]
    ])
      page.inked(c, text, left, base, '#c5d4e3', r)
    canvas.dataset.values = values.length
  })
  return canvas
}
