// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "base/error.h"
#include "peers/shape_mesh.h"
#include "peers/slab.h"

namespace trephine::peers {
namespace {

constexpr double mm_a_tick_of(double mm_per_s) { return mm_per_s * tick_s; }

// Of at most 20,000 points of the felt surface, evenly taken.
void measure_off(const FeltMesh& truth, const FeltMesh& mesh, MeshRow& row) {
  const std::size_t count = truth.mesh().points_mm.size(), step = std::max<std::size_t>(1, count / 20000);
  constexpr double farthest_mm = 20;
  std::size_t taken = 0;
  for (std::size_t n = 0; n < count; n += step, ++taken) {
    const Vec3 p = truth.mesh().world_mm(n) - mesh.mesh().origin_mm;
    const auto near = mesh.nearest(p, farthest_mm);
    const double off = near ? norm(p - near->point) : farthest_mm;
    row.mean_off_mm += off;
    row.most_off_mm = std::max(row.most_off_mm, off);
  }
  row.mean_off_mm /= double(taken);
}

class Comparer {
 public:
  Comparer(Comparison& out, const contact::ContactVolume& contact, int shape, const CompareParams& params,
           const PeerParams& peers, const device::HandPathParams& path,
           const std::function<void(const std::string&)>& say, const Progress& progress)
      : out_(out),
        params_(params),
        peers_(peers),
        path_params_(path),
        say_(say),
        progress_(progress),
        felt_(mesh_of_shape(contact.volume(), shape)),
        truth_{&felt_, &contact, shape},
        path_(device::path_over(contact, faces(), path)) {
    out_.felt_triangles = felt_.mesh().triangles.size();
  }

  void open_from(const std::vector<haptics::ServoFrame>& recording) {
    if (!recording.empty()) {
      poses_ = recording;
      return;
    }
    const auto ours = out_.kinds.front().make(truth_, peers_);
    const VariedHand hand = varied_hand(0, path_params_);
    poses_ = run_closed(*ours, hand.hand, path_of(hand), params_.hand_seconds);
  }

  void voxels() {
    for (const AlgorithmKind& kind : out_.kinds) {
      if (kind.feels_mesh) continue;
      progress_.check();
      const auto a = kind.make(truth_, peers_);
      servo(kind, *a, 0);
      for (int hand = 0; hand < params_.repetitions; ++hand) closed(kind, *a, 0, hand);
      open(kind, *a, 0);
      haptics_ms_.emplace_back(kind.name, client_ms(*a));
      say_(fmt::format("{}: {:.2f} us a tick, p99 {:.2f}", kind.name, out_.servo.back().times.mean_us,
                       out_.servo.back().times.p99_us));
    }
  }

  void mesh(std::size_t asked, int index, int meshes, const DrawMesh& draw) {
    progress_.check();
    const FeltMesh mesh(with_triangles(felt_.mesh(), asked));
    MeshRow row;
    row.asked = asked;
    const std::size_t triangles = row.triangles = mesh.mesh().triangles.size();
    measure_off(felt_, mesh, row);
    out_.meshes.push_back(row);
    std::optional<double> graphics_ms;
    if (draw) graphics_ms = draw(mesh.mesh());
    for (const auto& [name, ms] : haptics_ms_) out_.client.push_back({name, triangles, ms, graphics_ms});
    std::string line;
    for (const AlgorithmKind& kind : out_.kinds) {
      if (!kind.feels_mesh) continue;
      progress_.check();
      const auto a = kind.make({&mesh, truth_.contact, truth_.shape}, peers_);
      servo(kind, *a, triangles);
      for (int hand = index; hand < params_.repetitions; hand += meshes) closed(kind, *a, triangles, hand);
      open(kind, *a, triangles);
      out_.client.push_back({kind.name, triangles, client_ms(*a), graphics_ms});
      line += fmt::format(", {} {:.2f}", kind.name, out_.servo.back().times.mean_us);
    }
    say_(fmt::format("{} triangles, {:.3f} mm off at most, us a tick{}", triangles, row.most_off_mm,
                     line.empty() ? line : ":" + line.substr(1)));
  }

  void walls() {
    const auto slab = make_slab(0.5, 0.25), wall = make_voxel_wall(0.5);
    for (const AlgorithmKind& kind : out_.kinds)
      for (const double mm_a_tick : {1.0, 10.0, 100.0}) {
        progress_.check();
        fall(kind, *slab, "plate of 0.5 mm", mm_a_tick);
        if (!kind.feels_mesh) fall(kind, *wall, "one voxel of 0.5 mm", mm_a_tick);
      }
    say_("pokes through thin walls done");
  }

