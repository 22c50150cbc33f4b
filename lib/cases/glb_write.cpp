// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/text.h"
#include "cases/glb.h"
#include "cases/glb_layout.h"

namespace trephine {
namespace {

using Float3 = std::array<float, 3>;

// Weights of N. Max, "Weights for computing vertex normals from facet normals" (1999): exact on a sphere, and without
// the arc cosine of angle weights, whose last bit differs between C libraries.
std::vector<Vec3> vertex_normals(const TriMesh& mesh) {
  std::vector<Vec3> n(mesh.points_mm.size());
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec3 a = mesh.points_mm[t[c]];
      const Vec3 u = mesh.points_mm[t[(c + 1) % 3]] - a, v = mesh.points_mm[t[(c + 2) % 3]] - a;
      const double weight = dot(u, u) * dot(v, v);
      if (weight > 0) n[t[c]] += cross(u, v) / weight;
    }
  return n;
}

Float3 to_unit_float(Vec3 v) {
  v = normalized(v);
  if (!(norm(v) > 0.5)) v = {0, 0, 1};  // a point that no triangle uses
  return {float(v.x), float(v.y), float(v.z)};
}

// Digits beyond these are the C library's.
double linear_of_srgb(double s) {
  const double v = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return std::round(v * 1e6) / 1e6;
}

struct Arrays {
  std::vector<Float3> positions, normals;
  Float3 least, most;
};

Arrays rounded(const TriMesh& mesh, Vec3 center_mm) {
  Arrays a;
  a.least.fill(std::numeric_limits<float>::max());
  a.most.fill(std::numeric_limits<float>::lowest());
  const Vec3 shift = mesh.origin_mm - center_mm;
  a.positions.reserve(mesh.points_mm.size());
  for (const Vec3 p : mesh.points_mm) {
    const Vec3 q = shift + p;
    // + 0.f: one zero, whatever its sign was.
    const Float3 f{float(q.x) + 0.f, float(q.y) + 0.f, float(q.z) + 0.f};
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(f[c])) throw Error(ExitCode::bad_input, "", "glb", "a point does not fit float32");
      a.least[c] = std::min(a.least[c], f[c]);
      a.most[c] = std::max(a.most[c], f[c]);
    }
    a.positions.push_back(f);
  }
  std::vector<Vec3> own;
  if (mesh.normals.empty()) own = vertex_normals(mesh);
  const auto& normals = mesh.normals.empty() ? own : mesh.normals;
  a.normals.reserve(normals.size());
  for (const Vec3 n : normals) a.normals.push_back(to_unit_float(n));
  return a;
}

void check_triangles(const TriMesh& mesh, const std::vector<Float3>& positions) {
  std::size_t bad = 0;
  for (const auto& t : mesh.triangles)
    bad +=
        positions[t[0]] == positions[t[1]] || positions[t[1]] == positions[t[2]] || positions[t[2]] == positions[t[0]];
  if (bad > 0)
    throw Error(ExitCode::quality, "", "glb",
                std::to_string(bad) + " triangles lose a side when their points are rounded to float32");
}

template <class T>
void append(std::vector<unsigned char>& out, const T* data, std::size_t count) {
  const std::size_t at = out.size(), bytes = count * sizeof(T);
  out.resize(at + (bytes + 3) / 4 * 4);
  std::memcpy(out.data() + at, data, bytes);
}

