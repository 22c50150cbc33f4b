// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "cases/case_finding.h"
#include "consistency/anatomy_gate.h"

namespace trephine::stages {

/// What speaks against an anatomy of a case being good.
struct Evidence {
  std::string anatomy;  ///< empty: it is about every one
  std::string cut;      ///< where the scan ends in it ("above"); empty: the anatomy is doubtful
  std::string why;      ///< figures that a person reads with the verdict; may be empty
};

/// What the result of a stage adds to a case, beside what the stage hands on (StageType::contribute). Who makes a case
/// of these parts knows no stage by its name.
struct CaseParts {
  Named<ParameterValue> checks;                    ///< figures of the case: what was checked
  Named<ParameterValue> changes;                   ///< figures of the case: how the scan was changed
  Named<ParameterValue> made_of;                   ///< recorded beside the stage's parameters; names without the node's
  std::optional<consistency::AnatomyResult> head;  ///< figures of the patient
  std::vector<cases::CaseFinding> findings;
  std::optional<double> moved_mm;             ///< how far the stage moved a surface, of the bound that it was given
  std::optional<double> doubted_scale_ratio;  ///< of a scan that may be another patient's: how it stretches
  std::vector<Evidence> evidence;
  std::vector<std::string> remarks;  ///< that the verdict ends with
};

/// The figures of a result with `before` before their names.
Named<ParameterValue> figures_named(const std::string& before, const AnyParams& result);

}  // namespace trephine::stages