 private:
  contact::TouchableFaces faces() const { return {std::uint64_t{1} << truth_.shape, 0}; }
  device::HandPath path_of(const VariedHand& hand) const {
    return device::path_over(*truth_.contact, faces(), hand.path);
  }
  double mm_a_tick() const { return mm_a_tick_of(params_.speed_mm_per_s); }
  void servo(const AlgorithmKind& kind, ContactAlgorithm& a, std::size_t triangles) {
    out_.servo.push_back({kind.name, triangles, measure_ticks(a, path_, mm_a_tick(), params_.servo_ticks)});
  }
  double client_ms(ContactAlgorithm& a) { return measure_client_ms(a, path_, mm_a_tick(), params_.client_pictures); }
  void closed(const AlgorithmKind& kind, ContactAlgorithm& a, std::size_t triangles, int number) {
    progress_.check();
    const VariedHand hand = varied_hand(number, path_params_);
    const auto frames = run_closed(a, hand.hand, path_of(hand), params_.hand_seconds);
    out_.forces.push_back({kind.name, triangles, number, true, judge(frames, truth_)});
  }
  void open(const AlgorithmKind& kind, ContactAlgorithm& a, std::size_t triangles) {
    out_.forces.push_back({kind.name, triangles, 0, false, judge(run_open(a, poses_), truth_)});
  }
  void fall(const AlgorithmKind& kind, const Slab& wall, const std::string& name, double mm_a_tick) {
    const auto a = kind.make(wall.scene(), peers_);
    out_.falls.push_back({kind.name, name, mm_a_tick, params_.pokes, count_falls(*a, wall, mm_a_tick, params_.pokes)});
  }

  Comparison& out_;
  const CompareParams& params_;
  const PeerParams& peers_;
  const device::HandPathParams& path_params_;
  const std::function<void(const std::string&)>& say_;
  const Progress& progress_;
  const FeltMesh felt_;
  const PeerScene truth_;
  const device::HandPath path_;
  std::vector<haptics::ServoFrame> poses_;
  std::vector<std::pair<std::string, double>> haptics_ms_;  // of what feels voxels
};

}  // namespace

std::vector<std::size_t> CompareParams::counts() const {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::usage, "", "--triangles", what + "; an example: " + CompareParams().triangles);
  };
  std::vector<std::size_t> all;
  const char *at = triangles.data(), *end = at + triangles.size();
  while (true) {
    std::size_t n = 0;
    const auto [next, fault] = std::from_chars(at, end, n);
    if (fault != std::errc() || n < 100 || n > 20000000) refuse("must be numbers from 100 to 20,000,000, with commas");
    if (!all.empty() && n <= all.back()) refuse("must ascend");
    all.push_back(n);
    if (next == end) break;
    if (*next != ',' || all.size() == 64) refuse("must be at most 64 numbers, with commas");
    at = next + 1;
  }
  return all;
}

void compare(Comparison& out, const contact::ContactVolume& contact, int shape, const CompareParams& params,
             const PeerParams& peers, const device::HandPathParams& path,
             const std::vector<haptics::ServoFrame>& recording, const DrawMesh& draw,
             const std::function<void(const std::string&)>& say, const Progress& progress) {
  const std::vector<std::size_t> counts = params.counts();
  Comparer comparer(out, contact, shape, params, peers, path, say, progress);
  comparer.open_from(recording);
  comparer.voxels();
  for (std::size_t n = 0; n < counts.size(); ++n) comparer.mesh(counts[n], int(n), int(counts.size()), draw);
  comparer.walls();
  double load = 0;
  if (getloadavg(&load, 1) == 1) out.load = load;
  out.cores = int(std::thread::hardware_concurrency());
}

Spread spread_of(const Comparison& c, const std::string& algorithm, bool closed,
                 const std::function<double(const RunFigures&)>& figure) {
  Spread s;
  for (const ForceRow& row : c.forces) {
    if (row.algorithm != algorithm || row.closed != closed) continue;
    const double value = figure(row.figures);
    s.least = s.runs == 0 ? value : std::min(s.least, value);
    s.most = s.runs == 0 ? value : std::max(s.most, value);
    s.mean += value;
    ++s.runs;
  }
  if (s.runs > 0) s.mean /= s.runs;
  return s;
}

namespace {

bool counts(const ServoRow& row) { return keeps_contact(row); }
bool counts(const ClientRow&) { return true; }

template <class Row>
const Row* row_of(const std::vector<Row>& rows, const std::string& algorithm, bool largest) {
  const Row* found = nullptr;
  for (const Row& row : rows)
    if (row.algorithm == algorithm && counts(row) && (!found || (row.triangles > found->triangles) == largest))
      found = &row;
  return found;
}

}  // namespace

const ServoRow* servo_of(const Comparison& c, const std::string& algorithm, bool largest) {
  return row_of(c.servo, algorithm, largest);
}
const ClientRow* client_of(const Comparison& c, const std::string& algorithm, bool largest) {
  return row_of(c.client, algorithm, largest);
}

}  // namespace trephine::peers
