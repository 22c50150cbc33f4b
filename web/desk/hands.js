// The mouse, the fingers and the keys on a plane.
function handsOf(page, canvases, step) {
  for (const id of Object.keys(canvases)) handOn(page, canvases[id], id, step)
}

const zoomWithin = zoom => Math.max(0.5, Math.min(30, zoom))
// Up enlarges, as in 3D Slicer and ITK-SNAP; whoever is used to it sets the window so.
const rightDrag = () => (kept('right-drag') === 'window' ? 'window' : 'zoom')

function planeOf(hand) {
  const { page, id } = hand
  return page.volume && page.volume.planes.find(p => p.id === id)
}

function pinchOf(hand) {
  const { fingers } = hand
  const [a, b] = [...fingers.values()]
  return { wide: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, way: 0 }
}

// Two fingers: apart and together zooms; up and down goes through the slices.
function pinchTo(hand, p) {
  const { page, step, fingers } = hand
  if (fingers.size < 2) return
  const now = pinchOf(hand),
    was = hand.pinched
  if (Math.abs(now.wide - was.wide) > 3) {
    p.zoom = zoomWithin((p.zoom * now.wide) / Math.max(1, was.wide))
    was.wide = now.wide
  }
  was.way += now.y - was.y
  was.x = now.x
  was.y = now.y
  for (; Math.abs(was.way) >= 8; was.way -= Math.sign(was.way) * 8) step(p, was.way > 0 ? 1 : -1)
  page.redraw()
}

function pointOf(hand, p, e) {
  const { page, canvas } = hand
  const b = canvas.getBoundingClientRect(),
    [u, v] = p.back(e.clientX - b.left, e.clientY - b.top),
    at = [...page.at]
  at[p.u] = u
  at[p.v] = v
  return at
}

function endDrag(hand, e) {
  const { page, fingers } = hand
  const p = planeOf(hand)
  fingers.delete(e.pointerId)
  if (hand.pinched) {
    if (!fingers.size) hand.pinched = null
    return
  }
  if (hand.drag && hand.drag.how === 'tool' && p && page.tools[page.tool].up)
    doing(() => page.tools[page.tool].up(p, pointOf(hand, p, e), e))()
  hand.drag = null
}

// Before its scan and its outlines are there a case can be looked at, and nothing is edited.
const isLooking = tool => /^(cross|measure|profile)$/.test(tool)
function needOpen(page) {
  if (!page.isOpen) throw new Refused(t('not_open'))
}

// A tool that draws from here to there takes two: Enter where it begins, arrows, Enter where it ends.
async function actByKey(hand, p, e) {
  const { page } = hand
  if (!isLooking(page.tool)) needOpen(page)
  const tool = page.tools[page.tool],
    begun = page.begun
  page.begun = null
  if (begun && begun.tool === tool && begun.p === p) return tool.up(p, [...page.at], e)
  await tool.down(p, [...page.at], e)
  if (tool.draws) {
    page.begun = { tool, p }
    hint(t('enter_again'))
  } else if (tool.up) await tool.up(p, [...page.at], e)
}

