// SPDX-License-Identifier: GPL-3.0-or-later
#include "group/group_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace trephine::group {
namespace {

using lessons::AttemptResult;

const std::vector<std::string> known_phases = {"before", "practice", "after", "retention"};

double share_of(const AttemptResult& r) { return r.most_points > 0 ? double(r.points) / double(r.most_points) : 0; }

double mean_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return v.empty() ? 0 : sum / double(v.size());
}

std::vector<std::string> phases_of(const std::vector<AttemptResult>& attempts) {
  std::set<std::string> there;
  for (const AttemptResult& r : attempts)
    if (!r.phase.empty()) there.insert(r.phase);
  std::vector<std::string> phases;
  for (const std::string& phase : known_phases)
    if (there.erase(phase) > 0) phases.push_back(phase);
  phases.insert(phases.end(), there.begin(), there.end());
  return phases;
}

ParticipantView participant_of(const std::vector<const AttemptResult*>& attempts) {
  ParticipantView p;
  std::map<std::string, std::vector<double>> shares;
  std::vector<double> all;
  for (const AttemptResult* r : attempts) {
    ++p.done;
    p.completed += r->outcome == "completed";
    p.signed_count += r->signature == lessons::Signature::fits;
    p.failed += r->outcome == "failed";
    shares[r->phase].push_back(share_of(*r));
    p.completed_by_phase[r->phase] = p.completed_by_phase["all"] = r->outcome == "completed";
    all.push_back(share_of(*r));
    p.critical.insert(p.critical.end(), r->critical.begin(), r->critical.end());
    if (!r->recording_is_there) p.recordings_gone.push_back(r->report);
    if (p.group.empty()) p.group = r->group;
    if (p.level.empty()) p.level = r->level;
  }
  for (const auto& [phase, values] : shares) p.share_by_phase[phase] = mean_of(values);
  if (!all.empty()) p.first_share = all.front(), p.last_share = all.back(), p.mean_share = mean_of(all);
  const auto at = [&](const char* phase) { return p.share_by_phase.find(phase); };
  const auto before = at("before"), after = at("after"), later = at("retention"), end = p.share_by_phase.end();
  if (before != end && after != end && later != end && after->second > before->second)
    p.retained_ratio = (later->second - before->second) / (after->second - before->second);
  return p;
}

std::vector<RowView> rows_of(const std::vector<AttemptResult>& attempts) {
  std::vector<RowView> rows;
  for (const AttemptResult& r : attempts)
    for (const lessons::ResultRow& one : r.rows) {
      auto at = std::find_if(rows.begin(), rows.end(), [&](const RowView& row) { return row.name == one.name; });
      if (at == rows.end()) at = rows.insert(rows.end(), {one.name, one.title, {}});
      if (!one.score) continue;
      auto& [mean, count] = at->by_phase[r.phase];
      mean += (double(*one.score) - mean) / double(++count);
    }
  return rows;
}

