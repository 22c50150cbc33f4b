// Elements, requests, and what every page has: who works, the texts, the size of letters.
const $ = id => document.getElementById(id)

// make('button', { class: 'main', text: 'Save', click: f, disabled: true }, child, ...)
const make = (tag, given = {}, ...children) => {
  const e = document.createElement(tag)
  for (const [key, value] of Object.entries(given)) {
    if (value === undefined || value === null || value === false) continue
    if (key === 'class') e.className = value
    else if (key === 'text') e.textContent = value
    else if (typeof value === 'function') e.addEventListener(key, value)
    else if (key in e && key !== 'list') e[key] = value
    else e.setAttribute(key, value)
  }
  if (tag === 'button') e.type = 'button'
  e.append(...children.flat().filter(c => c !== undefined && c !== null && c !== false))
  return e
}

const desk = { cases: [], plan: new Map(), page: null, stats: {} }
const t = key => TEXTS[key] || '?' + key
const digits = (v, n) =>
  typeof v === 'number' && isFinite(v)
    ? v.toLocaleString('en', { minimumFractionDigits: n, maximumFractionDigits: n })
    : ''
// Whole numbers stay whole.
const figure = v => (typeof v !== 'number' ? String(v) : digits(v, Number.isInteger(v) ? 0 : 2))
const label = name => name.replace(/[_.]/g, ' ')

// ---- the secret of the desk
// It comes behind the # of the address, which no browser sends, and leaves the address before anything else is done. A tab
// keeps it for itself and this port, and every request names it in a header of its own.
let secret = ''
const takeSecret = () => {
  const came = location.hash.match(/^#([0-9a-f]{32})(?:\/(.*))?$/)
  if (came) history.replaceState(null, '', location.pathname + (came[2] ? '#' + came[2] : ''))
  try {
    if (came) sessionStorage.setItem('trephine-desk', came[1])
    secret = sessionStorage.getItem('trephine-desk') || ''
  } catch (e) {
    if (came) secret = came[1]
  }
}
takeSecret()
const withSecret = (headers = {}) => ({ 'Trephine-Desk': secret, ...headers })

// ---- requests
class Refused extends Error {}
class Superseded extends Refused {}
async function answered(request) {
  let reply
  try {
    reply = await request
  } catch (e) {
    throw new Refused(
      'The desk does not answer: is `trephine desk` still running? What was painted is kept where it was saved last.'
    )
  }
  if (reply.ok) return reply
  const text = await reply.text()
  if (reply.status === 404 && text === 'not found\n') throw new Refused(t('no_secret'))
  let said
  try {
    said = JSON.parse(text).error
  } catch (e) {
    said = `${reply.status} ${text}`
  }
  throw new Refused(said)
}
const ask = (path, query = {}, signal = undefined) =>
  answered(fetch('api/' + path + '?' + new URLSearchParams(query), { headers: withSecret(), signal }))
const askJson = async (path, query, signal) => (await ask(path, query, signal)).json()
const askBytes = async (path, query) => (await ask(path, query)).arrayBuffer()
const askPng = async (path, query) => URL.createObjectURL(new Blob([await askBytes(path, query)], { type: 'image/png' }))
const tell = async (path, body) =>
  (
    await answered(
      fetch('api/' + path, {
        method: 'POST',
        headers: withSecret({ 'Content-Type': 'application/json' }),
        body: JSON.stringify(body)
      })
    )
  ).json()
const tellForBytes = async (path, query, body) =>
  (
    await answered(
      fetch('api/' + path + '?' + new URLSearchParams(query), {
        method: 'POST',
        headers: withSecret({ 'Content-Type': 'application/octet-stream' }),
        body
      })
    )
  ).arrayBuffer()
const tellBytes = async (path, query, body) => JSON.parse(new TextDecoder().decode(await tellForBytes(path, query, body)))

// ---- what went wrong, and what went well
const problem = text => {
  $('problem').hidden = !text
  $('problem-text').textContent = text || ''
}
let hinted = 0
const hint = text => {
  $('hint').textContent = text
  $('hint').hidden = false
  clearTimeout(hinted)
  hinted = setTimeout(() => {
    $('hint').hidden = true
  }, 3500)
}
// Runs what a button does; it cannot be pressed twice meanwhile, and what it throws is told. What is told stays until a person
// does something again: a page that asks by itself how far a build is takes nothing away.
const doing =
  (f, ...given) =>
  async event => {
    const button = event && event.currentTarget
    if (button && 'disabled' in button) button.disabled = true
    try {
      if (event) problem('')
      await f(event, ...given)
    } catch (e) {
      problem(e instanceof Refused ? e.message : String((e && e.stack) || e))
    } finally {
      if (button && 'disabled' in button) button.disabled = false
    }
  }
const button = (key, f, given = {}) => make('button', { text: t(key), click: doing(f), ...given })

const isToken = text => /^[a-z0-9_-]{1,32}$/.test(text)
// A name that somebody types all the same is neither kept nor sent, and the field says so at once.
function judgeWho() {
  const said = $('who').value.trim(),
    fine = !said || isToken(said)
  $('who').setAttribute('aria-invalid', String(!fine))
  $('who').title = fine ? '' : t('need_who')
  if (fine) keep('who', said)
}
const who = () => {
  const token = $('who').value.trim()
  if (!isToken(token)) {
    $('who').focus()
    throw new Refused(t('need_who'))
  }
  return token
}

// ---- what a browser keeps of the desk; a browser that keeps nothing works all the same
const keep = (key, value) => {
  try {
    localStorage.setItem('trephine-' + key, value)
  } catch (e) {}
}
const kept = key => {
  try {
    return localStorage.getItem('trephine-' + key) || ''
  } catch (e) {
    return ''
  }
}

const words = () => {
  for (const e of document.querySelectorAll('[data-text]')) e.textContent = t(e.dataset.text)
  $('theme').textContent = t(document.documentElement.classList.contains('light') ? 'dark' : 'light')
}

// What panels are made of.
const heading = key => make('h2', { text: t(key) })
const para = (kind, text) => make('p', { class: kind, text })
const faint = text => make('span', { class: 'faint', text })
const inRow = (...children) => make('div', { class: 'row' }, ...children)
const tick = (text, given) => make('label', {}, make('input', { type: 'checkbox', ...given }), make('span', { text }))
const field = (key, ...controls) => make('label', {}, make('span', { text: t(key) }), ...controls)
const table = (heads, rows) =>
  make(
    'table',
    {},
    make(
      'tr',
      {},
      heads.map(h => make('th', { text: h[0], class: h[1] ? 'number' : '' }))
    ),
    rows
  )
