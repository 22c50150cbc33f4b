// Rays through the CT by trephine-sim's transfer functions, or through the shapes that are felt, lit from the eye as the page's
// surfaces are: front to back, empty bricks skipped, ended by the opaque surfaces and by the cut. WebGL2 alone.
const brickVoxels = 8

const castVertex = `#version 300 es
out vec2 at;
void main(){at=vec2(gl_VertexID&1,gl_VertexID>>1)*2.;gl_Position=vec4(at*2.-1.,0,1);}`
// What is seen of HU at a place `v` in voxels.
const ofHu = `uniform sampler3D voxels;
float huAt(vec3 v){return texture(voxels,(v+.5)/size).r;}
vec4 entry(vec3 v){float x=clamp(huAt(v)+1024.,0.,4095.);int n=min(int(x),4094);
return mix(texelFetch(table,ivec2(n&1023,n>>10),0),texelFetch(table,ivec2(n+1&1023,n+1>>10),0),x-float(n));}`
// A place is seen as the shape whose trilinear occupancy is at least 1/2, as simulator/render/cast_shader.cpp finds it: among
// shares that add up to 255 only one that outweighs all others can have that much. A whole occupancy counts as 1000 HU.
const ofShapes = `uniform highp usampler3D voxels;
uint seen;
uvec4 voxelAt(ivec3 f,int c){return texelFetch(voxels,min(f+ivec3(c&1,c>>1&1,c>>2),ivec3(size)-1),0);}
float weightOf(vec3 f,int c){vec3 w=mix(1.-f,f,vec3(c&1,c>>1&1,c>>2));return w.x*w.y*w.z;}
float shareOf(uvec4 v){return float(v.r==seen?v.g:v.b==seen?255u-v.g:0u);}
float huAt(vec3 v){v=clamp(v,vec3(0),size-1.);ivec3 f=ivec3(v);float sum=0.;
for(int c=0;c<8;++c)sum+=weightOf(v-vec3(f),c)*shareOf(voxelAt(f,c));return sum*(1000./255.);}
void vote(uint n,float weight,inout float by){by+=n==seen?weight:-weight;if(by<0.){seen=n;by=-by;}}
vec4 entry(vec3 v){v=clamp(v,vec3(0),size-1.);ivec3 f=ivec3(v);float by=0.;seen=0u;
for(int c=0;c<8;++c){uvec4 x=voxelAt(f,c);float w=weightOf(v-vec3(f),c);
vote(x.r,w*float(x.g),by);vote(x.b,w*float(255u-x.g),by);}
return seen!=0u&&huAt(v)>=500.?texelFetch(table,ivec2(seen,0),0):vec4(0);}`
const castFragment = what => `#version 300 es
precision highp float;precision highp sampler3D;
uniform sampler3D bricks;uniform sampler2D table,depth;
uniform vec3 eye,right,up,forward,size,spacing,origin,brickCount;uniform vec4 cut;uniform vec2 planes;uniform float stepMm;
in vec2 at;out vec4 colour;
${what}
vec3 lit(vec3 base,vec3 v,vec3 d){
vec3 g=vec3(huAt(v+vec3(1,0,0))-huAt(v-vec3(1,0,0)),huAt(v+vec3(0,1,0))-huAt(v-vec3(0,1,0)),
huAt(v+vec3(0,0,1))-huAt(v-vec3(0,0,1)))/(2.*spacing);
float steep=length(g),share=min(1.,steep/50.),f=abs(dot(g,d))/max(1e-6,steep);
return base*(.7+share*(.28+.72*f-.7))+.12*share*pow(f,24.);}
void main(){
vec2 p=at*2.-1.;vec3 ray=forward+p.x*right+p.y*up;float l=length(ray);
vec3 from=(eye-origin)/spacing,along=ray/spacing;
float begin=planes.x,end=planes.y,z=texture(depth,at).r;
if(z<1.)end=min(end,2.*planes.x*planes.y/(planes.x+planes.y-(2.*z-1.)*(planes.y-planes.x)));
for(int a=0;a<3;++a){float s=abs(along[a])<1e-7?1e-7:along[a],n=(-.5-from[a])/s,f=(size[a]-.5-from[a])/s;
begin=max(begin,min(n,f));end=min(end,max(n,f));}
float c=dot(cut.xyz,eye)+cut.w,k=dot(cut.xyz,ray);
if(abs(k)<1e-7){if(c<0.)end=begin;}else if(k>0.)begin=max(begin,-c/k);else end=min(end,-c/k);
float s=stepMm/l,light=1.;vec3 sum=vec3(0);
for(int n=int(begin/s);float(n)*s<end&&light>.005;++n){
float low=max(begin,float(n)*s),high=min(end,float(n+1)*s);if(high<=low)continue;
vec3 v=from+along*(.5*(low+high)),b=clamp(floor(v/${brickVoxels}.),vec3(0),brickCount-1.);
if(texelFetch(bricks,ivec3(b),0).r>.5){
vec3 x=((b+step(0.,along))*${brickVoxels}.-from)/(abs(along)+1e-9)*sign(along+1e-12);
n=max(n,int(min(x.x,min(x.y,x.z))/s-.5)-1);continue;}
vec4 e=entry(v);if(e.a<=0.)continue;
float alpha=1.-pow(max(1e-6,1.-e.a),(high-low)*l);
sum+=light*alpha*lit(e.rgb,v,ray/l);light*=1.-alpha;}
colour=vec4(sum,1.-light);}`
const layFragment = `#version 300 es
precision highp float;uniform sampler2D picture;in vec2 at;out vec4 o;void main(){o=texture(picture,at);}`

