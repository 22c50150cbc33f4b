// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "cases/case.h"
#include "library/library_state.h"

namespace trephine {

/// Which cases of a library are shown.
enum class CaseClass { any, normal, hydrocephalic, shifted, small, unknown };
struct LibraryFilter {
  CaseClass patient_class = CaseClass::any;
  double max_deviation_mm = 0;
  std::int64_t max_warnings_count = -1;
  bool failed = false;

  template <class V>
  static void describe(V& v) {
    using P = LibraryFilter;
    v.choice(&P::patient_class, "class",
             {{"any", CaseClass::any},
              {"normal", CaseClass::normal},
              {"hydrocephalic", CaseClass::hydrocephalic},
              {"shifted", CaseClass::shifted},
              {"small", CaseClass::small},
              {"unknown", CaseClass::unknown}},
             "Only cases of that class; unknown: cases that do not say.");
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 1000},
             "Only cases none of whose surfaces lies farther from its unreduced one; 0: all.");
    v.integer(&P::max_warnings_count, "max_warnings_count", Range{-1, 1e9},
              "Only cases whose run gave at most so many warnings; -1: all.");
    v.flag(&P::failed, "failed", "Only cases that are damaged or whose last build failed.");
  }
};

/// One case of a library, as case.json and run.json say; its other files are not looked at (library verify).
struct CaseRow {
  std::string token;
  std::string fault;  ///< why case.json cannot be read; empty: it can
  CaseManifest manifest;
  std::string patient_class;  ///< empty: not said
  std::uint64_t triangles = 0, bytes = 0;
  double deviation_max_mm = 0;
  std::vector<std::string> warnings;
  double seconds = 0;  ///< of its last run
  double age_s = 0;    ///< of case.json
  JobResult last;      ///< of its last library build; code 0 where there was none
  const ParameterValue* figure(const std::string& name) const;
  /// The anatomy by which the case is classed, as its recipe says; empty where it is not.
  std::string classed_by() const;
};

/// All folders of the library with a case.json, and those whose first build failed, by token. Throws 66 where there is
/// no library.
std::vector<CaseRow> read_library(const std::filesystem::path& library, const LibraryFilter& filter = {});
CaseRow read_library_case(const std::filesystem::path& library, const std::string& token);

std::string library_table(const std::vector<CaseRow>& rows);
std::string library_json(const std::vector<CaseRow>& rows);
/// One case in full.
std::string case_text(const CaseRow& row);

/// "3 min", "5 h", "12 d"
std::string age_text(double seconds);
/// The number with so many decimals.
std::string fixed_text(double v, int decimals);
/// A figure for a cell: fixed decimals; "" where it is not there.
std::string figure_text(const CaseRow& row, const std::string& name, int decimals, double factor = 1);

}  // namespace trephine
