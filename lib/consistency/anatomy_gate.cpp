// SPDX-License-Identifier: GPL-3.0-or-later
#include "consistency/anatomy_gate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/joined.h"
#include "base/refusal.h"
#include "base/text.h"
#include "consistency/anatomy_gate_gap.h"
#include "mask/coarse.h"
#include "mask/field_edge.h"
#include "place/cranium.h"

namespace trephine::consistency {
namespace {

using mask::BitMask;

constexpr double edge_reach_mm = 3;     ///< so far from where the field ends surfaces are not compared
constexpr double usual_slice_mm = 1.5;  ///< in thicker slices surfaces may be near to each other over more

std::string fixed(double v, int digits) {
  const double scale = std::pow(10.0, digits);
  return to_text(std::round(v * scale) / scale + 0.0);
}

std::string at_text(Vec3 p) { return "(" + fixed(p.x, 1) + ", " + fixed(p.y, 1) + ", " + fixed(p.z, 1) + ") mm"; }

/// The bone on voxels of about 2 mm; a coarse voxel is bone where any of its voxels is.
BitMask coarse_bone(const grid::Field& skull) {
  return mask::coarse_mask(mask::positive(skull, skull), mask::coarse_raster(skull, 2), 0);
}

const Remedy wrong_shape{
    "look there in the pictures: where the shape is wrong, paint it and bring it back by the stage `labels`, or take a "
    "series of a smoother kernel or thinner slices"};

/// Where the scan's field cuts the skin off, bone and skin end together at its edge; it is not always recognised.
const Remedy wrong_or_cut_skin{
    wrong_shape.text + "; where the scan's field of view cuts the skin off there, take a series with a larger one"};

/// About the places where padding or the volume's lateral sides cut a body. A round field leaves less than two voxels
/// of padding where it comes near to a side.
BitMask where_the_field_ends(const mask::HuView& hu, const Progress& progress) {
  constexpr int near_side = 2, least_size = 10;
  const grid::Lattice& l = hu.lattice();
  const auto at_side = [&](int index, int axis) {
    const int size = l.size[std::size_t(axis)];
    return size >= least_size && (index < near_side || index >= size - near_side);
  };
  BitMask ends = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i)
      row[i] = (at_side(i, 0) || at_side(j, 1)) && hu(i, j, k) > mask::FieldEdge::tissue_above_hu;
  });
  ends |= mask::field_edge(hu, progress).tissue;
  return mask::dilated(ends, edge_reach_mm, progress);
}

struct Gate {
  const head::HeadFields& fields;
  const AnatomyGateParams& params;
  AnatomyFindings& out;
  const Progress& progress;
  NotCompared accepted;
  const grid::HuVolume* volume;  ///< may be null
  const MeasuredOnce& once;
  struct Ranked {
    double badness;  ///< ml
    AnatomyFault fault;
  };
  std::vector<Ranked> faults;

  using Values = std::vector<std::pair<std::string, double>>;
  /// Where `places` hold all of it, these alone may be accepted, and no limit changes.
  void add(double badness, std::string what, Remedy remedy, Values values_to_set, Vec3 place, const char* first,
           const char* second, std::vector<Vec3> places = {}) {
    if (!places.empty()) {
      values_to_set.clear();
      places.insert(places.begin(), accepted.accepted_mm.begin(), accepted.accepted_mm.end());
    }
    faults.push_back(
        {badness,
         {std::move(what), std::move(remedy.text), std::move(values_to_set), std::move(places), place, first, second}});
  }
  static double above(double ml) { return std::ceil(10 * ml + 0.5) / 10; }

