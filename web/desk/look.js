// A case: its planes beside the 3D page, the tools, and the panels.

function viewBox(page, id, content) {
  const { views } = page.frame
  const b = make(
    'div',
    { class: 'view', 'data-view': id },
    content,
    make('button', {
      class: 'most',
      title: t('bigger'),
      'aria-label': t('bigger'),
      click: () => {
        const one = views.classList.contains('one') && b.classList.contains('chosen')
        views.classList.toggle('one', !one)
        for (const other of views.children) other.classList.toggle('chosen', !one && other === b)
        page.redraw()
      }
    })
  )
  return b
}

function stepSlices(page, p, n) {
  const to = [...page.at]
  to[p.n] += n
  page.go(to)
  for (const ahead of [1, 2]) {
    const index = page.at[p.n] + Math.sign(n) * ahead
    if (index >= 0 && index < page.volume.size[p.n]) Promise.resolve(page.volume.slice(p.n, index)).catch(() => {})
  }
}

function rememberView(page) {
  const { frame } = page
  clearTimeout(frame.remembering)
  if (!page.restored) return // what was kept is not read yet
  frame.remembering = setTimeout(
    () =>
      desk.config &&
      tellBytes(
        'keep',
        { case: page.token, what: 'view' },
        JSON.stringify({
          at: page.at,
          window: page.window,
          tool: page.tool,
          tab: page.tab,
          off: [...page.outlines].filter(o => !o[1]).map(o => o[0]),
          edit: page.heldEdit ? page.heldEdit() : null
        })
      ).catch(() => {}),
    700
  )
}

async function restoreView(page) {
  try {
    const view = JSON.parse(new TextDecoder().decode(await askBytes('draft', { case: page.token, what: 'view' })) || '{}')
    if (view.at && page.volume.inside(view.at)) page.at = view.at
    if (view.window) page.window = view.window
    if (view.off) page.off = view.off
    if (view.edit && page.holdEdit) page.holdEdit(view.edit)
    if (page.tools[view.tool]) page.pick(view.tool)
    if (page.panels[view.tab]) page.tab = view.tab
  } catch (e) {}
  page.restored = true
  page.show_(page.tab)
}

// The page of the case is made anew, and lies for one frame at an address of another origin.
async function showSolid(page) {
  const { solidBox } = page.frame
  const c = desk.cases.find(c => c.case === page.token)
  const told = make('div', { class: 'wait', text: t(c && !c.fault ? 'page_comes' : 'no_page') })
  for (const old of solidBox.querySelectorAll('iframe, .wait')) old.remove()
  solidBox.append(told)
  page.solidAsked && page.solidAsked.abort()
  const asked = (page.solidAsked = new AbortController())
  if (!c || c.fault) return
  try {
    const { address } = await askJson('page', { case: page.token }, asked.signal)
    if (asked.signal.aborted) return
    solidBox.insertBefore(
      make('iframe', {
        title: t('solid'),
        src: address + '#framed',
        sandbox: 'allow-scripts',
        referrerPolicy: 'no-referrer',
        load: () => {
          told.hidden = true
        }
      }),
      told
    )
  } catch (e) {
    if (!asked.signal.aborted) told.textContent = e.message
  }
}

function lookAt(page, p) {
  for (let a = 0; a < 3; ++a) page.at[a] = Math.max(0, Math.min(page.volume.size[a] - 1, Math.round(p[a])))
  page.redraw()
  page.told && page.told()
  if (page.begun && page.begun.tool.move) page.begun.tool.move(page.begun.p, [...page.at])
  rememberView(page)
}

function setGreyWindow(page, level, width) {
  page.window = { level: Math.round(level), width: Math.max(1, Math.round(width)) }
  page.redraw()
  page.told && page.told()
  rememberView(page)
}

function showPanel(page, name) {
  const { tabs, panel } = page.frame
  // Whoever works by keyboard keeps the place: what had the focus is found again by its name.
  const had = panel.contains(document.activeElement) ? document.activeElement : null,
    scrolled = page.tab === name ? panel.scrollTop : 0
  const named =
    had &&
    (had.id
      ? '#' + had.id
      : [...had.attributes]
          .filter(a => a.name.startsWith('data-'))
          .map(a => `[${a.name}="${CSS.escape(a.value)}"]`)
          .join(''))
  if (page.tab !== name) page.redraw() // a tab may have lines of its own
  page.tab = name
  for (const b of tabs.children) b.setAttribute('aria-selected', b.dataset.tab === name)
  page.told = null
  panel.replaceChildren(
    ...[]
      .concat(page.panels[name]())
      .flat(3)
      .filter(x => x)
  )
  panel.scrollTop = scrolled
  const again = named && panel.querySelector(named)
  if (again) again.focus({ preventScroll: true })
  rememberView(page)
}

