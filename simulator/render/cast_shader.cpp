// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shaders.h"

namespace trephine::render::shaders {

// As cast/ray_cast.cpp does, where the words are. Lengths are mm from the eye along the ray; directions are in the
// eye's axes, places in voxels. What need not be done stands in a loop of one turn or none: a processor that draws runs
// both sides of a branch, and leaves out a loop of no turns.
const char* const cast_fragment = R"(
#ifdef SHAPES
uniform usampler3D voxels;
#else
uniform sampler3D voxels;
#endif
uniform sampler3D bricks;
uniform sampler2D table, depth;
uniform vec4 frustum;  // left, right, bottom, top at distance 1
uniform vec2 planes, picture;  // near and far; pixels
uniform vec3 from, size, spacing_mm, brick_count;
uniform mat4 to_voxels, to_eye;  // of directions
uniform vec4 cut;  // seen where dot(cut.xyz, along) * t + cut.w <= 0
uniform vec3 box_low, box_high;
uniform mat4 to_box;
uniform float step_mm;
uniform vec2 seen_hu;
layout(location = 0) out vec4 colour;
layout(location = 1) out float hides_mm;

#ifdef SHAPES
uint seen;  // the shape that entry() found

uvec4 voxel_at(ivec3 first, int c) { return texelFetch(voxels, min(first + ivec3(c & 1, c >> 1 & 1, c >> 2), ivec3(size) - 1), 0); }
float weight_of(vec3 f, int c) {
  vec3 w = mix(1 - f, f, vec3(c & 1, c >> 1 & 1, c >> 2));
  return w.x * w.y * w.z;
}
float share_of(uvec4 v, uint number) { return float(v.r == number ? v.g : v.b == number ? FULL - v.g : 0u); }
float hu_at(vec3 at) {
  at = clamp(at, vec3(0), size - 1);
  ivec3 first = ivec3(at);
  float sum = 0;
  for (int c = 0; c < 8; ++c) sum += weight_of(at - first, c) * share_of(voxel_at(first, c), seen);
  return sum * (SHAPE_HU / float(FULL));
}

void vote(uint number, float weight, inout float by) {
  by += number == seen ? weight : -weight;
  if (by < 0) {
    seen = number;
    by = -by;
  }
}
vec4 entry(vec3 at) {
  at = clamp(at, vec3(0), size - 1);
  ivec3 first = ivec3(at);
  uvec4 v[8];
  float w[8], by = 0, sum = 0;
  seen = 0u;
  for (int c = 0; c < 8; ++c) {
    v[c] = voxel_at(first, c);
    w[c] = weight_of(at - first, c);
    vote(v[c].r, w[c] * float(v[c].g), by);
    vote(v[c].b, w[c] * float(FULL - v[c].g), by);
  }
  for (int c = 0; c < 8; ++c) sum += w[c] * share_of(v[c], seen);
  return seen != 0u && sum >= 0.5 * float(FULL) ? texelFetch(table, ivec2(seen, 0), 0) : vec4(0);
}
#else
float hu_at(vec3 at) { return textureLod(voxels, (at + 0.5) / size, 0).r * 32767; }

// Where nothing is seen, the table is not read.
vec4 entry(vec3 at) {
  float hu = hu_at(at);
  vec4 e = vec4(0);
  int reads = hu > seen_hu.x && hu < seen_hu.y ? 1 : 0;
  for (int k = 0; k < reads; ++k) {
    float x = clamp(hu - TABLE_LOW, 0, TABLE_COUNT - 1);
    int n = min(int(x), TABLE_COUNT - 2);
    e = mix(texelFetch(table, ivec2(n & 1023, n >> 10), 0), texelFetch(table, ivec2(n + 1 & 1023, n + 1 >> 10), 0), x - n);
  }
  return e;
}
#endif

void between(float start, float along, float low, float high, inout float begin, inout float end) {
  if (abs(along) < 1e-7) {
    if (start < low || start > high) end = -1e30;
    return;
  }
  float a = (low - start) / along, b = (high - start) / along;
  begin = max(begin, min(a, b));
  end = min(end, max(a, b));
}

vec3 lit(vec3 base, vec3 at, vec3 to_viewer, float lit_share) {
  vec3 g = vec3(hu_at(at + vec3(1, 0, 0)) - hu_at(at - vec3(1, 0, 0)), hu_at(at + vec3(0, 1, 0)) - hu_at(at - vec3(0, 1, 0)),
                hu_at(at + vec3(0, 0, 1)) - hu_at(at - vec3(0, 0, 1))) / (2 * spacing_mm);
  float steep = length(g), share = lit_share * min(1.0, steep / UNLIT);
  vec3 n = mat3(to_eye) * g * (-1 / max(1e-6, steep));
  if (dot(n, to_viewer) < 0) n = -n;
  const vec3 key = normalize(KEY_LIGHT), fill = normalize(vec3(0.80, 0.05, 0.45)),
             rim = normalize(vec3(0.25, 0.55, -0.80));
  float light = 0.70 * max(0.0, dot(n, key)) + 0.30 * max(0.0, dot(n, fill)) + 0.12 * max(0.0, dot(n, rim)) + 0.26 +
                0.08 * n.y;
  float shine = max(0.0, dot(n, normalize(key + to_viewer)));
  for (int i = 0; i < 5; ++i) shine *= shine;
  return base * (0.7 + share * (light - 0.7)) + 0.10 * share * shine;
}

void main() {
  vec3 d = normalize(vec3(mix(frustum.xz, frustum.yw, gl_FragCoord.xy / picture), -1));
  vec3 along = mat3(to_voxels) * d;
  ivec2 behind = textureSize(depth, 0);
  float z = texelFetch(depth, min(ivec2(gl_FragCoord.xy / picture * vec2(behind)), behind - 1), 0).r;
  float begin = 0, end = 1e6;
  if (z < 1) end = 2 * planes.x * planes.y / (planes.y + planes.x - (2 * z - 1) * (planes.y - planes.x)) / -d.z;
  vec3 in_box = mat3(to_box) * d;
  for (int a = 0; a < 3; ++a) {
    between(from[a], along[a], -0.5, size[a] - 0.5, begin, end);
    between(0, in_box[a], box_low[a], box_high[a], begin, end);
  }
  between(cut.w, dot(cut.xyz, d), -1e30, 0, begin, end);
  vec3 sum = vec3(0);
  float light = 1, hidden = 1e6;
  bool clear = true, cut_in = false;
  int n = int(begin / step_mm);
  while (begin < end && n * step_mm < end && light >= LEAST) {
    float low = max(begin, n * step_mm), high = min(end, (n + 1) * step_mm), t = (low + high) / 2;
    vec3 at = from + along * t;
    vec3 b = clamp(floor(at / BRICK), vec3(0), brick_count - 1);
    float away = texelFetch(bricks, ivec3(b), 0).r * 255;
    int looks = away < 0.5 ? 1 : 0;
    vec3 leaves = ((b + mix(vec3(1 - away), vec3(away), greaterThan(along, vec3(0)))) * BRICK - from) / along;
    leaves = mix(leaves, vec3(1e30), lessThan(abs(along), vec3(1e-7)));
    int next = looks > 0 ? n + 1 : max(n + 1, int(min(leaves.x, min(leaves.y, leaves.z)) / step_mm - 0.5));
    bool was_clear = clear;
    clear = true;
    for (int k = 0; k < looks; ++k) {
      vec4 e = entry(at);
      int shows = e.a > 0 ? 1 : 0;
      for (int l = 0; l < shows; ++l) {
        int begins = was_clear ? 1 : 0;
        for (int m = 0; m < begins; ++m) {
          low = max(begin, t - step_mm);
          int halvings = entry(from + along * low).a > 0 ? 0 : HALVINGS;
          float until = halvings > 0 ? t : low;
          for (int i = 0; i < halvings; ++i) {
            float middle = (low + until) / 2;
            bool there = entry(from + along * middle).a > 0;
            until = there ? middle : until;
            low = there ? low : middle;
          }
          low = until;
          t = (low + high) / 2;
          at = from + along * t;
          e = entry(at);
          cut_in = cut_in || low == begin;
        }
        clear = false;
        float alpha = 1 - pow(max(1e-6, 1 - e.a), high - low);
        sum += light * alpha * lit(e.rgb, at, -d, cut_in ? min(1, (t - begin) / (CUT_STEPS * step_mm)) : 1);
        light *= 1 - alpha;
        hidden = light <= 0.5 && hidden >= 1e6 ? low : hidden;
      }
    }
    n = next;
  }
  colour = vec4(sum, 1 - light);
  hides_mm = hidden;
}
)";

// Lays a cast over the picture, or (DEPTH) its places into the picture's depth.
const char* const cast_over_fragment = R"(
in vec2 at;
#ifdef DEPTH
uniform sampler2D hides_mm;
uniform vec4 frustum;
uniform vec2 planes;
void main() {
  float t = texture(hides_mm, at).r;
  if (t >= 1e6) discard;
  float z = -normalize(vec3(mix(frustum.xz, frustum.yw, at), -1)).z * t;
  gl_FragDepth = 0.5 + 0.5 * (planes.y + planes.x - 2 * planes.x * planes.y / z) / (planes.y - planes.x);
}
#else
uniform sampler2D rays;
out vec4 colour;
void main() { colour = texture(rays, at); }
#endif
)";

}  // namespace trephine::render::shaders
