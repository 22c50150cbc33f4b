// The data of a case's page. All files of a page become one script (lib/page/CMakeLists.txt); nothing is fetched, and
// texts of the case only ever become text nodes. docs/reference/case-page.md describes the data.
const again = 'Make it again: trephine page CASE.'
const tell = text => {
  const box = $('problem')
  box.hidden = false
  box.append(make('p', '', text))
}

// A block's bytes: base64, decoded piece by piece so that no second copy of it is made, then gzip, whose checksum the browser
// verifies.
async function unpack(id, bytes) {
  const damaged = `The page is cut off or damaged (part ${id}). ${again}`
  const element = $(id)
  if (!element) throw Error(damaged)
  const text = element.textContent,
    piece = 1 << 20
  element.remove()
  let at = 0
  const source = new ReadableStream({
    pull(c) {
      if (at >= text.length) return c.close()
      const part = atob(text.slice(at, (at += piece))),
        out = new Uint8Array(part.length)
      for (let i = 0; i < part.length; ++i) out[i] = part.charCodeAt(i)
      c.enqueue(out)
    }
  })
  const out = new Uint8Array(bytes)
  let end = 0
  try {
    const reader = source.pipeThrough(new DecompressionStream('gzip')).getReader()
    for (let next; !(next = await reader.read()).done; end += next.value.length) out.set(next.value, end)
  } catch (e) {
    throw Error(damaged)
  }
  if (end !== bytes) throw Error(damaged)
  return out
}

// A surface: positions in LPS mm, smooth normals, and deviations in mm (1e9 where none is known).
function readSurface(a, u) {
  let at = 0
  const damaged = () => Error(`The surface ${a.name} in this page is damaged. ${again}`)
  const varint = () => {
    let v = 0,
      scale = 1,
      b
    do {
      if (at >= u.length || scale > 2 ** 35) throw damaged()
      b = u[at++]
      v += (b & 127) * scale
      scale *= 128
    } while (b & 128)
    return v
  }
  const idx = new Uint32Array(3 * a.triangles),
    pos = new Float32Array(3 * a.points)
  let known = 0
  for (let i = 0; i < idx.length; ++i) {
    const back = varint()
    if (back > known) throw damaged()
    idx[i] = known - back
    if (!back && ++known > a.points) throw damaged()
  }
  const last = [0, 0, 0]
  for (let i = 0; i < a.points; ++i)
    for (let k = 0; k < 3; ++k) {
      const v = varint()
      last[k] += v % 2 ? -(v + 1) / 2 : v / 2
      pos[3 * i + k] = a.min_mm[k] + (last[k] * a.size_mm[k]) / 65535
    }
  let dev = null
  if (a.deviation_scale_mm !== undefined) {
    if (at + a.points > u.length) throw damaged()
    dev = new Float32Array(a.points)
    for (let i = 0; i < a.points; ++i) {
      const d = (u[at++] << 24) >> 24
      dev[i] = d === -128 ? 1e9 : (d * a.deviation_scale_mm) / 127
    }
  }
  if (at !== u.length) throw damaged()
  return {
    name: a.name,
    rgb: [...a.colour_rgb],
    opacity: a.opacity,
    pos,
    idx,
    nor: normalsOf(pos, idx),
    dev,
    visible: true,
    clip: true,
    p99: a.deviation_p99_mm
  }
}

function normalsOf(pos, idx) {
  const nor = new Float32Array(pos.length)
  for (let i = 0; i < idx.length; i += 3) {
    const a = 3 * idx[i],
      b = 3 * idx[i + 1],
      c = 3 * idx[i + 2]
    const ux = pos[b] - pos[a],
      uy = pos[b + 1] - pos[a + 1],
      uz = pos[b + 2] - pos[a + 2]
    const vx = pos[c] - pos[a],
      vy = pos[c + 1] - pos[a + 1],
      vz = pos[c + 2] - pos[a + 2]
    const x = uy * vz - uz * vy,
      y = uz * vx - ux * vz,
      z = ux * vy - uy * vx
    nor[a] += x
    nor[a + 1] += y
    nor[a + 2] += z
    nor[b] += x
    nor[b + 1] += y
    nor[b + 2] += z
    nor[c] += x
    nor[c + 1] += y
    nor[c + 2] += z
  }
  for (let i = 0; i < nor.length; i += 3) {
    const l = Math.hypot(nor[i], nor[i + 1], nor[i + 2]) || 1
    nor[i] /= l
    nor[i + 1] /= l
    nor[i + 2] /= l
  }
  return nor
}

// HU of each of the 256 levels of the CT.
function huOfLevels(levels) {
  const hu = new Float32Array(256)
  for (let s = 1; s < levels.length; ++s)
    for (let i = levels[s - 1][0]; i <= levels[s][0]; ++i)
      hu[i] = levels[s - 1][1] + ((levels[s][1] - levels[s - 1][1]) * (i - levels[s - 1][0])) / (levels[s][0] - levels[s - 1][0])
  return hu
}

// Each byte is the difference to the median of left, above, and left + above - above left.
function unpredict(u, [nx, ny]) {
  for (let at = 0; at < u.length;)
    for (let j = 0; j < ny; ++j)
      for (let i = 0, left = 0, corner = 0; i < nx; ++i, ++at) {
        const above = j ? u[at - nx] : 0
        left = u[at] += Math.max(Math.min(left, above), Math.min(Math.max(left, above), left + above - corner))
        left &= 255
        corner = above
      }
}

async function readVolume(data, v) {
  if (!v) return null
  const voxels = await unpack(v.block, data.blocks[v.block])
  if (v.predicted) unpredict(voxels, v.size)
  const shares = v.shares && (await unpack(v.shares, data.blocks[v.shares]))
  return { size: v.size, spacing: v.spacing_mm, origin: v.origin_mm, voxels, shares }
}

// A burr hole as a tube, which is also cut by the slices.
function tubeOf(hole) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
  const d = hole.direction,
    side = cross(d, Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]),
    l = Math.hypot(...side)
  const e = side.map(x => x / l),
    f = cross(d, e),
    n = 48,
    pos = [],
    nor = [],
    idx = []
  for (let i = 0; i < n; ++i) {
    const c = Math.cos((2 * Math.PI * i) / n),
      s = Math.sin((2 * Math.PI * i) / n),
      out = e.map((x, k) => c * x + s * f[k])
    for (const along of [-25, 8]) {
      pos.push(...out.map((x, k) => hole.position_mm[k] + (x * hole.diameter_mm) / 2 + along * d[k]))
      nor.push(...out)
    }
    const a = 2 * i,
      b = 2 * ((i + 1) % n)
    idx.push(a, b, a + 1, b, b + 1, a + 1)
  }
  return {
    name: hole.name,
    rgb: [1, 0.8, 0.1],
    opacity: 0.45,
    pos: new Float32Array(pos),
    nor: new Float32Array(nor),
    idx: new Uint32Array(idx),
    visible: true,
    clip: false,
    tool: true
  }
}

async function readCase() {
  if (!$('end')) throw Error('The page is cut off. ' + again)
  let data
  try {
    data = JSON.parse($('case-data').textContent)
  } catch (e) {
    throw Error('The page is damaged (its figures). ' + again)
  }
  const meshes = []
  for (const a of data.anatomies) if (a.block) meshes.push(readSurface(a, await unpack(a.block, data.blocks[a.block])))
  for (const hole of data.burr_holes) meshes.push(tubeOf(hole))
  return { data, meshes, ct: await readVolume(data, data.ct), felt: await readVolume(data, data.felt) }
}