function listTabs(page) {
  const { tabs } = page.frame
  return tabs.replaceChildren(
    ...Object.keys(page.panels).map(name =>
      make('button', {
        role: 'tab',
        'data-tab': name,
        'aria-selected': String(page.tab === name),
        text: t('tab_' + name),
        click: () => page.show_(name),
        keydown: e => {
          const to = e.key === 'ArrowRight' ? e.target.nextSibling : e.key === 'ArrowLeft' ? e.target.previousSibling : null
          if (to) {
            e.preventDefault()
            to.focus()
            to.click()
          }
        }
      })
    )
  )
}

async function reloadInfo(page) {
  page.info = await askJson('case', { case: page.token })
  const at = page.info.built ? page.info.built.landmarks.length : 0
  desk.stats.landmarks = at
  page.redraw()
  if (page.tab) page.show_(page.tab)
}

async function saveChange(page, path, body, why = '') {
  if (path === 'edit' || path === 'holes' || (path === 'landmark' && body.position_mm)) needOpen(page)
  const said = await tell(path, { case: page.token, by: who(), why, base: page.info.base, ...body })
  hint(t('saved'))
  await page.reloadInfo()
  if (path === 'scene')
    page
      .opening(true)
      .catch(e => problem(e.message))
      .finally(() => {
        $('busy').textContent = ''
      })
  else if (path === 'edit' || path === 'switch') page.refresh()
  if (said.warnings && said.warnings.length) problem(`${said.warnings.join('\n')}\n${t('saved_all_the_same')}`)
  return said
}

function refreshOutlines(page) {
  page
    .opening('behind')
    .catch(e => problem(e.message))
    .finally(() => {
      $('busy').textContent = ''
    })
}

async function openScan(page, again) {
  const { panel, wait } = page.frame
  wait.hidden = !!page.volume
  let fresh = again === true
  page.isOpen = page.isOpen && again === 'behind'
  const query = again ? { case: page.token, again: again === true ? 1 : again } : { case: page.token }
  for (let first = true; desk.page === page; first = false) {
    const now = await askJson('open', first ? query : { case: page.token })
    if (now.state === 'failed' && !now.lattice) throw ((wait.textContent = now.fault), new Refused(now.fault))
    if (now.lattice && (!page.volume || fresh)) {
      const old = page.volume
      fresh = false
      page.volume = makeVolume(page.token, now.lattice)
      if (!old || String(old.size) !== String(page.volume.size)) page.at = page.volume.size.map(n => n >> 1)
      if (old) page.redraw()
      else await restoreView(page)
      wait.hidden = true
      page.opened && page.opened()
    }
    wait.textContent = `${t('opening')} ${now.doing ? ': ' + now.doing : ''}`
    if (String(now.fields) !== String(page.fields)) {
      page.fields = now.fields
      for (const f of now.fields) if (!page.outlines.has(f)) page.outlines.set(f, !(page.off || []).includes(f))
      if (page.tab === 'look' || (page.tab === 'paint' && !panel.contains(document.activeElement))) page.show_(page.tab)
      page.redraw()
    }
    page.found = now.landmarks
    if (now.state !== 'opening') {
      page.isOpen = true
      // What was drawn meanwhile is of the case as it was.
      if (again === 'behind') now.fields.forEach(f => page.volume.forget(f + ':'))
      if (page.tab === 'place' && again !== 'behind' && !panel.contains(document.activeElement)) page.show_('place')
      page.redraw()
      if (now.fault) problem(now.fault)
      return
    }
    $('busy').textContent = `${t('opening')}: ${now.doing}`
    await new Promise(done => setTimeout(done, 250))
  }
}

function leaveCase(page) {
  page.solidAsked && page.solidAsked.abort()
  page.timers.forEach(clearInterval)
  removeEventListener('resize', page.redraw)
  removeEventListener('keydown', page.keys)
  $('busy').textContent = ''
}

