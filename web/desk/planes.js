// The scan's voxels on three linked planes, exactly as they are: one voxel of the scan's own raster is one square.
const PLANES = [
  { id: 'axial', patient: 2, across: 0, down: 1, up: false, ends: 'RLAP' },
  { id: 'coronal', patient: 1, across: 0, down: 2, up: true, ends: 'RLSI' },
  { id: 'sagittal', patient: 0, across: 1, down: 2, up: true, ends: 'APSI' }
]

// The scan's lattice and its slices, fetched as they are needed. Directions are columns: direction[3 * patient axis + lattice
// axis].
function makeVolume(token, lattice) {
  const { size, spacing_mm: spacing, origin_mm: origin, direction } = lattice,
    slices = new Map(),
    most = 240
  const toWorld = p =>
    [0, 1, 2].map(r => origin[r] + [0, 1, 2].reduce((sum, c) => sum + direction[3 * r + c] * spacing[c] * p[c], 0))
  const toIndex = w =>
    [0, 1, 2].map(c => [0, 1, 2].reduce((sum, r) => sum + direction[3 * r + c] * (w[r] - origin[r]), 0) / spacing[c])
  // Which lattice axis lies nearest to each of the patient's; each is taken once.
  const axes = [-1, -1, -1],
    free = new Set([0, 1, 2])
  const strength = []
  for (let p = 0; p < 3; ++p) for (let a = 0; a < 3; ++a) strength.push([Math.abs(direction[3 * p + a]), p, a])
  for (const [, p, a] of strength.sort((x, y) => y[0] - x[0]))
    if (axes[p] < 0 && free.has(a)) {
      axes[p] = a
      free.delete(a)
    }
  const planes = PLANES.map(p => {
    const n = axes[p.patient],
      u = axes[p.across],
      v = axes[p.down]
    return {
      ...p,
      n,
      u,
      v,
      flipU: direction[3 * p.across + u] < 0,
      flipV: direction[3 * p.down + v] < 0 !== p.up,
      zoom: 1,
      panX: 0,
      panY: 0
    }
  })
  const remember = (key, value) => {
    slices.delete(key)
    slices.set(key, value)
    if (slices.size > most) slices.delete(slices.keys().next().value)
    return value
  }
  // A desk that is slower than the wheel: a few requests at a time, what was asked for last comes first, and what was asked for
  // long ago is asked again where it is needed again.
  const queue = []
  let running = 0
  const next = () => {
    if (running >= 5 || !queue.length) return
    const job = queue.pop()
    ++running
    job
      .ask()
      .then(job.done, job.failed)
      .finally(() => {
        --running
        next()
      })
  }
  const soon = ask =>
    new Promise((done, failed) => {
      queue.push({ ask, done, failed })
      if (queue.length > 400) queue.shift().failed(new Superseded(''))
      next()
    })
  const fetched = (key, path, query, read) => {
    if (slices.has(key)) return remember(key, slices.get(key))
    const waiting = soon(() => askBytes(path, { case: token, ...query })).then(
      bytes => {
        const value = read(bytes)
        if (slices.get(key) === waiting) slices.set(key, value)
        return value
      },
      e => {
        slices.delete(key)
        throw e
      }
    )
    return remember(key, waiting)
  }
  const slice = (axis, index) => fetched(`${axis}:${index}`, 'slice', { axis, index }, bytes => new Int16Array(bytes))
  const outline = (name, axis, index) =>
    fetched(`${name}:${axis}:${index}`, 'field', { name, axis, index }, bytes => {
      const [u0, v0, nu, nv] = new Int32Array(bytes, 0, 4)
      return contourOf(new Int16Array(bytes, 16), u0, v0, nu, nv)
    })
  // A surface of the comparison where it meets the plane.
  const cut = (which, name, axis, index) =>
    fetched(`${which} ${name}:${axis}:${index}`, 'cut', { which, name, axis, index }, bytes => new Float32Array(bytes))
  const forget = begin => {
    for (const key of [...slices.keys()]) if (key.startsWith(begin)) slices.delete(key)
  }
  const ready = value => (value && !value.then ? value : null)
  const has = (axis, index) => ready(slices.get(`${axis}:${index}`))
  const inside = p => p.every((v, a) => v >= 0 && v < size[a])
  const at = (i, j, k) => i + size[0] * (j + size[1] * k)
  return {
    token,
    size,
    spacing,
    toWorld,
    toIndex,
    planes,
    slice,
    outline,
    cut,
    forget,
    has,
    ready,
    inside,
    at,
    count: size[0] * size[1] * size[2]
  }
}

