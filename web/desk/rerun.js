// Part 11: a rebuild of the one case, and what it changed: in figures, and drawn on the slices.
const ENDS = { 0: 'ended_well', 75: 'ended_busy', 80: 'ended_quality', 130: 'ended_stopped' }
const endOf = s => s.code === 0 ? `${t('done_in')} ${digits(s.seconds, 1)} s` : s.code === 130 ? t('ended_stopped') : `${t(ENDS[s.code] || 'ended_fault')} (${s.code})`

function rerunPanel(page) {
  let before = null, timer = 0, log = '', ended = null, difference = null, comparing = false
  const drawn = page.compared = new Set()
  const mine = () => desk.cases.find(c => c.case === page.token) || {}
  const volumes = () => Object.fromEntries((mine().anatomies || []).map(a => [a.name, a]))
  const watch = async () => {
    clearTimeout(timer)
    if (desk.page !== page) return
    const s = await askJson('status')
    const stage = s.at_work.map(j => ` · ${j.case} ${j.stage}`).join('')
    $('busy').textContent = s.running ? `${s.stopping ? t('stopping') : t('working')} ${digits(s.seconds, 0)} s${stage}` : ''
    log = s.lines.join('\n')
    ended = s.ever && !s.running ? s : null
    if ($('rerun-log')) $('rerun-log').textContent = log
    if (s.running) return timer = setTimeout(doing(watch), 400)
    await loadLibrary()
    page.showSolid()
    await page.reloadInfo()
    await page.opening(true)
    $('busy').textContent = ''
    desk.stats.rebuilt = (desk.stats.rebuilt || 0) + 1
    if (page.tab === 'build') page.show_('build')
    else if (ended && ended.code && ended.code !== 130) problem(`${endOf(ended)}: ${mine().last_reason || ''}`)
  }
  // A build that was begun elsewhere is shown here too.
  askJson('status').then(s => { if (s.running) watch() }, () => {})
  const run = async () => {
    before = volumes(), difference = null, drawn.clear()
    await tell('build', { only: [page.token] })
    watch()
  }
  const compare = async () => {
    comparing = true, difference = null
    page.show_('build')
    try {
      difference = await askJson('compare', { case: page.token })
      drawn.clear()
      for (const a of difference.anatomies) if (!a.same_bytes && (!a.deviation || a.deviation.max_mm > .5)) drawn.add(a.name)
      page.volume && page.volume.forget('was '), page.volume && page.volume.forget('is ')
    } finally {
      comparing = false
      if (page.tab === 'build') page.show_('build')
      page.redraw()
    }
  }
  // What it was in orange, dashed; what it is in blue: colours that all eyes tell apart.
  page.overlays.push((p, c) => {
    if (page.tab !== 'build') return  // elsewhere nothing would say what the lines are
    for (const name of drawn) for (const [which, colour, dash] of [['is', '#4db1ff', []], ['was', '#ff9c3c', [5, 4]]]) {
      const line = page.volume.cut(which, name, p.n, page.at[p.n])
      if (line.then) line.then(page.redraw, () => drawn.clear())
      else page.strokeOutline(c, p, line, colour, dash)
    }
  })
  const changes = () => {
    const d = difference
    if (d.identical) return [make('p', { class: 'good', text: t('identical') })]
    const rows = d.anatomies.map(a => make('tr', {}, make('td', {}, make('label', {}, make('input', { type: 'checkbox', 'data-drawn': a.name, checked: drawn.has(a.name), change: e => { e.target.checked ? drawn.add(a.name) : drawn.delete(a.name), page.redraw() } }), ' ', label(a.name))),
      ...a.same_bytes ? [make('td', { class: 'faint', colSpan: 3, text: t('same') })] : a.deviation ? [a.deviation.max_mm, a.deviation.p99_mm].map(v => make('td', { class: 'number', text: digits(v, 2) })).concat(make('td', { class: 'number', text: a.volume_ml.old === null || a.volume_ml.new === null ? '' : signed(a.volume_ml.new - a.volume_ml.old) })) : [make('td', { class: 'faint', colSpan: 3, text: a.not_measured || a.in })]))
    const moved = d.points.filter(p => p.moved_mm === null || p.moved_mm > 0).map(p => make('tr', { class: 'jump', tabIndex: 0, click: () => page.goWorld(p.position_mm.new || p.position_mm.old) }, make('td', {}, label(p.name), make('span', { class: 'faint', text: ` (${t(p.kind)})` })), make('td', { class: 'number', text: p.moved_mm === null ? t(p.in) : digits(p.moved_mm, 2) })))
    const values = d.parameters.map(v => make('p', {}, v.name, make('br'), make('span', { class: 'faint', text: `${text(v.old)} → ${text(v.new)}` })))
    return [make('p', { class: 'faint' }, make('span', { class: 'was', text: t('was_line') }), ' ', make('span', { class: 'is', text: t('is_line') })),
      table([[t('anatomy'), 0], [t('largest_mm'), 1], ['p99 mm', 1], [t('change_ml'), 1]], rows),
      moved.length ? [make('h2', { text: t('moved') }), table([[t('name'), 0], [t('mm'), 1]], moved)] : null,
      values.length ? [make('h2', { text: t('values') }), values] : null,
      d.warnings.map(w => make('p', { class: 'warn', text: w })),
      make('details', {}, make('summary', { text: t('whole_text') }), make('pre', { id: 'difference', text: d.text }))].flat(2)
  }
  const signed = v => Math.abs(v) < .0005 ? '0' : (v > 0 ? '+' : '−') + digits(Math.abs(v), 3)
  const text = v => v === null || v === undefined ? '–' : Array.isArray(v) ? `[${v.join(', ')}]` : String(v)
  page.addPanel('build', () => {
    const plan = desk.plan.get(page.token), reasons = page.info && page.info.reasons || [], now = volumes()
    const rows = before ? Object.keys({ ...before, ...now }).map(name => {
      const a = before[name], b = now[name]
      return make('tr', {}, make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)), make('td', { class: 'number', text: a ? digits(a.volume_ml, 2) : '' }), make('td', { class: 'number', text: b ? digits(b.volume_ml, 2) : '' }), make('td', { class: 'number', text: a && b ? signed(b.volume_ml - a.volume_ml) : '' }))
    }) : []
    const faults = [mine().last_code && ended && ended.code ? mine().last_reason : '', plan && plan.fault].filter(x => x)
    return [make('p', { class: 'faint', text: t('rerun_text') }), page.info && page.info.config ? null : make('p', { class: 'warn', text: t('no_config') }),
      make('div', { class: 'row' }, button('rerun', run, { id: 'rerun', class: 'main', disabled: !desk.config }), button('stop', () => tell('stop', {}), { id: 'stop-rerun' })),
      reasons.length ? [make('details', { open: reasons.length < 8 }, make('summary', { class: 'warn', text: `${t('why_stale')} (${reasons.length})` }), make('ul', {}, reasons.map(r => make('li', { text: r }))))] : plan && !plan.fault ? make('p', { class: 'good', text: t('fresh_text') }) : null,
      faults.map(f => refusalLine(page, f)),
      ended ? make('p', { id: 'ended', class: ended.code ? 'warn' : 'good', text: endOf(ended) }) : null,
      log ? make('pre', { id: 'rerun-log', class: 'file', text: log }) : make('pre', { id: 'rerun-log', class: 'faint' }),
      rows.length ? [make('h2', { text: t('change') }), table([[t('volume'), 0], [t('before'), 1], [t('after'), 1], [t('change'), 1]], rows), make('p', { class: 'faint', text: t('volume_of') })] : null,
      make('h2', { text: t('compare') }),
      make('div', { class: 'row' }, button('compare_it', compare, { id: 'compare' }), comparing ? make('span', { class: 'faint', text: t('comparing') }) : null),
      difference ? make('div', { id: 'changes' }, changes()) : null,
      make('h2', { text: t('log') }), make('div', { class: 'row' }, button('log_it', async () => { log = (await askJson('log', { case: page.token })).log || t('no_log'), page.show_('build') }))].flat()
  })
}
