// The camera, and the surfaces drawn with WebGL2, or by the processor where there is none.
// Radians, of the shorter side of the view.
const halfField = 0.26

// az turns about the patient's long axis (0: from the front), el lifts the eye, pan moves the picture (mm).
function makeCamera(centre, radius) {
  const home = { az: -0.7, el: 0.35, dist: radius * 3.6, pan: [0, 0] }
  const cam = { ...home, pan: [0, 0], centre, radius }
  cam.reset = () => Object.assign(cam, home, { pan: [0, 0] })
  cam.basis = () => {
    const ce = Math.cos(cam.el),
      se = Math.sin(cam.el),
      ca = Math.cos(cam.az),
      sa = Math.sin(cam.az)
    const toward = [ce * sa, -ce * ca, se],
      right = [ca, sa, 0],
      forward = toward.map(v => -v)
    const up = [
      right[1] * forward[2] - right[2] * forward[1],
      right[2] * forward[0] - right[0] * forward[2],
      right[0] * forward[1] - right[1] * forward[0]
    ]
    const eye = centre.map((c, k) => c - right[k] * cam.pan[0] - up[k] * cam.pan[1] + toward[k] * cam.dist)
    return { right, up, forward, eye }
  }
  // From where to where is drawn along the view, and how far its edges lie off the middle at distance 1.
  cam.reach = () => [Math.max(1, cam.dist - 3 * radius), cam.dist + 3 * radius]
  cam.tangents = (w, h) => [w / h, h / w].map(share => Math.tan(halfField) * Math.max(1, share))
  cam.matrix = (w, h) => {
    const { right, up, forward, eye } = cam.basis(),
      [near, far] = cam.reach(),
      [sx, sy] = cam.tangents(w, h).map(t => 1 / t)
    const shift = v => -(v[0] * eye[0] + v[1] * eye[1] + v[2] * eye[2]),
      a = (far + near) / (near - far),
      b = (2 * far * near) / (near - far)
    const r = [...right, shift(right)],
      u = [...up, shift(up)],
      f = [...forward, shift(forward)],
      m = new Float32Array(16)
    for (let k = 0; k < 4; ++k) {
      m[4 * k] = sx * r[k]
      m[4 * k + 1] = sy * u[k]
      m[4 * k + 2] = -a * f[k]
      m[4 * k + 3] = f[k]
    }
    m[14] += b
    return m
  }
  cam.mmPerPixel = (w, h) => (2 * cam.dist * Math.tan(halfField)) / Math.min(w, h)
  cam.project = (m, w, h, [x, y, z]) => {
    const d = m[3] * x + m[7] * y + m[11] * z + m[15]
    return [
      (0.5 + (0.5 * (m[0] * x + m[4] * y + m[8] * z + m[12])) / d) * w,
      (0.5 - (0.5 * (m[1] * x + m[5] * y + m[9] * z + m[13])) / d) * h
    ]
  }
  // The ray through a place of the view: from the eye, in a direction of length 1.
  cam.ray = (x, y, w, h) => {
    const { right, up, forward, eye } = cam.basis(),
      [tx, ty] = cam.tangents(w, h)
    const u = ((2 * x) / w - 1) * tx,
      v = (1 - (2 * y) / h) * ty
    const d = forward.map((f, k) => f + u * right[k] + v * up[k]),
      l = Math.hypot(...d)
    return { eye, d: d.map(x => x / l) }
  }
  return cam
}

// Opaque ones first, then from the inside out.
const drawOrder = meshes =>
  meshes.filter(m => m.visible && m.opacity > 0.01).sort((a, b) => (b.opacity >= 0.99) - (a.opacity >= 0.99) || a.size - b.size)

// What is cut away: everything on the far side of a plane along one of the patient's axes.
const clipPlane = (clip, m) => {
  const p = [0, 0, 0, 1e9]
  if (clip.axis >= 0 && m.clip) {
    p[clip.axis] = clip.keep
    p[3] = -clip.keep * clip.mm
  }
  return p
}

// The nearest point of what is seen on a ray, or null.
function pick(meshes, clip, { eye, d }) {
  let best = Infinity
  for (const m of meshes) {
    if (!m.visible || m.opacity < 0.3) continue
    const { pos, idx } = m,
      q = clipPlane(clip, m)
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
      const px = d[1] * vz - d[2] * vy,
        py = d[2] * vx - d[0] * vz,
        pz = d[0] * vy - d[1] * vx
      const det = ux * px + uy * py + uz * pz
      if (!det) continue
      const tx = eye[0] - pos[a],
        ty = eye[1] - pos[a + 1],
        tz = eye[2] - pos[a + 2],
        s = (tx * px + ty * py + tz * pz) / det
      if (s < 0 || s > 1) continue
      const wx = ty * uz - tz * uy,
        wy = tz * ux - tx * uz,
        wz = tx * uy - ty * ux,
        t = (d[0] * wx + d[1] * wy + d[2] * wz) / det
      const far = (vx * wx + vy * wy + vz * wz) / det
      if (t < 0 || s + t > 1 || far <= 0 || far >= best) continue
      if (q[0] * (eye[0] + far * d[0]) + q[1] * (eye[1] + far * d[1]) + q[2] * (eye[2] + far * d[2]) + q[3] >= 0) best = far
    }
  }
  return best < Infinity ? eye.map((e, k) => e + best * d[k]) : null
}

