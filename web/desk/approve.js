// Part 12: approval, after what a case of this recipe has was looked at.
function approvePanel(page) {
  const ticked = new Set()
  let seen = 0
  // The simulator says for which lessons the case serves; asked once for each state of the case.
  let uses = null, usesOf = '', fill = () => {}
  const lessons = c => {
    const of = String(desk.stats.rebuilt || 0), box = make('div', { id: 'lessons' })
    fill = () => box.replaceChildren(...!uses ? [make('p', { class: 'faint', text: t('asking_lessons') })] : uses.fault ? [make('p', { class: 'warn', text: uses.fault })] : [uses.lessons.some(l => !l.why_not) ? null : make('p', { class: 'warn', text: t('no_lesson') }), table([[t('lesson'), 0], [t('tasks'), 0]], uses.lessons.map(l => make('tr', { 'data-lesson': l.name }, make('td', { text: label(l.name) }), l.why_not ? make('td', { class: 'faint', text: `${t('not_served')} ${l.why_not}` }) : make('td', { class: Object.keys(l.doubtful).length < l.tasks.length ? 'good' : 'warn', text: l.tasks.map(x => label(x) + (l.doubtful[x] ? ` (${l.doubtful[x]})` : '')).join(', ') }))))].filter(x => x))
    if (usesOf !== of) {
      uses = null, usesOf = of
      askJson('lessons', { case: page.token }).then(said => { uses = said }, e => { uses = { fault: e.message } }).then(() => fill())
    }
    fill()
    return box
  }
  page.addPanel('approve', () => {
    const c = desk.cases.find(c => c.case === page.token), info = page.info || {}, built = info.built
    if (!built || !c) return [make('p', { class: 'warn', text: t('not_built') }), make('p', { class: 'faint', text: t('build_first') })]
    if (seen !== (desk.stats.rebuilt || 0)) seen = desk.stats.rebuilt || 0, ticked.clear()  // another case now: it is looked at anew
    const has = name => c.anatomies.some(a => a.name.includes(name))
    const lines = ['c_surfaces', has('skin') && 'c_skin', has('ventricle') && 'c_ventricles', built.landmarks.length && 'c_landmarks', built.holes.length && 'c_holes', has('skin') && (info.now && /crop|deface/.test(info.now.face) ? 'c_face' : 'c_face_kept'), info.warnings.length && 'c_warnings'].filter(x => x).map(key => ({ id: key, text: t(key), english: TEXTS.en[key] }))
    // What a run found and is sure of is acknowledged one by one.
    built.findings.filter(f => f.confidence >= .5).forEach((f, n) => lines.push({ id: `finding_${n + 1}`, text: `${t('c_finding')} ${f.text}`, english: `${TEXTS.en.c_finding} ${f.text}`, at: f.kind === 'other_patient' ? null : f.position_mm }))
    const known = info.now ? info.now.known_landmarks : [], lost = known.filter(name => !built.landmarks.some(l => l.name === name || l.name.startsWith(name + '_')))
    const level = make('select', { id: 'difficulty' }, [1, 2, 3, 4, 5].map(n => make('option', { value: String(n), text: String(n) })))
    level.value = String(c.approval ? c.approval.difficulty_level : 3)
    const stale = info.reasons && info.reasons.length > 0
    const approve = button('approve', async () => {
      await tell('approve', { case: page.token, by: who(), difficulty_level: +level.value, checks: lines.map(l => l.english) })
      await again()
    }, { id: 'approve', class: 'main' })
    const again = async () => { await loadLibrary(), await page.reloadInfo(), hint(t('saved')) }
    const judge = () => { approve.disabled = stale || lines.some(l => !ticked.has(l.id)), todo.hidden = stale || !approve.disabled }
    const todo = make('p', { class: 'faint', text: t('tick_all') })
    const list = lines.map(l => make('div', { class: 'row' }, make('label', {}, make('input', { type: 'checkbox', 'data-check': l.id, checked: ticked.has(l.id), change: e => { e.target.checked ? ticked.add(l.id) : ticked.delete(l.id), judge() } }), make('span', { text: l.text })), l.at ? button('go_there', () => page.goWorld(l.at)) : null))
    judge()
    return [
      c.approval ? make('p', { class: c.approval.holds ? 'good' : 'bad', text: c.approval.holds ? `${t('approved')} ${t('by')} ${c.approval.by}, ${t('difficulty')} ${c.approval.difficulty_level}` : t('void_') }) : make('p', { class: 'faint', text: t('unapproved') }),
      stale ? make('p', { class: 'warn', text: t('stale_case') }) : null,
      make('h2', { text: t('checklist') }), list,
      lost.length ? make('p', { class: 'warn', id: 'lost', text: `${t('lost_landmarks')} ${lost.map(label).join(', ')}` }) : null,
      info.now && info.now.cuts_holes && !built.holes.length ? make('p', { class: 'warn', text: t('no_hole_built') }) : null,
      make('div', { class: 'row' }, field('difficulty', level), approve, c.approval ? button('withdraw', async () => { await tell('approve', { case: page.token, by: who(), withdraw: true }); await again() }) : null), todo,
      // Below what is clicked, which must not move when the answer comes.
      make('h2', { text: t('lessons') }), lessons(c),
      info.warnings.length ? [make('h2', { text: t('warnings') }), info.warnings.map(w => warningLine(page, w))] : null
    ].flat(2)
  })
}
