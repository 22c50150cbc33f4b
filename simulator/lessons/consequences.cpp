// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/consequences.h"

namespace trephine::lessons {

std::vector<Flow> flows_of(const LessonScore& score) {
  std::vector<Flow> flows;
  for (const CriticalError& e : score.critical) {
    if (!e.rule.leads_to || !e.at_s) continue;
    Flow& flow = flows.emplace_back();
    flow.fluid = e.rule.leads_to->fluid;
    flow.ml_per_min = e.rule.leads_to->ml_per_min.limit;
    flow.seen = e.seen;
    flow.begin_s = *e.at_s;
    for (const Decision& d : score.decisions)
      if (d.when == e.rule.error && d.state == AnswerState::right) flow.end_s = d.at_s.value_or(flow.end_s);
  }
  return flows;
}

}  // namespace trephine::lessons
