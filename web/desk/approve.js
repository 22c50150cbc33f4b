// Approval, after what a case of this recipe has was looked at.

// Lessons that the case cannot serve: each is ticked, and a reason is given, as `library approve --accept` wants it.
const notServed = page =>
  page.approval.uses && page.approval.uses.lessons ? page.approval.uses.lessons.filter(l => l.why_not) : []

function acceptLines(page) {
  const { approval } = page,
    open = notServed(page)
  if (!open.length) return []
  const why = make('input', { id: 'accept-why', maxLength: 200, autocomplete: 'off', value: approval.why })
  why.addEventListener('input', () => {
    approval.why = why.value
    approval.judge()
  })
  return [
    para('faint', t('tick_lessons')),
    ...open.map(l =>
      inRow(
        tick(`${t('not_served_line')} ${label(l.name)}`, {
          'data-accept': l.name,
          checked: approval.accepted.has(l.name),
          change: e => {
            e.target.checked ? approval.accepted.add(l.name) : approval.accepted.delete(l.name)
            approval.judge()
          }
        })
      )
    ),
    inRow(field('accept_why', why))
  ]
}

function lessonUses(page, c) {
  const { approval } = page
  const of = String(desk.stats.rebuilt || 0),
    box = make('div', { id: 'lessons' })
  approval.fill = () =>
    box.replaceChildren(
      ...(!approval.uses
        ? [para('faint', t('asking_lessons'))]
        : approval.uses.fault
          ? [para('warn', approval.uses.fault)]
          : [
              approval.uses.lessons.some(l => !l.why_not) ? null : para('warn', t('no_lesson')),
              table(
                [
                  [t('lesson'), 0],
                  [t('tasks'), 0]
                ],
                approval.uses.lessons.map(l =>
                  make(
                    'tr',
                    { 'data-lesson': l.name },
                    make('td', { text: label(l.name) }),
                    l.why_not
                      ? make('td', { class: 'faint', text: `${t('not_served')} ${l.why_not}` })
                      : make('td', {
                          class: Object.keys(l.doubtful).length < l.tasks.length ? 'good' : 'warn',
                          text: l.tasks.map(x => label(x) + (l.doubtful[x] ? ` (${l.doubtful[x]})` : '')).join(', ')
                        })
                  )
                )
              ),
              ...acceptLines(page)
            ].filter(x => x))
    )
  if (approval.usesOf !== of) {
    approval.uses = null
    approval.usesOf = of
    askJson('lessons', { case: page.token })
      .then(
        said => {
          approval.uses = said
        },
        e => {
          approval.uses = { fault: e.message }
        }
      )
      .then(() => {
        approval.fill()
        approval.judge()
      })
  }
  approval.fill()
  return box
}

function approveControls(page) {
  const { approval } = page
  const { ticked } = approval
  const c = desk.cases.find(c => c.case === page.token),
    info = page.info || {},
    built = info.built
  if (!built || !c) return [para('warn', t('not_built')), para('faint', t('build_first'))]
  if (approval.seen !== (desk.stats.rebuilt || 0)) {
    approval.seen = desk.stats.rebuilt || 0
    ticked.clear()
    approval.accepted.clear()
  } // another case now: it is looked at anew
  const has = name => c.anatomies.some(a => a.name.includes(name))
  const lines = [
    'c_surfaces',
    has('skin') && 'c_skin',
    has('ventricle') && 'c_ventricles',
    built.landmarks.length && 'c_landmarks',
    built.holes.length && 'c_holes',
    has('skin') && (info.now && /crop|deface/.test(info.now.face) ? 'c_face' : 'c_face_kept'),
    info.warnings.length && 'c_warnings'
  ]
    .filter(x => x)
    .map(key => ({ id: key, text: t(key) }))
  // What a run found and is sure of is acknowledged one by one.
  built.findings
    .filter(f => f.confidence >= 0.5)
    .forEach((f, n) =>
      lines.push({
        id: `finding_${n + 1}`,
        text: `${t('c_finding')} ${f.text}`,
        at: f.kind === 'other_patient' ? null : f.position_mm
      })
    )
  const known = info.now ? info.now.known_landmarks : [],
    lost = known.filter(name => !built.landmarks.some(l => l.name === name || l.name.startsWith(name + '_')))
  const level = make(
    'select',
    { id: 'difficulty' },
    [1, 2, 3, 4, 5].map(n => make('option', { value: String(n), text: String(n) }))
  )
  level.value = String(c.approval ? c.approval.difficulty_level : 3)
  const stale = info.reasons && info.reasons.length > 0
  const approve = button(
    'approve',
    async () => {
      await tell('approve', {
        case: page.token,
        by: who(),
        difficulty_level: +level.value,
        checks: lines.map(l => l.text),
        accepted: Object.fromEntries(notServed(page).map(l => [l.name, approval.why.trim()]))
      })
      await again()
    },
    { id: 'approve', class: 'main' }
  )
  const again = async () => {
    await loadLibrary()
    await page.reloadInfo()
    hint(t('saved'))
  }
  const judge = () => {
    const open = notServed(page),
      unticked = lines.some(l => !ticked.has(l.id)),
      unaccepted = open.some(l => !approval.accepted.has(l.name)) || (open.length && !approval.why.trim())
    approve.disabled = stale || unticked || !approval.uses || !!unaccepted
    todo.textContent = t(unticked ? 'tick_all' : approval.uses ? 'tick_lessons' : 'asking_lessons')
    todo.hidden = stale || !approve.disabled
  }
  approval.judge = judge
  const todo = para('faint', t('tick_all'))
  const list = lines.map(l =>
    inRow(
      tick(l.text, {
        'data-check': l.id,
        checked: ticked.has(l.id),
        change: e => {
          e.target.checked ? ticked.add(l.id) : ticked.delete(l.id)
          judge()
        }
      }),
      l.at ? button('go_there', () => page.goWorld(l.at)) : null
    )
  )
  judge()
  return [
    c.approval
      ? para(
          c.approval.holds ? 'good' : 'bad',
          c.approval.holds
            ? `${t('approved')} ${t('by')} ${c.approval.by}, ${t('difficulty')} ${c.approval.difficulty_level}`
            : t('void_')
        )
      : para('faint', t('unapproved')),
    stale ? para('warn', t('stale_case')) : null,
    heading('checklist'),
    list,
    lost.length ? make('p', { class: 'warn', id: 'lost', text: `${t('lost_landmarks')} ${lost.map(label).join(', ')}` }) : null,
    info.now && info.now.cuts_holes && !built.holes.length && !saidHoles(page).length ? para('warn', t('no_hole_built')) : null,
    inRow(
      field('difficulty', level),
      approve,
      c.approval
        ? button('withdraw', async () => {
            await tell('approve', { case: page.token, by: who(), withdraw: true })
            await again()
          })
        : null
    ),
    todo,
    // Below what is clicked, which must not move when the answer comes.
    heading('lessons'),
    lessonUses(page, c),
    info.warnings.length ? [heading('warnings'), info.warnings.map(w => warningLine(page, w))] : null
  ].flat(2)
}

function approvePanel(page) {
  const approval = (page.approval = { ticked: new Set(), accepted: new Set(), why: '', seen: 0, uses: null, usesOf: '' })
  // The simulator says for which lessons the case serves; asked once for each state of the case.
  approval.fill = approval.judge = () => {}
  page.addPanel('approve', () => approveControls(page))
}
