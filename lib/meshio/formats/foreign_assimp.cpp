// SPDX-License-Identifier: GPL-3.0-or-later
// assimp's importers, on bytes in memory.
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/text.h"
#include "meshio/formats/formats_inside.h"

namespace trephine::meshio {
namespace {

class Stream final : public Assimp::IOStream {
 public:
  explicit Stream(std::string_view bytes) : bytes_(bytes) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t n = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, n * size);
    at_ += n * size;
    return n;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    // Offsets are unsigned, so a step back from the end or from the current position wraps around.
    const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    const std::size_t to = origin == aiOrigin_END ? from - offset : from + offset;
    if (to > bytes_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

// The file system that assimp sees: the file and its materials, whatever their names.
class Files final : public Assimp::IOSystem {
 public:
  Files(std::string name, std::string_view bytes, std::string_view materials)
      : name_(std::move(name)), bytes_(bytes), materials_(materials) {}
  bool Exists(const char* file) const override { return !find(file).empty(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    const std::string_view bytes = find(file);
    return bytes.empty() ? nullptr : new Stream(bytes);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string_view find(const std::string& file) const {
    if (file == name_) return bytes_;
    const bool is_mtl = file.size() > 4 && file.compare(file.size() - 4, 4, ".mtl") == 0;
    return is_mtl ? materials_ : std::string_view();
  }
  std::string name_;
  std::string_view bytes_, materials_;
};

// The matrix row by row, in double; points are columns.
using Matrix = std::array<std::array<double, 4>, 4>;

Matrix matrix_of(const aiMatrix4x4& m) {
  Matrix r;
  for (unsigned i = 0; i < 4; ++i)
    for (unsigned j = 0; j < 4; ++j) r[i][j] = m[i][j];
  return r;
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix r{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) r[i][j] += a[i][k] * b[k][j];
  return r;
}

bool mirrors(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

void take_colour(const aiScene& scene, const aiMesh& mesh, const ForeignReader& reader, ForeignSurface& s) {
  if (mesh.HasVertexColors(0) && mesh.mNumVertices > 0) {
    const aiColor4D first = mesh.mColors[0][0];
    s.has_colour = std::all_of(mesh.mColors[0], mesh.mColors[0] + mesh.mNumVertices,
                               [&](const aiColor4D& c) { return c == first; });
    s.colour = {first.r, first.g, first.b};
    return;
  }
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return;
  const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
  aiColor4D colour;
  const bool found = reader.reads("glb") ? material.Get(AI_MATKEY_BASE_COLOR, colour) == aiReturn_SUCCESS
                                         : material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS;
  if (found) {
    s.has_colour = true;
    s.colour = {colour.r, colour.g, colour.b};
  }
  float opacity = 1;
  s.has_opacity = material.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS;
  s.opacity = opacity;
}

void add_node(const aiScene& scene, const aiNode& node, const Matrix& outer, const ForeignReader& reader, int depth,
              std::vector<ForeignSurface>& out) {
  if (depth > 64 || out.size() > 100000) throw Error(ExitCode::bad_input, "", "", "damaged: nodes without an end");
  const Matrix m = outer * matrix_of(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    if (node.mMeshes[i] >= scene.mNumMeshes) throw Error(ExitCode::bad_input, "", "", "damaged: a mesh is missing");
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    ForeignSurface s;
    s.name = mesh.mName.length > 0 && !reader.reads("x3d") ? mesh.mName.C_Str() : node.mName.C_Str();
    take_colour(scene, mesh, reader, s);
    s.texture_points = mesh.HasTextureCoords(0) ? mesh.mNumVertices : 0;
    s.points.reserve(mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      Vec3 q;
      for (int r = 0; r < 3; ++r) q[r] = m[r][0] * p.x + m[r][1] * p.y + m[r][2] * p.z + m[r][3];
      s.points.push_back(q);
    }
    const bool turn = mirrors(m);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      s.triangles.push_back({face.mIndices[0], face.mIndices[turn ? 2 : 1], face.mIndices[turn ? 1 : 2]});
    }
    out.push_back(std::move(s));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(scene, *node.mChildren[i], m, reader, depth + 1, out);
}

}  // namespace

std::vector<ForeignSurface> read_with_assimp(const ForeignReader& reader, std::string_view bytes,
                                             std::string_view companion) {
  const std::string name = std::string("mesh.") + reader.extension;
  Assimp::Importer importer;
  importer.SetIOHandler(new Files(name, bytes, companion));  // the importer deletes it
  const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure | aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    std::string why = importer.GetErrorString();
    if (why.size() > 200) why.resize(200);
    throw Error(ExitCode::bad_input, "", "", "assimp cannot read it: " + printable(why));
  }
  std::vector<ForeignSurface> out;
  const Matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  add_node(*scene, *scene->mRootNode, identity, reader, 0, out);
  return out;
}

}  // namespace trephine::meshio
