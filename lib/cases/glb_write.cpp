// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/refusal.h"
#include "base/srgb.h"
#include "base/text.h"
#include "cases/glb.h"
#include "cases/glb_layout.h"
#include "surface/vertex_normals.h"

namespace trephine::cases {
namespace {

using Json = nlohmann::json;
using Float3 = std::array<float, 3>;

Float3 to_unit_float(Vec3 v) {
  v = normalized(v);
  if (!(norm(v) > 0.5)) v = {0, 0, 1};  // a point that no triangle uses
  return {float(v.x), float(v.y), float(v.z)};
}

// Further digits would depend on the C library.
double rounded_linear(double srgb) { return std::round(linear_of_srgb(srgb) * 1e6) / 1e6; }

struct Arrays {
  std::vector<Float3> positions, normals;
  Float3 least, most;
};

Arrays rounded(const surface::TriMesh& mesh, Vec3 center_mm) {
  Arrays a;
  a.least.fill(std::numeric_limits<float>::max());
  a.most.fill(std::numeric_limits<float>::lowest());
  const Vec3 shift = mesh.origin_mm - center_mm;
  a.positions.reserve(mesh.points_mm.size());
  for (const Vec3 p : mesh.points_mm) {
    const Vec3 q = shift + p;
    // + 0.f turns -0 into 0, so that equal positions give equal bytes.
    const Float3 f{float(q.x) + 0.f, float(q.y) + 0.f, float(q.z) + 0.f};
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(f[c])) throw Error(ExitCode::bad_input, "", "glb", "a point does not fit float32");
      a.least[c] = std::min(a.least[c], f[c]);
      a.most[c] = std::max(a.most[c], f[c]);
    }
    a.positions.push_back(f);
  }
  std::vector<Vec3> own;
  if (mesh.normals.empty()) own = surface::vertex_normals(mesh);
  const auto& normals = mesh.normals.empty() ? own : mesh.normals;
  a.normals.reserve(normals.size());
  for (const Vec3 n : normals) a.normals.push_back(to_unit_float(n));
  return a;
}

void check_triangles(const surface::TriMesh& mesh, const std::vector<Float3>& positions) {
  std::size_t bad = 0;
  for (const auto& t : mesh.triangles)
    bad +=
        positions[t[0]] == positions[t[1]] || positions[t[1]] == positions[t[2]] || positions[t[2]] == positions[t[0]];
  if (bad > 0)
    throw refusal("glb", std::to_string(bad) + " triangles lose a side when their points are rounded to float32",
                  {"allow larger triangles by `max_deviation_mm` of `decimate`, or mend the surface with `repair`"});
}

// Zeros up to a multiple of four, as glTF wants its views and chunks.
void pad(std::string& bytes, char with) { bytes.resize((bytes.size() + 3) / 4 * 4, with); }

template <class T>
void append(std::string& out, const T* data, std::size_t count) {
  out.append(reinterpret_cast<const char*>(data), count * sizeof(T));
  pad(out, '\0');
}

// The binary chunk: positions, normals, indices.
std::string data_of(const surface::TriMesh& mesh, const Arrays& arrays, bool narrow) {
  std::string out;
  append(out, arrays.positions.data(), arrays.positions.size());
  append(out, arrays.normals.data(), arrays.normals.size());
  const std::size_t corners = mesh.triangles.size() * 3;
  if (!narrow) {
    append(out, mesh.triangles.data()->data(), corners);
    return out;
  }
  std::vector<std::uint16_t> indices;
  indices.reserve(corners);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) indices.push_back(static_cast<std::uint16_t>(v));
  append(out, indices.data(), corners);
  return out;
}

Json material_of(const GlbParams& params) {
  Json m = {{"name", params.name}};
  m["pbrMetallicRoughness"] = {{"baseColorFactor",
                                {rounded_linear(params.colour_rgb[0]), rounded_linear(params.colour_rgb[1]),
                                 rounded_linear(params.colour_rgb[2]), params.opacity}},
                               {"metallicFactor", 0.0},
                               {"roughnessFactor", 0.6}};
  if (params.opacity < 1) m["alphaMode"] = "BLEND";
  return m;
}

