// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "stages/stage.h"

namespace trephine::extremes {

/// One line of the table: what is done to a stage, and what comes of it. run() gives the figure of a result or the code
/// and line of an error; a text that begins with "FAULT" is what must not be.
struct Case {
  std::string extreme;
  std::function<std::string()> run;
  bool slow = false;  ///< only of the long suite
};

struct Section {
  std::string name;     ///< a-z, 0-9, _: of a test
  std::string heading;  ///< of the table
  std::string about;    ///< a sentence under it
  std::function<std::vector<Case>()> cases;
};

/// Runs f; every Error becomes its code and line, anything else that is thrown a fault. Ends the process, naming the
/// case, where it takes longer than the time limit.
std::string outcome_of(const std::string& name, const std::function<std::string()>& f);

/// What a stage did with these inputs: figures of what it gave, checked: finite, valid, not empty without a word.
std::string outcome_of_stage(const stages::StageType& stage, const AnyParams& params,
                             const stages::StageInputs& inputs);

/// Figures of stage data and of the report that came with it; "FAULT: ..." where they are no valid result.
std::string describe(const stages::StageData& data, const Report& report);

/// Four digits: the same on every machine.
std::string rounded(double v);

std::vector<Section> parameter_sections();
std::vector<Section> input_sections();
std::vector<Section> convergence_sections();
std::vector<Section> export_sections();

}  // namespace trephine::extremes
