// Parameters of the case with a preview, what was done by hand, and a rebuild of the one case.

const anatomyOf = (page, path) => page.fields.find(f => path.startsWith(f + '.'))

function sayTrial(page) {
  const { trial } = page
  const at = $('tried')
  if (!at) return
  at.replaceChildren(
    ...(trial.tried.path
      ? [
          para(trial.tried.kind, trial.tried.text),
          trial.tried.rows.length
            ? table(
                [
                  ['', 0],
                  ['', 1]
                ],
                trial.tried.rows.map(([name, v]) =>
                  make('tr', {}, make('td', { text: label(name) }), make('td', { class: 'number', text: figure(v) }))
                )
              )
            : null,
          inRow(button('no_preview', () => forgetTrial(page), { id: 'no-preview' }))
        ].filter(x => x)
      : [])
  )
}

function forgetTrial(page) {
  const { trial } = page
  ++trial.number
  trial.tried = { path: '', text: '', kind: 'faint', rows: [] }
  page.tried = null
  page.redraw()
  sayTrial(page)
}

const previewValue = (page, path, value) => page.previewValues([{ path, value }], anatomyOf(page, path), `${path} = ${value}`)

async function tryWish(page, wish, told) {
  const { trial } = page
  const mine = ++trial.number
  await tell('try', { case: page.token, ...wish })
  for (;;) {
    const now = await askJson('tried', { case: page.token })
    if (mine !== trial.number || desk.page !== page) return null
    if (!now.running) return now
    told(`${now.doing} ${now.fraction ? digits(now.fraction * 100, 0) + ' %' : ''}`)
    await new Promise(done => setTimeout(done, 200))
  }
}

function findValue(page, text) {
  const { trial } = page
  trial.find = text
  page.show_('values')
}

async function previewValues(page, values, anatomy, name) {
  const { trial } = page
  const path = name
  page.tried = null
  trial.tried = { path, text: t('previewing'), kind: 'faint', rows: [] }
  sayTrial(page)
  let now
  try {
    now = await page.tryIt({ values, anatomy }, what => {
      trial.tried.text = `${t('previewing')}: ${what}`
      sayTrial(page)
    })
  } catch (e) {
    trial.tried = { path, text: e.message, kind: 'bad', rows: [] }
    return sayTrial(page)
  }
  if (!now) return
  // What the value changes is the volume; the stage's own figures stand below.
  const figures = [
    ...(now.volume_ml
      ? [
          [t('volume_now'), now.volume_ml.now],
          [t('volume_then'), now.volume_ml.then]
        ]
      : []),
    ...(now.reports.length
      ? Object.entries(now.reports[0].figures)
          .filter(([, v]) => typeof v === 'number')
          .slice(0, 8)
      : [])
  ]
  trial.tried = now.fault
    ? { path, text: now.fault, kind: 'bad', rows: [] }
    : { path, text: `${name}: ${t('preview_line')}`, kind: 'good', rows: figures }
  page.volume.forget('~tried')
  page.tried = now.has_field ? anatomy : null
  desk.stats.tried = (desk.stats.tried || 0) + 1
  page.redraw()
  sayTrial(page)
}

function drawTrial(page, p, c) {
  if (!page.tried) return
  const line = page.volume.outline('~tried', p.n, page.at[p.n])
  if (line.then)
    return line.then(page.redraw, () => {
      page.tried = null
    })
  page.strokeOutline(c, p, line, '#ffffff', [5, 4])
}

