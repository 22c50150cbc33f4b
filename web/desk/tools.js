// The tools of a case's page: the rulers, the list of tools, and the keys that take one.

const lengthMm = (page, a, b) => Math.hypot(...[0, 1, 2].map(k => (a[k] - b[k]) * page.volume.spacing[k]))

function ruler(page, done) {
  let m = null
  return {
    draws: true,
    stop: () => {
      if (m) {
        m.mm = 0
        done(m, true)
        m = null
      }
    },
    down: (p, at) => {
      m = { plane: p.id, index: page.at[p.n], from: at, to: at, mm: 0 }
      done(m, false)
    },
    move: (p, at) => {
      if (m) {
        m.to = at
        m.mm = lengthMm(page, m.from, at)
        page.redraw()
      }
    },
    up: (p, at) => {
      if (m) {
        m.to = at
        m.mm = lengthMm(page, m.from, at)
        done(m, true)
        m = null
        page.redraw()
      }
    }
  }
}

function pickTool(page, name) {
  const { tools } = page.frame
  page.tool = name
  for (const b of tools.querySelectorAll('[data-tool]')) b.setAttribute('aria-pressed', b.dataset.tool === name)
  page.redraw()
  rememberView(page)
}

function listTools(page) {
  const { tools } = page.frame
  return tools.replaceChildren(
    ...Object.entries(page.tools).map(([name, tool]) =>
      make(
        'button',
        { 'data-tool': name, 'aria-pressed': String(page.tool === name), click: () => page.pick(name) },
        make('span', { text: t('t_' + name) }),
        make('kbd', { text: tool.key.toUpperCase() })
      )
    ),
    make(
      'button',
      { id: 'undo', click: doing(() => page.undo && page.undo()) },
      make('span', { text: t('undo') }),
      make('kbd', { text: 'Ctrl Z' })
    ),
    make(
      'button',
      { id: 'redo', click: doing(() => page.redo && page.redo()) },
      make('span', { text: t('redo') }),
      make('kbd', { text: 'Ctrl Y' })
    )
  )
}

function caseKeys(page, e) {
  // A list that was chosen from keeps the keyboard: a tool's letter must not choose another anatomy in it.
  if (e.target.matches('input, textarea') || (e.target.matches('select') && (e.key.length > 1 || e.key === ' '))) return
  const k = e.key.toLowerCase()
  if ((e.ctrlKey || e.metaKey) && (k === 'z' || k === 'y')) {
    e.preventDefault()
    doing(() => (k === 'y' || e.shiftKey ? page.redo && page.redo() : page.undo && page.undo()))()
    return
  }
  if (e.ctrlKey || e.metaKey || e.altKey) return
  const tool = Object.entries(page.tools).find(([, tool]) => tool.key === k)
  if (tool) {
    e.preventDefault()
    page.pick(tool[0])
  } else if ((k === '[' || k === ']') && page.resize) {
    e.preventDefault()
    page.resize(k === ']' ? 1.25 : 0.8)
  }
}
