// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"

namespace trephine::trade {

/// A path and the values that its parameter takes, each as --set takes it ("0.3", "[1, 1, 1]").
struct SweptParameter {
  std::string path;
  std::vector<std::string> values;
};

/// Every combination of the values; the last parameter changes fastest.
struct TradeSweep {
  std::string name;                   ///< a-z, 0-9, _
  std::vector<std::string> settings;  ///< settings of every point of the sweep
  std::vector<SweptParameter> values;
};

struct TradePlan {
  std::vector<std::string> finest;  ///< settings of the result against which deviations are measured; it is a point too
  std::vector<TradeSweep> sweeps;
};

/// A point that is to be measured.
struct PlannedPoint {
  std::string name;  ///< "bound/0.3", "finest"
  std::string sweep;
  std::vector<std::string> settings;
};

/// The finest point, then the points of the sweeps in their order. Names are unique (a point that two sweeps share is
/// measured once).
std::vector<PlannedPoint> points_of(const TradePlan& plan);

/// The plan where none is given. It sweeps the bound of decimation, its count, smoothing, the voxel size of the scan
/// with and without a bound that goes with it, and the voxel size of the haptic volume where the case has one.
TradePlan standard_plan(bool haptic);

/// Reads a plan:
///   trephine: 1
///   finest: {PATH: VALUE, ...}
///   sweeps:
///     NAME:
///       set: {PATH: VALUE, ...}
///       values: {PATH: [VALUE, ...], ...}
/// A value is a scalar or a list of scalars. Throws ErrorList (78) with file:line:column, 66 where the file is missing.
TradePlan read_trade_plan(const std::filesystem::path& file);

/// What a plan's file may hold, for its schema.
AnyParams trade_file_params();

}  // namespace trephine::trade