  using Figure = std::optional<double> AnatomyResult::*;
  using Count = std::optional<std::int64_t> AnatomyResult::*;
  /// Checks `name` against `other_name`.
  void check_pair(const char* name, const grid::Field* one, const char* other_name, const grid::Field* other,
                  Relation relation, double gap_mm, Figure wrong_ml, Figure least_gap_mm) {
    if (!one || !other) return;
    const auto measured = [&](const std::string& what, std::vector<std::string> of,
                              const std::function<Clearance()>& measure) {
      return once ? once(what + to_text(gap_mm) + " mm, accepted " + params.accepted_places_mm, of, measure)
                  : measure();
    };
    Clearance c = measured("clearance of ", {name, other_name},
                           [&] { return clearance(*one, *other, relation, gap_mm, accepted, progress); });
    const bool inside = relation == Relation::inside, in_skin = std::string(other_name) == "skin";
    // A slice mixes bone and scalp under the vertex, over the more of it the thicker it is. Other pairs do not lie so
    // flat against each other.
    const Vec3 spacing = one->spacing_mm;
    const double slices = in_skin ? std::max(1.0, std::max({spacing.x, spacing.y, spacing.z}) / usual_slice_mm) : 1;
    const auto is_wrong = [&] {
      return c.wrong_ml > params.max_outside_ml || (c.near_mm2 > slices * params.max_near_mm2 && c.gap_mm < gap_mm);
    };
    if (is_wrong() && in_skin && volume) {
      const Clearance everywhere = c;
      c = measured("clearance beside the field's edge of ", {name, other_name, "volume"}, [&] {
        NotCompared edge = accepted;
        edge.field_edge = where_the_field_ends(mask::HuView(*volume), progress);
        if (!edge.field_edge->any()) return c;
        return clearance(*one, *other, relation, gap_mm, edge, progress);
      });
      if (c.wrong_ml < everywhere.wrong_ml || c.near_mm2 < everywhere.near_mm2)
        out.warnings.push_back({"field_cuts",
                                "the scanned field's edge cuts {anatomy} and skin: there they end together, and were "
                                "not compared",
                                {{"anatomy", name}}});
    }
    out.result.*wrong_ml = c.wrong_ml;
    if (c.gap_mm < 1e5) out.result.*least_gap_mm = c.gap_mm;
    if (c.wrong_ml > params.max_outside_ml) {
      add(c.wrong_ml,
          fixed(c.wrong_ml, 2) + " ml of the " + name + (inside ? " lie outside of the " : " lie in the ") +
              other_name + ", by up to " + fixed(c.depth_mm, 1) + " mm, deepest at " + at_text(c.deepest_mm),
          wrong_shape, {{"max_outside_ml", above(c.wrong_ml)}}, c.deepest_mm, name, other_name, c.places_mm);
    } else if (is_wrong()) {
      add(0.001 * c.near_mm2,
          std::string("the surfaces of ") + name + " and " + other_name + " are only " + fixed(c.gap_mm, 2) +
              " mm apart at " + at_text(c.gap_at_mm) + ", and over " + fixed(c.near_mm2, 0) + " mm2 nearer than the " +
              fixed(gap_mm, 2) + " mm asked for",
          in_skin ? wrong_or_cut_skin : wrong_shape, {{"max_near_mm2", std::ceil(c.near_mm2 / slices) + 1}},
          c.gap_at_mm, name, other_name, c.places_mm);
    }
  }

  void check_empty(const char* name, const grid::Field* field, const std::optional<double>& ml) {
    if (field && *ml <= 0)
      add(1e6, std::string("the ") + name + " have not one voxel",
          {"set other thresholds (`lower_hu`, `upper_hu`), or paint it and bring it back by the stage `labels`"}, {},
          field->to_world_mm({0, 0, 0}), name, "");
  }

  /// Counts the pieces by face neighbours and checks those beside the largest.
  void check_pieces(const char* name, const grid::Field* field, Count count, double max_loose_ml) {
    if (!field) return;
    const auto pieces = mask::components(mask::positive(*field, *field));
    out.result.*count = static_cast<std::int64_t>(pieces.list.size());
    if (pieces.list.size() < 2 || max_loose_ml < 0) return;
    std::size_t first = 0, second = 1, all = 0;
    for (std::size_t c = 0; c < pieces.list.size(); ++c) all += pieces.list[c].voxels;
    if (pieces.list[second].voxels > pieces.list[first].voxels) std::swap(first, second);
    for (std::size_t c = 2; c < pieces.list.size(); ++c) {
      if (pieces.list[c].voxels > pieces.list[first].voxels)
        second = std::exchange(first, c);
      else if (pieces.list[c].voxels > pieces.list[second].voxels)
        second = c;
    }
    const double unit = field->voxel_volume_mm3() / 1000, loose = double(all - pieces.list[first].voxels) * unit;
    if (loose <= max_loose_ml) return;
    const grid::Box& box = pieces.list[second].box;
    const Vec3 place = field->to_world_mm({0.5 * (box.begin[0] + box.end[0] - 1), 0.5 * (box.begin[1] + box.end[1] - 1),
                                           0.5 * (box.begin[2] + box.end[2] - 1)});
    add(loose,
        std::string("the ") + name + " is in " + grouped_text(static_cast<long long>(pieces.list.size())) +
            " pieces; " + fixed(loose, 2) + " ml hang on nothing, of which the largest is " +
            fixed(double(pieces.list[second].voxels) * unit, 2) + " ml about " + at_text(place),
        wrong_shape, {{"max_loose_brain_ml", above(loose)}}, place, name, "");
  }