function handOn(page, canvas, id, step) {
  const hand = { page, canvas, id, step, drag: null, pinched: null, fingers: new Map() }
  const { fingers } = hand
  canvas.addEventListener('pointerdown', e => {
    const p = planeOf(hand)
    if (!p || !p.drawn) return
    canvas.setPointerCapture(e.pointerId)
    if (e.pointerType === 'touch') {
      fingers.set(e.pointerId, [e.clientX, e.clientY])
      // A second finger: what the first one began is none; both together zoom, move and scroll.
      if (fingers.size === 2) {
        if (hand.drag && hand.drag.how === 'tool' && page.tools[page.tool].stop) page.tools[page.tool].stop()
        hand.drag = null
        hand.pinched = pinchOf(hand)
        return
      }
    }
    if (hand.pinched) return
    canvas.focus()
    e.preventDefault()
    hand.drag = {
      x: e.clientX,
      y: e.clientY,
      window: { ...page.window },
      pan: [p.panX, p.panY],
      zoom: p.zoom,
      how: e.button === 2 ? rightDrag() : e.button === 1 || e.shiftKey ? 'pan' : 'tool'
    }
    if (hand.drag.how === 'tool')
      doing(() => {
        if (!isLooking(page.tool)) {
          hand.drag = page.isOpen ? hand.drag : null
          needOpen(page)
        }
        return page.tools[page.tool].down(p, pointOf(hand, p, e), e)
      })()
  })
  canvas.addEventListener('pointermove', e => {
    const p = planeOf(hand)
    if (!p || !p.drawn) return
    const at = pointOf(hand, p, e)
    if (fingers.has(e.pointerId)) fingers.set(e.pointerId, [e.clientX, e.clientY])
    if (hand.pinched) return pinchTo(hand, p)
    page.pointer = { plane: p, at }
    if (!hand.drag) {
      if (page.tools[page.tool].hover) page.redraw()
    } else if (hand.drag.how === 'window')
      page.setWindow(
        hand.drag.window.level + (e.clientY - hand.drag.y) * 2,
        hand.drag.window.width + (e.clientX - hand.drag.x) * 2
      )
    else if (hand.drag.how === 'zoom') {
      p.zoom = zoomWithin(hand.drag.zoom * Math.exp((hand.drag.y - e.clientY) / 150))
      page.redraw()
    } else if (hand.drag.how === 'pan') {
      p.panX = hand.drag.pan[0] + e.clientX - hand.drag.x
      p.panY = hand.drag.pan[1] + e.clientY - hand.drag.y
      page.redraw()
    } else if (page.tools[page.tool].move)
      for (const one of e.getCoalescedEvents ? [...e.getCoalescedEvents(), e] : [e])
        page.tools[page.tool].move(p, pointOf(hand, p, one), one)
  })
  // Keys go to the plane under the mouse, unless something is typed or chosen elsewhere.
  canvas.addEventListener('pointerenter', e => {
    if (e.pointerType === 'mouse' && !document.activeElement.matches('input, textarea, select'))
      canvas.focus({ preventScroll: true })
  })
  canvas.addEventListener('pointerup', e => endDrag(hand, e))
  canvas.addEventListener('pointercancel', e => endDrag(hand, e))
  canvas.addEventListener('contextmenu', e => e.preventDefault())
  canvas.addEventListener(
    'wheel',
    e => {
      const p = planeOf(hand)
      e.preventDefault()
      if (!p) return
      if (!e.ctrlKey) return step(p, e.deltaY > 0 ? -1 : 1) // forward as Page Up
      p.zoom = zoomWithin(p.zoom * (e.deltaY > 0 ? 1 / 1.15 : 1.15))
      page.redraw()
    },
    { passive: false }
  )
  canvas.addEventListener('keydown', e => {
    const p = planeOf(hand),
      s = e.shiftKey ? 5 : 1
    if (!p || e.ctrlKey || e.metaKey || e.altKey) return
    const move = (axis, flip, n) => {
      const to = [...page.at]
      to[axis] += flip ? -n : n
      page.go(to)
    }
    const keys = {
      PageUp: () => step(p, s),
      PageDown: () => step(p, -s),
      ArrowLeft: () => move(p.u, p.flipU, -s),
      ArrowRight: () => move(p.u, p.flipU, s),
      ArrowUp: () => move(p.v, p.flipV, -s),
      ArrowDown: () => move(p.v, p.flipV, s),
      '+': () => {
        p.zoom = zoomWithin(p.zoom * 1.15)
      },
      '-': () => {
        p.zoom = zoomWithin(p.zoom / 1.15)
      },
      0: () => {
        p.zoom = 1
        p.panX = p.panY = 0
      },
      Enter: () => doing(() => actByKey(hand, p, e))()
    }
    if (!keys[e.key]) return
    e.preventDefault()
    keys[e.key]()
    page.redraw()
  })
}
