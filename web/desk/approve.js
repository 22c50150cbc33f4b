// Part 10: approval, after what a case of this recipe has was looked at.
function approvePanel(page) {
  const ticked = new Set()
  page.addPanel('approve', () => {
    const c = desk.cases.find(c => c.case === page.token), info = page.info || {}, built = info.built
    if (!built || !c) return [make('p', { class: 'warn', text: t('not_built') })]
    const has = name => c.anatomies.some(a => a.name.includes(name))
    const lines = ['c_surfaces', has('skin') && 'c_skin', has('ventricle') && 'c_ventricles', built.landmarks.length && 'c_landmarks', built.holes.length && 'c_holes', has('skin') && 'c_face', info.warnings.length && 'c_warnings'].filter(x => x)
    const level = make('select', { id: 'difficulty' }, [1, 2, 3, 4, 5].map(n => make('option', { value: String(n), text: String(n) })))
    level.value = String(c.approval ? c.approval.difficulty_level : 3)
    const stale = info.reasons && info.reasons.length > 0
    const approve = button('approve', async () => {
      await tell('approve', { case: page.token, by: who(), difficulty_level: +level.value, checks: lines.map(l => TEXTS.en[l]) })
      await again()
    }, { id: 'approve', class: 'main' })
    const again = async () => { await loadLibrary(), await page.reloadInfo(), hint(t('saved')) }
    const judge = () => { approve.disabled = stale || lines.some(l => !ticked.has(l)), todo.hidden = stale || !approve.disabled }
    const todo = make('p', { class: 'faint', text: t('tick_all') })
    const list = lines.map(l => make('div', { class: 'row' }, make('label', {}, make('input', { type: 'checkbox', 'data-check': l, checked: ticked.has(l), change: e => { e.target.checked ? ticked.add(l) : ticked.delete(l), judge() } }), make('span', { text: t(l) }))))
    judge()
    return [
      c.approval ? make('p', { class: c.approval.holds ? 'good' : 'bad', text: c.approval.holds ? `${t('approved')} ${t('by')} ${c.approval.by}, ${t('difficulty')} ${c.approval.difficulty_level}` : t('void_') }) : make('p', { class: 'faint', text: t('unapproved') }),
      stale ? make('p', { class: 'warn', text: t('stale_case') }) : null,
      make('h2', { text: t('checklist') }), list,
      make('div', { class: 'row' }, field('difficulty', level), approve, c.approval ? button('withdraw', async () => { await tell('approve', { case: page.token, by: who(), withdraw: true }); await again() }) : null), todo,
      info.warnings.length ? [make('h2', { text: t('warnings') }), info.warnings.map(w => warningLine(page, w))] : null
    ].flat(2)
  })
}