  /// `allowed` is the cranial cavity with the bone, on a coarser raster.
  void check_cavity(const char* name, const grid::Field* field, const BitMask& allowed, Figure outside_ml,
                    double max_ml) {
    if (!field) return;
    const BitMask outside = mask::make_mask(*field, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < field->size[0]; ++i) {
        if (!(field->at(i, j, k) > 0)) continue;
        const Vec3 c = allowed.lattice().to_index(field->to_world_mm({double(i), double(j), double(k)}));
        row[i] = !allowed.at(int(std::lround(c.x)), int(std::lround(c.y)), int(std::lround(c.z)));
      }
    });
    const double ml = double(outside.count()) * field->voxel_volume_mm3() / 1000;
    out.result.*outside_ml = ml;
    if (ml <= max_ml) return;
    const grid::Box box = mask::largest(mask::components(outside)).bounds();
    const Vec3 place = field->to_world_mm({0.5 * (box.begin[0] + box.end[0] - 1), 0.5 * (box.begin[1] + box.end[1] - 1),
                                           0.5 * (box.begin[2] + box.end[2] - 1)});
    add(ml,
        fixed(ml, 2) + " ml of the " + name + " lie outside of the cranial cavity, most of them about " +
            at_text(place),
        wrong_shape, {{"max_outside_skull_ml", above(ml)}}, place, name, "skull");
  }

  void check_enclosed() {
    if (!fields.skull || (!fields.brain && !fields.ventricles)) return;
    const BitMask bone = coarse_bone(*fields.skull);
    BitMask cavity;
    try {
      auto found = place::cranial_cavity(bone, progress);
      out.result.cranial_cavity_ml = found.result.cranial_cavity_ml;
      out.warnings.insert(out.warnings.end(), found.warnings.begin(), found.warnings.end());
      cavity = std::move(found.value);
    } catch (const Error& e) {
      if (e.code() != ExitCode::quality) throw;
      out.warnings.push_back(
          {"no_cranial_cavity",
           "the skull encloses no space in which a brain could lie: whether it lies inside was not checked",
           {}});
      return;
    }
    cavity |= bone;
    check_cavity("brain", fields.brain, cavity, &AnatomyResult::brain_outside_skull_ml, params.max_outside_skull_ml);
    if (!fields.brain)
      check_cavity("ventricles", fields.ventricles, cavity, &AnatomyResult::ventricles_outside_skull_ml,
                   params.max_outside_skull_ml);
  }
};

std::string all_of(const std::vector<AnatomyFault>& faults) { return joined(faults, "; ", &AnatomyFault::what); }

std::vector<Vec3> places_of(const std::string& text) {
  std::vector<Vec3> places;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    std::string word = text.substr(at, end - at);
    at = end + 1;
    Vec3 p;
    bool good = std::count(word.begin(), word.end(), ',') == 2;
    for (int a = 0; good && a < 3; ++a) {
      const std::size_t comma = std::min(word.find(','), word.size());
      const std::optional<double> value = parse_number(trimmed(word.substr(0, comma)));
      good = value.has_value();
      if (good) p[a] = *value;
      word = word.substr(std::min(comma + 1, word.size()));
    }
    if (!good)
      throw Error(ExitCode::usage, "", "accepted_places_mm",
                  printable(text) + ": must be places as x,y,z in mm, with semicolons between them");
    places.push_back(p);
  }
  return places;
}

std::string text_of(const std::vector<Vec3>& places) {
  return joined(places, ";", [](const Vec3 p) { return fixed(p.x, 0) + "," + fixed(p.y, 0) + "," + fixed(p.z, 0); });
}

