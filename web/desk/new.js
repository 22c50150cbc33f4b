// A new case: where its scan lies, which series, which recipe.

async function bringFiles(page, files) {
  const { piece } = page.intake
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
        $('busy').textContent = `${t('bringing')} ${digits((100 * sent) / all, 0)} %`
      }
    const { path } = await tell('dropped', { drop, files: files.length, archive })
    await listSeries(page, path)
  } finally {
    $('busy').textContent = ''
  }
}

async function filesInFolder(entry) {
  if (entry.isFile) return [await new Promise((done, failed) => entry.file(done, failed))]
  const reader = entry.createReader(),
    all = []
  for (;;) {
    const some = await new Promise((done, failed) => reader.readEntries(done, failed))
    if (!some.length) return all
    for (const e of some.sort((a, b) => (a.name < b.name ? -1 : 1))) all.push(...(await filesInFolder(e)))
  }
}

async function takeDropped(page, e) {
  const items = [...e.dataTransfer.items].map(i => i.webkitGetAsEntry && i.webkitGetAsEntry()),
    files = [...e.dataTransfer.files]
  await bringFiles(
    page,
    items.some(i => i && i.isDirectory) ? (await Promise.all(items.filter(i => i).map(filesInFolder))).flat() : files
  )
}

function dropArea(page) {
  const pick = (id, given) =>
    make('input', {
      type: 'file',
      id,
      hidden: true,
      ...given,
      change: doing(async e => {
        await bringFiles(page, [...e.target.files])
        e.target.value = ''
      })
    })
  const zip = pick('pick-zip', { accept: '.zip' }),
    folder = pick('pick-folder', { webkitdirectory: true, multiple: true })
  const box = make(
    'div',
    {
      class: 'drop',
      id: 'drop',
      dragover: e => {
        e.preventDefault()
        box.classList.add('over')
      },
      dragleave: () => box.classList.remove('over'),
      drop: e => {
        e.preventDefault()
        box.classList.remove('over')
        doing(() => takeDropped(page, e))()
      }
    },
    make('p', { text: t('drop_here') }),
    inRow(
      make('button', { text: t('pick_zip'), click: () => zip.click() }),
      make('button', { text: t('pick_folder'), click: () => folder.click() })
    ),
    zip,
    folder
  )
  return box
}

async function openFolder(page, path) {
  const { tree } = page.intake
  const data = await askJson('folders', path === null ? {} : { path })
  const parts = path === null ? [] : path.split('/')
  tree.replaceChildren(
    ...[
      heading('drop_title'),
      dropArea(page),
      heading('choose_folder'),
      path === null ? para('faint', t('choose_how')) : para('faint', data.name),
      path === null
        ? null
        : make('button', {
            class: 'pick',
            text: '↑ ' + t('up'),
            click: doing(() => openFolder(page, parts.length > 1 ? parts.slice(0, -1).join('/') : null))
          }),
      ...data.folders.map(f =>
        make('button', {
          class: 'pick',
          'data-path': f.path,
          text: '▸ ' + f.name,
          click: doing(() => openFolder(page, f.path))
        })
      ),
      ...data.archives.map(f =>
        make('button', {
          class: 'pick',
          'data-path': f.path,
          text: 'ZIP ' + f.name,
          click: doing(() => listSeries(page, f.path))
        })
      ),
      path === null ? null : para('faint', `${data.files} ${t('files')}`)
    ].filter(x => x)
  )
  if (path !== null) tree.append(button('look_series', () => listSeries(page, path), { id: 'look-series', class: 'main' }))
}

async function listSeries(page, path) {
  const { right } = page.intake
  right.replaceChildren(para('faint', t('listing')))
  let data
  try {
    data = await askJson('series', { path })
  } catch (e) {
    right.replaceChildren(seriesHint())
    throw e
  }
  const stem = file => file.replace(/^.*\//, '').replace(/\.yaml$/, '')
  const about = make('p', { class: 'faint', id: 'about' })
  const token = make('input', { id: 'token', maxLength: 64, size: 34, placeholder: t('token_help'), autocomplete: 'off' }),
    recipe = make(
      'select',
      { id: 'recipe', change: () => tellAbout() },
      data.recipes.map(r =>
        make('option', {
          value: r.file,
          text: `${r.about ? r.about.split(/[:.]( |$)/)[0] : `${stem(r.pipeline)}, ${stem(r.scene)}`} (${r.file})`
        })
      )
    )
  const tellAbout = () => {
    about.textContent = (data.recipes.find(r => r.file === recipe.value) || { about: '' }).about
  }
  if (data.recipes.some(r => r.file === data.recipe)) recipe.value = data.recipe
  const chosen = data.series.find(s => s.proposed) || data.series.find(s => s.usable)
  let series = chosen ? chosen.token : ''
  const rows = data.series.map(s => {
    const radio = make('input', {
      type: 'radio',
      name: 'series',
      value: s.token,
      'aria-label': s.token,
      checked: s.token === series,
      disabled: !s.usable,
      change: () => {
        series = s.token
      }
    })
    const picture = make('td', { class: s === chosen ? 'pictured' : '' }),
      show = button(
        'show',
        async () => {
          const src = await askPng('picture', { path, series: s.token })
          picture.replaceChildren(make('img', { class: 'thumb', alt: t('picture'), src }))
        },
        { disabled: !s.usable, 'data-show': s.token }
      )
    picture.append(show)
    if (s === chosen) setTimeout(() => show.click(), 0)
    return make(
      'tr',
      {},
      make('td', {}, radio),
      make('td', { text: s.token }),
      make('td', { text: s.line || [s.modality, s.kernel, s.orientation].filter(x => x).join(', ') }),
      make(
        'td',
        {},
        make('span', { class: s.usable ? 'good' : 'bad', text: s.verdict }),
        s.proposed ? [' ', make('span', { class: 'tag good', text: t('proposed') })] : null
      ),
      picture
    )
  })
  right.replaceChildren(
    heading('series'),
    data.series.length
      ? table(
          [
            [t('take'), 0],
            [t('series'), 0],
            [t('what_it_is'), 0],
            [t('verdict'), 0],
            [t('picture'), 0]
          ],
          rows
        )
      : para('warn', t('no_series')),
    heading('case_and_recipe'),
    inRow(field('token', token)),
    inRow(field('recipe', recipe)),
    about,
    para('faint', t('create_text')),
    inRow(
      button(
        'create',
        async () => {
          await tell('new', {
            case: token.value.trim(),
            path,
            series: data.series.length > 1 ? series : '',
            recipe: recipe.value
          })
          await loadLibrary()
          location.hash = 'library'
          hint(t('created'))
        },
        { id: 'create', class: 'main', disabled: !data.series.some(s => s.usable) }
      )
    )
  )
  tellAbout()
}

const seriesHint = () => para('faint', t('series_start'))

async function showNew(page) {
  const { tree, right } = page.intake
  $('title').textContent = t('newcase')
  $('page').replaceChildren(make('div', { class: 'split' }, tree, right))
  right.replaceChildren(seriesHint())
  await openFolder(page, null)
}

function newPage() {
  const page = { name: 'new' }
  const intake = (page.intake = {})
  const tree = make('div', { id: 'folders' }),
    right = make('div', { id: 'series' })
  Object.assign(intake, { tree, right })
  // What is dropped comes to the desk in pieces, and lies beside LIBRARY.yaml under a name of its content: file names may be
  // patients'.
  const piece = 4 << 20
  intake.piece = piece
  page.leave = () => {}
  page.show = () => showNew(page)
  return page
}
