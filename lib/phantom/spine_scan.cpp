// SPDX-License-Identifier: GPL-3.0-or-later
// The spine on the scanner of the head, and its truth.
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "phantom/body_scan.h"
#include "phantom/spine_parts.h"
#include "phantom/truth_json.h"

namespace trephine::phantom {
namespace {

using Json = nlohmann::ordered_json;

constexpr double vertebra_reach_mm = 30;  // before and behind the middle

// From the scanner's frame to the spine's: the middle of the default block is the spine's middle.
Vec3 offset_mm() { return default_centre_mm() - Vec3{0, 10, 0}; }

// From the spine's frame to the scanner's, as it lies there.
itk::LinearMap lies(const ScanParams& p) { return lies_at(offset_mm(), p); }

// Streaks from places along each screw, and a dark band along it.
void draw_metal(const Spine& spine, const itk::LinearMap& map, double height_hu, SliceImage& image,
                const SlicePose& pose, double pixel_mm) {
  constexpr double each_mm = 8, share = 0.4;
  std::uint64_t number = 0;
  for (const Spine::Screw& s : spine.screws()) {
    const Vec3 tip = map(s.tip_mm), seat = map(s.seat_mm);
    for (double t = -6; t < norm(seat - tip); t += each_mm)
      add_streaks(image, pose, pixel_mm, seat + normalized(tip - seat) * t, share * height_hu, 31 + number++);
    add_dark_band(image, pose, pixel_mm, seat, tip, height_hu);
  }
}

// How far a screw stands out of the bone of its vertebra beside the pedicle's narrow part: the farthest of its side.
double breach_mm(const Spine& spine, const Spine::Screw& screw, const Spine::Pedicle& pedicle, double radius_mm) {
  constexpr double narrow_mm = 8;
  const Vec3 u = screw.axis(), a = normalized(cross(u, {0, 0, 1})), b = cross(u, a);
  double most = 0;
  for (double t = 0; t < norm(screw.tip_mm - screw.seat_mm); t += 0.25) {
    const Vec3 at = screw.seat_mm + u * t;
    if (std::abs(dot(at - pedicle.middle_mm, pedicle.forwards)) > narrow_mm) continue;
    for (int n = 0; n < 36; ++n) {
      const double turn = 2 * M_PI * n / 36;
      most = std::max(most, -spine.bone_of(screw.vertebra, at + (a * std::cos(turn) + b * std::sin(turn)) * radius_mm));
    }
  }
  return most;
}

// From a place of the spine without bend and pose to the same place of a vertebra in the scanner.
itk::LinearMap to_scan(const Spine& spine, int vertebra, const ScanParams& params) {
  const itk::LinearMap map = lies(params);
  const auto at = [&](Vec3 p) { return map(spine.bent(vertebra, p - offset_mm())); };
  itk::LinearMap out;
  out.offset_mm = at({});
  for (int a = 0; a < 3; ++a) {
    Vec3 e;
    e[a] = 1;
    out.matrix.column[a] = at(e) - out.offset_mm;
  }
  return out;
}

// The screws, each in the spine as it is without bend.
Json put_in(const Spine& bent, const ScanParams& params) {
  SpineParams straight = bent.params();
  straight.bend_deg = 0;
  const Spine spine(straight);
  Json all = Json::array();
  for (const Spine::Screw& s : spine.screws()) {
    Vec3 entry = s.seat_mm;
    while (norm(entry - s.tip_mm) > 0.2 && spine.bone_of(s.vertebra, entry) < 0) entry += s.axis() * 0.05;
    double breach = 0;
    for (const Spine::Pedicle& p : spine.pedicles())
      if (p.vertebra == s.vertebra && p.left == s.left)
        breach = breach_mm(spine, s, p, 0.5 * straight.screws.diameter_mm);
    all.push_back({{"kind", straight.screws.needle ? "needle" : "screw"},
                   {"screw", s.left ? "left" : "right"},
                   {"from_middle", s.vertebra - straight.vertebrae_count / 2},
                   {"tip_mm", json_of(s.tip_mm + offset_mm())},
                   {"head_mm", json_of(s.seat_mm + offset_mm())},
                   {"entry_mm", json_of(entry + offset_mm())},
                   {"axis", json_of(s.axis())},
                   {"diameter_mm", straight.screws.diameter_mm},
                   {"length_mm", straight.screws.length_mm},
                   {"breach_mm", breach},
                   {"to_scan", json_of(to_scan(bent, s.vertebra, params))}});
  }
  return all;
}

// The planes of a scan as the spine, which lies otherwise in the scanner, sees them.
std::vector<SlicePose> seen_by_spine(const std::vector<SlicePose>& slices, const ScanParams& p) {
  if (!has_pose(p)) return slices;
  const itk::LinearMap back = itk::inverse(head_pose(p));
  std::vector<SlicePose> out;
  for (const SlicePose& s : slices) out.push_back({back(s.origin_mm), back.matrix * s.row, back.matrix * s.column});
  return out;
}

// As many vertebrae as the block is high, and one more: none ends in it that a scan would show whole.
Spine spine_in(SpineParams spine, const std::vector<SlicePose>& slices, const ScanParams& p) {
  double reach = 0;
  const double columns = p.columns_count - 1, rows = p.rows_count - 1, pixel = pixel_spacing_mm(p);
  for (const SlicePose& s : slices)
    for (int n = 0; n < 4; ++n) {
      const Vec3 corner = s.origin_mm + s.row * (n & 1 ? columns * pixel : 0) + s.column * (n & 2 ? rows * pixel : 0);
      reach = std::max(reach, std::abs(corner.z - offset_mm().z));
    }
  spine.vertebrae_count = 2 * int(std::ceil(reach / spine.pitch_mm)) + 1;
  return Spine(spine);
}

// Whether a vertebra lies between the first and the last slice, before and behind its middle, with as much beside it as
// its neighbours leave.
bool whole(const Spine& spine, int vertebra, const std::vector<SlicePose>& slices) {
  double low = 1e9, high = -1e9;
  for (const SlicePose& s : slices) {
    const Vec3 normal = cross(s.row, s.column);
    double ends[2];  // where the slice, which may be tilted, lies there
    for (const int side : {0, 1}) {
      const Vec3 at = offset_mm() + Vec3{0, side ? vertebra_reach_mm : -vertebra_reach_mm, 0};
      ends[side] = (dot(normal, s.origin_mm) - normal.x * at.x - normal.y * at.y) / normal.z;
    }
    low = std::min(low, std::max(ends[0], ends[1]));
    high = std::max(high, std::min(ends[0], ends[1]));
  }
  const double z = spine.level(vertebra) + offset_mm().z, half = 0.5 * spine.params().pitch_mm;
  return z - half >= low && z + half <= high;
}

}  // namespace

Scan scan(const SpineParams& of, const ScanParams& params, std::uint64_t seed, const Progress& progress) {
  const Spine spine = spine_in(of, seen_by_spine(slice_poses(params), params), params);
  const itk::LinearMap map = lies(params), back = itk::inverse(map);
  const bool moved = has_pose(params);
  const HuAt hu = [&](Vec3 p, double width_mm) { return hu_of(spine, moved ? back(p) : p - offset_mm(), width_mm); };
  if (spine.screws().empty()) return scan_body(hu, params, seed, progress);
  return scan_body(hu, params, seed, progress, [&](SliceImage& image, const SlicePose& pose, double pixel_mm) {
    draw_metal(spine, map, params.streak_hu, image, pose, pixel_mm);
  });
}

std::int64_t write_truth(const std::filesystem::path& folder, const SpineParams& of, const Scan& scan,
                         const ScanParams& params, bool labels) {
  make_output_folder(folder);
  const std::vector<SlicePose> slices = seen_by_spine(scan.slices, params);
  const Spine spine = spine_in(of, slices, params);
  Json json;
  json["trephine_spine_truth"] = 1;
  json["frame"] = "DICOM patient LPS, mm";
  json["spine"] = json_of_params(of);
  json["pedicles"] = Json::array();
  int first = -1;
  for (const Spine::Pedicle& p : spine.pedicles()) {
    if (!whole(spine, p.vertebra, slices)) continue;
    if (first < 0) first = p.vertebra;
    double behind = 0, before = 0;
    while (spine.bone(p.middle_mm - p.forwards * behind) > 0) behind += 0.1;
    while (spine.bone(p.middle_mm + p.forwards * before) > 0) before += 0.1;
    const Vec3 entry = p.middle_mm - p.forwards * behind, target = entry + p.forwards * (0.75 * (behind + before));
    json["pedicles"].push_back(
        {{"name", "pedicle_" + std::to_string(p.vertebra - first + 1) + (p.left ? "_left" : "_right")},
         {"entry_mm", json_of(entry + offset_mm())},
         {"target_mm", json_of(target + offset_mm())},
         {"middle_mm", json_of(p.middle_mm + offset_mm())},
         {"half_width_mm", p.half_width_mm}});
  }
  if (of.screws.sides != SpineScrews::Sides::none) json["put_in"] = put_in(spine, params);
  if (has_pose(params)) json["spine_to_scan"] = json_of(head_pose(params));
  if (labels && has_lattice(params)) {
    grid::write_nrrd(folder / "labels.nrrd", labelled(scan, [&](Vec3 at_mm) {
                       const Vec3 p = at_mm - offset_mm();
                       return spine.bone(p) > 0 ? 2 : spine.canal(p) > 0 ? 3 : spine.skin(p) > 0 ? 1 : 0;
                     }));
  }
  write_file(folder / "truth.json", json.dump(1) + "\n");
  return static_cast<std::int64_t>(json["pedicles"].size());
}

}  // namespace trephine::phantom