// The line at 0 of a slice of a field, in the slice's own places: pairs of ends, u along the lower axis. Beyond the field all is
// outside.
function contourOf(samples, u0, v0, nu, nv) {
  const ends = []
  const value = (u, v) => (u < 0 || v < 0 || u >= nu || v >= nv ? -1 : samples[v * nu + u])
  for (let v = -1; v < nv; ++v)
    for (let u = -1; u < nu; ++u) {
      const a = value(u, v),
        b = value(u + 1, v),
        c = value(u + 1, v + 1),
        d = value(u, v + 1)
      const kind = (a > 0) | ((b > 0) << 1) | ((c > 0) << 2) | ((d > 0) << 3)
      if (kind === 0 || kind === 15) continue
      const f = (p, q) => p / (p - q)
      const top = () => ends.push(u0 + u + f(a, b), v0 + v),
        right = () => ends.push(u0 + u + 1, v0 + v + f(b, c))
      const low = () => ends.push(u0 + u + f(d, c), v0 + v + 1),
        left = () => ends.push(u0 + u, v0 + v + f(a, d))
      const lines = {
        1: [left, top],
        2: [top, right],
        3: [left, right],
        4: [right, low],
        5: [left, top, right, low],
        6: [top, low],
        7: [left, low],
        8: [low, left],
        9: [low, top],
        10: [top, right, low, left],
        11: [low, right],
        12: [right, left],
        13: [right, top],
        14: [top, left]
      }
      for (const end of lines[kind]) end()
    }
  return new Float32Array(ends)
}

// How a plane's canvas and the lattice belong together. Everything is in pixels of the canvas.
function layOut(plane, volume, canvas) {
  const { u, v, flipU, flipV } = plane,
    { size, spacing } = volume,
    r = Math.min(2, devicePixelRatio || 1)
  const w = Math.max(1, (canvas.clientWidth * r) | 0),
    h = Math.max(1, (canvas.clientHeight * r) | 0)
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w
    canvas.height = h
  }
  const wide = size[u] * spacing[u],
    high = size[v] * spacing[v],
    k = Math.min(w / wide, h / high) * 0.98 * plane.zoom
  const left = w / 2 - (wide * k) / 2 + plane.panX * r,
    top = h / 2 - (high * k) / 2 + plane.panY * r
  const X = c => left + ((flipU ? size[u] - 1 - c : c) + 0.5) * spacing[u] * k,
    Y = c => top + ((flipV ? size[v] - 1 - c : c) + 0.5) * spacing[v] * k
  plane.back = (x, y) => {
    const a = (x * r - left) / k / spacing[u] - 0.5,
      b = (y * r - top) / k / spacing[v] - 0.5
    return [flipU ? size[u] - 1 - a : a, flipV ? size[v] - 1 - b : b]
  }
  plane.place = (a, b) => [X(a) / r, Y(b) / r]
  return Object.assign(plane, { r, w, h, k, left, top, wide: wide * k, high: high * k, X, Y })
}

// The picture of a slice, one pixel a voxel: paint(pixels, index of the voxel in the slice's data, index of the pixel).
function pixelsOf(plane, volume, fill) {
  const nu = volume.size[plane.u],
    nv = volume.size[plane.v],
    lower = plane.u < plane.v
  if (!plane.image || plane.image.width !== nu || plane.image.height !== nv) plane.image = new ImageData(nu, nv)
  const px = new Uint32Array(plane.image.data.buffer)
  for (let y = 0, n = 0; y < nv; ++y) {
    const b = plane.flipV ? nv - 1 - y : y
    let from = lower ? b * nu + (plane.flipU ? nu - 1 : 0) : b + (plane.flipU ? (nu - 1) * nv : 0)
    const step = (lower ? 1 : nv) * (plane.flipU ? -1 : 1)
    for (let x = 0; x < nu; ++x, ++n, from += step) px[n] = fill(from, n)
  }
  if (!plane.voxels) plane.voxels = document.createElement('canvas')
  if (plane.voxels.width !== nu || plane.voxels.height !== nv) {
    plane.voxels.width = nu
    plane.voxels.height = nv
  }
  plane.voxels.getContext('2d').putImageData(plane.image, 0, 0)
  return plane.voxels
}

const rgba = (r, g, b, a = 255) => ((a << 24) | (b << 16) | (g << 8) | r) >>> 0
