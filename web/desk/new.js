// Part 13: a new case: where its scan lies, which series, which recipe.
function newPage() {
  const page = { name: 'new' }
  const tree = make('div', { id: 'folders' }), right = make('div', { id: 'series' })
  // What is dropped comes to the desk in pieces, and lies beside LIBRARY.yaml under a name of its content: file names may be patients'.
  const piece = 4 << 20
  const bring = async files => {
    const archive = files.length === 1 && /\.zip$/i.test(files[0].name)
    if (!files.length) throw new Refused(t('drop_empty'))
    if (files.length === 1 && !archive) throw new Refused(t('drop_one'))
    const drop = [...crypto.getRandomValues(new Uint8Array(8))].map(b => b.toString(16).padStart(2, '0')).join('')
    const all = files.reduce((sum, f) => sum + f.size, 0) || 1
    let sent = 0
    try {
      for (let n = 0; n < files.length; ++n)
        for (let offset = 0; offset === 0 || offset < files[n].size; offset += piece) {
          const part = files[n].slice(offset, offset + piece)
          await tellBytes('drop', { drop, file: n, offset }, part)
          sent += part.size
          $('busy').textContent = `${t('bringing')} ${digits(100 * sent / all, 0)} %`
        }
      const { path } = await tell('dropped', { drop, files: files.length, archive })
      await list(path)
    } finally { $('busy').textContent = '' }
  }
  const inFolder = async entry => {
    if (entry.isFile) return [await new Promise((done, failed) => entry.file(done, failed))]
    const reader = entry.createReader(), all = []
    for (;;) {
      const some = await new Promise((done, failed) => reader.readEntries(done, failed))
      if (!some.length) return all
      for (const e of some.sort((a, b) => a.name < b.name ? -1 : 1)) all.push(...await inFolder(e))
    }
  }
  const take = async e => {
    const items = [...e.dataTransfer.items].map(i => i.webkitGetAsEntry && i.webkitGetAsEntry()), files = [...e.dataTransfer.files]
    await bring(items.some(i => i && i.isDirectory) ? (await Promise.all(items.filter(i => i).map(inFolder))).flat() : files)
  }
  const area = () => {
    const pick = (id, given) => make('input', { type: 'file', id, hidden: true, ...given, change: doing(async e => { await bring([...e.target.files]); e.target.value = '' }) })
    const zip = pick('pick-zip', { accept: '.zip' }), folder = pick('pick-folder', { webkitdirectory: true, multiple: true })
    const box = make('div', { class: 'drop', id: 'drop', dragover: e => { e.preventDefault(), box.classList.add('over') }, dragleave: () => box.classList.remove('over'), drop: e => { e.preventDefault(), box.classList.remove('over'), doing(() => take(e))() } },
      make('p', { text: t('drop_here') }), make('div', { class: 'row' }, make('button', { text: t('pick_zip'), click: () => zip.click() }), make('button', { text: t('pick_folder'), click: () => folder.click() })), zip, folder)
    return box
  }
  const open = async path => {
    const data = await askJson('folders', path === null ? {} : { path })
    const parts = path === null ? [] : path.split('/')
    tree.replaceChildren(...[make('h2', { text: t('drop_title') }), area(), make('h2', { text: t('choose_folder') }), path === null ? make('p', { class: 'faint', text: t('choose_how') }) : make('p', { class: 'faint', text: data.name }),
      path === null ? null : make('button', { class: 'pick', text: '↑ ' + t('up'), click: doing(() => open(parts.length > 1 ? parts.slice(0, -1).join('/') : null)) }),
      ...data.folders.map(f => make('button', { class: 'pick', 'data-path': f.path, text: '▸ ' + f.name, click: doing(() => open(f.path)) })),
      ...data.archives.map(f => make('button', { class: 'pick', 'data-path': f.path, text: 'ZIP ' + f.name, click: doing(() => list(f.path)) })),
      path === null ? null : make('p', { class: 'faint', text: `${data.files} ${t('files')}` })].filter(x => x))
    if (path !== null) tree.append(button('look_series', () => list(path), { id: 'look-series', class: 'main' }))
  }
  const list = async path => {
    right.replaceChildren(make('p', { class: 'faint', text: t('listing') }))
    let data
    try { data = await askJson('series', { path }) } catch (e) { right.replaceChildren(start()); throw e }
    const stem = file => file.replace(/^.*\//, '').replace(/\.yaml$/, '')
    const about = make('p', { class: 'faint', id: 'about' })
    const token = make('input', { id: 'token', maxLength: 64, size: 34, placeholder: t('token_help'), autocomplete: 'off' }), recipe = make('select', { id: 'recipe', change: () => tellAbout() }, data.recipes.map(r => make('option', { value: r.file, text: `${r.about ? r.about.split(/[:.]( |$)/)[0] : `${stem(r.pipeline)}, ${stem(r.scene)}`} (${r.file})` })))
    const tellAbout = () => { about.textContent = (data.recipes.find(r => r.file === recipe.value) || { about: '' }).about }
    if (data.recipes.some(r => r.file === data.recipe)) recipe.value = data.recipe
    const chosen = data.series.find(s => s.proposed) || data.series.find(s => s.usable)
    let series = chosen ? chosen.token : ''
    const rows = data.series.map(s => {
      const radio = make('input', { type: 'radio', name: 'series', value: s.token, 'aria-label': s.token, checked: s.token === series, disabled: !s.usable, change: () => { series = s.token } })
      const picture = make('td', { class: s === chosen ? 'pictured' : '' }), show = button('show', async () => {
        const bytes = await askBytes('picture', { path, series: s.token })
        picture.replaceChildren(make('img', { class: 'thumb', alt: t('picture'), src: URL.createObjectURL(new Blob([bytes], { type: 'image/png' })) }))
      }, { disabled: !s.usable, 'data-show': s.token })
      picture.append(show)
      if (s === chosen) setTimeout(() => show.click(), 0)
      return make('tr', {}, make('td', {}, radio), make('td', { text: s.token }), make('td', { text: s.line || [s.modality, s.kernel, s.orientation].filter(x => x).join(', ') }), make('td', {}, make('span', { class: s.usable ? 'good' : 'bad', text: s.verdict }), s.proposed ? [' ', make('span', { class: 'tag good', text: t('proposed') })] : null), picture)
    })
    right.replaceChildren(make('h2', { text: t('series') }), data.series.length ? table([[t('take'), 0], [t('series'), 0], [t('what_it_is'), 0], [t('verdict'), 0], [t('picture'), 0]], rows) : make('p', { class: 'warn', text: t('no_series') }),
      make('h2', { text: t('case_and_recipe') }), make('div', { class: 'row' }, field('token', token)), make('div', { class: 'row' }, field('recipe', recipe)), about, make('p', { class: 'faint', text: t('create_text') }), make('div', { class: 'row' }, button('create', async () => {
        await tell('new', { case: token.value.trim(), path, series: data.series.length > 1 ? series : '', recipe: recipe.value })
        await loadLibrary()
        location.hash = 'library'
        hint(t('created'))
      }, { id: 'create', class: 'main', disabled: !data.series.some(s => s.usable) })))
    tellAbout()
  }
  const start = () => make('p', { class: 'faint', text: t('series_start') })
  page.leave = () => {}
  page.show = async () => {
    $('title').textContent = t('newcase')
    $('page').replaceChildren(make('div', { class: 'split' }, tree, right))
    right.replaceChildren(start())
    await open(null)
  }
  return page
}
