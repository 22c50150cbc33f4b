// Part 9: correcting by brush. What is painted is a byte a voxel of the scan: 1 added, 2 removed. It stays in the page, and as a
// draft on the desk, until it is saved as a patch of the case.
function paintPanel(page) {
  const brush = { radius: 3, ball: false, within: false, low: 226, high: 3071, grow: 15, plane: 'axial' }
  let anatomy = '', bytes = null, count = [0, 0], stroke = null, keeping = 0, restored = false
  const box = { low: [1e9, 1e9, 1e9], high: [-1, -1, -1] }, done = [], undone = []
  const choices = () => page.info && page.info.now ? page.info.now.anatomies.filter(a => a.field && page.fields.includes(a.name)) : []
  const ready = () => {
    if (!anatomy) throw page.show_('paint'), new Refused(t('no_field'))
    if (!bytes) bytes = new Uint8Array(page.volume.count)
  }
  const write = (n, value, at) => {
    const old = bytes[n]
    if (old === value) return
    if (stroke && !stroke.has(n)) stroke.set(n, old)
    bytes[n] = value
    if (old) --count[old - 1]
    if (value) {
      ++count[value - 1]
      for (let a = 0; a < 3; ++a) box.low[a] = Math.min(box.low[a], at[a]), box.high[a] = Math.max(box.high[a], at[a])
    }
  }
  const placeOf = n => [n % page.volume.size[0], Math.floor(n / page.volume.size[0]) % page.volume.size[1], Math.floor(n / page.volume.size[0] / page.volume.size[1])]
  const huAt = (p, data, at) => { const [lo, hi] = p.u < p.v ? [p.u, p.v] : [p.v, p.u]; return data[at[hi] * page.volume.size[lo] + at[lo]] }
  // The HU that the configuration says of an anatomy, where one of its steps has such values; the last step counts.
  page.rangeOf = name => {
    const said = end => page.info && page.info.now ? page.info.now.values.filter(v => v.path.startsWith(name + '.') && v.path.endsWith('.' + end)).map(v => +v.value).filter(isFinite).pop() : undefined
    const low = said('lower_hu'), high = said('upper_hu')
    return low === undefined && high === undefined ? null : [low === undefined ? -1024 : low, high === undefined ? 3071 : high]
  }
  const usualRange = () => {
    const usual = brush.own ? null : page.rangeOf(anatomy)
    if (usual) [brush.low, brush.high] = usual
  }
  const inRange = hu => hu >= brush.low && hu <= brush.high

  // A disc in the plane, or a ball; voxel centres within the radius, and always the one that is pointed at.
  const dab = ({ p, centre, value }) => {
    const { volume } = page, { size, spacing } = volume, c = centre.map(Math.round)
    const reach = [0, 1, 2].map(a => a === p.n && !brush.ball ? 0 : Math.floor(brush.radius / spacing[a])), at = [0, 0, 0], lo = [], hi = []
    for (let a = 0; a < 3; ++a) lo[a] = Math.max(0, c[a] - reach[a]), hi[a] = Math.min(size[a] - 1, c[a] + reach[a])
    for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2]) for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1]) for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) {
      let d = 0
      for (let a = 0; a < 3; ++a) d += ((at[a] - (a === p.n && !brush.ball ? c[a] : centre[a])) * spacing[a]) ** 2
      if (d > brush.radius ** 2 && (at[0] !== c[0] || at[1] !== c[1] || at[2] !== c[2])) continue
      if (brush.within && value && !inRange(huAt(p, volume.has(p.n, at[p.n]), at))) continue
      write(volume.at(...at), value, at)
    }
  }
  // A ball in a range of HU reaches into slices that were not fetched yet: dabs wait for them, in their order.
  const waiting = []
  let fetching = false, over = true
  const slicesOf = ({ p, centre, value }) => {
    const reach = brush.ball ? Math.floor(brush.radius / page.volume.spacing[p.n]) : 0, c = Math.round(centre[p.n]), all = []
    if (brush.within && value) for (let i = Math.max(0, c - reach); i <= Math.min(page.volume.size[p.n] - 1, c + reach); ++i) if (!page.volume.has(p.n, i)) all.push(page.volume.slice(p.n, i))
    return all
  }
  const paintWaiting = async () => {
    if (fetching) return
    while (waiting.length) {
      const missing = slicesOf(waiting[0])
      if (missing.length) {
        fetching = true
        try { await Promise.all(missing) } catch (e) { waiting.length = 0, problem(e.message) } finally { fetching = false }
        continue
      }
      dab(waiting.shift())
    }
    page.redraw()
    if (over) finish()
  }
  const painter = (key, value) => {
    let last = null
    return {
      key, hover: true,
      down: (p, at) => {
        ready()
        const began = performance.now()
        if (!over || fetching) return
        stroke = new Map(), last = at, over = false
        waiting.push({ p, centre: at, value })
        paintWaiting()
        requestAnimationFrame(() => requestAnimationFrame(() => { desk.stats.brush = performance.now() - began }))
      },
      move: (p, at) => {
        if (!stroke || !last) return
        const way = Math.hypot(...[0, 1, 2].map(a => (at[a] - last[a]) * page.volume.spacing[a])), n = Math.max(1, Math.ceil(way / Math.max(.3, brush.radius / 2)))
        const from = last
        for (let i = 1; i <= n; ++i) waiting.push({ p, centre: from.map((v, a) => v + (at[a] - v) * i / n), value })
        last = at
        paintWaiting()
      },
      up: () => {
        if (!last) return
        last = null, over = true
        if (!fetching) paintWaiting()
      },
      // A second finger: the touch was meant for looking, and what it painted goes.
      stop: () => {
        if (!last) return
        last = null, waiting.length = 0, over = true
        if (stroke && stroke.size) finish(), page.undoPaint()
        stroke = null
      }
    }
  }
  const finish = () => {
    if (stroke && stroke.size) {
      done.push(stroke), undone.length = 0
      if (done.length > 100) done.shift()
    }
    stroke = null
    tellCount()
    keepDraft()
  }
  page.tools.add = painter('b', 1)
  page.tools.remove = painter('r', 2)
  page.tools.erase = painter('u', 0)
  // The part of the slice that hangs together with the clicked place: of the same paint, and of the range of HU where one is asked for.
  page.tools.fill = {
    key: 'f',
    down: (p, at) => {
      ready()
      const { volume } = page, start = at.map(Math.round), data = volume.has(p.n, page.at[p.n])
      if (!volume.inside(start)) return
      const was = bytes[volume.at(...start)], fits = q => bytes[volume.at(...q)] === was && (!brush.within || inRange(huAt(p, data, q)))
      const open = [start], found = []
      const seen = new Set([volume.at(...start)])
      while (open.length) {
        const q = open.pop()
        if (!fits(q)) continue
        found.push(q)
        for (const [a, d] of [[p.u, 1], [p.u, -1], [p.v, 1], [p.v, -1]]) {
          const next = [...q]
          next[a] += d
          if (next[a] < 0 || next[a] >= volume.size[a]) { if (!brush.within) throw new Refused(t('fill_open')) }
          else if (!seen.has(volume.at(...next))) seen.add(volume.at(...next)), open.push(next)
        }
      }
      stroke = new Map()
      for (const q of found) write(volume.at(...q), 1, q)
      finish()
      page.redraw()
    }
  }
  page.tools.grow = {
    key: 'g',
    down: async (p, at) => {
      ready()
      const [i, j, k] = at.map(Math.round), { volume } = page
      if (!volume.inside([i, j, k])) return
      const answer = await askBytes('grow', { case: page.token, i, j, k, radius_mm: brush.grow, lower_hu: brush.low, upper_hu: brush.high })
      take(answer, () => 1)
    }
  }
  // What the desk made of it, as one stroke.
  const take = (answer, valueOf) => {
    const [x, y, z, nx, ny] = new Int32Array(answer, 0, 6), made = new Uint8Array(answer, 24)
    const before = count[0] + count[1]
    stroke = new Map()
    for (let n = 0; n < made.length; ++n) if (made[n]) {
      const q = [x + n % nx, y + Math.floor(n / nx) % ny, z + Math.floor(n / nx / ny)]
      write(page.volume.at(...q), valueOf(made[n]), q)
    }
    finish()
    page.redraw()
    return count[0] + count[1] - before
  }
  // The slices between painted ones, along the axis of the chosen plane.
  const between = async () => {
    ready()
    const body = packed(), p = page.volume.planes.find(p => p.id === brush.plane)
    if (!body) throw new Refused(t('nothing'))
    const value = count[0] ? 1 : 2
    const answer = await tellForBytes('between', { case: page.token, axis: p.n, value }, body)
    hint(`${t('filled')} ${take(answer, v => v)}`)
  }
  page.resize = factor => {
    brush.radius = Math.max(.3, Math.min(60, Math.round(brush.radius * factor * 10) / 10))
    if (page.tab === 'paint') page.show_('paint')
    page.redraw()
  }
  const back = (from, to) => {
    const change = from.pop()
    if (!change) return
    stroke = new Map()
    for (const [n, old] of change) write(n, old, placeOf(n))
    to.push(stroke)
    stroke = null
    tellCount()
    keepDraft()
    page.redraw()
  }
  page.undoPaint = () => back(done, undone)
  page.redoPaint = () => back(undone, done)

  // ---- drawn over the slices: blue is added, orange removed (colours that all eyes tell apart)
  page.overlays.push((p, c) => {
    const { volume } = page
    if (bytes && count[0] + count[1] && page.at[p.n] >= box.low[p.n] && page.at[p.n] <= box.high[p.n]) {
      const strides = [1, volume.size[0], volume.size[0] * volume.size[1]], base = page.at[p.n] * strides[p.n], su = strides[p.u], sv = strides[p.v]
      const u0 = Math.max(0, box.low[p.u]), u1 = box.high[p.u], v0 = Math.max(0, box.low[p.v]), v1 = box.high[p.v], image = new ImageData(u1 - u0 + 1, v1 - v0 + 1), px = new Uint32Array(image.data.buffer)
      const colours = [0, rgba(0, 140, 255, 120), rgba(255, 120, 0, 130)], nu = u1 - u0 + 1, nv = v1 - v0 + 1
      for (let y = 0, n = 0; y < nv; ++y) for (let x = 0; x < nu; ++x, ++n) px[n] = colours[bytes[base + (p.flipU ? u1 - x : u0 + x) * su + (p.flipV ? v1 - y : v0 + y) * sv]]
      p.paint = p.paint || document.createElement('canvas')
      p.paint.width = nu, p.paint.height = nv
      p.paint.getContext('2d').putImageData(image, 0, 0)
      const smooth = c.imageSmoothingEnabled, x0 = Math.min(p.X(u0), p.X(u1)) - volume.spacing[p.u] * p.k / 2, y0 = Math.min(p.Y(v0), p.Y(v1)) - volume.spacing[p.v] * p.k / 2
      c.imageSmoothingEnabled = false
      c.drawImage(p.paint, x0, y0, nu * volume.spacing[p.u] * p.k, nv * volume.spacing[p.v] * p.k)
      c.imageSmoothingEnabled = smooth
    }
    if (page.tools[page.tool].hover && page.pointer && page.pointer.plane === p) {
      c.strokeStyle = page.tool === 'add' ? '#4db1ff' : page.tool === 'remove' ? '#ff9c3c' : '#ffffff'
      c.lineWidth = p.r
      c.beginPath(), c.arc(p.X(page.pointer.at[p.u]), p.Y(page.pointer.at[p.v]), Math.max(2, brush.radius * p.k), 0, 7), c.stroke()
    }
  })

  // ---- what edits that are no painting need of this panel
  page.anatomy = () => anatomy
  page.chooseAnatomy = name => { anatomy = name }
  page.needAnatomy = () => {
    if (!anatomy || page.tab !== 'paint') page.show_('paint')
    if (!anatomy) throw new Refused(t('no_field'))
  }
  page.rangeWanted = () => brush.within ? { lower_hu: brush.low, upper_hu: brush.high } : {}
  const edits = editsOf(page)

  const eachPainted = f => {
    for (let k = Math.max(0, box.low[2]); k <= box.high[2]; ++k) for (let j = Math.max(0, box.low[1]); j <= box.high[1]; ++j) for (let i = Math.max(0, box.low[0]); i <= box.high[0]; ++i) {
      const n = page.volume.at(i, j, k)
      if (bytes[n]) f([i, j, k], n)
    }
  }
  // ---- as the desk takes it: where the box begins, its size, a byte a voxel
  const packed = () => {
    const low = [1e9, 1e9, 1e9], high = [-1, -1, -1]
    eachPainted(at => { for (let a = 0; a < 3; ++a) low[a] = Math.min(low[a], at[a]), high[a] = Math.max(high[a], at[a]) })
    if (high[0] < 0) return null
    const n = low.map((v, a) => high[a] - v + 1), out = new Uint8Array(24 + n[0] * n[1] * n[2])
    new Int32Array(out.buffer, 0, 6).set([...low, ...n])
    for (let k = 0, to = 24; k < n[2]; ++k) for (let j = 0; j < n[1]; ++j, to += n[0]) {
      const from = page.volume.at(low[0], low[1] + j, low[2] + k)
      out.set(bytes.subarray(from, from + n[0]), to)
    }
    return out
  }
  const unpack = (bytes_) => {
    const [x, y, z, nx, ny, nz] = new Int32Array(bytes_.buffer, bytes_.byteOffset, 6)
    bytes = bytes || new Uint8Array(page.volume.count)
    for (let k = 0, n = 24; k < nz; ++k) for (let j = 0; j < ny; ++j) for (let i = 0; i < nx; ++i, ++n)
      if (bytes_[n] && page.volume.inside([x + i, y + j, z + k])) write(page.volume.at(x + i, y + j, z + k), bytes_[n], [x + i, y + j, z + k])
  }
  // The draft begins with the anatomy's name in 64 bytes.
  // One at a time: on a slow machine many of them would fill the page's memory.
  let sending = false
  const keepDraft = () => {
    clearTimeout(keeping)
    keeping = setTimeout(async () => {
      if (sending) return keepDraft()
      sending = true
      const body = count[0] + count[1] ? packed() : null, head = new Uint8Array(64)
      new TextEncoder().encodeInto(anatomy, head)
      try {
        await tellBytes('keep', { case: page.token, what: 'paint' }, body ? new Blob([head, body]) : new Blob([]))
        desk.stats.kept = (desk.stats.kept || 0) + 1
      } catch (e) { problem(`${t('not_kept')} ${e.message}`) } finally { sending = false }
    }, 800)
  }
  page.opened = async () => {
    if (restored) return
    restored = true
    const draft = new Uint8Array(await askBytes('draft', { case: page.token, what: 'paint' }))
    if (draft.length < 88) return
    anatomy = new TextDecoder().decode(draft.slice(0, 64)).replace(/\0+$/, '')
    unpack(draft.slice(64))
    hint(t('draft'))
    tellCount()
    page.redraw()
  }
  // What is thrown away is a stroke: undo brings it back.
  const throwAway = () => {
    if (!bytes) return
    stroke = new Map()
    eachPainted((at, n) => write(n, 0, at))
    finish()
    page.redraw()
  }
  const clearAll = () => {
    bytes = null, count = [0, 0], done.length = undone.length = 0
    box.low = [1e9, 1e9, 1e9], box.high = [-1, -1, -1]
    keepDraft()
    page.redraw()
  }
  let counted = null
  const tellCount = () => {
    desk.stats.painted = [...count]
    const ml = page.volume ? page.volume.spacing[0] * page.volume.spacing[1] * page.volume.spacing[2] / 1000 : 0
    if (counted) counted.textContent = count[0] + count[1] ? [[count[0], t('to_add')], [count[1], t('to_remove')]].filter(c => c[0]).map(([n, what]) => `${digits(n * ml, 2)} ml ${what} (${n} ${t('voxels')})`).join(', ') : t('nothing')
  }

  page.addPanel('paint', () => {
    const list = choices()
    if (!anatomy && list.length) anatomy = (list.find(a => a.shown) || list[0]).name
    usualRange()
    const select = make('select', { id: 'anatomy', change: e => { anatomy = e.target.value, usualRange(), $('low').value = brush.low, $('high').value = brush.high, range(), page.redraw() } }, list.map(a => make('option', { value: a.name, text: label(a.name) })))
    select.value = anatomy
    const number = (key, name, given) => make('input', { type: 'number', value: brush[key], 'aria-label': t(name), ...given, change: e => { if (isFinite(e.target.valueAsNumber)) brush[key] = e.target.valueAsNumber; if (key === 'low' || key === 'high') brush.own = true; range(), page.redraw() } })
    const showing = make('input', { type: 'checkbox', id: 'show-range', checked: !!page.range, change: () => { range(), page.redraw() } })
    const range = () => { page.range = showing.checked ? [brush.low, brush.high] : null }
    const plane = make('select', { id: 'plane', change: e => { brush.plane = e.target.value } }, PLANES.map(p => make('option', { value: p.id, text: t(p.id) })))
    plane.value = brush.plane
    counted = make('span', { id: 'painted' })
    tellCount()
    const why = make('textarea', { id: 'why', maxLength: 400 }), fixed = !page.info || page.info.fixed || !page.info.now
    const patches = (page.info && page.info.journal || []).filter(e => e.file || e.edit)
    const save = async () => {
      const body = bytes && packed()
      if (!body) throw new Refused(t('nothing'))
      const said = await tellBytes('patch', { case: page.token, anatomy, by: who(), why: why.value, base: page.info.base }, body)
      clearAll()
      hint(said.done + (said.was_so_ml > 0 ? `; ${digits(said.was_so_ml, 2)} ml ${t('was_so')}` : ''))
      await page.reloadInfo()
      page.refresh()
    }
    return [
      fixed && page.info && page.info.fixed ? make('p', { class: 'warn', text: page.info.fixed }) : null,
      make('h2', { text: t('anatomy') }), make('div', { class: 'row' }, list.length ? select : make('span', { class: 'faint', text: t('no_field') })),
      make('h2', { text: t('brush') }),
      make('div', { class: 'row' }, field('radius_', number('radius', 'radius_', { id: 'radius', min: .3, max: 60, step: .5 }), make('span', { class: 'faint', text: t('mm') })), make('label', {}, make('input', { type: 'checkbox', id: 'ball', checked: brush.ball, change: e => { brush.ball = e.target.checked } }), make('span', { text: t('ball') }))),
      make('div', { class: 'row' }, make('label', {}, make('input', { type: 'checkbox', id: 'within', checked: brush.within, change: e => { brush.within = e.target.checked } }), make('span', { text: t('within') })), number('low', 'hu_low', { id: 'low' }), make('span', { text: t('to') }), number('high', 'hu_high', { id: 'high' }), make('span', { class: 'faint', text: 'HU' })),
      make('div', { class: 'row' }, make('label', {}, showing, make('span', { text: t('show_range') }))),
      make('div', { class: 'row' }, field('grow_within', number('grow', 'grow_within', { id: 'grow', min: 1, max: 200 }), make('span', { class: 'faint', text: t('mm') }))),
      make('p', { class: 'faint', text: t('grow_how') }),
      make('div', { class: 'row' }, field('between_', plane), button('between', between, { id: 'between' })),
      make('h2', { text: t('painted') }), make('div', { class: 'row' }, counted), field('why', why),
      make('div', { class: 'row' }, button('save_patch', save, { id: 'save-patch', class: 'main', disabled: !!fixed }), button('throw_', throwAway, { id: 'throw' })),
      edits.panel(why, fixed),
      make('h2', { text: t('patches') }), patches.length ? make('p', { class: 'faint', text: t('patches_how') }) : null, patches.length ? patches.map(e => make('div', { class: 'row' }, make('label', {}, make('input', { type: 'checkbox', 'data-patch': String(e.id), checked: e.on, change: doing(ev => page.save('switch', { id: e.id, on: ev.target.checked })) }), make('span', { text: t('on') })), make('span', { text: e.what }), make('span', { class: 'faint', text: `${e.by} ${e.when}${e.why ? ': ' + e.why : ''}` }))) : make('p', { class: 'faint', text: t('nothing') })
    ].flat(2)
  })
}