// The bits of a half float.
function halfOf(v) {
  const bits = new Uint32Array(new Float32Array([v]).buffer)[0],
    sign = (bits >> 16) & 0x8000,
    exponent = ((bits >> 23) & 255) - 112
  return exponent <= 0 ? sign : sign | (exponent << 10) | ((bits >> 13) & 0x3ff)
}

// Opacity and colour at these HU: [[hu, opacity, r, g, b], ...] by ascending HU, linear between, and beyond the ends as these.
function atHu(points, hu) {
  const n = points.findIndex(p => p[0] > hu)
  if (n < 0) return points[points.length - 1].slice(1)
  if (n === 0) return points[0].slice(1)
  const [a, b] = [points[n - 1], points[n]],
    f = (hu - a[0]) / (b[0] - a[0])
  return [1, 2, 3, 4].map(k => a[k] + f * (b[k] - a[k]))
}

// Calls take(brick, voxel) for each voxel and each brick that reads it: its own, and those next to it. Returns how many bricks
// there are along each axis.
function forEachBrick(size, take) {
  const count = size.map(n => Math.ceil(n / brickVoxels))
  const bricksOf = (i, axis) => {
    const own = Math.floor(i / brickVoxels)
    return [own, Math.floor((i - 1) / brickVoxels), Math.floor((i + 1) / brickVoxels)].filter(
      (b, n, all) => b >= 0 && b < count[axis] && all.indexOf(b) === n
    )
  }
  const inX = Array.from({ length: size[0] }, (_, i) => bricksOf(i, 0))
  for (let k = 0, at = 0; k < size[2]; ++k)
    for (let j = 0; j < size[1]; ++j) {
      const rows = bricksOf(k, 2).flatMap(z => bricksOf(j, 1).map(y => count[0] * (y + count[1] * z)))
      for (let i = 0; i < size[0]; ++i, ++at) for (const row of rows) for (const x of inX[i]) take(row + x, at)
    }
  return count
}

