// SPDX-License-Identifier: GPL-3.0-or-later
#include "craniometry/plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/pi.h"

namespace trephine::craniometry {
namespace {

constexpr double of_an_implausible_one = 0.4, weak = 0.4;

/// The landmarks that stand behind a name of the ranges: itself, or the pair.
std::vector<std::string> members(const std::string& name) {
  if (name == "tragi") return {"tragus_left", "tragus_right"};
  if (name == "foramina") return {"monro_left", "monro_right"};
  return {name};
}

using Known = std::map<std::string, cases::CaseLandmark>;

std::optional<Vec3> place_of(const std::string& name, const Known& known) {
  Vec3 sum;
  const std::vector<std::string> all = members(name);
  for (const std::string& m : all) {
    const auto at = known.find(m);
    if (at == known.end()) return {};
    sum += at->second.position_mm;
  }
  return sum / double(all.size());
}

struct Fault {
  const LandmarkRange* range;
  double value;
  std::vector<std::string> names;  ///< of all landmarks that it is measured from
};

std::vector<Fault> faults_of(const Known& known) {
  std::vector<Fault> out;
  for (const LandmarkRange& r : landmark_ranges()) {
    const auto from = place_of(r.from, known), to = place_of(r.to, known);
    if (!from || !to) continue;
    double value = norm(*to - *from);
    if (r.at) {
      const auto at = place_of(r.at, known);
      if (!at) continue;
      const Vec3 a = *from - *at, b = *to - *at;
      value = std::acos(std::clamp(dot(a, b) / std::max(norm(a) * norm(b), 1e-9), -1.0, 1.0)) * 180 / pi;
    }
    if (value >= r.least && value <= r.most) continue;
    Fault f{&r, value, {}};
    for (const char* name : {r.from, r.to, r.at})
      if (name)
        for (const std::string& m : members(name)) f.names.push_back(m);
    out.push_back(std::move(f));
  }
  return out;
}

std::string spoken(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name == "tragi" || name == "foramina" ? "the middle of the " + name : "the " + name;
}

std::string reason_of(const Fault& f, const std::string& name) {
  const LandmarkRange& r = *f.range;
  if (r.at)
    return fmt::format("{:.0f} degrees at {} between {} and {}, {:.0f} to {:.0f} are plausible", f.value, spoken(r.at),
                       spoken(r.from), spoken(r.to), r.least, r.most);
  const std::vector<std::string> from = members(r.from);
  const bool is_from = std::find(from.begin(), from.end(), name) != from.end();
  return fmt::format("{:.0f} mm from {}, {:.0f} to {:.0f} are plausible", f.value, spoken(is_from ? r.to : r.from),
                     r.least, r.most);
}

}  // namespace

const std::vector<LandmarkRange>& landmark_ranges() {
  static const std::vector<LandmarkRange> ranges{
      {"tragus_left", "tragus_right", nullptr, 110, 180},
      {"nasion", "tragi", nullptr, 78, 125},
      {"inion", "tragi", nullptr, 70, 120},
      {"vertex", "tragi", nullptr, 105, 165},
      {"bregma", "tragi", nullptr, 100, 155},
      {"foramina", "tragi", nullptr, 35, 80},
      {"nasion", "inion", nullptr, 150, 230},
      {"nasion", "bregma", nullptr, 92, 150},
      {"foramina", "nasion", nullptr, 62, 125},
      {"monro_left", "monro_right", nullptr, 1, 25},
      {"nasion", "inion", "tragi", 138, 180},
      {"nasion", "vertex", "tragi", 45, 115},
      {"nasion", "bregma", "tragi", 45, 85},
      {"bregma", "inion", "tragi", 80, 120},
      {"nasion", "foramina", "tragi", 25, 95},
  };
  return ranges;
}

std::vector<LandmarkDoubt> implausible(const std::vector<cases::CaseLandmark>& landmarks) {
  Known known;
  for (const cases::CaseLandmark& l : landmarks)
    if (l.source != "estimated") known[l.name] = l;
  std::map<std::string, std::string> blamed;
  for (;;) {
    std::map<std::string, int> count;
    const std::vector<Fault> faults = faults_of(known);
    for (const Fault& f : faults)
      for (const std::string& n : f.names)
        if (known.at(n).source != "given") ++count[n];
    int most = 0;
    for (const auto& c : count) most = std::max(most, c.second);
    if (most == 0) break;
    bool any_weak = false;
    for (const auto& c : count) any_weak = any_weak || (c.second == most && known.at(c.first).confidence < weak);
    for (const auto& c : count) {
      if (c.second != most || (any_weak && known.at(c.first).confidence >= weak)) continue;
      for (const Fault& f : faults)
        if (std::find(f.names.begin(), f.names.end(), c.first) != f.names.end()) {
          blamed[c.first] = reason_of(f, c.first);
          break;
        }
    }
    for (const auto& b : blamed) known.erase(b.first);
  }
  std::vector<LandmarkDoubt> out;
  for (const cases::CaseLandmark& l : landmarks)
    if (const auto b = blamed.find(l.name); b != blamed.end())
      out.push_back({l.name, of_an_implausible_one, b->second});
  return out;
}

double before_suture_mm(Vec3 point_mm, Vec3 bregma_mm, Vec3 centre_mm, Vec3 nasion_mm) {
  const Vec3 outwards = normalized(bregma_mm - centre_mm);
  const Vec3 to_nasion = nasion_mm - centre_mm;
  const Vec3 forwards = normalized(to_nasion - outwards * dot(to_nasion, outwards));
  return dot(point_mm - bregma_mm, forwards);
}

}  // namespace trephine::craniometry
