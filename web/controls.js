// Mouse, touch and keys, and the controls of the panel.

function localPoint(viewer, e) {
  const { view } = viewer
  const b = view.getBoundingClientRect()
  return [e.clientX - b.left, e.clientY - b.top]
}

function spread(viewer) {
  const { pointers } = viewer
  const [a, b] = [...pointers.values()]
  return Math.hypot(a[0] - b[0], a[1] - b[1])
}

function clickView(viewer, x, y) {
  const { page, meshes, cam, clip, state, view } = viewer
  const w = view.clientWidth,
    h = view.clientHeight,
    m = cam.matrix(w, h)
  const near =
    state.showMarks &&
    page.marks.find(l => {
      const [a, b] = cam.project(m, w, h, l.p)
      return Math.hypot(a - x, b - y) < 7
    })
  const p = near ? near.p : pick(meshes, clip, cam.ray(x, y, w, h))
  if (p) goTo(viewer, p)
}

function release(viewer, e) {
  const { pointers } = viewer
  if (!pointers.delete(e.pointerId)) return
  viewer.pinch = 0
  if (viewer.moving) {
    viewer.moving = false
    redraw(viewer)
  } else if (e.type === 'pointerup' && e.button === 0 && viewer.travelled < 4) clickView(viewer, ...localPoint(viewer, e))
}

function turn(viewer, az, el) {
  const { cam } = viewer
  cam.az += az
  cam.el = Math.max(-1.55, Math.min(1.55, cam.el + el))
  redraw(viewer)
}

function zoom(viewer, factor) {
  const { radius, cam } = viewer
  cam.dist = Math.max(radius * 0.05, Math.min(radius * 40, cam.dist * factor))
  redraw(viewer)
}

function lookFrom(viewer, name) {
  const { cam, sides } = viewer
  if (name === 'home') cam.reset()
  else [cam.az, cam.el] = sides[name]
  redraw(viewer)
}

const listen = (id, event, f) => $(id).addEventListener(event, f)
const hexOf = rgb =>
  '#' +
  rgb
    .map(c =>
      Math.round(255 * c)
        .toString(16)
        .padStart(2, '0')
    )
    .join('')

function setScale(viewer, mm) {
  viewer.scale = mm
  $('scale').value = mm
  $('bar-name').textContent = viewer.heat ? 'deviation of ' + label(viewer.heat.name) : ''
  $('bar-low').textContent = '−' + mm.toFixed(2)
  $('bar-high').textContent = '+' + mm.toFixed(2) + ' mm'
}

// Keys go to what lies under the mouse, unless something is typed or chosen elsewhere.
function takeKeys(element) {
  element.addEventListener('pointerenter', e => {
    if (e.pointerType === 'mouse' && !document.activeElement.matches('input,select')) element.focus({ preventScroll: true })
  })
}

// The view: mouse, touch, keys.
function listenToView(viewer) {
  const { meshes, cam, view, solid, pointers } = viewer
  view.addEventListener('pointerdown', e => {
    if (e.target !== solid) return
    view.setPointerCapture(e.pointerId)
    pointers.set(e.pointerId, [e.clientX, e.clientY])
    viewer.travelled = pointers.size === 1 ? 0 : 99
    viewer.pinch = pointers.size === 2 ? spread(viewer) : 0
    view.focus()
  })
  view.addEventListener('pointermove', e => {
    const old = pointers.get(e.pointerId)
    if (!old) return
    const dx = e.clientX - old[0],
      dy = e.clientY - old[1],
      mm = cam.mmPerPixel(view.clientWidth, view.clientHeight)
    pointers.set(e.pointerId, [e.clientX, e.clientY])
    viewer.travelled += Math.abs(dx) + Math.abs(dy)
    if (viewer.travelled < 4) return
    viewer.moving = true
    if (pointers.size === 2) {
      const d = spread(viewer)
      if (viewer.pinch && d) cam.dist *= viewer.pinch / d
      viewer.pinch = d
      cam.pan[0] += (dx * mm) / 2
      cam.pan[1] -= (dy * mm) / 2
    } else if (e.buttons & 2) zoom(viewer, Math.exp(dy / 150))
    else if (e.shiftKey || e.buttons & 4) {
      cam.pan[0] += dx * mm
      cam.pan[1] -= dy * mm
    } else turn(viewer, -dx * 0.008, dy * 0.008)
    redraw(viewer)
  })
  view.addEventListener('pointerup', e => release(viewer, e))
  view.addEventListener('pointercancel', e => release(viewer, e))
  view.addEventListener('contextmenu', e => e.preventDefault())
  takeKeys(view)
  view.addEventListener(
    'wheel',
    e => {
      e.preventDefault()
      zoom(viewer, Math.exp(Math.sign(e.deltaY) * 0.08))
    },
    { passive: false }
  )
  const sides = { a: [0, 0], p: [Math.PI, 0], l: [Math.PI / 2, 0], r: [-Math.PI / 2, 0], s: [0, 1.55], i: [0, -1.55] }
  viewer.sides = sides
  for (const b of document.querySelectorAll('#views button')) b.addEventListener('click', () => lookFrom(viewer, b.dataset.view))
  const keys = {
    arrowleft: () => turn(viewer, 0.1, 0),
    arrowright: () => turn(viewer, -0.1, 0),
    arrowup: () => turn(viewer, 0, 0.1),
    arrowdown: () => turn(viewer, 0, -0.1),
    '+': () => zoom(viewer, 0.9),
    '-': () => zoom(viewer, 1 / 0.9),
    0: () => lookFrom(viewer, 'home')
  }
  addEventListener('keydown', e => {
    if (e.target.matches('input,select,canvas.slice,button,tr') || e.ctrlKey || e.metaKey || e.altKey) return
    const k = e.key.toLowerCase(),
      n = +k
    if (sides[k]) lookFrom(viewer, k)
    else if (keys[k]) keys[k]()
    else if (n && meshes[n - 1]) meshes[n - 1].box.click()
    else return
    e.preventDefault()
  })
}