// What rays go through: `what` the shader sees at a place, `fill` of the texture of voxels, `look(how)` for the table of colours
// and opacities and for the bricks in which nothing of it is seen (255).
function huSource(volume, hu) {
  const { size, voxels } = volume,
    bricks = size.reduce((n, s) => n * Math.ceil(s / brickVoxels), 1),
    lowest = new Uint8Array(bricks).fill(255),
    highest = new Uint8Array(bricks)
  const count = forEachBrick(size, (b, at) => {
    const v = voxels[at]
    if (v < lowest[b]) lowest[b] = v
    if (v > highest[b]) highest[b] = v
  })
  const fill = gl => {
    const halves = Uint16Array.from(hu, halfOf),
      samples = new Uint16Array(voxels.length)
    for (let n = 0; n < voxels.length; ++n) samples[n] = halves[voxels[n]]
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R16F, ...size, 0, gl.RED, gl.HALF_FLOAT, samples)
  }
  // Where several functions see something, what one lets through meets the next, and the colour is their mean by opacity.
  const look = ({ functions, shift }) => {
    const table = new Uint8Array(4 * 4096),
      seen = new Uint32Array(4097)
    for (let n = 0; n < 4096; ++n) {
      const all = functions.map(points => atHu(points, n - 1024 - shift)),
        weights = all.map(e => e[0] + 1e-6),
        sum = weights.reduce((a, w) => a + w),
        colour = [1, 2, 3].map(k => all.reduce((a, e, f) => a + weights[f] * e[k], 0) / sum),
        opacity = 1 - all.reduce((clear, e) => clear * (1 - e[0]), 1)
      table.set([...colour, opacity].map(v => Math.round(255 * v)), 4 * n)
      seen[n + 1] = seen[n] + (table[4 * n + 3] > 0)
    }
    const index = v => Math.max(0, Math.min(4095, v + 1024)),
      empty = lowest.map((low, b) => {
        const from = Math.floor(index(hu[low])),
          to = Math.ceil(index(hu[highest[b]]))
        return seen[to + 1] > seen[from] ? 0 : 255
      })
    return { table, empty }
  }
  return { volume, what: ofHu, filter: 'LINEAR', fill, look, count }
}

// `shapes`: number and colour of each. What is looked for is one of them, or (0) all.
function shapeSource(volume, shapes) {
  const { size, voxels, shares } = volume,
    all = voxels.length,
    bricks = size.reduce((n, s) => n * Math.ceil(s / brickVoxels), 1),
    holds = new Uint32Array(bricks) // bit n - 1: shape n
  const bit = n => (n ? 1 << (n - 1) : 0),
    count = forEachBrick(size, (b, at) => {
      if (shares[at]) holds[b] |= bit(voxels[at]) | bit(shares[all + at])
    })
  const fill = gl => {
    const samples = new Uint8Array(4 * all)
    for (let n = 0; n < all; ++n) {
      samples[4 * n] = voxels[n]
      samples[4 * n + 1] = shares[n]
      samples[4 * n + 2] = shares[all + n]
    }
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA8UI, ...size, 0, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE, samples)
  }
  const look = ({ shape }) => {
    const table = new Uint8Array(4 * 4096),
      seen = shapes.filter(s => !shape || s.number === shape),
      bits = seen.reduce((a, s) => a | bit(s.number), 0)
    for (const s of seen) table.set([...s.colour_rgb, 1].map(v => Math.round(255 * v)), 4 * s.number)
    return { table, empty: Uint8Array.from(holds, h => (h & bits ? 0 : 255)) }
  }
  return { volume, what: ofShapes, filter: 'NEAREST', fill, look, count }
}

// What the page can cast, by the name that is chosen: the CT by each transfer function, and what is felt, all of it or one shape.
function castsOf({ ct, felt, transfers = {} }) {
  const casts = new Map(),
    shapes = felt ? felt.shapes : []
  if (ct) for (const name of Object.keys(transfers)) casts.set(name, { of: 'ct', functions: [transfers[name]] })
  const offer = (name, some) => {
    if (felt.shares) casts.set(name, { of: 'felt', shape: some.length === 1 ? some[0].number : 0, fixed: true })
    else if (ct && ct.from === 'haptic') casts.set(name, { of: 'ct', functions: some.map(s => s.transfer), fixed: true })
  }
  if (shapes.length) offer('felt: all', shapes)
  if (shapes.length > 1) for (const s of shapes) offer('felt: ' + label(s.name), [s])
  return casts
}

