// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the declarations of case.json share.
#include "base/params.h"
#include "base/report.h"

namespace trephine::cases {

/// Figures by name, in the order of insertion; numbers are finite.
using CaseValues = Named<ParameterValue>;

namespace case_form {
extern const TextForm token, file_name, sha256, shape_name;
}
namespace case_range {
constexpr Range finite{-1e12, 1e12}, not_negative{0, 1e12}, above_zero{1e-6, 1e6}, share{0, 1}, length_mm{0, 1e4};
constexpr Range voxels{1, 65535}, count{0, 9e15};
}  // namespace case_range

}  // namespace trephine::cases
