// Part 9: parameters of the case, what was done by hand, and a rebuild of the one case.
function valuesPanel(page) {
  let find = ''
  page.addPanel('values', () => {
    const now = page.info && page.info.now
    if (!now) return [make('p', { class: 'warn', text: t('no_config') })]
    const rows = make('div'), fixed = !!page.info.fixed
    const list = () => {
      const parts = find.toLowerCase().split(/\s+/).filter(x => x), fit = now.values.filter(v => parts.every(p => v.path.toLowerCase().includes(p))).slice(0, 120)
      rows.replaceChildren(table([[t('values'), 0], [t('value'), 0], [t('source'), 0]], fit.map(v => {
        const value = make('input', { value: v.value, size: 12, 'data-value': v.path, disabled: fixed }), by = v.source === 'set'
        const save = doing(async () => { if (value.value.trim() !== v.value) await page.save('value', { path: v.path, value: value.value.trim() }) })
        value.addEventListener('keydown', e => { if (e.key === 'Enter') save() })
        return make('tr', {}, make('td', { text: v.path }), make('td', {}, value, make('button', { text: t('set'), disabled: fixed, click: save })), make('td', {}, make('span', { text: v.source }), by ? make('button', { text: t('unset'), disabled: fixed, click: doing(() => page.save('value', { path: v.path, value: null })) }) : null))
      })))
    }
    list()
    return [page.info.fixed ? make('p', { class: 'warn', text: page.info.fixed }) : page.info.shared ? make('p', { class: 'faint', text: `${t('own')} ${page.info.config}` }) : null,
      make('input', { type: 'search', class: 'wide', id: 'find-value', placeholder: t('find_value'), 'aria-label': t('find_value'), value: find, input: e => { find = e.target.value, list() } }), rows]
  })
  page.addPanel('history', () => {
    const journal = page.info && page.info.journal || []
    return [make('h2', { text: t('history') }), journal.length ? table([['', 0], [t('by'), 0], ['', 0]], [...journal].reverse().map(e => make('tr', {}, make('td', { text: e.when.replace('T', ' ').replace('Z', '') }), make('td', { text: e.by }), make('td', { text: e.what + (e.why ? ` (${e.why})` : '') })))) : make('p', { class: 'faint', text: t('empty_history') }),
      page.info && page.info.yaml ? [make('h2', { text: `${t('yaml')} ${page.info.config}` }), make('pre', { id: 'yaml', text: page.info.yaml })] : null].flat()
  })
}

function rerunPanel(page) {
  let before = null, timer = 0, log = '', difference = ''
  const volumes = () => Object.fromEntries(((desk.cases.find(c => c.case === page.token) || {}).anatomies || []).map(a => [a.name, a]))
  const watch = async () => {
    clearTimeout(timer)
    if (desk.page !== page) return
    const s = await askJson('status')
    $('busy').textContent = s.running ? `${t('working')} ${digits(s.seconds, 0)} s` + s.at_work.map(j => ` · ${j.case} ${j.stage}`).join('') : ''
    log = s.lines.join('\n') + (s.running || !s.ever ? '' : `\n${s.code ? t('ended') + ' ' + s.code : t('done_in') + ' ' + digits(s.seconds, 1) + ' s'}`)
    if ($('rerun-log')) $('rerun-log').textContent = log
    if (s.running) return timer = setTimeout(doing(watch), 400)
    desk.stats.rebuilt = (desk.stats.rebuilt || 0) + 1
    await loadLibrary()
    page.showSolid()
    await page.reloadInfo()
    await page.opening(true)
    $('busy').textContent = ''
    if (page.tab === 'build') page.show_('build')
  }
  const run = async () => {
    before = volumes()
    await tell('build', { only: [page.token] })
    watch()
  }
  page.addPanel('build', () => {
    const plan = desk.plan.get(page.token), reasons = page.info && page.info.reasons || [], now = volumes()
    const rows = before ? Object.keys({ ...before, ...now }).map(name => {
      const a = before[name], b = now[name], d = a && b ? b.volume_ml - a.volume_ml : NaN
      return make('tr', {}, make('td', {}, swatch(page.colourOf(name)), ' ' + label(name)), make('td', { class: 'number', text: a ? digits(a.volume_ml, 2) : '' }), make('td', { class: 'number', text: b ? digits(b.volume_ml, 2) : '' }), make('td', { class: 'number', text: isNaN(d) ? '' : (d > 0 ? '+' : '') + digits(d, 3) }))
    }) : []
    return [make('p', { text: t('rerun_text') }),
      reasons.length ? [make('p', { class: 'warn', text: t('why_stale') }), make('ul', {}, reasons.map(r => make('li', { text: r })))] : plan && plan.fault ? make('p', { class: 'bad', text: plan.fault }) : make('p', { class: 'good', text: t('fresh') }),
      make('div', { class: 'row' }, button('rerun', run, { id: 'rerun', class: 'main', disabled: !desk.config }), button('stop', () => tell('stop', {}))),
      make('pre', { id: 'rerun-log', class: 'faint', text: log }),
      rows.length ? [make('h2', { text: t('change') }), table([[t('volume'), 0], [t('before'), 1], [t('after'), 1], [t('change'), 1]], rows)] : null,
      button('compare', async () => { difference = '…', page.show_('build'); difference = (await askJson('compare', { case: page.token })).text; if (page.tab === 'build') page.show_('build') }, { id: 'compare' }),
      difference ? make('pre', { id: 'difference', text: difference }) : null,
      button('log', async () => { $('rerun-log').textContent = (await askJson('log', { case: page.token })).log })].flat()
  })
}
