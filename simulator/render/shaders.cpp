// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shaders.h"

namespace trephine::render::shaders {

const char* const surface_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour_linear;
uniform mat4 model, to_camera, projection;
uniform vec4 clip;  // removed where dot(clip.xyz, p) > clip.w
out vec3 place, seen_from_eye, facing, albedo;
#ifdef SHADOW
uniform mat4 to_shadow;
out vec3 in_shadow;
#endif
void main() {
  vec4 p = model * vec4(position, 1);
  vec4 c = to_camera * p;
  place = p.xyz;
  seen_from_eye = c.xyz;
  facing = mat3(to_camera) * (mat3(model) * normal);
  albedo = colour_linear;
#ifdef SHADOW
  in_shadow = (to_shadow * vec4(p.xyz, 1)).xyz;
#endif
  gl_ClipDistance[0] = clip.w - dot(clip.xyz, p.xyz);
  gl_Position = projection * c;
}
)";

// The lights are those of the toolchain's pictures: a key light from the upper left, a weak one from the right, a rim
// light from behind, and a sky that is a little brighter than the ground; they stand still relative to the viewer.
// Parts that a surface does not need are not compiled (surface_parts): a processor that draws runs both sides of a
// branch.
const char* const surface_fragment = R"(
in vec3 place, seen_from_eye, facing, albedo;
#ifdef LABEL  // what it is, and how far before the eye along its line of sight
uniform int label;
layout(location = 0) out float depth_mm;
layout(location = 1) out uint seen;
#else
uniform float opacity;
out vec4 colour;
#endif
#ifdef GRAIN
uniform float grain;
uniform sampler3D noise;
#endif
#ifdef GLOW
uniform float glow;
uniform vec3 glow_place, glow_colour;
#endif
#ifdef BALLS
uniform int balls;
uniform vec4 ball[48];
#endif
#ifdef WALL  // the inside of an incision's ball, where the surface's occupancy is 1/2 or more
uniform int wall_ball;
uniform mat4 to_occupancy;
uniform sampler3D occupancy;
#endif
#ifdef THEATRE
uniform vec4 field, wound;  // places, with the lamp's radius and the wound's
uniform float open_mm, wet, bump_mm;  // open_mm: of the drape, 0 where there is none
// Leans the normal as a height over the surface would, by how it changes from pixel to pixel [Mikkelsen2010].
vec3 bumped(vec3 n, float high_mm) {
  vec3 dx = dFdx(seen_from_eye), dy = dFdy(seen_from_eye);
  vec3 across = cross(dy, n), along = cross(n, dx);
  float det = dot(dx, across);
  vec3 lean = sign(det) * (dFdx(high_mm) * across + dFdy(high_mm) * along);
  lean /= max(abs(det), 1e-9);
  return normalize(n - lean * min(1, 0.5 / max(length(lean), 1e-6)));  // seen from afar it is no steeper than that
}
#endif
#ifdef DUST
uniform mat4 to_dust;
uniform sampler3D dust, grains;
#endif
#ifdef SHADOW  // of the tool
uniform int shadow_taps;
in vec3 in_shadow;
uniform vec2 shadow_step;
uniform sampler2DShadow shadow;
// How much of the key light comes past the tool.
float past_tool() {
  const vec2 taps[5] = vec2[5](vec2(0), vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1));
  float sum = 0;
  for (int i = 0; i < shadow_taps; ++i) sum += texture(shadow, vec3(in_shadow.xy + taps[i] * shadow_step, in_shadow.z));
  return sum / shadow_taps;
}
#else
float past_tool() { return 1; }
#endif
void main() {
#ifdef BALLS
  float edge_mm = 1e3;  // to the nearest incision's edge
  for (int n = 0; n < balls; ++n) {
#ifdef WALL
    if (n == wall_ball) continue;
#endif
    float beyond_mm = distance(place, ball[n].xyz) - ball[n].w;
    if (beyond_mm < 0) discard;
    edge_mm = min(edge_mm, beyond_mm);
  }
#endif
#ifdef WALL
  vec3 at = (to_occupancy * vec4(place, 1)).xyz;
  if (any(lessThan(at, vec3(0))) || any(greaterThan(at, vec3(1))) || texture(occupancy, at).r < 0.5) discard;
#endif
#ifdef LABEL
  depth_mm = -seen_from_eye.z;
  seen = uint(label);
#else
  vec3 n = normalize(facing), to_eye = normalize(-seen_from_eye);
  bool inner = !gl_FrontFacing;  // not by the normal, which leans over the edge where a surface turns away
  if (inner) n = -n;
  vec3 base = albedo;
#ifdef GRAIN
  float g = texture(noise, place * 0.045).r * 0.6 + texture(noise, place * 0.21).r * 0.4 - 0.5;
  base *= 1 + grain * g;
#endif
  if (inner) base *= vec3(0.62, 0.5, 0.5);
#ifdef THEATRE
  const vec3 blood = vec3(0.17, 0.008, 0.008);
  float moist = wet, rough = 0;
#ifdef GRAIN
  rough = g;
#endif
  float from_field_mm = distance(place, field.xyz);
  if (open_mm > 0 && from_field_mm > open_mm) {  // cloth
    float weave = 0.5 + 0.25 * (sin(place.x * 5.2) * sin(place.y * 5.2) + sin(place.z * 5.2));
    base = vec3(0.018, 0.16, 0.15) * (0.86 + 0.28 * weave);
    base *= 0.45 + 0.55 * smoothstep(0, 3.5, from_field_mm - open_mm);  // the hem
    moist = 0;
  } else {
    if (open_mm > 0) base = mix(base, base * vec3(0.92, 0.66, 0.40), 0.5);  // the skin was prepared
#ifdef BALLS
    float bled = 1 - smoothstep(0.4, 2.6 + 5.0 * rough, edge_mm);
    base = mix(base, blood, 0.9 * max(0, bled));
    moist = max(moist, bled);
#else
    // Beneath the skin blood gathers along the edge of what is open.
    float in_wound = distance(place, wound.xyz) / max(wound.w, 1e-3);
    float smeared = wound.w > 0 ? smoothstep(0.62, 1.0, in_wound + 0.5 * rough) * (1 - step(1.25, in_wound)) : 0;
    base = mix(base, blood, 0.75 * smeared);
#endif
#ifdef WALL
    base = mix(base, blood, 0.55 + 0.4 * rough);
#endif
  }
#ifdef GRAIN
  if (!inner) n = bumped(n, bump_mm * rough);
#endif
#endif
#ifdef DUST
  // Powder lies in flecks; where it is wet it is a slurry, darker and redder; blood lies over it. Wet bone shines. A
  // processor that draws leaves out a loop of no turns, where it would run both sides of a branch.
  vec3 in_dust = (to_dust * vec4(place, 1)).xyz;
  float water = 0;
  int near = !inner && all(greaterThan(in_dust, vec3(0))) && all(lessThan(in_dust, vec3(1))) ? 1 : 0;
  for (int n = 0; n < near; ++n) {
    vec3 powder = textureLod(dust, in_dust, 0).rgb;
    water = powder.g;
    base *= 1 - 0.25 * water;
    int covered = max(powder.r, powder.b) > 0.02 ? 1 : 0;
    for (int m = 0; m < covered; ++m) {
      float fleck = textureLod(grains, place * 0.19, 0).r;
      float lies = smoothstep(0.40, 0.60, 0.8 * powder.r + 0.8 * (fleck - 0.5)) * min(1, 4 * powder.r);
      vec3 powdered = mix(vec3(0.92, 0.90, 0.86), vec3(0.48, 0.25, 0.20), 0.75 * water) * (0.6 + 0.7 * fleck);
      base = mix(base, powdered, 0.92 * lies);
      float bloody = smoothstep(0.30, 0.70, powder.b + 0.3 * (fleck - 0.5));
      base = mix(base, mix(vec3(0.10, 0.003, 0.004), vec3(0.20, 0.012, 0.012), water), 0.94 * bloody);
      water = max(water, bloody);
    }
  }
#endif
  const vec3 key = normalize(KEY_LIGHT), fill = normalize(vec3(0.80, 0.05, 0.45)),
             rim = normalize(vec3(0.25, 0.55, -0.80));
  float past = past_tool();
  float light = 0.70 * past * max(0.0, dot(n, key)) + 0.30 * max(0.0, dot(n, fill)) + 0.12 * max(0.0, dot(n, rim)) +
                0.26 + 0.08 * n.y;
  float shine = max(0.0, dot(n, normalize(key + to_eye)));
  for (int i = 0; i < 5; ++i) shine *= shine;  // to the power of 32
  vec3 lit = base * light + 0.10 * past * shine;
#ifdef THEATRE
  float lamp = 1 - smoothstep(0.55 * field.w, 1.5 * field.w, from_field_mm);
  lit = (base * light + past * (0.06 * shine + moist * (0.30 * shine * shine + 0.05 * shine))) *
        mix(vec3(0.30, 0.33, 0.36), vec3(1.22, 1.17, 1.08), lamp);
#endif
#ifdef DUST
  lit += water * past * (0.22 * shine + 0.25 * shine * shine);
#endif
#ifdef GLOW
  // A spot where the tool touches, and a ring of 2.2 mm around it.
  float d = distance(place, glow_place);
  float near_ring = max(0.0, 1 - 3 * (d - 2.2) * (d - 2.2)), near_spot = max(0.0, 1 - 2 * d * d);
  lit = mix(lit, glow_colour, min(1.0, (near_ring * near_ring + near_spot * near_spot) * glow));
#endif
  float grazing = 1 - abs(dot(n, to_eye));
  float a = opacity >= 1 ? 1 : opacity + (1 - opacity) * 0.7 * grazing * grazing * grazing;
  colour = vec4(lit, a);
#endif
}
)";