// A click sets the cross-hair, a drag scrolls or measures, the wheel scrolls, a right drag zooms or sets the window, shift and
// drag moves.
function listenToSlices(viewer) {
  const { volume, at, state, window_ } = viewer
  for (const p of planes) {
    const canvas = $(p.id),
      spacing = volume ? volume.spacing[p.axis] : 1
    let from = null
    const placeAt = (x, y) => {
      const b = canvas.getBoundingClientRect()
      return p.back(x - b.left, y - b.top)
    }
    const step = n => {
      const q = [...at],
        [low, high] = state.reach[p.axis]
      q[p.axis] = Math.max(low, Math.min(high, q[p.axis] + n * spacing))
      goTo(viewer, q)
    }
    canvas.addEventListener('pointerdown', e => {
      canvas.setPointerCapture(e.pointerId)
      from = { x: e.clientX, y: e.clientY, moved: false, rest: 0, window: { ...window_ }, zoom: p.zoom, pan: [...p.pan] }
    })
    canvas.addEventListener('pointermove', e => {
      if (!from) return
      const dx = e.clientX - from.x,
        dy = e.clientY - from.y
      if (!from.moved && Math.hypot(dx, dy) < 4) return
      from.moved = true
      if (e.buttons & 2 && $('right-drag').value === 'zoom') p.zoom = Math.max(1, Math.min(30, from.zoom * Math.exp(-dy / 150)))
      else if (e.buttons & 2) {
        setWindow(viewer, from.window.level - dy, from.window.width + 2 * dx)
        $('window').value = 'free'
      } else if (e.shiftKey || e.buttons & 4) p.pan = [from.pan[0] + dx, from.pan[1] + dy]
      else if ($('measure').checked) {
        if (!from.measure) state.measures.push((from.measure = { plane: p, mm: at[p.axis], from: placeAt(from.x, from.y) }))
        from.measure.to = placeAt(e.clientX, e.clientY)
      } else {
        const n = Math.trunc(-dy / 3) - from.rest
        from.rest += n
        if (n) step(n)
      }
      reslice(viewer)
    })
    canvas.addEventListener('pointerup', e => {
      if (from && !from.moved && e.button === 0) {
        const q = [...at]
        ;[q[p.u], q[p.v]] = placeAt(e.clientX, e.clientY)
        goTo(viewer, q)
      }
      from = null
    })
    canvas.addEventListener('pointercancel', () => {
      from = null
    })
    canvas.addEventListener('contextmenu', e => e.preventDefault())
    takeKeys(canvas)
    canvas.addEventListener(
      'wheel',
      e => {
        e.preventDefault()
        step(e.deltaY > 0 ? -1 : 1)
      },
      { passive: false }
    )
    canvas.addEventListener('keydown', e => {
      const n = { ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5 }[e.key]
      if (n) {
        e.preventDefault()
        step(n)
      }
    })
  }
}

