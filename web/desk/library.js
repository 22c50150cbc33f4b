// The library: its cases as cards, what would be rebuilt and why, builds.

function filterChoice(page, key, options) {
  const { shown } = page.browse
  const s = make(
    'select',
    {
      change: () => {
        shown[key] = s.value
        listCards(page)
      }
    },
    options.map(([value, text]) => make('option', { value, text }))
  )
  s.value = shown[key]
  s.id = 'by-' + key
  return s
}

function libraryControls(page) {
  const { count, search, states, top } = page.browse
  const classes = [...new Set(desk.cases.map(c => c.class).filter(c => c))].sort()
  const can = desk.config
  top.replaceChildren(
    field('find', search),
    field('class_', filterChoice(page, 'class_', [['', t('all')], ...classes.map(c => [c, c])])),
    field('state', filterChoice(page, 'state', [['', t('all')], ...states.map(s => [s, t(s)])])),
    field(
      'sort',
      filterChoice(
        page,
        'sort',
        ['name', 'age', 'warnings'].map(k => [k, t(k)])
      )
    ),
    count,
    make('span', { class: 'grow' }),
    can
      ? button(
          'newcase',
          () => {
            location.hash = 'new'
          },
          { id: 'new' }
        )
      : null,
    button('again', () => loadCards(page)),
    can ? button('build_all', () => buildCases(page, []), { id: 'build', class: 'main' }) : null,
    button('stop', () => tell('stop', {}), { id: 'stop', hidden: true })
  )
  if (!can) top.append(para('warn', t('no_config')))
}

function stateOfCase(c) {
  const plan = desk.plan.get(c.case)
  return {
    stale: !!plan && plan.reasons.length > 0,
    fresh: !!plan && !plan.reasons.length && !plan.fault && !c.last_code,
    failed: !!(c.last_code || c.fault || (plan && plan.fault)),
    approved: !!(c.approval && c.approval.holds),
    unapproved: !(c.approval && c.approval.holds),
    warned: c.warnings.length > 0
  }
}

function caseFits(page, c) {
  const { shown } = page.browse
  const text = [c.case, c.class, c.fault, ...c.warnings].join('\n').toLowerCase()
  return (
    text.includes(shown.find.toLowerCase()) &&
    (!shown.class_ || c.class === shown.class_) &&
    (!shown.state || stateOfCase(c)[shown.state])
  )
}

// A picture is asked for when its card is seen.
const seen = new IntersectionObserver(entries => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue
    seen.unobserve(target)
    askPng('overview', { case: target.dataset.of, name: target.dataset.name }).then(
      address => (target.src = address),
      () => {} // the card says the rest
    )
  }
})

const cardTag = (text, kind) => make('span', { class: 'tag ' + (kind || ''), text })

function caseCard(c) {
  const plan = desk.plan.get(c.case),
    s = stateOfCase(c),
    pair = make('div', { class: 'pair' }),
    text = make('div', { class: 'text' })
  c.pictures.forEach((name, i) => {
    const picture = make('img', { alt: '', class: i ? 'dark' : '', 'data-of': c.case, 'data-name': name })
    picture.addEventListener('load', () => URL.revokeObjectURL(picture.src))
    pair.append(picture)
    seen.observe(picture)
  })
  if (!c.pictures.length) pair.append(make('div', { class: 'none', text: t('built_not') }))
  text.append(
    make('strong', { text: c.case }),
    faint(
      [
        c.class,
        c.anatomies.length ? `${c.anatomies.length} ${t('anatomies')}` : '',
        c.triangles ? `${digits(c.triangles, 0)} ${t('triangles')}` : '',
        c.figures.evans_index_ratio !== undefined ? 'Evans ' + digits(c.figures.evans_index_ratio, 2) : ''
      ]
        .filter(x => x)
        .join(' · ')
    )
  )
  const faults = [c.fault, c.last_code ? `${c.last_code}: ${c.last_reason}` : '', plan && plan.fault].filter(x => x)
  for (const f of new Set(faults)) text.append(make('span', { class: 'bad', text: f }))
  if (plan && plan.reasons.length)
    text.append(
      make('span', { class: 'warn', text: t('why_stale') }),
      make(
        'ul',
        { class: 'faint' },
        plan.reasons.slice(0, 3).map(r => make('li', { text: r })),
        plan.reasons.length > 3 ? make('li', { text: `+ ${plan.reasons.length - 3}` }) : null
      )
    )
  text.append(
    make(
      'div',
      { class: 'foot' },
      s.failed
        ? cardTag(t('failed'), 'bad')
        : s.stale
          ? cardTag(t('stale'), 'warn')
          : s.fresh
            ? cardTag(t('fresh'), 'good')
            : null,
      c.warnings.length ? cardTag(`${t('warning_count')} ${c.warnings.length}`, c.wrong_count ? 'bad' : 'warn') : null,
      c.approval
        ? cardTag(
            c.approval.holds ? `${t('approved')} ${t('by')} ${c.approval.by}` : t('void_'),
            c.approval.holds ? 'good' : 'bad'
          )
        : cardTag(t('unapproved'))
    )
  )
  return make(
    'button',
    {
      class: 'card',
      'data-case': c.case,
      click: () => {
        location.hash = 'case/' + c.case
      }
    },
    pair,
    text
  )
}

