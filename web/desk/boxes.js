// Regions of interest by mouse: a box in mm, LPS, that a stage of the recipe looks into alone. It is two lines of the case's
// configuration, its lower and its upper corner.

const valueRows = page => (page.info && page.info.now ? page.info.now.values : [])
const valueRow = (page, path) => valueRows(page).find(v => v.path === path)
const regionAnatomies = page =>
  valueRows(page)
    .filter(
      v => v.path.endsWith('_min_mm') && valueRow(page, v.path.replace(/_min_mm$/, '_max_mm')) && numbersOf(v.value).length === 3
    )
    .map(v => v.path.replace(/_min_mm$/, ''))
const numbersOf = text => (text.match(/-?[\d.]+(e[+-]?\d+)?/g) || []).map(Number)

function savedBox(page, name) {
  const [low, high] = ['_min_mm', '_max_mm'].map(end => numbersOf(valueRow(page, name + end).value))
  return { low, high }
}

function chooseRegion(page, name) {
  const { region } = page
  region.of = name
  region.box = name ? savedBox(page, name) : null
  page.redraw()
}

function hasBounds(page) {
  const { region } = page
  const { far } = region
  return region.box && [...region.box.low, ...region.box.high].some(v => Math.abs(v) < far)
}

const boxText = v => `[${v.map(x => Math.round(x * 10) / 10).join(', ')}]`

function boxLines(page, b) {
  const { region } = page
  return [
    { path: region.of + '_min_mm', value: boxText(b.low) },
    { path: region.of + '_max_mm', value: boxText(b.high) }
  ]
}

function givenBox(page) {
  const { region } = page
  return [region.of + '_min_mm', region.of + '_max_mm'].map(path => ({
    path,
    value: valueRow(page, path).source === 'set' ? valueRow(page, path).value : null
  }))
}

function tellRegion(page) {
  const { region } = page
  const { far } = region
  const ends = a => [region.box.low[a], region.box.high[a]].map(v => (Math.abs(v) < far ? v.toFixed(1) : '∞')).join(' … ')
  if ($('region'))
    $('region').textContent = !region.of
      ? t('region_first')
      : hasBounds(page)
        ? [0, 1, 2].map(a => `${'LPS'[a]} ${ends(a)}`).join(' · ') + ' mm'
        : t('region_none')
}

function regionControls(page, fixed) {
  const { region } = page
  const all = regionAnatomies(page)
  if (!all.includes(region.of)) {
    region.of = ''
    region.box = null
  }
  const select = make(
    'select',
    {
      id: 'region-of',
      change: e => {
        chooseRegion(page, e.target.value)
        page.show_('place')
      }
    },
    make('option', { value: '', text: '–' }),
    all.map(n =>
      make('option', {
        value: n,
        text: n
          .replace(/_?roi$/, '')
          .replace(/\.$/, '')
          .replace(/[_.]/g, ' ')
      })
    )
  )
  select.value = region.of
  setTimeout(() => tellRegion(page), 0)
  const set = async () => {
    await page.change('value', { values: givenBox(page) }, { values: boxLines(page, region.box) })
    chooseRegion(page, region.of)
    page.show_('place')
  }
  const whole = async () => {
    await page.change('value', { values: givenBox(page) }, { values: givenBox(page).map(v => ({ ...v, value: null })) })
    chooseRegion(page, region.of)
    page.show_('place')
  }
  return [
    heading('regions'),
    para('faint', t('regions_how')),
    inRow(field('region_of', select)),
    make('p', { id: 'region', class: 'faint' }),
    region.of
      ? inRow(
          button(
            'preview',
            () =>
              page.previewValues(
                boxLines(page, region.box),
                page.fields.find(f => region.of.startsWith(f + '.')),
                `${region.of} = ${boxText(region.box.low)} … ${boxText(region.box.high)}`
              ),
            { disabled: !page.fields.some(f => region.of.startsWith(f + '.')), id: 'region-preview' }
          ),
          button('set', set, { id: 'region-set', class: 'main', disabled: !!fixed || !hasBounds(page) }),
          button('unset', whole, { id: 'region-whole', disabled: !!fixed })
        )
      : null
  ]
}

function drawRegion(page, p, c) {
  const { region } = page
  const { far } = region
  if (!region.box || !hasBounds(page)) return
  const here = page.volume.toWorld(page.at)[p.patient]
  if (here < region.box.low[p.patient] || here > region.box.high[p.patient]) return
  const [a, b] = [0, 1, 2].filter(k => k !== p.patient),
    corners = [
      [0, 0],
      [1, 0],
      [1, 1],
      [0, 1]
    ].map(([x, y]) => {
      const w = page.volume.toWorld(page.at)
      w[a] = Math.max(-far, Math.min(far, (x ? region.box.high : region.box.low)[a]))
      w[b] = Math.max(-far, Math.min(far, (y ? region.box.high : region.box.low)[b]))
      const at = page.volume.toIndex(w)
      return [p.X(at[p.u]), p.Y(at[p.v])]
    })
  c.strokeStyle = '#f0c45c'
  c.lineWidth = 1.6 * p.r
  c.setLineDash([8 * p.r, 4 * p.r])
  c.beginPath()
  corners.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)))
  c.closePath()
  c.stroke()
  c.setLineDash([])
}

function boxesOf(page) {
  const region = (page.region = { far: 1e5, of: '', box: null })
  let drag = null
  page.tools.region = {
    key: 'i',
    draws: true,
    down: (p, at) => {
      if (page.tab !== 'place') page.show_('place')
      if (!region.of) throw new Refused(t('region_first'))
      drag = { p, from: page.volume.toWorld(at), low: [...region.box.low], high: [...region.box.high] }
    },
    // The two axes of the plane; along the third one the box stays as it is.
    move: (p, at) => {
      if (!drag || drag.p !== p) return
      const w = page.volume.toWorld(at)
      for (const a of [0, 1, 2])
        if (a !== p.patient) {
          region.box.low[a] = Math.min(drag.from[a], w[a])
          region.box.high[a] = Math.max(drag.from[a], w[a])
        }
      page.redraw()
      tellRegion(page)
    },
    up: p => {
      const was = drag
      drag = null
      if (was && [0, 1, 2].some(a => a !== p.patient && region.box.high[a] - region.box.low[a] < 1))
        region.box = { low: was.low, high: was.high }
      page.redraw()
      page.show_('place')
    }
  }
  page.overlays.push((p, c) => drawRegion(page, p, c))
  return { panel: fixed => regionControls(page, fixed) }
}
