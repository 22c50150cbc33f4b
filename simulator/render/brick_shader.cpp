// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shaders.h"

namespace trephine::render::shaders {

const char* const brick_head = "#version 430 core\n";

// One work group makes one brick of 8^3 cells, as mesh_brick() of drill/live_surface.h does: the same edges and
// triangles, in the same order of cells; only its vertices are numbered by edges. Corner (x, y, z) of the brick's cells
// has the value (x + 1, y + 1, z + 1) of those that are read.
const char* const brick_compute = R"(
layout(local_size_x = 128) in;
struct Place { uint first_vertex, vertex_room, first_index, index_room; };
layout(std430, binding = 0) buffer Vertices { uvec4 vertices[]; };  // position as floats, normal in four bytes
layout(std430, binding = 1) buffer Indices { uint indices[]; };
layout(std430, binding = 2) buffer Places { Place places[]; };
layout(std430, binding = 3) buffer Commands { uint commands[]; };
layout(std430, binding = 4) buffer Heap { uint vertex_end, index_end; };
layout(std430, binding = 5) readonly buffer Work { uvec2 work[]; };  // brick and slot
layout(std140, binding = 0) uniform Cells { uvec4 cells[256]; };
uniform usampler3D values;
uniform ivec3 bricks;
uniform vec3 spacing_mm;
uniform int mirrored, count;

const uint threads = 128u, edges_each = 18u, cells_each = 4u;  // 128 * 18 >= 3 * 9^3, 128 * 4 = 8^3
shared uint value[1331];
shared uint vertex_of[2187];  // by axis and corner
shared uvec2 sums[128];
shared Place place;

uint at(ivec3 corner) { return value[(corner.z + 1) * 121 + (corner.y + 1) * 11 + corner.x + 1]; }
bool solid(ivec3 corner) { return at(corner) > 32767u; }
ivec3 along(int axis) { return ivec3(axis == 0, axis == 1, axis == 2); }
ivec3 corner_of(uint n) { return ivec3(n % 9u, n / 9u % 9u, n / 81u); }
bool crossed(uint edge) {
  if (edge >= 2187u) return false;
  int axis = int(edge / 729u);
  ivec3 p = corner_of(edge % 729u);
  return p[axis] < 8 && solid(p) != solid(p + along(axis));
}
uint cell_set(uint cell) {
  ivec3 p = ivec3(cell % 8u, cell / 8u % 8u, cell / 64u);
  uint set = 0u;
  for (int c = 0; c < 8; ++c) set |= uint(solid(p + ivec3(c & 1, c >> 1 & 1, c >> 2))) << c;
  return set;
}
uint byte_of(uint set, uint n) { return cells[set][n >> 2] >> (8u * (n & 3u)) & 255u; }

uvec4 vertex(ivec3 first, int axis, ivec3 p) {
  ivec3 q = p + along(axis);
  float vp = float(at(p)), vq = float(at(q));
  precise float t = (32767.5 - vp) / (vq - vp);
  precise vec3 position, normal;
  precise float squared = 0;
  for (int a = 0; a < 3; ++a) {
    position[a] = (float(first[a] + p[a]) + (a == axis ? t : 0.0)) * spacing_mm[a];
    ivec3 d = along(a);
    float at_p = float(at(p + d)) - float(at(p - d)), at_q = float(at(q + d)) - float(at(q - d));
    normal[a] = -(at_p + t * (at_q - at_p)) / spacing_mm[a];
    squared += normal[a] * normal[a];
  }
  if (!(squared > 0.0)) {
    normal = vec3(along(axis)) * (vp > vq ? 1.0 : -1.0);
    squared = 1.0;
  }
  return uvec4(floatBitsToUint(position), packSnorm4x8(vec4(normal * (1.0 / sqrt(squared)), 0)));
}

void main() {
  uint item = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, me = gl_LocalInvocationIndex;
  if (item >= uint(count)) return;  // the whole group
  uint brick = work[item].x, slot = work[item].y;
  ivec3 b = ivec3(brick % uint(bricks.x), brick / uint(bricks.x) % uint(bricks.y),
                  brick / uint(bricks.x) / uint(bricks.y));
  for (uint n = me; n < 1331u; n += threads)
    value[n] = texelFetch(values, 8 * b + ivec3(n % 11u, n / 11u % 11u, n / 121u), 0).r;
  barrier();
  uvec2 own = uvec2(0);
  for (uint n = 0u; n < edges_each; ++n) own.x += uint(crossed(me * edges_each + n));
  for (uint n = 0u; n < cells_each; ++n) own.y += 3u * byte_of(cell_set(me * cells_each + n), 0u);
  sums[me] = own;
  barrier();
  for (uint by = 1u; by < threads; by *= 2u) {  // sums of all threads up to this one
    uvec2 add = me >= by ? sums[me - by] : uvec2(0);
    barrier();
    sums[me] += add;
    barrier();
  }
  uvec2 total = sums[threads - 1u], before = sums[me] - own;
#ifdef COUNT
  if (me == 0u) places[slot] = Place(0u, total.x, 0u, total.y);
#else
  if (me == 0u) {
    Place p = places[slot];
    if (total.x > p.vertex_room || total.y > p.index_room) {
      p.vertex_room = total.x + total.x / 2u + 16u;  // a surface that is cut grows
      p.index_room = total.y + total.y / 2u + 16u;
      p.first_vertex = atomicAdd(vertex_end, p.vertex_room);
      p.first_index = atomicAdd(index_end, p.index_room);
      places[slot] = p;
    }
    commands[5u * slot] = total.y;
    commands[5u * slot + 1u] = 1u;
    commands[5u * slot + 2u] = p.first_index;
    commands[5u * slot + 3u] = p.first_vertex;
    commands[5u * slot + 4u] = 0u;
    place = p;
  }
  barrier();
  ivec3 first = 8 * b - 1;
  uint to = before.x;
  for (uint n = 0u; n < edges_each; ++n) {
    uint edge = me * edges_each + n;
    if (!crossed(edge)) continue;
    vertex_of[edge] = to;
    vertices[place.first_vertex + to] = vertex(first, int(edge / 729u), corner_of(edge % 729u));
    ++to;
  }
  barrier();
  to = place.first_index + before.y;
  for (uint n = 0u; n < cells_each; ++n) {
    uint cell = me * cells_each + n, set = cell_set(cell), corners = 3u * byte_of(set, 0u);
    ivec3 p = ivec3(cell % 8u, cell / 8u % 8u, cell / 64u);
    for (uint k = 0u; k < corners; ++k) {
      // In a left-handed lattice the second and third corner change places.
      uint from = mirrored == 1 && k % 3u != 0u ? k - k % 3u + 3u - k % 3u : k;
      uint edge = byte_of(set, from + 1u), axis = edge >> 2, m = edge & 3u;
      uint c = axis == 0u ? m << 1 : axis == 1u ? (m & 1u) | (m & 2u) << 1 : m;
      ivec3 low = p + ivec3(c & 1u, c >> 1 & 1u, c >> 2);
      indices[to++] = vertex_of[axis * 729u + uint(low.z * 81 + low.y * 9 + low.x)];
    }
  }
#endif
}
)";

}  // namespace trephine::render::shaders
