// What is painted, as it is kept and sent.

function eachPainted(page, f) {
  const { paint } = page
  const { box } = paint
  for (let k = Math.max(0, box.low[2]); k <= box.high[2]; ++k)
    for (let j = Math.max(0, box.low[1]); j <= box.high[1]; ++j)
      for (let i = Math.max(0, box.low[0]); i <= box.high[0]; ++i) {
        const n = page.volume.at(i, j, k)
        if (paint.bytes[n]) f([i, j, k], n)
      }
}

function packPaint(page) {
  const { paint } = page
  const low = [1e9, 1e9, 1e9],
    high = [-1, -1, -1]
  eachPainted(page, at => {
    for (let a = 0; a < 3; ++a) {
      low[a] = Math.min(low[a], at[a])
      high[a] = Math.max(high[a], at[a])
    }
  })
  if (high[0] < 0) return null
  const n = low.map((v, a) => high[a] - v + 1),
    out = new Uint8Array(24 + n[0] * n[1] * n[2])
  new Int32Array(out.buffer, 0, 6).set([...low, ...n])
  for (let k = 0, to = 24; k < n[2]; ++k)
    for (let j = 0; j < n[1]; ++j, to += n[0]) {
      const from = page.volume.at(low[0], low[1] + j, low[2] + k)
      out.set(paint.bytes.subarray(from, from + n[0]), to)
    }
  return out
}

function unpackPaint(page, bytes_) {
  const { paint } = page
  const [x, y, z, nx, ny, nz] = new Int32Array(bytes_.buffer, bytes_.byteOffset, 6)
  paint.bytes = paint.bytes || new Uint8Array(page.volume.count)
  for (let k = 0, n = 24; k < nz; ++k)
    for (let j = 0; j < ny; ++j)
      for (let i = 0; i < nx; ++i, ++n)
        if (bytes_[n] && page.volume.inside([x + i, y + j, z + k]))
          writeVoxel(page, page.volume.at(x + i, y + j, z + k), bytes_[n], [x + i, y + j, z + k])
}

function keepDraft(page) {
  const { paint } = page
  clearTimeout(paint.keeping)
  paint.keeping = setTimeout(async () => {
    if (paint.sending) return keepDraft(page)
    paint.sending = true
    const body = paint.count[0] + paint.count[1] ? packPaint(page) : null,
      head = new Uint8Array(64)
    new TextEncoder().encodeInto(paint.anatomy, head)
    try {
      await tellBytes('keep', { case: page.token, what: 'paint' }, body ? new Blob([head, body]) : new Blob([]))
      desk.stats.kept = (desk.stats.kept || 0) + 1
    } catch (e) {
      problem(`${t('not_kept')} ${e.message}`)
    } finally {
      paint.sending = false
    }
  }, 800)
}

async function restoreDraft(page) {
  const { paint } = page
  if (paint.restored) return
  paint.restored = true
  const draft = new Uint8Array(await askBytes('draft', { case: page.token, what: 'paint' }))
  if (draft.length < 88) return
  paint.anatomy = new TextDecoder().decode(draft.slice(0, 64)).replace(/\0+$/, '')
  unpackPaint(page, draft.slice(64))
  hint(t('draft'))
  tellCount(page)
  page.redraw()
}

// What is thrown away is a stroke: undo brings it back.
function throwAway(page) {
  const { paint } = page
  if (!paint.bytes) return
  paint.stroke = new Map()
  eachPainted(page, (at, n) => writeVoxel(page, n, 0, at))
  finishStroke(page)
  page.redraw()
}

function clearPaint(page) {
  const { paint } = page
  const { box, done, undone } = paint
  paint.bytes = null
  paint.count = [0, 0]
  done.length = undone.length = 0
  box.low = [1e9, 1e9, 1e9]
  box.high = [-1, -1, -1]
  keepDraft(page)
  page.redraw()
}