Json document_of(const surface::TriMesh& mesh, const Arrays& arrays, const GlbParams& params, bool narrow,
                 std::size_t bytes) {
  using namespace detail;
  constexpr int array_buffer = 34962, element_array_buffer = 34963;
  const std::size_t points = arrays.positions.size(), corners = mesh.triangles.size() * 3;
  const std::size_t vector_bytes = points * sizeof(Float3), index_bytes = corners * (narrow ? 2 : 4);
  const Vec3 c = params.center_mm;
  Json out;
  out["asset"] = {{"version", "2.0"}, {"generator", "trephine"}};
  out["buffers"] = {{{"byteLength", bytes}}};
  out["bufferViews"] = {
      {{"buffer", 0}, {"byteLength", vector_bytes}, {"target", array_buffer}},
      {{"buffer", 0}, {"byteLength", vector_bytes}, {"byteOffset", vector_bytes}, {"target", array_buffer}},
      {{"buffer", 0}, {"byteLength", index_bytes}, {"byteOffset", 2 * vector_bytes}, {"target", element_array_buffer}}};
  out["accessors"] = {{{"bufferView", 0},
                       {"componentType", gltf_float},
                       {"count", points},
                       {"type", "VEC3"},
                       {"min", Json(std::vector<double>(arrays.least.begin(), arrays.least.end()))},
                       {"max", Json(std::vector<double>(arrays.most.begin(), arrays.most.end()))}},
                      {{"bufferView", 1}, {"componentType", gltf_float}, {"count", points}, {"type", "VEC3"}},
                      {{"bufferView", 2},
                       {"componentType", narrow ? gltf_uint16 : gltf_uint32},
                       {"count", corners},
                       {"type", "SCALAR"}}};
  out["materials"] = Json::array({material_of(params)});
  const Json primitive = {
      {"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"material", 0}, {"mode", gltf_triangles}};
  out["meshes"] = Json::array({{{"name", params.name}, {"primitives", Json::array({primitive})}}});
  const Json extras = {{"frame", "LPS"}, {"unit", "mm"}, {"center_mm", Json(std::vector<double>{c.x, c.y, c.z})}};
  out["nodes"] = Json::array({{{"name", params.name}, {"mesh", 0}, {"matrix", gltf_from_lps}, {"extras", extras}}});
  out["scene"] = 0;
  out["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  return out;
}

void append_number(std::string& out, std::size_t value) {
  if (value > std::numeric_limits<std::uint32_t>::max())
    throw refusal("glb", "the surface is larger than a GLB can be, 4 GiB",
                  {"allow fewer triangles by `target_triangles_count` of `decimate`"});
  const auto v = static_cast<std::uint32_t>(value);
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

void append_chunk(std::string& out, const char* type, const std::string& bytes) {
  append_number(out, bytes.size());
  out.append(type, 4);
  out += bytes;
}

void check_params(const GlbParams& params) {
  bool good = is_finite(params.center_mm) && params.opacity >= 0 && params.opacity <= 1;
  for (const double c : params.colour_rgb) good = good && c >= 0 && c <= 1;
  for (const char c : params.name)
    good = good && static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7f;
  if (!good || params.name.empty())
    throw Error(ExitCode::internal, "", "glb", "name, centre, colour or opacity is out of range");
}

void check_written(const std::string& bytes, const surface::TriMesh& mesh, const Arrays& arrays) {
  const surface::TriMesh back = read_glb(bytes).mesh;
  bool same = back.triangles == mesh.triangles && back.points_mm.size() == arrays.positions.size();
  for (std::size_t i = 0; same && i < arrays.positions.size(); ++i)
    for (int c = 0; c < 3; ++c) same = same && float(back.points_mm[i][c]) == arrays.positions[i][c];
  if (!same) throw Error(ExitCode::internal, "", "glb", "what was written does not read back");
}

}  // namespace

std::string make_glb(const surface::TriMesh& mesh, const GlbParams& params) {
  surface::check_mesh(mesh);
  check_params(params);
  if (mesh.triangles.empty())
    throw refusal("glb", "the surface is empty",
                  {"leave it out of the scene, or look at what its stages made with `keep`"});
  const Arrays arrays = rounded(mesh, params.center_mm);
  check_triangles(mesh, arrays.positions);
  const bool narrow = mesh.points_mm.size() <= detail::largest_uint16_points;
  const std::string data = data_of(mesh, arrays, narrow);
  std::string json = document_of(mesh, arrays, params, narrow, data.size()).dump();
  pad(json, ' ');
  std::string bytes = "glTF";
  bytes.reserve(28 + json.size() + data.size());
  append_number(bytes, 2);
  append_number(bytes, 28 + json.size() + data.size());
  append_chunk(bytes, "JSON", json);
  append_chunk(bytes, "BIN", data);  // and the zero that ends it
  check_written(bytes, mesh, arrays);
  return bytes;
}

}  // namespace trephine::cases
