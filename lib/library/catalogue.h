// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/params.h"
#include "cases/case.h"
#include "library/library_state.h"

namespace trephine::library {

/// Which cases of a library are shown.
enum class CaseClass { any, normal, hydrocephalic, shifted, small, uncertain, unknown };
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
              {"uncertain", CaseClass::uncertain},
              {"unknown", CaseClass::unknown}},
             "Only cases of that class; unknown: cases without a class.");
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 1000},
             "Only cases none of whose surfaces lies farther from its unreduced surface; 0: all.");
    v.integer(&P::max_warnings_count, "max_warnings_count", Range{-1, 1e9},
              "Only cases whose run gave at most this many warnings; -1: all.");
    v.flag(&P::failed, "failed", "Only cases that are damaged or whose last build failed.");
  }
};

/// One case of a library, as case.json and run.json describe it; its other files are not read (library verify reads
/// them).
struct CaseRow {
  std::string token;
  std::string fault;  ///< why case.json cannot be read; empty: it can be read
  cases::CaseManifest manifest;
  std::string patient_class;  ///< empty: not known
  std::uint64_t triangles = 0, bytes = 0;
  double deviation_max_mm = 0;
  std::vector<std::string> warnings;    ///< of its last run, the gravest first
  std::vector<std::string> severities;  ///< of each of them: "wrong", "look", "note"
  std::size_t wrong_count = 0;          ///< of them, those that speak against an anatomy
  double seconds = 0;                   ///< of its last run
  double peak_memory_mb = 0;
  std::vector<std::pair<std::string, double>> stage_seconds;  ///< of the stages that its last run computed, in order
  double age_s = 0;                                           ///< age of case.json
  JobResult last;  ///< of its last library build; code 0 where there was none
  const ParameterValue* figure(const std::string& name) const;
  /// The anatomy by which the case is classed according to its recipe; empty where there is none.
  std::string classed_by() const;
};

/// All folders of the library that hold a case.json, and the cases whose first build failed, sorted. Throws Error 66
/// where there is no library.
std::vector<std::string> library_tokens(const std::filesystem::path& library);

/// Reads one of these; what is wrong with it stands in its row.
CaseRow read_row(const std::filesystem::path& library, const std::string& token);

/// What the case does without, or has something simple in place of: "simple_brain stands for brain, dura is left out".
std::string concessions_text(const CaseRow& row);

/// Calls `visit` for each case that the filter lets pass, in the order of the tokens. Only a few rows are held at a
/// time, so that a library may have any number of cases. Throws Error 66 where there is no library.
void each_case(const std::filesystem::path& library, const LibraryFilter& filter,
               const std::function<void(const CaseRow&)>& visit);

/// Throws Error 64 where the token is none, and 66 where the library has no such case.
CaseRow read_library_case(const std::filesystem::path& library, const std::string& token);

/// "5 (2 wrong)".
std::string warnings_text(const CaseRow& row);

/// The cases as a table, a line for each.
class LibraryTable {
 public:
  void add(const CaseRow& row);
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> cells_;
  std::string classed_by_;
};

/// The cases as a JSON array.
class LibraryJson {
 public:
  void add(const CaseRow& row);
  std::string text() const;

 private:
  std::string text_;
};

/// Everything that is known of one case, as text.
std::string case_text(const CaseRow& row);

/// An age as text: "3 min", "5 h", "12 d".
std::string age_text(double seconds);
/// The number with that many decimals.
std::string fixed_text(double v, int decimals);
/// A figure as the text of a cell, with a fixed count of decimals; "" where the figure is missing.
std::string figure_text(const CaseRow& row, const std::string& name, int decimals, double factor = 1);

}  // namespace trephine::library
