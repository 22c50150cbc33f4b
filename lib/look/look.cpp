// SPDX-License-Identifier: GPL-3.0-or-later
#include "look/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/joined.h"
#include "body/board.h"
#include "look/orientation.h"
#include "mask/coarse.h"
#include "mask/hu_view.h"
#include "segmentation/scan_edge.h"

namespace trephine::look {
namespace {

constexpr double cell_mm = 3;
constexpr double tissue_hu = -300, bone_hu = 226, hollow_hu = -400;
constexpr double core_mm = 7, rim_mm = 4;
constexpr double outlet_mm = 8, max_hollow_ml = 400;
constexpr double min_cut_mm2 = 300;      ///< of the body at a side of the scan
constexpr double told_edge_ratio = 0.1;  ///< of the body's outline

const char* letters(Vec3 d) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  if (x >= y && x >= z) return d.x > 0 ? "L" : "R";
  if (y >= z) return d.y > 0 ? "P" : "A";
  return d.z > 0 ? "S" : "I";
}

const char* side_of(Vec3 d) {
  switch (*letters(d)) {
    case 'L':
      return "left";
    case 'R':
      return "right";
    case 'P':
      return "back";
    case 'A':
      return "front";
    case 'S':
      return "above";
    default:
      return "below";
  }
}

/// What the cells of a scan hold.
struct Cells {
  grid::Grid<float> hu;
  mask::BitMask bone, body, air;
  body::Board board;
};

Cells cells_of(const grid::HuVolume& volume, const Progress& progress) {
  const mask::HuView hu(volume);
  const mask::CoarseRaster raster = mask::coarse_raster(hu.lattice(), cell_mm);
  mask::BitMask all(hu.lattice());
  all.invert();
  Cells c;
  c.hu = mask::coarse_mean(hu, all, raster, -1000);
  progress.report(0.3);
  c.bone = mask::coarse_mask(mask::above(hu, bone_hu), raster, 0.4);
  const mask::HuView cells(c.hu);
  c.board = body::find_board(cells, progress);
  mask::BitMask tissue = mask::above(cells, tissue_hu);
  if (c.board.voxels.any()) tissue.remove(c.board.voxels), c.bone.remove(c.board.voxels);
  const mask::BitMask core = mask::largest(mask::components(mask::eroded(tissue, core_mm, progress)));
  c.body = mask::both(mask::dilated(core, core_mm + rim_mm, progress), tissue);
  c.bone &= mask::dilated_6(c.body);
  // Air that the body holds: sinuses, nose, throat. Its outlets are narrow.
  c.air = mask::holes(c.body, mask::FillRule{outlet_mm, max_hollow_ml, true}, progress);
  c.air.remove(mask::above(cells, hollow_hu));
  progress.report(0.6);
  return c;
}

/// To which side of the patient the table lies by the patient's position; a zero vector where that does not say.
Vec3 down_by(const std::string& position) {
  if (position.size() < 3) return {};
  const std::string lies = position.substr(2);
  if (lies == "S") return {0, 1, 0};
  if (lies == "P") return {0, -1, 0};
  if (lies == "DL") return {1, 0, 0};
  if (lies == "DR") return {-1, 0, 0};
  return {};
}

void look_at_table(const Cells& c, const std::string& position, ScanLook& out) {
  if (!c.board.voxels.any()) return;
  const Vec3 side = c.hu.direction.column[std::size_t(c.board.axis)] * (c.board.at_end ? 1.0 : -1.0);
  const Vec3 down = down_by(position);
  if (norm(down) > 0 && dot(down, side) < 0.5)
    out.sayings.push_back(fmt::format(
        "the table lies to the {} of the patient, and by PatientPosition {} it must lie to the {}: the images "
        "are turned or mirrored against their tags, or the patient lay otherwise",
        side_of(side), position, side_of(down)));
}

void look_at_ends(const Cells& c, ScanLook& out) {
  const grid::Lattice& l = c.hu;
  std::string sides;
  for (int a = 0; a < 3; ++a)
    for (const bool last : {false, true}) {
      double mm2 = 0;
      const int at = last ? l.size[std::size_t(a)] - 1 : 0;
      for (int k = a == 2 ? at : 0; k < (a == 2 ? at + 1 : l.size[2]); ++k)
        for (int j = a == 1 ? at : 0; j < (a == 1 ? at + 1 : l.size[1]); ++j)
          for (int i = a == 0 ? at : 0; i < (a == 0 ? at + 1 : l.size[0]); ++i)
            if (c.body.get(i, j, k)) mm2 += l.voxel_volume_mm3() / l.spacing_mm[a];
      if (mm2 < min_cut_mm2) continue;
      const Vec3 side = l.direction.column[std::size_t(a)] * (last ? 1.0 : -1.0);
      out.ends.push_back(fmt::format("{} {:.0f} cm2", side_of(side), mm2 / 100));
      if (a != 2) sides += (sides.empty() ? "" : " and ") + std::string(side_of(side));
    }
  grid::Field field(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) field.at(i, j, k) = c.body.get(i, j, k) ? 1 : -1;
  const double cut = segmentation::scan_edge_ratio(mask::HuView(c.hu), field);
  if (cut > told_edge_ratio)
    out.sayings.push_back(
        fmt::format("the scanned field cuts the body: {:.0f} % of its outline in the slices is the field's edge{}, "
                    "where a surface is "
                    "no skin",
                    100 * cut, sides.empty() ? "" : ", also its " + sides));
  else if (!sides.empty())
    out.sayings.push_back("the field of view cuts the body at its " + sides + ": a surface there is no skin");
}

/// The three letters of the volume's axes where each patient axis is multiplied by `sign` (LPS).
std::string axes_with(const grid::Lattice& l, Vec3 sign) {
  std::string out;
  for (int a = 0; a < 3; ++a) {
    const Vec3 d = l.direction.column[std::size_t(a)];
    out += letters({d.x * sign.x, d.y * sign.y, d.z * sign.z});
  }
  return out;
}

/// Where the sides that are alike are the said front and back, the said left and right are front and back: the face
/// tells which is which. Empty where they are the said above and below, or where the face tells nothing.
void axes_of_a_quarter_turn(const Cells& c, int left_right_axis, Vec3 face, ScanLook& out) {
  constexpr double least_mm = 5;
  const char said = *letters(c.hu.direction.column[std::size_t(left_right_axis)]);
  if ((said != 'A' && said != 'P') || std::abs(face.x) < least_mm) return;
  const double front = face.x > 0 ? -1 : 1,
               up = face.z > 0 ? -1 : 1;  // the signs that bring the face to the front, below
  for (const bool turned : {true, false}) {
    const double left = turned ? -front * up : front * up;  // the exchange of two axes is a mirror by itself
    std::string axes;
    for (const Vec3& d : c.hu.direction.column) axes += letters({left * d.y, front * d.x, up * d.z});
    (turned ? out.axes_if_turned : out.axes_if_mirrored) = axes;
  }
}

void look_at_head(const Cells& c, ScanLook& out, const Progress& progress) {
  const HeadSigns s = head_signs(c.bone, c.air, progress);
  if (!s.found) return;
  const double of_bone = std::min(1.0, s.bone_ml / 30), of_air = std::min(1.0, s.air_ml / 8);
  if (of_bone + of_air < 0.7) return;
  const Vec3 face = (s.bone_mm * of_bone + s.air_mm * of_air) / (of_bone + of_air);
  constexpr double clear_mm = 15;
  const bool upside_down = face.z > clear_mm, reversed = face.y > clear_mm;
  const bool on_side = s.left_right_axis >= 0 &&
                       *letters(c.hu.direction.column[std::size_t(s.left_right_axis)]) != 'L' &&
                       *letters(c.hu.direction.column[std::size_t(s.left_right_axis)]) != 'R';
  if (!upside_down && !reversed && !on_side) {
    if (face.z < -clear_mm) out.head = Seen::as_said;
    return;
  }
  out.head = Seen::otherwise;
  if (on_side) {
    out.what_is_seen = "the two sides of the head that are alike are not its left and right";
    axes_of_a_quarter_turn(c, s.left_right_axis, face, out);
    return;
  }
  out.what_is_seen = upside_down && reversed ? "the face lies above and behind the brain"
                     : upside_down           ? "upside down: face and neck lie above the brain"
                                             : "the face lies behind the brain";
  const Vec3 mirrored{1, reversed ? -1.0 : 1.0, upside_down ? -1.0 : 1.0};
  const bool both = upside_down && reversed;  // half a turn about the axis from left to right is no mirror
  out.axes_if_turned = axes_with(c.hu, both ? mirrored : Vec3{-1, mirrored.y, mirrored.z});
  out.axes_if_mirrored = axes_with(c.hu, both ? Vec3{-1, -1, -1} : mirrored);
}

}  // namespace

