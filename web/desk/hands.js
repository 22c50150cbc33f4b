// Part 5b: the mouse, the fingers and the keys on a plane.
function handsOf(page, canvases, step) {
  for (const id of Object.keys(canvases)) {
    const canvas = canvases[id], plane = () => page.volume && page.volume.planes.find(p => p.id === id)
    let drag = null, pinched = null
    const fingers = new Map()
    const pinchOf = () => {
      const [a, b] = [...fingers.values()]
      return { wide: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, way: 0 }
    }
    // Two fingers: apart and together zooms; up and down goes through the slices.
    const pinch = p => {
      if (fingers.size < 2) return
      const now = pinchOf(), was = pinched
      if (Math.abs(now.wide - was.wide) > 3) p.zoom = Math.max(.5, Math.min(30, p.zoom * now.wide / Math.max(1, was.wide))), was.wide = now.wide
      was.way += now.y - was.y
      was.x = now.x, was.y = now.y
      for (; Math.abs(was.way) >= 8; was.way -= Math.sign(was.way) * 8) step(p, was.way > 0 ? 1 : -1)
      page.redraw()
    }
    const point = (p, e) => {
      const b = canvas.getBoundingClientRect(), [u, v] = p.back(e.clientX - b.left, e.clientY - b.top), at = [...page.at]
      at[p.u] = u, at[p.v] = v
      return at
    }
    canvas.addEventListener('pointerdown', e => {
      const p = plane()
      if (!p || !p.drawn) return
      canvas.setPointerCapture(e.pointerId)
      if (e.pointerType === 'touch') {
        fingers.set(e.pointerId, [e.clientX, e.clientY])
        // A second finger: what the first one began is none; both together zoom, move and scroll.
        if (fingers.size === 2) {
          if (drag && drag.how === 'tool' && page.tools[page.tool].stop) page.tools[page.tool].stop()
          drag = null
          pinched = pinchOf()
          return
        }
      }
      if (pinched) return
      canvas.focus()
      e.preventDefault()
      drag = { x: e.clientX, y: e.clientY, window: { ...page.window }, pan: [p.panX, p.panY], how: e.button === 2 ? 'window' : e.button === 1 || e.shiftKey ? 'pan' : 'tool' }
      if (drag.how === 'tool') doing(() => page.tools[page.tool].down(p, point(p, e), e))()
    })
    canvas.addEventListener('pointermove', e => {
      const p = plane()
      if (!p || !p.drawn) return
      const at = point(p, e)
      if (fingers.has(e.pointerId)) fingers.set(e.pointerId, [e.clientX, e.clientY])
      if (pinched) return pinch(p)
      page.pointer = { plane: p, at }
      if (!drag) {
        if (page.tools[page.tool].hover) page.redraw()
      } else if (drag.how === 'window') page.setWindow(drag.window.level + (e.clientY - drag.y) * 2, drag.window.width + (e.clientX - drag.x) * 2)
      else if (drag.how === 'pan') p.panX = drag.pan[0] + e.clientX - drag.x, p.panY = drag.pan[1] + e.clientY - drag.y, page.redraw()
      else if (page.tools[page.tool].move) for (const one of e.getCoalescedEvents ? [...e.getCoalescedEvents(), e] : [e]) page.tools[page.tool].move(p, point(p, one), one)
    })
    const end = e => {
      const p = plane()
      fingers.delete(e.pointerId)
      if (pinched) {
        if (!fingers.size) pinched = null
        return
      }
      if (drag && drag.how === 'tool' && p && page.tools[page.tool].up) doing(() => page.tools[page.tool].up(p, point(p, e), e))()
      drag = null
    }
    canvas.addEventListener('pointerup', end)
    canvas.addEventListener('pointercancel', end)
    canvas.addEventListener('contextmenu', e => e.preventDefault())
    canvas.addEventListener('wheel', e => {
      const p = plane()
      e.preventDefault()
      if (!p) return
      if (!e.ctrlKey) return step(p, e.deltaY > 0 ? -1 : 1)  // forward as Page Up
      p.zoom = Math.max(.5, Math.min(30, p.zoom * (e.deltaY > 0 ? 1 / 1.15 : 1.15)))
      page.redraw()
    }, { passive: false })
    // A tool that draws from here to there takes two: Enter where it begins, arrows, Enter where it ends.
    const byKey = async (p, e) => {
      const tool = page.tools[page.tool], begun = page.begun
      page.begun = null
      if (begun && begun.tool === tool && begun.p === p) return tool.up(p, [...page.at], e)
      await tool.down(p, [...page.at], e)
      if (tool.draws) page.begun = { tool, p }, hint(t('enter_again'))
      else if (tool.up) await tool.up(p, [...page.at], e)
    }
    canvas.addEventListener('keydown', e => {
      const p = plane(), s = e.shiftKey ? 5 : 1
      if (!p || e.ctrlKey || e.metaKey || e.altKey) return
      const move = (axis, flip, n) => { const to = [...page.at]; to[axis] += flip ? -n : n; page.go(to) }
      const keys = { PageUp: () => step(p, s), PageDown: () => step(p, -s), ArrowLeft: () => move(p.u, p.flipU, -s), ArrowRight: () => move(p.u, p.flipU, s), ArrowUp: () => move(p.v, p.flipV, -s), ArrowDown: () => move(p.v, p.flipV, s),
        '+': () => { p.zoom *= 1.15 }, '-': () => { p.zoom = Math.max(.5, p.zoom / 1.15) }, 0: () => { p.zoom = 1, p.panX = p.panY = 0 }, Enter: () => doing(() => byKey(p, e))() }
      if (!keys[e.key]) return
      e.preventDefault()
      keys[e.key]()
      page.redraw()
    })
  }
}