const char* const plane_vertex = R"(#version 430 core
layout(location = 0) in vec2 corner;  // -1 to 1
uniform vec3 middle, across, along;
uniform mat4 to_camera, projection;
out vec3 place;
void main() {
  place = middle + across * corner.x + along * corner.y;
  gl_Position = projection * (to_camera * vec4(place, 1));
}
)";

const char* const plane_fragment = R"(#version 430 core
in vec3 place;
uniform vec3 tint;       // linear
uniform float ct_share;  // 0: the tint alone
uniform int only_ct;     // 1: nothing where no CT is
uniform float light, low, high;
uniform int encode;  // 1: for a framebuffer that takes sRGB as it is
uniform mat4 to_ct;
uniform sampler3D ct;
uniform int balls;
uniform vec4 ball[48];
out vec4 colour;
void main() {
  for (int n = 0; n < balls; ++n)
    if (distance(place, ball[n].xyz) < ball[n].w) discard;
  vec3 c = tint * light;
  if (ct_share > 0) {
    vec3 at = (to_ct * vec4(place, 1)).xyz;
    bool inside = all(greaterThanEqual(at, vec3(0))) && all(lessThanEqual(at, vec3(1)));
    if (only_ct == 1 && (!inside || texture(ct, at).r * 32767 < -500)) discard;  // nothing where air is
    if (inside) {
      float grey = clamp((texture(ct, at).r * 32767 - low) / (high - low), 0, 1);
      c = mix(c, vec3(grey <= 0.04045 ? grey / 12.92 : pow((grey + 0.055) / 1.055, 2.4)), ct_share);
    }
  }
  if (encode == 1) c = mix(12.92 * c, 1.055 * pow(c, vec3(1 / 2.4)) - 0.055, step(0.0031308, c));
  colour = vec4(c, 1);
}
)";