// A participant's performance by which the pass mark is set: the test after practice where both levels have one, else
// the test before it, else all.
PassMark pass_mark_of(const ModuleView& m, const GroupParams& params) {
  PassMark out;
  out.less = params.less_level;
  out.more = params.more_level;
  const auto values = [&](const std::string& level, const std::string& phase) {
    std::vector<double> v;
    for (const ParticipantView& p : m.participants) {
      if (p.level != level || p.done == 0) continue;
      const auto at = p.share_by_phase.find(phase);
      if (phase == "all")
        v.push_back(p.mean_share);
      else if (at != p.share_by_phase.end())
        v.push_back(at->second);
    }
    return v;
  };
  std::string chosen = "all";
  for (const char* phase : {"before", "after"})  // the later one that both have
    if (values(out.less, phase).size() > 1 && values(out.more, phase).size() > 1) chosen = phase;
  out.of = chosen == "all" ? "the mean of all attempts" : "phase " + chosen;
  const std::vector<double> less = values(out.less, chosen), more = values(out.more, chosen);
  if (less.size() < 2 || more.size() < 2) {
    out.why_not = fmt::format("level {} has {} participants with results and level {} has {}; two each are needed",
                              out.less, less.size(), out.more, more.size());
    return out;
  }
  out.less_summary = study::summarised(less, 0.95);
  out.more_summary = study::summarised(more, 0.95);
  if (out.less_summary.mean >= out.more_summary.mean) {
    out.why_not = fmt::format("level {} is no better than level {} ({:.1f} and {:.1f} % of the points)", out.more,
                              out.less, 100 * out.more_summary.mean, 100 * out.less_summary.mean);
    return out;
  }
  const std::optional<double> mark =
      study::crossing(out.less_summary.mean, *out.less_summary.sd, out.more_summary.mean, *out.more_summary.sd);
  if (!mark) {
    out.why_not = "all performances of a level are equal, or the densities do not cross between the means";
    return out;
  }
  out.mark_ratio = *mark;
  out.less_pass_expected_ratio = 1 - study::normal_share_below(*mark, out.less_summary.mean, *out.less_summary.sd);
  out.more_fail_expected_ratio = study::normal_share_below(*mark, out.more_summary.mean, *out.more_summary.sd);
  std::size_t less_passed = 0, more_failed = 0;
  for (const ParticipantView& p : m.participants) {
    const auto at = p.share_by_phase.find(chosen);
    if (p.done == 0 || (chosen != "all" && at == p.share_by_phase.end())) continue;
    const bool enough = (chosen == "all" ? p.mean_share : at->second) >= *mark;
    const bool pass = enough && p.completed_by_phase.at(chosen);
    out.passed.emplace_back(p.participant, pass);
    less_passed += p.level == out.less && pass;
    more_failed += p.level == out.more && !pass;
  }
  out.less_pass_ratio = double(less_passed) / double(less.size());
  out.more_fail_ratio = double(more_failed) / double(more.size());
  return out;
}

}  // namespace

GroupView view_of(const lessons::Results& results, const GroupParams& params) {
  GroupView view;
  view.notes = results.notes;
  std::vector<std::string> modules;
  const auto add_module = [&](const std::string& name) {
    if (std::find(modules.begin(), modules.end(), name) == modules.end()) modules.push_back(name);
  };
  for (const lessons::ExercisePlan& plan : results.plans) add_module(plan.module);
  for (const AttemptResult& r : results.attempts) add_module(r.module);
  std::sort(modules.begin(), modules.end());
  for (const std::string& name : modules) {
    ModuleView m;
    m.module = name;
    std::map<std::string, std::vector<const AttemptResult*>> by_participant;
    for (const AttemptResult& r : results.attempts)
      if (r.module == name) m.attempts.push_back(r);
    for (const AttemptResult& r : m.attempts) by_participant[r.participant].push_back(&r);
    for (const lessons::ExercisePlan& plan : results.plans)
      if (plan.module == name) by_participant[plan.participant];
    for (const auto& [participant, attempts] : by_participant) {
      ParticipantView p = participant_of(attempts);
      p.participant = participant;
      for (const lessons::ExercisePlan& plan : results.plans)
        if (plan.participant == participant && plan.module == name) {
          p.planned = plan.cases.size();
          p.group = plan.group;
          p.level = plan.level;
        }
      for (const std::string& error : p.critical) ++m.failures[error][participant];
      m.participants.push_back(p);
    }
    m.phases = phases_of(m.attempts);
    m.rows = rows_of(m.attempts);
    if (!params.less_level.empty() && !params.more_level.empty()) m.pass_mark = pass_mark_of(m, params);
    std::vector<std::vector<std::pair<std::string, double>>> experts;
    for (const AttemptResult& r : m.attempts)
      if (!r.level.empty() && r.level == params.expert_level) experts.push_back(r.motion);
    m.bands = lessons::expert_bands(experts);
    view.modules.push_back(m);
  }
  return view;
}

}  // namespace trephine::group
