// A rebuild of the one case, and what it changed: in figures, and drawn on the slices.
const ENDS = { 0: 'ended_well', 75: 'ended_busy', 80: 'ended_quality', 130: 'ended_stopped' }
const endOf = s =>
  s.code === 0
    ? `${t('done_in')} ${digits(s.seconds, 1)} s`
    : s.code === 130
      ? t('ended_stopped')
      : `${t(ENDS[s.code] || 'ended_fault')} (${s.code})`

const progressOf = job => job.stage + (job.fraction < 0 ? '' : ` ${digits(100 * job.fraction, 0)} %`)

const caseOfPage = page => desk.cases.find(c => c.case === page.token) || {}
const volumesNow = page => Object.fromEntries((caseOfPage(page).anatomies || []).map(a => [a.name, a]))

async function watchRerun(page) {
  const { rerun } = page
  clearTimeout(rerun.timer)
  if (desk.page !== page) return
  const s = await askJson('status')
  const stage = s.at_work.map(j => ` · ${j.case} ${progressOf(j)}`).join('')
  $('busy').textContent = s.running ? `${s.stopping ? t('stopping') : t('working')} ${digits(s.seconds, 0)} s${stage}` : ''
  rerun.log = s.lines.join('\n')
  rerun.ended = s.ever && !s.running ? s : null
  if ($('rerun-log')) $('rerun-log').textContent = rerun.log
  if (s.running)
    return (rerun.timer = setTimeout(
      doing(() => watchRerun(page)),
      400
    ))
  await loadLibrary()
  page.showSolid()
  await page.reloadInfo()
  await page.opening(true)
  $('busy').textContent = ''
  desk.stats.rebuilt = (desk.stats.rebuilt || 0) + 1
  if (page.tab === 'build') page.show_('build')
  else if (rerun.ended && rerun.ended.code && rerun.ended.code !== 130)
    problem(`${endOf(rerun.ended)}: ${caseOfPage(page).last_reason || ''}`)
}

async function runCase(page) {
  const { rerun } = page
  const { drawn } = rerun
  rerun.before = volumesNow(page)
  rerun.difference = null
  drawn.clear()
  await tell('build', { only: [page.token] })
  watchRerun(page)
}

async function compareRuns(page) {
  const { rerun } = page
  const { drawn } = rerun
  rerun.comparing = true
  rerun.difference = null
  page.show_('build')
  try {
    rerun.difference = await askJson('compare', { case: page.token })
    drawn.clear()
    for (const a of rerun.difference.anatomies) if (!a.same_bytes && (!a.deviation || a.deviation.max_mm > 0.5)) drawn.add(a.name)
    page.volume && page.volume.forget('was ')
    page.volume && page.volume.forget('is ')
  } finally {
    rerun.comparing = false
    if (page.tab === 'build') page.show_('build')
    page.redraw()
  }
}

function changeRows(page) {
  const { rerun } = page
  const { drawn } = rerun
  const d = rerun.difference
  if (d.identical) return [para('good', t('identical'))]
  const rows = d.anatomies.map(a =>
    make(
      'tr',
      {},
      make(
        'td',
        {},
        make(
          'label',
          {},
          make('input', {
            type: 'checkbox',
            'data-drawn': a.name,
            checked: drawn.has(a.name),
            change: e => {
              e.target.checked ? drawn.add(a.name) : drawn.delete(a.name)
              page.redraw()
            }
          }),
          ' ',
          label(a.name)
        )
      ),
      ...(a.same_bytes
        ? [make('td', { class: 'faint', colSpan: 3, text: t('same') })]
        : a.deviation
          ? [a.deviation.max_mm, a.deviation.p99_mm]
              .map(v => make('td', { class: 'number', text: digits(v, 2) }))
              .concat(
                make('td', {
                  class: 'number',
                  text: a.volume_ml.change === null ? '' : signed(a.volume_ml.change)
                })
              )
          : [make('td', { class: 'faint', colSpan: 3, text: a.not_measured || a.in })])
    )
  )
  const moved = d.points
    .filter(p => p.moved_mm === null || p.moved_mm > 0)
    .map(p =>
      make(
        'tr',
        { class: 'jump', tabIndex: 0, click: () => page.goWorld(p.position_mm.new || p.position_mm.old) },
        make('td', {}, label(p.name), faint(` (${t(p.kind)})`)),
        make('td', { class: 'number', text: p.moved_mm === null ? t(p.in) : digits(p.moved_mm, 2) })
      )
    )
  const values = d.parameters.map(v => make('p', {}, v.name, make('br'), faint(`${valueText(v.old)} → ${valueText(v.new)}`)))
  return [
    make(
      'p',
      { class: 'faint' },
      make('span', { class: 'was', text: t('was_line') }),
      ' ',
      make('span', { class: 'is', text: t('is_line') })
    ),
    table(
      [
        [t('anatomy'), 0],
        [t('largest_mm'), 1],
        ['p99 mm', 1],
        [t('change_ml'), 1]
      ],
      rows
    ),
    moved.length
      ? [
          heading('moved'),
          table(
            [
              [t('name'), 0],
              [t('mm'), 1]
            ],
            moved
          )
        ]
      : null,
    values.length ? [heading('values'), values] : null,
    d.warnings.map(w => para('warn', w)),
    make('details', {}, make('summary', { text: t('whole_text') }), make('pre', { id: 'difference', text: d.text }))
  ].flat(2)
}