// The colour of a deviation: blue inside, red outside, grey where none is known.
const heatColour = (v, scale) => {
  if (Math.abs(v) > 1e8) return [0.5, 0.5, 0.5]
  const t = Math.max(-1, Math.min(1, v / scale)),
    p = Math.abs(t),
    end = t > 0 ? [0.75, 0.05, 0.1] : [0.1, 0.2, 0.75]
  return end.map(e => 0.93 + (e - 0.93) * p)
}

const vertexShader = `#version 300 es
in vec3 p,n;in float d;uniform mat4 m;out vec3 P,N;out float V;
void main(){P=p;N=n;V=d;gl_Position=m*vec4(p,1);}`
const fragmentShader = `#version 300 es
precision highp float;in vec3 P,N;in float V;uniform vec4 c,q;uniform vec3 e;uniform float h;out vec4 o;
void main(){if(dot(q.xyz,P)+q.w<0.)discard;
vec3 n=normalize(N),v=normalize(e-P);float f=dot(n,v);vec3 k=c.rgb;
if(h>0.){float t=clamp(V/h,-1.,1.);k=V>1e8?vec3(.5):t>0.?mix(vec3(.93),vec3(.75,.05,.1),t):mix(vec3(.93),vec3(.1,.2,.75),-t);}
if(f<0.){k*=.62;f=-f;}
o=vec4(k*(.28+.72*f)+.12*pow(f,24.),c.a);}`

function programOf(gl, ...texts) {
  const program = gl.createProgram()
  texts.forEach((text, n) => {
    const shader = gl.createShader(n ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER)
    gl.shaderSource(shader, text)
    gl.compileShader(shader)
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw Error(gl.getShaderInfoLog(shader))
    gl.attachShader(program, shader)
  })
  ;['p', 'n', 'd'].forEach((name, i) => gl.bindAttribLocation(program, i, name))
  gl.linkProgram(program)
  return program
}

// `sources` are made when they are first asked for: draw() takes a `cast` of one of them, and says whether that is coarse.
function glPainter(canvas, meshes, sources) {
  const gl = canvas.getContext('webgl2', { antialias: true, alpha: false })
  if (!gl) return null
  let program, at, casts
  const upload = () => {
    casts = {}
    program = programOf(gl, vertexShader, fragmentShader)
    at = {}
    for (const name of ['m', 'c', 'q', 'e', 'h']) at[name] = gl.getUniformLocation(program, name)
    for (const m of meshes) {
      m.array = gl.createVertexArray()
      gl.bindVertexArray(m.array)
      ;[m.pos, m.nor, m.dev].forEach((values, i) => {
        if (!values) return
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer())
        gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW)
        gl.enableVertexAttribArray(i)
        gl.vertexAttribPointer(i, i < 2 ? 3 : 1, gl.FLOAT, false, 0, 0)
      })
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer())
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, m.idx, gl.STATIC_DRAW)
    }
    gl.bindVertexArray(null)
  }
  const surfaces = ({ cam, clip, heat, scale }, drawn) => {
    gl.enable(gl.DEPTH_TEST)
    gl.useProgram(program)
    gl.uniformMatrix4fv(at.m, false, cam.matrix(canvas.width, canvas.height))
    gl.uniform3fv(at.e, cam.basis().eye)
    for (const m of drawn) {
      const go = () => gl.drawElements(gl.TRIANGLES, m.idx.length, gl.UNSIGNED_INT, 0)
      gl.bindVertexArray(m.array)
      gl.uniform4fv(at.q, clipPlane(clip, m))
      gl.uniform4f(at.c, ...m.rgb, m.opacity)
      gl.uniform1f(at.h, heat === m ? scale : 0)
      gl.disable(gl.BLEND)
      gl.depthFunc(gl.LESS)
      // The nearest layer alone: depth first, then its colour.
      if (m.opacity < 0.99) {
        gl.colorMask(false, false, false, false)
        go()
        gl.colorMask(true, true, true, true)
        gl.depthFunc(gl.EQUAL)
        gl.enable(gl.BLEND)
        gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA)
      }
      go()
    }
  }
  const draw = how => {
    if (gl.isContextLost()) return false
    const all = drawOrder(meshes)
    gl.viewport(0, 0, canvas.width, canvas.height)
    gl.clearColor(...how.ground, 1)
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT)
    surfaces(how, all)
    if (!how.cast) return false
    const { of } = how.cast,
      cast = (casts[of] = casts[of] || makeCast(gl, sources[of]())),
      opaque = all.filter(m => m.opacity >= 0.99)
    return cast.draw(how, canvas, () => surfaces(how, opaque))
  }
  upload()
  return { draw, upload, kind: 'webgl2' }
}

