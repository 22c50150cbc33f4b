// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/verdict.h"

#include <algorithm>

#include "publish/findings_content.h"

namespace trephine::publish {
namespace {

bool is_about(const stages::Evidence& e, const std::string& anatomy) {
  return e.anatomy.empty() || e.anatomy == anatomy;
}

AnatomyVerdict judge(const std::string& anatomy, const cases::CaseManifest& m,
                     const std::vector<stages::Evidence>& evidence) {
  AnatomyVerdict out{anatomy, AnatomyState::good, "", ""};
  if (std::any_of(m.missing.begin(), m.missing.end(), [&](const auto& a) { return a.anatomy == anatomy; })) {
    out.state = AnatomyState::left_out;
    return out;
  }
  for (const stages::Evidence& e : evidence)
    if (is_about(e, anatomy)) {
      if (e.cut.empty())
        out.state = AnatomyState::doubtful;
      else
        out.cut = e.cut;
    }
  for (const cases::CaseStandIn& s : m.stand_ins)
    if (s.anatomy == anatomy) {
      out.state = AnatomyState::stand_in;
      out.stand_in = s.by;
    }
  return out;
}

// Of an anatomy whose name is said to be of a kind ("simple_brain" for the brain), the kind.
std::string kind_of(const AnatomyVerdict& v) {
  const std::string of = "_" + v.anatomy;
  const bool named =
      v.stand_in.size() > of.size() && v.stand_in.compare(v.stand_in.size() - of.size(), of.size(), of) == 0;
  return named ? v.stand_in.substr(0, v.stand_in.size() - of.size()) : v.stand_in + " instead";
}

std::string words_for(const AnatomyVerdict& v) {
  const std::string cut = v.cut.empty() ? "" : "cut off " + v.cut;
  switch (v.state) {
    case AnatomyState::good:
      return cut.empty() ? "good" : cut;
    case AnatomyState::doubtful:
      return "doubtful" + (cut.empty() ? "" : ", " + cut);
    case AnatomyState::stand_in:
      return kind_of(v) + (cut.empty() ? "" : ", " + cut);
    case AnatomyState::left_out:
      break;
  }
  return "left out";
}

}  // namespace

std::vector<AnatomyVerdict> judge_anatomies(const std::vector<std::string>& wanted, const cases::CaseManifest& manifest,
                                            const std::vector<stages::Evidence>& evidence) {
  std::vector<AnatomyVerdict> all;
  for (const std::string& anatomy : wanted) all.push_back(judge(anatomy, manifest, evidence));
  return all;
}

std::vector<stages::Evidence> evidence_of(const Warning& warning, const std::string& anatomy) {
  const stages::WarningKind kind = stages::kind_of(warning);
  std::vector<stages::Evidence> all;
  if (kind.severity != stages::Severity::wrong) return all;
  for (const std::string& a : kind.about) all.push_back({a, "", ""});
  if (kind.about.empty() && !anatomy.empty()) all.push_back({anatomy, "", ""});
  return all;
}

std::vector<std::string> heirs_of(const std::string& anatomy, const pipeline::Graph& graph,
                                  const config::CaseConfig& config) {
  std::vector<std::string> heirs, steps{anatomy};
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const std::string step = steps[n];
    if (step.empty() || config.is_shown(step)) {
      heirs.push_back(step);
      continue;
    }
    for (const pipeline::Node& node : graph.nodes)
      for (const auto& [port, source] : node.sources) {
        const std::string of = node.anatomy();
        if (port == "within" || of.empty() || graph.nodes[std::size_t(source)].anatomy() != step) continue;
        if (std::find(steps.begin(), steps.end(), of) == steps.end()) steps.push_back(of);
      }
  }
  return heirs;
}

std::vector<stages::Evidence> evidence_of(const std::vector<cases::CaseFinding>& findings) {
  std::vector<stages::Evidence> all;
  for (const cases::CaseFinding* f : sure(findings))
    for (const std::string& anatomy : f->concerns) all.push_back({anatomy, "", ""});
  return all;
}

std::string verdict_text(const std::vector<AnatomyVerdict>& anatomies, const cases::CaseManifest& manifest,
                         const std::vector<stages::Evidence>& evidence, const std::vector<std::string>& remarks) {
  Named<std::string> parts;  // names by words
  for (const AnatomyVerdict& v : anatomies) {
    const std::string words = words_for(v);
    const auto same = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == words; });
    if (same == parts.end())
      parts.emplace_back(words, v.anatomy);
    else
      same->second += ", " + v.anatomy;
  }
  const bool bleeds = true;
  std::string text = findings_text(manifest.findings, bleeds);
  if (!text.empty()) text = "to be looked at first: " + text;
  for (const auto& [words, names] : parts) text += (text.empty() ? "" : "; ") + names + ": " + words;
  std::vector<std::string> reasons;
  for (const stages::Evidence& e : evidence)
    if (!e.why.empty() && std::find(reasons.begin(), reasons.end(), e.why) == reasons.end() &&
        std::any_of(anatomies.begin(), anatomies.end(), [&](const auto& v) { return is_about(e, v.anatomy); }))
      reasons.push_back(e.why);
  for (const std::string& why : reasons) text += " (" + why + ")";
  for (const std::string& remark : remarks) text += "; " + remark;
  const std::string to_look_at = findings_text(manifest.findings, !bleeds);
  return to_look_at.empty() ? text : text + "; to be looked at: " + to_look_at;
}

}  // namespace trephine::publish