function listSurfaces(viewer) {
  const { meshes } = viewer
  meshes.forEach((m, i) => {
    const row = make('div', 'row'),
      on = (m.box = make('input')),
      colour = make('input'),
      opacity = make('input'),
      name = make('label', '', `${i + 1} ${label(m.name)}`)
    on.type = 'checkbox'
    on.checked = true
    on.id = 'on-' + i
    name.htmlFor = on.id
    on.addEventListener('change', () => {
      m.visible = on.checked
      redrawAll(viewer)
    })
    colour.type = 'color'
    colour.value = hexOf(m.rgb)
    colour.id = 'colour-' + i
    colour.setAttribute('aria-label', 'colour of ' + label(m.name))
    colour.addEventListener('input', () => {
      m.rgb = [1, 3, 5].map(k => parseInt(colour.value.slice(k, k + 2), 16) / 255)
      redrawAll(viewer)
    })
    opacity.type = 'range'
    opacity.min = 0
    opacity.max = 1
    opacity.step = 0.01
    opacity.value = m.opacity
    opacity.id = 'opacity-' + i
    opacity.setAttribute('aria-label', 'opacity of ' + label(m.name))
    opacity.addEventListener('input', () => {
      m.opacity = +opacity.value
      redraw(viewer)
    })
    row.append(on, colour, name, opacity)
    if (m.dev) {
      const b = (m.heatButton = make('button', '', 'deviation'))
      b.type = 'button'
      b.id = 'deviation-' + i
      b.addEventListener('click', () => {
        viewer.heat = viewer.heat === m ? null : m
        for (const x of meshes) if (x.heatButton) x.heatButton.classList.toggle('on', x === viewer.heat)
        $('bar').hidden = !viewer.heat
        if (viewer.heat) m.opacity = opacity.value = 1
        if (viewer.heat) {
          $('scale').max = Math.max(0.05, 2 * m.p99)
          setScale(viewer, Math.max(0.01, m.p99))
        }
        redraw(viewer)
      })
      row.append(b)
    }
    $('anatomies').append(row)
  })
}

function listenToPanel(viewer) {
  const { page, meshes, clip, innermost, at, state } = viewer
  listen('scale', 'input', e => {
    setScale(viewer, +e.target.value)
    redraw(viewer)
  })
  listen('clip', 'change', e => {
    clip.axis = +e.target.value
    clip.mm = at[clip.axis] || 0
    redraw(viewer)
  })
  listen('clip-what', 'change', e => {
    for (const m of meshes) m.clip = !m.tool && (e.target.value === 'all' || m !== innermost)
    redraw(viewer)
  })
  listen('flip', 'click', () => {
    clip.keep *= -1
    redraw(viewer)
  })
  listen('show-marks', 'change', e => {
    state.showMarks = e.target.checked
    redrawAll(viewer)
  })
  listen('show-cuts', 'change', e => {
    state.showCuts = e.target.checked
    reslice(viewer)
  })
  listen('show-felt', 'change', e => {
    state.showFelt = e.target.checked
    reslice(viewer)
  })
  listen('window', 'change', e => {
    if (e.target.value !== 'free') {
      setWindow(viewer, ...e.target.value.split(',').map(Number))
      reslice(viewer)
    }
  })
  for (const id of ['level', 'width'])
    listen(id, 'change', () => {
      $('window').value = 'free'
      setWindow(viewer, +$('level').value, +$('width').value)
      reslice(viewer)
    })
  listenToTheme(() => redraw(viewer))
  const casts = castsOf(viewer.data),
    setCast = () => {
      const chosen = casts.get($('cast').value)
      $('shift').disabled = !!chosen && !!chosen.fixed
      viewer.cast = chosen ? { ...chosen, shift: $('shift').disabled ? 0 : +$('shift').value } : null
      redraw(viewer)
    }
  for (const name of casts.keys()) $('cast').append(make('option', '', name))
  for (const id of ['cast', 'shift']) {
    $(id).disabled = !casts.size || viewer.painter.kind !== 'webgl2'
    listen(id, 'input', setCast)
  }
  listen('fill', 'input', e => {
    fillFelt(viewer, +e.target.value)
    reslice(viewer)
  })
  listen('clear', 'click', () => {
    state.measures.length = 0
    for (const p of planes) Object.assign(p, { zoom: 1, pan: [0, 0] })
    reslice(viewer)
  })
  for (const id of ['window', 'level', 'width']) $(id).disabled = !page.ct
  $('show-felt').disabled = !page.felt || !page.ct
  $('fill').disabled = !page.felt
  $('show-felt').checked = !!page.felt && !page.ct
}