function sceneChoice(page, fits) {
  const all = (page.info.now.scenes || []).filter(s => s.chosen || fits(s)),
    own = all.find(s => s.chosen)
  if (!all.some(s => !s.chosen)) return null
  const about = make('p', { class: 'faint' }),
    choice = make(
      'select',
      { 'data-scene': '', change: () => tellAbout() },
      all.map(s => make('option', { value: s.file, text: s.file.replace(/^.*\//, '') }))
    )
  const tellAbout = () => {
    about.textContent = (all.find(s => s.file === choice.value) || { about: '' }).about
  }
  choice.value = (all.find(s => s.chosen && fits(s)) || all.find(fits) || own).file
  const set = button(
    'set',
    async () => {
      if (own && choice.value === own.file) return hint(t('same_value'))
      await page.change('scene', { scene: own.file }, { scene: choice.value })
    },
    { 'data-set-scene': '', disabled: !!page.info.fixed }
  )
  tellAbout()
  return [inRow(field('scene', choice), set), about]
}

// A parameter: its value, where that comes from, and what can be done with it.
function valueLine(page, v) {
  const { trial } = page,
    fixed = !!page.info.fixed
  const by = v.source === 'set',
    is_place = /^\[?\s*-?[\d.e+]+(\s*,\s*-?[\d.e+]+){2}\s*\]?$/.test(v.value) && /(_mm|seed|point|centre)/.test(v.path)
  const value = make('input', { value: v.value, size: 12, 'data-value': v.path, 'aria-label': v.path, disabled: fixed })
  const save = doing(async () => {
    clearTimeout(trial.later)
    if (value.value.trim() === v.value) return hint(t('same_value'))
    await page.change('value', { path: v.path, value: by ? v.value : null }, { path: v.path, value: value.value.trim() })
    forgetTrial(page)
  })
  const look = () => {
    if (value.value.trim()) doing(() => previewValue(page, v.path, value.value.trim()))()
  }
  value.addEventListener('keydown', e => {
    if (e.key === 'Enter') save()
  })
  value.addEventListener('input', () => {
    clearTimeout(trial.later)
    if (trial.live && anatomyOf(page, v.path)) trial.later = setTimeout(look, 600)
  })
  return make(
    'tr',
    {},
    make('td', { class: 'path' }, nameInGroup(v.path), make('br'), faint(`${t('source')} ${v.source}`)),
    make(
      'td',
      {},
      value,
      inRow(
        make('button', { text: t('set'), disabled: fixed, click: save }),
        anatomyOf(page, v.path) ? make('button', { text: t('preview'), 'data-preview': v.path, click: look }) : null,
        is_place && page.volume
          ? make('button', {
              text: t('at_cross'),
              disabled: fixed,
              click: () => {
                value.value = `[${page.volume
                  .toWorld(page.at)
                  .map(x => Math.round(x * 100) / 100)
                  .join(', ')}]`
                look()
              }
            })
          : null,
        by
          ? make('button', {
              text: t('unset'),
              disabled: fixed,
              click: doing(() => page.change('value', { path: v.path, value: v.value }, { path: v.path, value: null }))
            })
          : null
      )
    ),
    make('td', { class: 'faint', text: v.about })
  )
}

// A stage of an anatomy, such as skull.decimate, with all of its parameters; their lines are made when it is opened.
const groupOf = path => path.slice(0, Math.max(0, path.lastIndexOf('.')))
const nameInGroup = path => path.slice(path.lastIndexOf('.') + 1)

function valueGroup(page, group, values, open) {
  const title = `${label(group || nameInGroup(values[0].path))} (${values.length})`,
    box = make('details', { 'data-group': group, open }, make('summary', { text: title }))
  const fill = () => {
    if (box.open && box.children.length === 1)
      box.append(
        table(
          [
            [t('value_name'), 0],
            [t('value'), 0],
            [t('about'), 0]
          ],
          values.map(v => valueLine(page, v))
        )
      )
  }
  box.addEventListener('toggle', () => {
    page.trial.open[box.open ? 'add' : 'delete'](group)
    fill()
  })
  fill()
  return box
}

function valueControls(page) {
  const { trial } = page
  const now = page.info && page.info.now
  if (!now) return [para('warn', t('no_config'))]
  const rows = make('div')
  const list = () => {
    const parts = trial.find
        .toLowerCase()
        .split(/\s+/)
        .filter(x => x),
      fits = text => parts.every(p => text.toLowerCase().includes(p)),
      groups = new Map()
    for (const v of now.values)
      if (fits(`${v.path} ${v.about}`)) {
        const group = groupOf(v.path)
        groups.set(group, [...(groups.get(group) || []), v])
      }
    rows.replaceChildren(
      ...[...groups].map(([group, values], i) =>
        valueGroup(page, group, values, parts.length ? i < 8 : trial.open.has(group))
      )
    )
  }
  list()
  setTimeout(() => sayTrial(page), 0)
  return [
    page.info.fixed ? para('warn', page.info.fixed) : page.info.shared ? para('faint', `${t('own')} ${page.info.config}`) : null,
    page.sceneChoice(() => true),
    make('input', {
      type: 'search',
      class: 'wide',
      id: 'find-value',
      placeholder: t('find_value'),
      'aria-label': t('find_value'),
      value: trial.find,
      input: e => {
        trial.find = e.target.value
        list()
      }
    }),
    inRow(
      tick(t('live'), {
        id: 'live',
        checked: trial.live,
        change: e => {
          trial.live = e.target.checked
        }
      })
    ),
    make('div', { id: 'tried' }),
    rows
  ]
}

function historyControls(page) {
  const journal = (page.info && page.info.journal) || []
  return [
    heading('history'),
    journal.length
      ? table(
          [
            [t('when'), 0],
            [t('what'), 0]
          ],
          [...journal]
            .reverse()
            .map(e =>
              make(
                'tr',
                {},
                make('td', {}, e.when.replace('T', ' ').replace('Z', ' UTC'), make('br'), faint(`${t('by')} ${e.by}`)),
                make('td', {}, e.what, e.why ? [make('br'), faint(e.why)] : null)
              )
            )
        )
      : para('faint', t('empty_history')),
    page.info && page.info.yaml
      ? [
          heading('yaml'),
          para('faint', page.info.shared ? `${t('own')} ${page.info.config}` : page.info.config),
          make('pre', { id: 'yaml', class: 'file', text: page.info.yaml })
        ]
      : null
  ].flat()
}

function valuesPanel(page) {
  const tried = { path: '', text: '', kind: 'faint', rows: [] }
  page.trial = { find: '', open: new Set(), live: true, tried, later: 0, number: 0 }
  // The run's own computation with that value, up to the field of the anatomy; nothing is saved.
  page.tryIt = (wish, told) => tryWish(page, wish, told)
  page.findValue = text => findValue(page, text)
  page.previewValues = (values, anatomy, name) => previewValues(page, values, anatomy, name)
  page.overlays.push((p, c) => drawTrial(page, p, c))
  // The scene for which the case is made: what is shown and felt of it, and what is cut.
  page.sceneChoice = fits => sceneChoice(page, fits)
  page.addPanel('values', () => valueControls(page))
  page.addPanel('history', () => historyControls(page))
}