function allCards() {
  const known = new Set(desk.cases.map(c => c.case))
  const planned = [...desk.plan.values()]
    .filter(p => !known.has(p.case))
    .map(p => ({
      case: p.case,
      class: '',
      fault: '',
      warnings: [],
      pictures: [],
      anatomies: [],
      figures: {},
      approval: null,
      last_code: 0,
      age_s: -1
    }))
  return [...desk.cases, ...planned]
}

function listCards(page) {
  const { shown, cards, count } = page.browse
  keep('list', JSON.stringify(shown))
  const cases = allCards().filter(c => caseFits(page, c)),
    by = { name: c => c.case, age: c => c.age_s, warnings: c => -c.warnings.length }[shown.sort] || (c => c.case)
  cases.sort((a, b) => (by(a) < by(b) ? -1 : by(a) > by(b) ? 1 : a.case < b.case ? -1 : 1))
  count.textContent = `${cases.length} ${t('of')} ${allCards().length} ${t('cases')}`
  cards.replaceChildren(
    ...(cases.length ? cases.map(caseCard) : [para('faint', allCards().length ? t('none_fits') : t('empty_library'))])
  )
}

async function loadCards(page) {
  await loadLibrary()
  libraryControls(page)
  listCards(page)
}

async function buildCases(page, only) {
  await tell('build', { only })
  watchBuild(page)
}

async function watchBuild(page) {
  const { jobs, log } = page.browse
  clearTimeout(page.timer)
  const s = await askJson('status')
  const was = page.building
  page.building = s.running
  page.ended = s.ever && !s.running ? s.code : null
  if ($('stop')) {
    $('stop').hidden = !s.running
    $('build') && ($('build').disabled = s.running)
  }
  $('busy').textContent = s.running ? (s.stopping ? t('stopping') : t('working')) + ' ' + digits(s.seconds, 0) + ' s' : ''
  jobs.replaceChildren(
    ...s.at_work.map(j => make('div', { class: 'job' }, make('span', { text: j.case }), faint(progressOf(j) || '…')))
  )
  log.hidden = !s.ever
  log.textContent = s.lines.join('\n') + (s.ever && !s.running ? `\n${endOf(s)}` : '')
  log.scrollTop = log.scrollHeight
  if (was && !s.running) await loadCards(page)
  if (s.running && desk.page === page)
    page.timer = setTimeout(
      doing(() => watchBuild(page)),
      500
    )
}

async function showLibrary(page) {
  const { cards, jobs, log, top } = page.browse
  $('title').textContent = desk.name || 'Trephine'
  $('page').replaceChildren(top, jobs, make('div', { class: 'scroll' }, cards), log)
  libraryControls(page)
  listCards(page)
  await loadCards(page)
  await watchBuild(page)
}

function libraryPage() {
  const page = { name: 'library', building: false, timer: 0 }
  const browse = (page.browse = {
    shown: { find: '', class_: '', state: '', sort: 'name' },
    states: ['stale', 'fresh', 'failed', 'approved', 'unapproved', 'warned']
  })
  const { shown } = browse
  try {
    Object.assign(shown, JSON.parse(kept('list') || '{}'))
  } catch (e) {}
  const cards = make('div', { class: 'cards' }),
    count = make('span', { class: 'faint' }),
    jobs = make('div'),
    log = make('pre', { id: 'log', hidden: true })
  Object.assign(browse, { cards, count, jobs, log })
  const search = make('input', {
    type: 'search',
    id: 'find',
    value: shown.find,
    input: e => {
      shown.find = e.target.value
      listCards(page)
    }
  })
  const top = make('div', { class: 'bar' })
  Object.assign(browse, { search, top })
  page.leave = () => clearTimeout(page.timer)
  page.show = () => showLibrary(page)
  return page
}

async function loadLibrary() {
  const data = await askJson('library')
  desk.cases = data.cases
  desk.name = data.name
  desk.config = data.config
  desk.plan = new Map()
  if (desk.config) for (const p of (await askJson('plan')).cases) desk.plan.set(p.case, p)
}