/// Each remedy once, and each key once, with the value that all faults need.
Remedy remedies_of(const std::vector<AnatomyFault>& faults) {
  std::set<std::string> said;
  std::map<std::string, double> values;
  Message text;
  std::string keys;
  std::vector<Vec3> places;
  for (const AnatomyFault& f : faults) {
    for (const Vec3 p : f.places_to_accept_mm)
      if (std::none_of(places.begin(), places.end(), [&](Vec3 q) { return q == p; })) places.push_back(p);
    if (said.insert(f.remedy.text()).second) text = text + (text.empty() ? "" : "; ") + f.remedy;
    for (const auto& [key, value] : f.values_to_set) values[key] = std::max(values[key], value);
  }
  for (const auto& [key, value] : values)
    keys += (keys.empty() ? "" : " and ") + fixed(value, value < 1000 ? 1 : 0) + " for `" + key + "`";
  if (!places.empty()) keys = text_of(places) + " for `accepted_places_mm`" + (keys.empty() ? "" : " and ") + keys;
  if (keys.empty()) return {text};
  return {text + ("; where it is right, set " + keys + " of the stage `anatomy`")};
}

}  // namespace

AnatomyError::AnatomyError(std::vector<AnatomyFault> faults)
    : Error(refusal("", all_of(faults), remedies_of(faults))), faults_(std::move(faults)) {
  finds_fault_with({faults_.front().first, faults_.front().second});
}

AnatomyFindings examine_anatomy(const head::HeadFields& fields, const head::HeadLandmarks* landmarks,
                                const AnatomyGateParams& params, const Progress& progress, const MeasuredOnce& once,
                                const grid::HuVolume* volume) {
  using R = AnatomyResult;
  AnatomyFindings out;
  auto head = head::measure_head(fields, landmarks, params, progress.part(0, 0.2));
  out.result.head = head.result;
  out.warnings = std::move(head.warnings);
  const std::vector<Vec3> accepted = places_of(params.accepted_places_mm);
  if (!accepted.empty())
    out.warnings.push_back({"accepted",
                            "what is wrong within 20 mm of {places_mm} was accepted and not checked",
                            {{"places_mm", params.accepted_places_mm}}});
  Gate gate{fields, params, out, progress, {accepted, {}}, volume, once, {}};
  gate.check_empty("skin", fields.skin, out.result.head.skin_ml);
  gate.check_empty("skull", fields.skull, out.result.head.skull_ml);
  gate.check_empty("brain", fields.brain, out.result.head.brain_ml);
  gate.check_empty("ventricles", fields.ventricles, out.result.head.ventricles_ml);
  if (gate.faults.empty()) {
    gate.check_pair("ventricles", fields.ventricles, "brain", fields.brain, Relation::inside,
                    params.min_brain_ventricles_gap_mm, &R::ventricles_outside_brain_ml, &R::brain_ventricles_gap_mm);
    progress.report(0.3);
    gate.check_pair("ventricles", fields.ventricles, "skull", fields.skull, Relation::apart,
                    params.min_skull_brain_gap_mm, &R::ventricles_in_skull_ml, &R::skull_ventricles_gap_mm);
    progress.report(0.4);
    gate.check_pair("brain", fields.brain, "skull", fields.skull, Relation::apart, params.min_skull_brain_gap_mm,
                    &R::brain_in_skull_ml, &R::skull_brain_gap_mm);
    progress.report(0.6);
    gate.check_pair("skull", fields.skull, "skin", fields.skin, Relation::inside, params.min_skin_skull_gap_mm,
                    &R::skull_outside_skin_ml, &R::skin_skull_gap_mm);
    if (!fields.skull)
      gate.check_pair("brain", fields.brain, "skin", fields.skin, Relation::inside, params.min_skin_skull_gap_mm,
                      &R::brain_outside_skin_ml, &R::skin_brain_gap_mm);
    progress.report(0.8);
    gate.check_enclosed();
    gate.check_pieces("brain", fields.brain, &R::brain_pieces_count, params.max_loose_brain_ml);
    gate.check_pieces("ventricles", fields.ventricles, &R::ventricles_pieces_count, -1);
  }
  std::stable_sort(gate.faults.begin(), gate.faults.end(),
                   [](const auto& a, const auto& b) { return a.badness > b.badness; });
  for (auto& f : gate.faults) out.faults.push_back(std::move(f.fault));
  out.result.faults_count = out.faults.size();
  progress.report(1);
  return out;
}

void require_anatomy(const AnatomyFindings& findings) {
  if (!findings.faults.empty()) throw AnatomyError(findings.faults);
}

}  // namespace trephine::consistency
