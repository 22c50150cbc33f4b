// Part 10: parameters of the case with a preview, what was done by hand, and a rebuild of the one case.
function valuesPanel(page) {
  let find = '', live = true, tried = { path: '', text: '', kind: 'faint', rows: [] }, later = 0, number = 0

  // The run's own computation with that value, up to the field of the anatomy; nothing is saved.
  page.tryIt = async (wish, told) => {
    const mine = ++number
    await tell('try', { case: page.token, ...wish })
    for (;;) {
      const now = await askJson('tried', { case: page.token })
      if (mine !== number || desk.page !== page) return null
      if (!now.running) return now
      told(`${now.doing} ${now.fraction ? digits(now.fraction * 100, 0) + ' %' : ''}`)
      await new Promise(done => setTimeout(done, 200))
    }
  }
  page.findValue = text => { find = text, page.show_('values') }
  const anatomyOf = path => page.fields.find(f => path.startsWith(f + '.'))
  const say = () => {
    const at = $('tried')
    if (!at) return
    at.replaceChildren(...tried.path ? [make('p', { class: tried.kind, text: tried.text }), tried.rows.length ? table([['', 0], ['', 1]], tried.rows.map(([name, v]) => make('tr', {}, make('td', { text: label(name) }), make('td', { class: 'number', text: figure(v) })))) : null, make('div', { class: 'row' }, button('no_preview', forget, { id: 'no-preview' }))].filter(x => x) : [])
  }
  const forget = () => {
    ++number
    tried = { path: '', text: '', kind: 'faint', rows: [] }
    page.tried = null
    page.redraw()
    say()
  }
  const preview = (path, value) => page.previewValues([{ path, value }], anatomyOf(path), `${path} = ${value}`)
  page.previewValues = async (values, anatomy, name) => {
    const path = name
    page.tried = null
    tried = { path, text: t('previewing'), kind: 'faint', rows: [] }
    say()
    let now
    try {
      now = await page.tryIt({ values, anatomy }, what => { tried.text = `${t('previewing')}: ${what}`, say() })
    } catch (e) {
      tried = { path, text: e.message, kind: 'bad', rows: [] }
      return say()
    }
    if (!now) return
    // What the value changes is the volume; the stage's own figures stand below.
    const figures = [...now.volume_ml ? [[t('volume_now'), now.volume_ml.now], [t('volume_then'), now.volume_ml.then]] : [], ...now.reports.length ? Object.entries(now.reports[0].figures).filter(([, v]) => typeof v === 'number').slice(0, 8) : []]
    tried = now.fault ? { path, text: now.fault, kind: 'bad', rows: [] } : { path, text: `${name}: ${t('preview_line')}`, kind: 'good', rows: figures }
    page.volume.forget('~tried')
    page.tried = now.has_field ? anatomy : null
    desk.stats.tried = (desk.stats.tried || 0) + 1
    page.redraw()
    say()
  }
  page.overlays.push((p, c) => {
    if (!page.tried) return
    const line = page.volume.outline('~tried', p.n, page.at[p.n])
    if (line.then) return line.then(page.redraw, () => { page.tried = null })
    page.strokeOutline(c, p, line, '#ffffff', [5, 4])
  })

  // The scene for which the case is made: what is shown and felt of it, and what is cut.
  page.sceneChoice = fits => {
    const all = (page.info.now.scenes || []).filter(s => s.chosen || fits(s)), own = all.find(s => s.chosen)
    if (!all.some(s => !s.chosen)) return null
    const about = make('p', { class: 'faint' }), choice = make('select', { 'data-scene': '', change: () => tellAbout() }, all.map(s => make('option', { value: s.file, text: s.file.replace(/^.*\//, '') })))
    const tellAbout = () => { about.textContent = (all.find(s => s.file === choice.value) || { about: '' }).about }
    choice.value = (own || all[0]).file
    const set = button('set', async () => {
      if (own && choice.value === own.file) return hint(t('same_value'))
      await page.change('scene', { scene: own.file }, { scene: choice.value })
    }, { 'data-set-scene': '', disabled: !!page.info.fixed })
    tellAbout()
    return [make('div', { class: 'row' }, field('scene', choice), set), about]
  }

  page.addPanel('values', () => {
    const now = page.info && page.info.now
    if (!now) return [make('p', { class: 'warn', text: t('no_config') })]
    const rows = make('div'), fixed = !!page.info.fixed
    const list = () => {
      const parts = find.toLowerCase().split(/\s+/).filter(x => x), all = now.values.filter(v => parts.every(p => v.path.toLowerCase().includes(p))), fit = all.slice(0, 120)
      rows.replaceChildren(table([[t('value_name'), 0], [t('value'), 0]], fit.map(v => {
        const by = v.source === 'set', is_place = /^\[?\s*-?[\d.e+]+(\s*,\s*-?[\d.e+]+){2}\s*\]?$/.test(v.value) && /(_mm|seed|point|centre)/.test(v.path)
        const value = make('input', { value: v.value, size: 12, 'data-value': v.path, 'aria-label': v.path, disabled: fixed })
        const save = doing(async () => {
          clearTimeout(later)
          if (value.value.trim() === v.value) return hint(t('same_value'))
          await page.change('value', { path: v.path, value: by ? v.value : null }, { path: v.path, value: value.value.trim() })
          forget()
        })
        const look = () => { if (value.value.trim()) doing(() => preview(v.path, value.value.trim()))() }
        value.addEventListener('keydown', e => { if (e.key === 'Enter') save() })
        value.addEventListener('input', () => { clearTimeout(later); if (live && anatomyOf(v.path)) later = setTimeout(look, 600) })
        return make('tr', {}, make('td', { class: 'path' }, v.path, make('br'), make('span', { class: 'faint', text: `${t('source')} ${v.source}` })), make('td', {}, value, make('div', { class: 'row' }, make('button', { text: t('set'), disabled: fixed, click: save }), anatomyOf(v.path) ? make('button', { text: t('preview'), 'data-preview': v.path, click: look }) : null,
          is_place && page.volume ? make('button', { text: t('at_cross'), disabled: fixed, click: () => { value.value = `[${page.volume.toWorld(page.at).map(x => Math.round(x * 100) / 100).join(', ')}]`; look() } }) : null,
          by ? make('button', { text: t('unset'), disabled: fixed, click: doing(() => page.change('value', { path: v.path, value: v.value }, { path: v.path, value: null })) }) : null)))
      })), ...all.length > fit.length ? [make('p', { class: 'faint', text: `${fit.length} ${t('of')} ${all.length}: ${t('narrow')}` })] : [])
    }
    list()
    setTimeout(say, 0)
    return [page.info.fixed ? make('p', { class: 'warn', text: page.info.fixed }) : page.info.shared ? make('p', { class: 'faint', text: `${t('own')} ${page.info.config}` }) : null, page.sceneChoice(() => true),
      make('input', { type: 'search', class: 'wide', id: 'find-value', placeholder: t('find_value'), 'aria-label': t('find_value'), value: find, input: e => { find = e.target.value, list() } }),
      make('div', { class: 'row' }, make('label', {}, make('input', { type: 'checkbox', id: 'live', checked: live, change: e => { live = e.target.checked } }), make('span', { text: t('live') }))), make('div', { id: 'tried' }), rows]
  })
  page.addPanel('history', () => {
    const journal = page.info && page.info.journal || []
    return [make('h2', { text: t('history') }), journal.length ? table([[t('when'), 0], [t('what'), 0]], [...journal].reverse().map(e => make('tr', {}, make('td', {}, e.when.replace('T', ' ').replace('Z', ' UTC'), make('br'), make('span', { class: 'faint', text: `${t('by')} ${e.by}` })), make('td', {}, e.what, e.why ? [make('br'), make('span', { class: 'faint', text: e.why })] : null)))) : make('p', { class: 'faint', text: t('empty_history') }),
      page.info && page.info.yaml ? [make('h2', { text: t('yaml') }), make('p', { class: 'faint', text: page.info.shared ? `${t('own')} ${page.info.config}` : page.info.config }), make('pre', { id: 'yaml', class: 'file', text: page.info.yaml })] : null].flat()
  })
}
