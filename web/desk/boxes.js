// Part 8b: regions of interest by mouse: a box in mm, LPS, that a stage of the recipe looks into alone. It is two lines of the case's
// configuration, its lower and its upper corner.
function boxesOf(page) {
  const far = 1e5  // the recipes say a million where they mean no bound
  let of = '', box = null, drag = null
  const rows = () => page.info && page.info.now ? page.info.now.values : []
  const row = path => rows().find(v => v.path === path)
  const names = () => rows().filter(v => v.path.endsWith('_min_mm') && row(v.path.replace(/_min_mm$/, '_max_mm')) && numbers(v.value).length === 3).map(v => v.path.replace(/_min_mm$/, ''))
  const numbers = text => (text.match(/-?[\d.]+(e[+-]?\d+)?/g) || []).map(Number)
  const saved = name => { const [low, high] = ['_min_mm', '_max_mm'].map(end => numbers(row(name + end).value)); return { low, high } }
  const choose = name => { of = name, box = name ? saved(name) : null, page.redraw() }
  const bounded = () => box && [...box.low, ...box.high].some(v => Math.abs(v) < far)
  const text = v => `[${v.map(x => Math.round(x * 10) / 10).join(', ')}]`
  const lines = b => [{ path: of + '_min_mm', value: text(b.low) }, { path: of + '_max_mm', value: text(b.high) }]
  const given = () => [of + '_min_mm', of + '_max_mm'].map(path => ({ path, value: row(path).source === 'set' ? row(path).value : null }))

  page.tools.region = {
    key: 'i', draws: true,
    down: (p, at) => {
      if (page.tab !== 'place') page.show_('place')
      if (!of) throw new Refused(t('region_first'))
      drag = { p, from: page.volume.toWorld(at), low: [...box.low], high: [...box.high] }
    },
    // The two axes of the plane; along the third one the box stays as it is.
    move: (p, at) => {
      if (!drag || drag.p !== p) return
      const w = page.volume.toWorld(at)
      for (const a of [0, 1, 2]) if (a !== p.patient) box.low[a] = Math.min(drag.from[a], w[a]), box.high[a] = Math.max(drag.from[a], w[a])
      page.redraw()
      tell_()
    },
    up: p => {
      const was = drag
      drag = null
      if (was && [0, 1, 2].some(a => a !== p.patient && box.high[a] - box.low[a] < 1)) box = { low: was.low, high: was.high }
      page.redraw()
      page.show_('place')
    }
  }
  page.overlays.push((p, c) => {
    if (!box || !bounded()) return
    const here = page.volume.toWorld(page.at)[p.patient]
    if (here < box.low[p.patient] || here > box.high[p.patient]) return
    const [a, b] = [0, 1, 2].filter(k => k !== p.patient), corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([x, y]) => {
      const w = page.volume.toWorld(page.at)
      w[a] = Math.max(-far, Math.min(far, (x ? box.high : box.low)[a])), w[b] = Math.max(-far, Math.min(far, (y ? box.high : box.low)[b]))
      const at = page.volume.toIndex(w)
      return [p.X(at[p.u]), p.Y(at[p.v])]
    })
    c.strokeStyle = '#f0c45c', c.lineWidth = 1.6 * p.r
    c.setLineDash([8 * p.r, 4 * p.r])
    c.beginPath(), corners.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y)), c.closePath(), c.stroke()
    c.setLineDash([])
  })
  const tell_ = () => {
    if ($('region')) $('region').textContent = !of ? t('region_first') : bounded() ? [0, 1, 2].map(a => `${'LPS'[a]} ${[box.low[a], box.high[a]].map(v => Math.abs(v) < far ? v.toFixed(1) : '∞').join(' … ')}`).join(' · ') + ' mm' : t('region_none')
  }
  const panel = fixed => {
    const all = names()
    if (!all.includes(of)) of = '', box = null
    const select = make('select', { id: 'region-of', change: e => { choose(e.target.value), page.show_('place') } }, make('option', { value: '', text: '–' }), all.map(n => make('option', { value: n, text: n.replace(/_?roi$/, '').replace(/\.$/, '').replace(/[_.]/g, ' ') })))
    select.value = of
    setTimeout(tell_, 0)
    const set = async () => { await page.change('value', { values: given() }, { values: lines(box) }); choose(of), page.show_('place') }
    const whole = async () => { await page.change('value', { values: given() }, { values: given().map(v => ({ ...v, value: null })) }); choose(of), page.show_('place') }
    return [make('h2', { text: t('regions') }), make('p', { class: 'faint', text: t('regions_how') }), make('div', { class: 'row' }, field('region_of', select)), make('p', { id: 'region', class: 'faint' }),
      of ? make('div', { class: 'row' }, button('preview', () => page.previewValues(lines(box), page.fields.find(f => of.startsWith(f + '.')), `${of} = ${text(box.low)} … ${text(box.high)}`), { disabled: !page.fields.some(f => of.startsWith(f + '.')), id: 'region-preview' }), button('set', set, { id: 'region-set', class: 'main', disabled: !!fixed || !bounded() }), button('unset', whole, { id: 'region-whole', disabled: !!fixed })) : null]
  }
  return { panel }
}
