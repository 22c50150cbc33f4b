// SPDX-License-Identifier: GPL-3.0-or-later
// The chest on the scanner of the head, and its truth.
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "phantom/body_scan.h"
#include "phantom/chest.h"
#include "phantom/truth_json.h"

namespace trephine::phantom {
namespace {

using Json = nlohmann::ordered_json;

// From the scanner's frame to the chest's.
Vec3 offset_mm() { return default_centre_mm() - Vec3{0, -5, -5}; }

Json line_of(const std::vector<Vec3>& points) {
  Json all = Json::array();
  for (const Vec3& p : points) all.push_back(json_of(p + offset_mm()));
  return all;
}

// The lines, each in the chest as it is without pose and raised shoulders.
Json put_in(ChestParams of) {
  of.shoulders_raised_deg = 0;
  Json all = Json::array();
  for (const Chest::PutIn& one : Chest(of).put_in())
    all.push_back({{"kind", "line"},
                   {"side", one.left ? "left" : "right"},
                   {"skin_mm", json_of(one.skin_mm + offset_mm())},
                   {"vein_mm", json_of(one.vein_mm + offset_mm())},
                   {"tip_mm", json_of(one.tip_mm + offset_mm())},
                   {"course_mm", line_of(one.course_mm)},
                   {"diameter_mm", of.line.wide_mm},
                   {"in_lung_mm", one.in_lung_mm}});
  return all;
}

}  // namespace

Scan scan(const ChestParams& of, const ScanParams& params, std::uint64_t seed, const Progress& progress) {
  const Chest chest(of);
  const itk::LinearMap map = lies_at(offset_mm(), params), back = itk::inverse(map);
  const bool moved = has_pose(params);
  const HuAt hu = [&](Vec3 p, double width_mm) { return chest.hu(moved ? back(p) : p - offset_mm(), width_mm); };
  const std::vector<Vec3> electrodes = chest.electrodes_mm();
  if (electrodes.empty()) return scan_body(hu, params, seed, progress);
  return scan_body(hu, params, seed, progress, [&](SliceImage& image, const SlicePose& pose, double pixel_mm) {
    for (std::size_t n = 0; n < electrodes.size(); ++n)
      add_streaks(image, pose, pixel_mm, map(electrodes[n]), params.streak_hu, 71 + n);
  });
}

std::int64_t write_truth(const std::filesystem::path& folder, const ChestParams& of, const Scan& scan,
                         const ScanParams& params, bool labels) {
  make_output_folder(folder);
  const Chest chest(of);
  Json json;
  json["trephine_chest_truth"] = 1;
  json["frame"] = "DICOM patient LPS, mm";
  json["chest"] = json_of_params(of);
  json["notch_mm"] = json_of(chest.notch_mm() + offset_mm());
  for (const bool left : {false, true})
    json[left ? "left" : "right"] = {{"clavicle_mm", line_of(chest.clavicle_line(left))},
                                     {"vein_mm", line_of(chest.vein_line(left))},
                                     {"artery_mm", line_of(chest.artery_line(left))}};
  if (of.line.sides != ChestLine::Sides::none) json["put_in"] = put_in(of);
  if (has_pose(params)) json["chest_to_scan"] = json_of(head_pose(params));
  if (labels && has_lattice(params)) {
    grid::write_nrrd(folder / "labels.nrrd", labelled(scan, [&](Vec3 at_mm) {
                       const Vec3 p = at_mm - offset_mm();
                       return !(chest.skin(p) > 0)      ? 0
                              : chest.clavicle(p) > 0   ? 2
                              : chest.other_bone(p) > 0 ? 3
                              : chest.vein(p) > 0       ? 4
                              : chest.artery(p) > 0     ? 5
                              : chest.lung(p) > 0       ? 6
                                                        : 1;
                     }));
  }
  write_file(folder / "truth.json", json.dump(1) + "\n");
  return 6;
}

}  // namespace trephine::phantom