async function showCase(page) {
  const { views, tools, tabs, panel, wait } = page.frame
  $('title').textContent = page.token
  $('page').replaceChildren(make('div', { class: 'work' }, tools, views, make('aside', {}, tabs, panel)))
  lookPanel(page)
  placePanel(page)
  paintPanel(page)
  valuesPanel(page)
  rerunPanel(page)
  approvePanel(page)
  page.listTools()
  page.listTabs()
  addEventListener('resize', page.redraw)
  addEventListener('keydown', page.keys)
  if (!desk.cases.length) await loadLibrary()
  page.showSolid()
  await page.reloadInfo()
  if (!desk.config) return (wait.textContent = t('no_config'))
  await page.opening(false)
  $('busy').textContent = ''
}

function casePage(token) {
  const page = {
    name: 'case',
    token,
    tool: 'cross',
    at: [0, 0, 0],
    volume: null,
    isOpen: false,
    info: null,
    window: { level: 40, width: 400 },
    outlines: new Map(),
    measures: [],
    line: null,
    marks: true,
    timers: [],
    fields: [],
    tab: 'look',
    range: null,
    overlays: []
  }
  const frame = (page.frame = {
    canvases: {},
    due: 0,
    colours: new Map(),
    coloursOf: null,
    // HU to grey, once a window: a slice is then a look into a table.
    grey: null,
    greyOf: '',
    remembering: 0
  })
  const { canvases } = frame
  const views = make('div', { class: 'views' }),
    tools = make('nav', { class: 'tools', 'aria-label': 'tools' }),
    tabs = make('div', { class: 'tabs', role: 'tablist' }),
    panel = make('div', { class: 'panel', id: 'panel' })
  Object.assign(frame, { views, tools, tabs, panel })
  page.panels = {}
  page.every = (f, ms) => page.timers.push(setInterval(f, ms))
  for (const p of PLANES) canvases[p.id] = make('canvas', { id: p.id, tabIndex: 0, 'aria-label': t(p.id) })
  const solid = make('div', { class: 'wait', text: t('solid') }),
    wait = make('div', { class: 'wait', id: 'opening', text: t('opening') })
  frame.wait = wait
  const solidBox = viewBox(page, 'solid', solid)
  frame.solidBox = solidBox
  views.append(
    viewBox(page, 'axial', canvases.axial),
    viewBox(page, 'coronal', canvases.coronal),
    viewBox(page, 'sagittal', canvases.sagittal),
    solidBox
  )
  views.firstChild.append(wait)
  page.showSolid = () => showSolid(page)
  page.redraw = () => redraw(page)
  page.colourOf = name => colourOf(page, name)
  page.strokeOutline = strokeOutline
  // Until an outline is there on all three planes.
  page.outlinesDrawn = name => Promise.all(page.volume.planes.map(p => page.volume.outline(name, p.n, page.at[p.n])))
  page.inked = inked
  // As the case was built; of one that was not, as they are found now.
  page.foundMarks = () => (page.info && page.info.built ? page.info.built.landmarks : page.found || [])
  page.allMarks = () => allMarks(page)
  page.go = p => lookAt(page, p)
  page.goWorld = w => page.volume && page.go(page.volume.toIndex(w))
  page.setWindow = (level, width) => setGreyWindow(page, level, width)
  page.remember = () => rememberView(page)
  handsOf(page, canvases, (p, n) => stepSlices(page, p, n))
  let was = page.at
  page.tools = {
    cross: {
      key: 'x',
      down: (p, at) => {
        was = [...page.at]
        page.go(at)
      },
      move: (p, at) => page.go(at),
      stop: () => page.go(was)
    },
    measure: {
      key: 'm',
      ...ruler(page, (m, over) => {
        if (!over) page.measures.push(m)
        else {
          if (m.mm < 0.5) page.measures.pop()
          page.show_('look')
        }
      })
    },
    profile: {
      key: 'p',
      ...ruler(page, (m, over) => {
        page.line = m
        if (over) page.show_('look')
      })
    }
  }
  page.pick = name => pickTool(page, name)
  page.listTools = () => listTools(page)
  page.keys = e => caseKeys(page, e)
  page.addPanel = (name, build) => {
    page.panels[name] = build
  }
  page.show_ = name => showPanel(page, name)
  page.listTabs = () => listTabs(page)
  page.reloadInfo = () => reloadInfo(page)
  // Saves something of the case; what the page knows of it is asked anew.
  page.save = (path, body, why) => saveChange(page, path, body, why)
  // The outlines as the configuration makes them now, computed behind what goes on.
  page.refresh = () => refreshOutlines(page)
  page.opening = again => openScan(page, again)
  page.leave = () => leaveCase(page)
  page.show = () => showCase(page)
  return page
}
