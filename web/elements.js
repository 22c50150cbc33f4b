'use strict'
// What the page of a case and that of a library share.
const $ = id => document.getElementById(id)

const make = (tag, name, text) => {
  const e = document.createElement(tag)
  if (name) e.className = name
  if (text !== undefined) e.textContent = text
  return e
}

// Light or dark: as the system is, until the button says otherwise.
function listenToTheme(changed) {
  const root = document.documentElement
  const show = light => {
    $('theme').textContent = root.classList.toggle('light', light) ? 'dark' : 'light'
    changed()
  }
  $('theme').addEventListener('click', () => show())
  show(matchMedia('(prefers-color-scheme: light)').matches)
}
