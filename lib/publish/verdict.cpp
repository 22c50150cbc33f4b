// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/verdict.h"

#include <fmt/format.h>

#include <algorithm>

#include "publish/findings_content.h"
#include "publish/scan_findings.h"

namespace trephine::publish {
namespace {

std::string text_in(const ParameterValue* value) {
  const auto* text = value ? std::get_if<std::string>(value) : nullptr;
  return text ? *text : "";
}

std::string figure(const cases::CaseManifest& manifest, const std::string& name) {
  for (const auto& [n, value] : manifest.figures)
    if (n == name) return text_in(&value);
  return "";
}

bool is_other_part(const cases::CaseManifest& m) { return figure(m, "body_part.is_expected") == "unknown"; }

bool is_hard_in(const Report* scan, const std::string& anatomy) {
  const std::string suited = scan ? text_in(scan->find(anatomy)) : "";
  return suited == "doubtful" || suited == "unsuited";
}

// Of an anatomy whose name is said to be of a kind, the kind.
std::string kind_of(const cases::CaseStandIn& s) {
  const std::string of = "_" + s.anatomy;
  const bool named = s.by.size() > of.size() && s.by.compare(s.by.size() - of.size(), of.size(), of) == 0;
  return named ? s.by.substr(0, s.by.size() - of.size()) : s.by + " instead";
}

std::string word_for_all(const std::string& anatomy, const cases::CaseManifest& m, const Report* scan) {
  for (const cases::CaseStandIn& a : m.stand_ins)
    if (a.anatomy == anatomy) return kind_of(a);
  if (may_be_of_another(m, anatomy) || is_other_part(m)) return "doubtful";
  const bool uncertain = figure(m, "class_of") == anatomy && figure(m, "class") == "uncertain";
  return is_hard_in(scan, anatomy) || uncertain ? "doubtful" : "good";
}

// The same, and where the scan ends in it.
std::string word_for(const std::string& anatomy, const cases::CaseManifest& m, const Report* scan,
                     const Report* region) {
  for (const cases::CaseMissing& a : m.missing)
    if (a.anatomy == anatomy) return "left out";
  const std::string word = word_for_all(anatomy, m, scan), cut = region ? text_in(region->find(anatomy + "_cut")) : "";
  if (cut.empty()) return word;
  return (word == "good" ? "" : word + ", ") + "cut off " + cut;
}

// What of the scan speaks against more.
std::string reasons(const Report& scan) {
  const auto number = [&](const char* name) {
    const ParameterValue* value = scan.find(name);
    const auto* v = value ? std::get_if<double>(value) : nullptr;
    return v ? *v : 0.0;
  };
  const double motion_mm = number("motion_mm");
  return fmt::format(" (slices of {:.3g} mm, noise of {:.0f} HU{})", number("slice_step_mm"), number("noise_hu"),
                     motion_mm > 0 ? fmt::format(", the head moved by {:.1f} mm", motion_mm) : "");
}

// Deviations are measured from the surface on the voxels that it was made on, and say nothing of what coarser ones
// lost.
std::string coarser_voxels(const Report& resample) {
  const auto number = [&](const char* name) {
    const ParameterValue* v = resample.find(name);
    return v ? std::get<double>(*v) : 1.0;
  };
  const ParameterValue* spacing = resample.find("spacing_mm");
  if (!spacing || !(number("coarsest_ratio") > 1 + 1e-6)) return "";
  const auto& mm = std::get<std::vector<double>>(*spacing);
  const double percent = 100 * number("voxels_ratio");
  return fmt::format(
      "; on voxels of {:.3g} x {:.3g} x {:.3g} mm, {:.{}f} % of the scan's: the deviations leave out what "
      "that loses (`trade` measures it)",
      mm.at(0), mm.at(1), mm.at(2), percent, percent < 10 ? 1 : 0);
}

}  // namespace

std::string verdict_of(const std::vector<std::string>& wanted, const cases::CaseManifest& manifest, const Report* scan,
                       const Report* region, const Report* resample) {
  std::vector<std::pair<std::string, std::string>> parts;  // word, names
  for (const std::string& anatomy : wanted) {
    const std::string word = word_for(anatomy, manifest, scan, region);
    const auto same = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == word; });
    if (same == parts.end())
      parts.emplace_back(word, anatomy);
    else
      same->second += ", " + anatomy;
  }
  std::string text;
  for (const auto& [word, names] : parts) text += (text.empty() ? "" : "; ") + names + ": " + word;
  const std::string to_look_at = findings_text(manifest.findings);
  const bool hard = std::any_of(wanted.begin(), wanted.end(), [&](const auto& a) { return is_hard_in(scan, a); });
  if (hard) text += reasons(*scan);
  if (is_other_part(manifest)) text += "; it is not sure that the scan shows the part of the body that is made of it";
  if (resample) text += coarser_voxels(*resample);
  return to_look_at.empty() ? text : text + "; to be looked at: " + to_look_at;
}

}  // namespace trephine::publish