const char* const shadow_vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 model, to_light;
void main() { gl_Position = to_light * (model * vec4(position, 1)); }
)";

const char* const box_vertex = R"(#version 430 core
uniform mat4 model, to_camera, projection;
uniform vec3 low, high;
void main() {
  const int corner[36] = int[36](0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4,
                                 6, 1, 3, 5, 3, 7, 5);
  int c = corner[gl_VertexID];
  vec3 p = mix(low, high, vec3(c & 1, c >> 1 & 1, c >> 2 & 1));
  gl_Position = projection * (to_camera * (model * vec4(p, 1)));
}
)";

const char* const box_fragment = R"(#version 430 core
void main() {}
)";

const char* const screen_vertex = R"(#version 430 core
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2;
  gl_Position = vec4(at * 2 - 1, 0, 1);
}
)";

// Obscurance after McGuire et al. 2011, from the depth alone: the normal is that of the nearer neighbours. Their
// falloff by the sixth power left a burr hole as bright as what is around it; ours is of the second.
const char* const openness_fragment = R"(#version 430 core
in vec2 at;
uniform sampler2D depth;
uniform vec4 frustum;  // left, right, bottom, top at distance 1
uniform vec2 planes;   // near, far
uniform float radius_mm;
uniform float px_per_tan;  // of the depth's picture
out float open;
float away(float d) { return 2 * planes.x * planes.y / (planes.y + planes.x - (2 * d - 1) * (planes.y - planes.x)); }
vec3 position(ivec2 p, vec2 size) {
  float z = away(texelFetch(depth, p, 0).r);
  vec2 t = (vec2(p) + 0.5) / size;
  return vec3(mix(frustum.xz, frustum.yw, t) * z, -z);
}
void main() {
  ivec2 size = textureSize(depth, 0);
  ivec2 p = min(ivec2(gl_FragCoord.xy) * 2, size - 1);
  if (texelFetch(depth, p, 0).r >= 1) {
    open = 1;
    return;
  }
  vec3 c = position(p, vec2(size));
  vec3 l = position(max(p - ivec2(1, 0), ivec2(0)), vec2(size)), r = position(min(p + ivec2(1, 0), size - 1), vec2(size));
  vec3 b = position(max(p - ivec2(0, 1), ivec2(0)), vec2(size)), t = position(min(p + ivec2(0, 1), size - 1), vec2(size));
  vec3 dx = abs(l.z - c.z) < abs(r.z - c.z) ? c - l : r - c;
  vec3 dy = abs(b.z - c.z) < abs(t.z - c.z) ? c - b : t - c;
  vec3 n = normalize(cross(dx, dy));
  float reach = clamp(radius_mm * px_per_tan / -c.z, 2.0, 200.0);
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float turn = 0.3927 * float((cell.x * 7 + cell.y * 13 + cell.x * cell.y * 5) & 15);
  float sum = 0;
  const int samples = 9;
  for (int i = 0; i < samples; ++i) {
    float k = (float(i) + 0.5) / samples, angle = turn + 2.39996 * float(i) * 1.7;
    ivec2 q = p + ivec2(vec2(cos(angle), sin(angle)) * reach * k);
    if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, size))) continue;
    vec3 v = position(q, vec2(size)) - c;
    float vv = dot(v, v);
    // How far it stands above the surface, as an angle: what is less is a facet's edge. Beyond the radius it counts not.
    sum += max(0.0, dot(v, n) * inversesqrt(vv + 1e-6) - 0.12) * max(0.0, 1 - vv / (radius_mm * radius_mm));
  }
  open = clamp(1 - 2.4 * sum / samples, 0.25, 1.0);
}
)";

// The 4 x 4 cells of the pattern are averaged.
const char* const smooth_fragment = R"(#version 430 core
uniform sampler2D open;
out float smoothed;
void main() {
  ivec2 size = textureSize(open, 0), p = ivec2(gl_FragCoord.xy);
  float sum = 0;
  for (int y = -1; y <= 2; ++y)
    for (int x = -1; x <= 2; ++x) sum += texelFetch(open, clamp(p + ivec2(x, y), ivec2(0), size - 1), 0).r;
  smoothed = sum / 16;
}
)";

const char* const darken_fragment = R"(#version 430 core
in vec2 at;
uniform sampler2D open;
out vec4 colour;
void main() { colour = vec4(texture(open, at).rrr, 1); }
)";

const char* const present_fragment = R"(#version 430 core
in vec2 at;
uniform sampler2D picture;
out vec4 colour;
void main() {
  vec3 c = texture(picture, at).rgb;
  colour = vec4(mix(12.92 * c, 1.055 * pow(c, vec3(1 / 2.4)) - 0.055, step(0.0031308, c)), 1);
}
)";

}  // namespace trephine::render::shaders