ScanLook look_at(const grid::HuVolume& volume, const std::string& position, const Progress& progress) {
  mask::check_finite(volume);
  ScanLook out;
  out.blank = blank_slices(volume, progress);
  const Cells c = cells_of(volume, progress);
  if (!c.body.any()) return out;
  look_at_head(c, out, progress);
  look_at_table(c, position, out);
  look_at_ends(c, out);
  return out;
}

namespace {

/// What is wrong with the head's directions, and what can be done.
Message contradiction_of(const ScanLook& look) {
  Message text = "the head lies otherwise than the scan says: " + look.what_is_seen + "; take the original series";
  if (!look.axes_if_mirrored.empty())
    text =
        text +
        ("; or say to which side of the patient columns, rows and slices rise, where the images are mirrored by " +
         Setting{"axes", look.axes_if_mirrored} + ", where they are turned by " + Setting{"axes", look.axes_if_turned} +
         " (which of the two it is, and so which side is left, no picture tells)");
  return text + ("; or where it is right as it is, say why by " + Setting{"orientation_reason", "WHY"});
}

}  // namespace

std::optional<ScanLook> look_at_ct(const grid::HuVolume& volume, const dicom::ImportFigures& scan,
                                   const Progress& progress) {
  if (scan.modality != "CT") return {};
  return look_at(volume, scan.tags ? scan.tags->patient_position : "", progress);
}

LookFigures figures_of(const ScanLook& look) {
  const std::string ends = joined(look.ends);
  LookFigures figures{look.head, ends.empty() ? "nowhere" : ends, {}};
  if (look.blank) figures.blank_slices_count = look.blank->count;
  return figures;
}

Warnings warnings_of(const ScanLook& look) {
  Warnings all;
  if (look.head == Seen::otherwise) all.push_back({"head_lies_otherwise", contradiction_of(look).text("import"), {}});
  if (const auto& blank = look.blank)
    all.push_back(
        {"blank_slices",
         "{slices_count} slices from z = {from_mm:.0f} to {to_mm:.0f} mm are copies of the one before, or of a "
         "single value: what lies there was not measured; take the original series",
         {{"slices_count", std::int64_t{blank->count}}, {"from_mm", blank->from_mm}, {"to_mm", blank->to_mm}}});
  for (const std::string& s : look.sayings) all.push_back({"seen", s, {}});
  return all;
}

void require_orientation(const ScanLook& look, const std::string& reason) {
  if (look.head == Seen::otherwise && reason.empty())
    throw Error(ExitCode::bad_input, "", "orientation_reason", contradiction_of(look));
}

}  // namespace trephine::look
