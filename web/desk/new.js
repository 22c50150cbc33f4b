// Part 11: a new case: where its scan lies, which series, which recipe.
function newPage() {
  const page = { name: 'new' }
  const tree = make('div', { id: 'folders' }), right = make('div')
  const open = async path => {
    const data = await askJson('folders', path === null ? {} : { path })
    const parts = path === null ? [] : path.split('/')
    tree.replaceChildren(make('h2', { text: t('choose_folder') }),
      path === null ? null : make('button', { class: 'pick', text: '↑ ' + t('up'), click: doing(() => open(parts.length > 1 ? parts.slice(0, -1).join('/') : null)) }),
      ...data.folders.map(f => make('button', { class: 'pick', 'data-path': f.path, text: '▸ ' + f.name, click: doing(() => open(f.path)) })),
      ...data.archives.map(f => make('button', { class: 'pick', 'data-path': f.path, text: '⧉ ' + f.name, click: doing(() => list(f.path)) })),
      make('p', { class: 'faint', text: `${data.files} ${t('files')}` }))
    if (path !== null) tree.append(button('look_series', () => list(path), { id: 'look-series', class: 'main' }))
  }
  const list = async path => {
    right.replaceChildren(make('p', { class: 'faint', text: '…' }))
    const data = await askJson('series', { path })
    const token = make('input', { id: 'token', maxLength: 64, placeholder: t('token_help'), autocomplete: 'off' }), recipe = make('select', { id: 'recipe' }, data.recipes.map(r => make('option', { value: r.file, text: `${r.file} — ${r.pipeline}, ${r.scene}` })))
    const chosen = data.series.find(s => s.proposed) || data.series.find(s => s.usable)
    let series = chosen ? chosen.token : ''
    const rows = data.series.map(s => {
      const radio = make('input', { type: 'radio', name: 'series', value: s.token, checked: s.token === series, disabled: !s.usable, change: () => { series = s.token } })
      const picture = make('td'), show = button('show', async () => {
        const bytes = await askBytes('picture', { path, series: s.token })
        picture.replaceChildren(make('img', { class: 'thumb', alt: t('picture'), src: URL.createObjectURL(new Blob([bytes], { type: 'image/png' })) }))
      }, { disabled: !s.usable, 'data-show': s.token })
      picture.append(show)
      return make('tr', {}, make('td', {}, radio), make('td', { text: s.token }), make('td', { text: s.line || [s.modality, s.kernel, s.orientation].filter(x => x).join(', ') }), make('td', {}, make('span', { class: s.usable ? 'good' : 'bad', text: s.verdict }), s.proposed ? make('span', { class: 'tag good', text: t('proposed') }) : null), picture)
    })
    right.replaceChildren(make('h2', { text: t('series') }), data.series.length ? table([['', 0], [t('series'), 0], ['', 0], [t('verdict'), 0], [t('picture'), 0]], rows) : make('p', { class: 'warn', text: t('no_series') }),
      make('h2', { text: t('recipe') }), make('div', { class: 'row' }, field('token', token), field('recipe', recipe), button('create', async () => {
        await tell('new', { case: token.value.trim(), path, series: data.series.length > 1 ? series : '', recipe: recipe.value })
        await loadLibrary()
        location.hash = 'library'
      }, { id: 'create', class: 'main', disabled: !data.series.some(s => s.usable) })))
  }
  page.leave = () => {}
  page.show = async () => {
    $('title').textContent = t('newcase')
    $('page').replaceChildren(make('div', { class: 'split' }, tree, right))
    await open(null)
  }
  return page
}