int add_view(tinygltf::Model& model, std::size_t offset, std::size_t length, int target) {
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = offset;
  view.byteLength = length;
  view.target = target;
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int add_accessor(tinygltf::Model& model, int view, int component, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

tinygltf::Material material_of(const GlbParams& params) {
  tinygltf::Material m;
  m.name = params.name;
  auto& pbr = m.pbrMetallicRoughness;
  pbr.baseColorFactor = {linear_of_srgb(params.colour_rgb[0]), linear_of_srgb(params.colour_rgb[1]),
                         linear_of_srgb(params.colour_rgb[2]), params.opacity};
  pbr.metallicFactor = 0;
  pbr.roughnessFactor = 0.6;
  if (params.opacity < 1) m.alphaMode = "BLEND";
  return m;
}

tinygltf::Model model_of(const TriMesh& mesh, const Arrays& arrays, const GlbParams& params) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "trephine";
  model.materials.push_back(material_of(params));

  tinygltf::Buffer buffer;
  tinygltf::Primitive primitive;
  const std::size_t points = arrays.positions.size(), position_bytes = points * sizeof(Float3);
  append(buffer.data, arrays.positions.data(), points);
  append(buffer.data, arrays.normals.data(), points);
  const int positions = add_view(model, 0, position_bytes, TINYGLTF_TARGET_ARRAY_BUFFER);
  const int normals = add_view(model, position_bytes, position_bytes, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["POSITION"] =
      add_accessor(model, positions, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, points);
  model.accessors[0].minValues.assign(arrays.least.begin(), arrays.least.end());
  model.accessors[0].maxValues.assign(arrays.most.begin(), arrays.most.end());
  primitive.attributes["NORMAL"] =
      add_accessor(model, normals, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, points);

  const std::size_t corners = mesh.triangles.size() * 3;
  const bool small = points <= detail::largest_uint16_points;
  if (small) {
    std::vector<std::uint16_t> narrow;
    narrow.reserve(corners);
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) narrow.push_back(static_cast<std::uint16_t>(v));
    append(buffer.data, narrow.data(), corners);
  } else {
    append(buffer.data, mesh.triangles.data()->data(), corners);
  }
  const int indices =
      add_view(model, 2 * position_bytes, corners * (small ? 2 : 4), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  primitive.indices = add_accessor(
      model, indices, small ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
      TINYGLTF_TYPE_SCALAR, corners);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  model.buffers.push_back(std::move(buffer));

  tinygltf::Mesh m;
  m.name = params.name;
  m.primitives.push_back(primitive);
  model.meshes.push_back(m);

  tinygltf::Node node;
  node.name = params.name;
  node.mesh = 0;
  node.matrix.assign(detail::gltf_from_lps.begin(), detail::gltf_from_lps.end());
  using tinygltf::Value;
  node.extras = Value(Value::Object{
      {"frame", Value(std::string("LPS"))},
      {"unit", Value(std::string("mm"))},
      {"center_mm",
       Value(Value::Array{Value(params.center_mm.x), Value(params.center_mm.y), Value(params.center_mm.z)})}});
  model.nodes.push_back(node);
  tinygltf::Scene scene;
  scene.nodes = {0};
  model.scenes.push_back(scene);
  model.defaultScene = 0;
  return model;
}

void check_params(const GlbParams& params) {
  bool good = is_finite(params.center_mm) && params.opacity >= 0 && params.opacity <= 1;
  for (const double c : params.colour_rgb) good = good && c >= 0 && c <= 1;
  for (const char c : params.name)
    good = good && static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7f;
  if (!good || params.name.empty())
    throw Error(ExitCode::internal, "", "glb", "name, centre, colour or opacity is out of range");
}

void check_written(const std::string& bytes, const TriMesh& mesh, const Arrays& arrays) {
  const TriMesh back = read_glb(bytes).mesh;
  bool same = back.triangles == mesh.triangles && back.points_mm.size() == arrays.positions.size();
  for (std::size_t i = 0; same && i < arrays.positions.size(); ++i)
    for (int c = 0; c < 3; ++c) same = same && float(back.points_mm[i][c]) == arrays.positions[i][c];
  if (!same) throw Error(ExitCode::internal, "", "glb", "what was written does not read back");
}

}  // namespace

std::string make_glb(const TriMesh& mesh, const GlbParams& params) {
  check_mesh(mesh);
  check_params(params);
  if (mesh.triangles.empty()) throw Error(ExitCode::quality, "", "glb", "the surface is empty");
  const Arrays arrays = rounded(mesh, params.center_mm);
  check_triangles(mesh, arrays.positions);
  const tinygltf::Model model = model_of(mesh, arrays, params);
  std::ostringstream out;
  out.imbue(std::locale::classic());
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true) || !out)
    throw Error(ExitCode::internal, "", "glb", "cannot be written");
  std::string bytes = out.str();
  check_written(bytes, mesh, arrays);
  return bytes;
}

}  // namespace trephine
