// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/loaded_peer.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/shared_library.h"
#include "peers/peer_abi.h"

namespace trephine::peers {
namespace {

struct PeerLibrary : SharedLibrary {
  decltype(&trephine_peer_name) name = nullptr;
  decltype(&trephine_peer_open) open = nullptr;
  decltype(&trephine_peer_reset) reset = nullptr;
  decltype(&trephine_peer_client) client = nullptr;
  decltype(&trephine_peer_step) step = nullptr;
  decltype(&trephine_peer_close) close = nullptr;

  explicit PeerLibrary(const std::filesystem::path& path) : SharedLibrary(path, "trephine_peer_") {
    require_version(TREPHINE_PEER_VERSION);
    find("name", name);
    find("open", open);
    find("reset", reset);
    find("client", client);
    find("step", step);
    find("close", close);
  }
};

bool is_name(const char* name) {
  if (!name || !*name || std::strlen(name) > 31) return false;
  return std::all_of(name, name + std::strlen(name),
                     [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

class LoadedPeer : public ContactAlgorithm {
 public:
  LoadedPeer(std::shared_ptr<const PeerLibrary> library, const PeerScene& scene, const PeerParams& params)
      : library_(std::move(library)), scene_(scene), params_(params) {
    const surface::TriMesh& mesh = scene.mesh->mesh();
    const trephine_peer_mesh given = {&mesh.points_mm.data()->x, mesh.points_mm.size(),  mesh.triangles.data()->data(),
                                      mesh.triangles.size(),     params.spring_n_per_mm, params.proxy_radius_mm};
    peer_ = library_->open(&given);
    if (!peer_) fail("open", "failed");
  }
  ~LoadedPeer() override { library_->close(peer_); }
  LoadedPeer(const LoadedPeer&) = delete;
  LoadedPeer& operator=(const LoadedPeer&) = delete;

  const haptics::HapticState& update(const haptics::HapticInput& given) override {
    const Vec3 origin = scene_.mesh->mesh().origin_mm, at = given.tip_mm - origin;
    if (!begun_) must("reset", library_->reset(peer_, &at.x));
    begun_ = true;
    Vec3 proxy, force;
    must("step", library_->step(peer_, &at.x, given.dt_s, &proxy.x, &force.x));
    if (!is_finite(proxy) || !is_finite(force)) fail("step", "gives what is not finite");
    answer(state_, given, proxy + origin, force != Vec3{}, normalized(force), scene_.shape, 0);
    state_.force_n = force;
    return state_;
  }
  void client(Vec3 device_mm) override {
    const Vec3 at = device_mm - scene_.mesh->mesh().origin_mm;
    must("client", library_->client(peer_, &at.x));
  }
  void reset() override { begun_ = false; }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& how) const {
    throw Error(ExitCode::io, library_->file(), library_->prefix() + what, how);
  }
  void must(const std::string& what, int result) const {
    if (result != 0) fail(what, "failed");
  }

  std::shared_ptr<const PeerLibrary> library_;
  const PeerScene scene_;
  const PeerParams params_;
  haptics::HapticState state_;
  void* peer_ = nullptr;
  bool begun_ = false;
};

}  // namespace

AlgorithmKind load_peer(const std::filesystem::path& path) {
  const auto library = std::make_shared<const PeerLibrary>(path);
  if (!is_name(library->name()))
    throw Error(ExitCode::bad_input, path.string(), "name", "must be of a-z, 0-9 and _, and at most 31 characters");
  const std::string name = library->name();
  return {name, name, path.filename().string(), true, [library](const PeerScene& scene, const PeerParams& params) {
            return std::unique_ptr<ContactAlgorithm>(std::make_unique<LoadedPeer>(library, scene, params));
          }};
}

}  // namespace trephine::peers
