// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/face_belief.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::face {
namespace {

constexpr const char* face_landmarks[] = {"nasion", "tragus_left", "tragus_right"};
constexpr double found_confidence = 0.5;  ///< from which a found landmark says where the face is

const char* how_to_say =
    "; where one of the two is right, the scene must say which and why: face: {policy: deface, believe: given, "
    "believe_reason: ...}, or believe: found";

[[noreturn]] void refuse(const std::string& landmark, const std::string& what) {
  throw Error(ExitCode::privacy, "", "landmarks." + landmark, what);
}

bool is_blank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos; }

/// What a person gave and what was found contradict each other, and nobody said which is right.
void check_agreement(const head::HeadLandmarks& known, const head::HeadLandmarks* found) {
  for (const char* name : face_landmarks) {
    const cases::CaseLandmark* used = known.find(name);
    if (!used || (!found && used->source == "found")) continue;
    const cases::CaseLandmark* other = found ? found->find(name) : nullptr;
    if (!other)
      refuse(name, "is given and was not found, so that nothing says whether it is right: a face may be left" +
                       std::string(how_to_say));
    const double apart_mm = norm(used->position_mm - other->position_mm);
    if (!(apart_mm <= landmarks_agree_mm))
      refuse(name, fmt::format("as given lies {:.0f} mm from where it is found, ({:.0f}, {:.0f}, {:.0f}) mm with a "
                               "confidence of {:.2f}, at most {:.0f}{}",
                               apart_mm, other->position_mm.x, other->position_mm.y, other->position_mm.z,
                               other->confidence, landmarks_agree_mm, how_to_say));
  }
}

/// Known landmarks, with those that were found for sure in place of the given ones.
head::HeadLandmarks as_found(const head::HeadLandmarks& known, const head::HeadLandmarks& found) {
  head::HeadLandmarks out = known;
  for (cases::CaseLandmark& l : out.landmarks)
    if (const cases::CaseLandmark* other = found.find(l.name); other && other->confidence >= found_confidence)
      l = *other;
  return out;
}

bool is_same(const FaceRegion& a, const FaceRegion& b) {
  return a.nasion_mm == b.nasion_mm && a.tragi_mm == b.tragi_mm && a.left == b.left;
}

/// The union of two cuts: air where one of them left air, also where the other holds noise that is below air, else
/// of two values the one nearer to air. (Soft tissue with which only one of them covered air is lost; a cut may
/// cover what the other one removed.)
template <class T>
void unite(grid::Grid<T>& a, const grid::Grid<T>& b) {
  const T air = static_cast<T>(removed_hu);
  for (std::size_t v = 0; v < a.voxels.size(); ++v)
    a.voxels[v] = a.voxels[v] == air || b.voxels[v] == air ? air : std::min(a.voxels[v], b.voxels[v]);
}

}  // namespace

std::vector<FaceRegion> believed_regions(const head::HeadLandmarks& known, const head::HeadLandmarks* found,
                                         const FaceBeliefParams& params) {
  if (params.believe != FaceBelief::both && is_blank(params.believe_reason))
    throw Error(ExitCode::privacy, "", "believe_reason", "is missing: why are these landmarks right?");
  std::vector<FaceRegion> regions;
  if (params.believe == FaceBelief::found) {
    regions = {face_region(found ? *found : known)};
  } else {
    if (params.believe == FaceBelief::both) check_agreement(known, found);
    regions = {face_region(known)};
    if (params.believe == FaceBelief::both && found)
      if (const FaceRegion other = face_region(as_found(known, *found)); !is_same(other, regions[0]))
        regions.push_back(other);
  }
  return regions;
}

std::vector<FaceRegion> face_regions(const head::HeadLandmarks& known, const head::HeadLandmarks* found,
                                     const grid::Field& skin, const FaceBeliefParams& params) {
  std::vector<FaceRegion> regions = believed_regions(known, found, params);
  for (const FaceRegion& r : regions) check_tragi(r, skin);
  return regions;
}

std::optional<double> tragi_position_ratio(const FaceRegion& region, const grid::Field& skin) {
  constexpr double beside_mm = 30, above_mm = 45, under_mm = 15;  // the slab about the midline where the occiput is
  constexpr int rim = 1;
  double back_mm = 0;
  bool ends = true;
  for (int k = 0; k < skin.size[2]; ++k)
    for (int j = 0; j < skin.size[1]; ++j)
      for (int i = 0; i < skin.size[0]; ++i) {
        if (!(skin.at(i, j, k) > 0)) continue;
        const Vec3 p = skin.to_world_mm({double(i), double(j), double(k)}) - region.tragi_mm;
        const double back = -dot(p, region.front), up = dot(p, region.up);
        if (back <= back_mm || std::abs(dot(p, region.left)) > beside_mm || up > above_mm || up < -under_mm) continue;
        back_mm = back;
        ends = i < rim || j < rim || i >= skin.size[0] - rim || j >= skin.size[1] - rim;
      }
  if (ends) return {};
  const double front_mm = region.in_front_mm(region.nasion_mm);
  return front_mm / (front_mm + back_mm);
}

void check_tragi(const FaceRegion& region, const grid::Field& skin) {
  constexpr double min_ratio = 0.42;
  const auto ratio = tragi_position_ratio(region, skin);
  if (ratio && !(*ratio >= min_ratio))
    refuse(
        "tragus_left, tragus_right",
        fmt::format("lie {:.0f} % of the way from the nasion to the back of the head, must be at least {:.0f}: an ear "
                    "lies farther back, and what is in front of it would show a face",
                    100 * *ratio, 100 * min_ratio));
}

Outcome<grid::HuVolume, DefaceResult> deface(const grid::HuVolume& volume, const grid::Field& skin,
                                             const std::vector<FaceRegion>& regions, const DefaceParams& params,
                                             const Progress& progress) {
  const double share = 1.0 / double(regions.size());
  auto out = deface(volume, skin, regions.at(0), params, progress.part(0, share));
  for (std::size_t r = 1; r < regions.size(); ++r) {
    const auto other =
        deface(volume, skin, regions[r], params, progress.part(double(r) * share, double(r + 1) * share));
    std::visit(
        [&](auto& g) {
          using G = std::decay_t<decltype(g)>;
          unite(g, std::get<G>(other.value));
        },
        out.value);
    const DefaceResult& more = other.result;
    out.result.removed_ml = std::max(out.result.removed_ml, more.removed_ml);
    out.result.removed_voxels_count = std::max(out.result.removed_voxels_count, more.removed_voxels_count);
    if (more.depth_mm >= 0)
      out.result.depth_mm = out.result.depth_mm < 0 ? more.depth_mm : std::min(out.result.depth_mm, more.depth_mm);
  }
  out.result.regions_count = static_cast<std::int64_t>(regions.size());
  return out;
}

}  // namespace trephine::face