const signed = v => (Math.abs(v) < 0.0005 ? '0' : (v > 0 ? '+' : '−') + digits(Math.abs(v), 3))
const valueText = v => (v === null || v === undefined ? '–' : Array.isArray(v) ? `[${v.join(', ')}]` : String(v))

function drawCompared(page, p, c) {
  const { drawn } = page.rerun
  if (page.tab !== 'build') return // elsewhere nothing would say what the lines are
  for (const name of drawn)
    for (const [which, colour, dash] of [
      ['is', '#4db1ff', []],
      ['was', '#ff9c3c', [5, 4]]
    ]) {
      const line = page.volume.cut(which, name, p.n, page.at[p.n])
      if (line.then) line.then(page.redraw, () => drawn.clear())
      else page.strokeOutline(c, p, line, colour, dash)
    }
}

function rerunControls(page) {
  const { rerun } = page
  const plan = desk.plan.get(page.token),
    reasons = (page.info && page.info.reasons) || [],
    now = volumesNow(page)
  const rows = rerun.before
    ? Object.keys({ ...rerun.before, ...now }).map(name => {
        const a = rerun.before[name],
          b = now[name],
          // A surface and a shape that is felt alone differ by how they are made: the comparison measures what is felt.
          alike = a && b && !a.triangles === !b.triangles
        return make(
          'tr',
          {},
          make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)),
          make('td', { class: 'number', text: a ? digits(a.volume_ml, 2) : '' }),
          make('td', { class: 'number', text: b ? digits(b.volume_ml, 2) : '' }),
          make('td', { class: 'number', text: alike ? signed(b.volume_ml - a.volume_ml) : '' })
        )
      })
    : []
  const faults = [
    caseOfPage(page).last_code && rerun.ended && rerun.ended.code ? caseOfPage(page).last_reason : '',
    plan && plan.fault
  ].filter(x => x)
  return [
    para('faint', t('rerun_text')),
    page.info && page.info.config ? null : para('warn', t('no_config')),
    inRow(
      button('rerun', () => runCase(page), { id: 'rerun', class: 'main', disabled: !desk.config }),
      button('stop', () => tell('stop', {}), { id: 'stop-rerun' })
    ),
    reasons.length
      ? [
          make(
            'details',
            { open: reasons.length < 8 },
            make('summary', { class: 'warn', text: `${t('why_stale')} (${reasons.length})` }),
            make(
              'ul',
              {},
              reasons.map(r => make('li', { text: r }))
            )
          )
        ]
      : plan && !plan.fault
        ? para('good', t('fresh_text'))
        : null,
    faults.map(f => refusalLine(page, f)),
    rerun.ended ? make('p', { id: 'ended', class: rerun.ended.code ? 'warn' : 'good', text: endOf(rerun.ended) }) : null,
    rerun.log
      ? make('pre', { id: 'rerun-log', class: 'file', text: rerun.log })
      : make('pre', { id: 'rerun-log', class: 'faint' }),
    rows.length
      ? [
          heading('change'),
          table(
            [
              [t('volume'), 0],
              [t('before'), 1],
              [t('after'), 1],
              [t('change'), 1]
            ],
            rows
          ),
          para('faint', t('volume_of'))
        ]
      : null,
    heading('compare'),
    inRow(
      button('compare_it', () => compareRuns(page), { id: 'compare' }),
      rerun.comparing ? faint(t('comparing')) : null
    ),
    rerun.difference ? make('div', { id: 'changes' }, changeRows(page)) : null,
    heading('log'),
    inRow(
      button('log_it', async () => {
        rerun.log = (await askJson('log', { case: page.token })).log || t('no_log')
        page.show_('build')
      })
    )
  ].flat()
}

function rerunPanel(page) {
  const rerun = (page.rerun = { before: null, timer: 0, log: '', ended: null, difference: null, comparing: false })
  const drawn = (page.compared = new Set())
  rerun.drawn = drawn
  // A build that was begun elsewhere is shown here too.
  askJson('status').then(
    s => {
      if (s.running) watchRerun(page)
    },
    () => {}
  )
  // What it was in orange, dashed; what it is in blue: colours that all eyes tell apart.
  page.overlays.push((p, c) => drawCompared(page, p, c))
  page.addPanel('build', () => rerunControls(page))
}