// A z-buffer in the processor: vertices are projected once, triangles are filled row by row with one shade each.
function softPainter(canvas, meshes) {
  const target = canvas.getContext('2d'),
    small = document.createElement('canvas')
  const draw = ({ cam, clip, heat, scale, ground, moving }) => {
    const s = moving ? 3 : 1.5,
      w = Math.max(8, (canvas.width / s) | 0),
      h = Math.max(8, (canvas.height / s) | 0)
    const image = new ImageData(w, h),
      px = new Uint32Array(image.data.buffer),
      depth = new Float32Array(w * h)
    const [gr, gg, gb] = ground.map(x => x * 255)
    px.fill((255 << 24) | (gb << 16) | (gg << 8) | gr)
    const mt = cam.matrix(w, h),
      { forward } = cam.basis()
    for (const m of drawOrder(meshes)) fill(m, m.opacity >= 0.99 ? px : new Uint32Array(w * h), depth)
    small.width = w
    small.height = h
    small.getContext('2d').putImageData(image, 0, 0)
    target.drawImage(small, 0, 0, canvas.width, canvas.height)

    function fill(m, into, depth) {
      const { pos, nor, idx } = m,
        n = pos.length / 3,
        X = new Float32Array(n),
        Y = new Float32Array(n),
        Z = new Float32Array(n),
        L = new Float32Array(n)
      const q = clipPlane(clip, m),
        closed = q[3] > 1e8 && m.opacity >= 0.99 && !m.tool,
        hot = heat === m && m.dev
      for (let i = 0, k = 0; i < n; ++i, k += 3) {
        const x = pos[k],
          y = pos[k + 1],
          z = pos[k + 2],
          d = 1 / (mt[3] * x + mt[7] * y + mt[11] * z + mt[15])
        X[i] = (0.5 + 0.5 * (mt[0] * x + mt[4] * y + mt[8] * z + mt[12]) * d) * w
        Y[i] = (0.5 - 0.5 * (mt[1] * x + mt[5] * y + mt[9] * z + mt[13]) * d) * h
        Z[i] = q[0] * x + q[1] * y + q[2] * z + q[3] < 0 ? -1 : d
        L[i] = -(nor[k] * forward[0] + nor[k + 1] * forward[1] + nor[k + 2] * forward[2])
      }
      for (let t = 0; t < idx.length; t += 3) {
        const a = idx[t],
          b = idx[t + 1],
          c = idx[t + 2]
        const ax = X[a],
          ay = Y[a],
          bx = X[b] - ax,
          by = Y[b] - ay,
          cx = X[c] - ax,
          cy = Y[c] - ay,
          area = bx * cy - by * cx
        if (!area || (area > 0 && closed) || Z[a] < 0 || Z[b] < 0 || Z[c] < 0) continue
        const y0 = Math.max(0, Math.ceil(Math.min(ay, Y[b], Y[c]) - 0.5)),
          y1 = Math.min(h - 1, Math.floor(Math.max(ay, Y[b], Y[c]) - 0.5))
        const x0 = Math.max(0, Math.ceil(Math.min(ax, X[b], X[c]) - 0.5)),
          x1 = Math.min(w - 1, Math.floor(Math.max(ax, X[b], X[c]) - 0.5))
        if (x0 > x1 || y0 > y1) continue
        let light = (L[a] + L[b] + L[c]) / 3,
          dim = 255
        if (light < 0) {
          light = -light
          dim *= 0.62
        }
        const k = dim * (0.28 + 0.72 * light)
        let rgb = m.rgb
        if (hot) {
          const da = m.dev[a],
            db = m.dev[b],
            dc = m.dev[c]
          rgb = heatColour(da > 1e8 || db > 1e8 || dc > 1e8 ? 1e9 : (da + db + dc) / 3, scale)
        }
        const colour = (255 << 24) | ((rgb[2] * k) << 16) | ((rgb[1] * k) << 8) | (rgb[0] * k)
        const ux = cy / area,
          uy = -cx / area,
          vx = -by / area,
          vy = bx / area,
          za = Z[a],
          zb = Z[b] - za,
          zc = Z[c] - za
        for (let y = y0; y <= y1; ++y) {
          const dx = x0 + 0.5 - ax,
            dy = y + 0.5 - ay
          let u = dx * ux + dy * uy,
            v = dx * vx + dy * vy
          for (let i = y * w + x0, end = y * w + x1; i <= end; ++i, u += ux, v += vx) {
            if (u < 0 || v < 0 || u + v > 1) continue
            const z = za + u * zb + v * zc
            if (z > depth[i]) {
              depth[i] = z
              into[i] = colour
            }
          }
        }
      }
      if (into !== px) blend(into, m.opacity)
    }
    function blend(own, o) {
      for (let i = 0; i < own.length; ++i) {
        const c = own[i]
        if (!c) continue
        const p = px[i],
          r = p & 255,
          g = (p >> 8) & 255,
          b = (p >> 16) & 255
        px[i] =
          (255 << 24) |
          ((b + (((c >> 16) & 255) - b) * o) << 16) |
          ((g + (((c >> 8) & 255) - g) * o) << 8) |
          (r + ((c & 255) - r) * o)
      }
    }
  }
  return { draw, upload() {}, kind: 'processor' }
}