function makeCast(gl, source) {
  const { size, spacing, origin } = source.volume
  const texture = (target, filter) => {
    const t = gl.createTexture()
    gl.bindTexture(target, t)
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(target, name, filter)
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(target, name, gl.CLAMP_TO_EDGE)
    return t
  }
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1)
  const t = { voxels: texture(gl.TEXTURE_3D, gl[source.filter]) }
  source.fill(gl)
  t.bricks = texture(gl.TEXTURE_3D, gl.NEAREST)
  t.table = texture(gl.TEXTURE_2D, gl.NEAREST)
  t.depth = texture(gl.TEXTURE_2D, gl.NEAREST)
  t.picture = texture(gl.TEXTURE_2D, gl.LINEAR)
  const casting = programOf(gl, castVertex, castFragment(source.what)),
    laying = programOf(gl, castVertex, layFragment),
    frames = { depth: gl.createFramebuffer(), picture: gl.createFramebuffer() }
  const cast = { shown: null, ms: 0 } // ms: what a whole picture at rest would take
  const look = how => {
    const { table, empty } = source.look(how)
    gl.bindTexture(gl.TEXTURE_2D, t.table)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 1024, 4, 0, gl.RGBA, gl.UNSIGNED_BYTE, table)
    gl.bindTexture(gl.TEXTURE_3D, t.bricks)
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.R8, ...source.count, 0, gl.RED, gl.UNSIGNED_BYTE, empty)
  }
  const bind = (program, names) =>
    names.forEach((name, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit)
      gl.bindTexture(name === 'voxels' || name === 'bricks' ? gl.TEXTURE_3D : gl.TEXTURE_2D, t[name])
      gl.uniform1i(gl.getUniformLocation(program, name), unit)
    })
  // `surfaces` draws the opaque ones, of which only the depth counts. The picture is laid over what is drawn already. Unless it
  // is to be `whole`, it is as coarse as a picture of 120 ms needs; says whether it is.
  cast.draw = ({ cam, clip, cast: how, whole }, canvas, surfaces) => {
    const began = performance.now(),
      key = JSON.stringify(how)
    if (cast.shown !== key) look(how)
    cast.shown = key
    const scale = whole ? 1 : Math.max(1, Math.min(8, Math.sqrt(cast.ms / 240)))
    const w = Math.max(1, Math.round(canvas.width / scale)),
      h = Math.max(1, Math.round(canvas.height / scale))
    gl.bindTexture(gl.TEXTURE_2D, t.depth)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, w, h, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null)
    gl.bindTexture(gl.TEXTURE_2D, t.picture)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, w, h, 0, gl.RGBA, gl.UNSIGNED_BYTE, null)
    gl.bindTexture(gl.TEXTURE_2D, null)
    gl.viewport(0, 0, w, h)
    gl.bindFramebuffer(gl.FRAMEBUFFER, frames.depth)
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, t.depth, 0)
    gl.clear(gl.DEPTH_BUFFER_BIT)
    surfaces()
    gl.bindFramebuffer(gl.FRAMEBUFFER, frames.picture)
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, t.picture, 0)
    gl.disable(gl.DEPTH_TEST)
    gl.disable(gl.BLEND)
    gl.useProgram(casting)
    bind(casting, ['voxels', 'bricks', 'table', 'depth'])
    const at = name => gl.getUniformLocation(casting, name),
      { right, up, forward, eye } = cam.basis(),
      [x, y] = cam.tangents(canvas.width, canvas.height)
    gl.uniform3fv(at('eye'), eye)
    gl.uniform3fv(at('right'), right.map(v => v * x))
    gl.uniform3fv(at('up'), up.map(v => v * y))
    gl.uniform3fv(at('forward'), forward)
    gl.uniform3fv(at('size'), size)
    gl.uniform3fv(at('spacing'), spacing)
    gl.uniform3fv(at('origin'), origin)
    gl.uniform3fv(at('brickCount'), source.count)
    gl.uniform4fv(at('cut'), clipPlane(clip, { clip: true }))
    gl.uniform2fv(at('planes'), cam.reach())
    gl.uniform1f(at('stepMm'), (whole ? 0.5 : 1) * Math.min(...spacing))
    gl.drawArrays(gl.TRIANGLES, 0, 3)
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)) // waits until it is there
    cast.ms = (performance.now() - began) * scale * scale * (whole ? 1 : 2)
    gl.bindFramebuffer(gl.FRAMEBUFFER, null)
    gl.viewport(0, 0, canvas.width, canvas.height)
    gl.useProgram(laying)
    bind(laying, ['picture'])
    gl.enable(gl.BLEND)
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA)
    gl.drawArrays(gl.TRIANGLES, 0, 3)
    gl.activeTexture(gl.TEXTURE0)
    return !whole
  }
  return cast
}
