'use strict'
// What the page of a case and that of a library share.
const $ = id => document.getElementById(id)

const make = (tag, name, text) => {
  const e = document.createElement(tag)
  if (name) e.className = name
  if (text !== undefined) e.textContent = text
  return e
}
