// SPDX-License-Identifier: GPL-3.0-or-later
// The extremes of every stage, as tests and as a table. Usage: extremes_test [--write docs/validation/extremes.md
// [--long] [SECTION]]
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "base/child.h"
#include "outcome.h"
#include "scenes.h"

namespace trephine::extremes {
namespace {

const char* const preamble =
    "# Extremes\n\n"
    "What every stage does at the ends of its parameters and of its input, and past them. `extremes_test --write "
    "docs/validation/extremes.md` wrote this; the tests `extremes.*` fail where the program does something else today. "
    "A result "
    "is "
    "finite, and a surface closed, 2-manifold and free of self-intersections; a refusal is a code and one line; there "
    "is "
    "no crash, NaN, or empty result without a word. Which faults the suite found stands in "
    "[extremes-faults.md](extremes-faults.md). Lines marked (long) are checked by `./check --long` alone.\n";

const std::vector<Section>& all_sections() {
  static const std::vector<Section> all = [] {
    std::vector<Section> s = convergence_sections();
    for (Section& more : export_sections()) s.push_back(std::move(more));
    for (Section& more : parameter_sections()) s.push_back(std::move(more));
    for (Section& more : input_sections()) s.push_back(std::move(more));
    return s;
  }();
  return all;
}

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string row(const std::string& extreme, const std::string& outcome) {
  return "| " + cell(extreme) + " | " + cell(outcome) + " |\n";
}

std::string key_of(const Case& c) { return c.slow ? c.extreme + " (long)" : c.extreme; }

std::string top_of(const Section& s) {
  return "\n## " + s.heading + "\n\n" + (s.about.empty() ? "" : s.about + "\n\n") +
         "| extreme | what happens |\n|---|---|\n";
}

// The committed table, section by section: its lines as they stand.
std::map<std::string, std::string> committed() {
  std::ifstream file(TREPHINE_SOURCE_DIR "/docs/validation/extremes.md");
  std::map<std::string, std::string> sections;
  std::string line, heading;
  while (std::getline(file, line)) {
    if (line.rfind("## ", 0) == 0) heading = line.substr(3);
    sections[heading] += line + "\n";
  }
  return sections;
}

// The row of the committed section that begins with this extreme.
std::string committed_row(const std::string& section, const std::string& extreme) {
  std::istringstream lines(section);
  const std::string start = "| " + cell(extreme) + " | ";
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(start, 0) == 0) return line + "\n";
  return "";
}

enum class Which { quick, slow };

class Extremes : public testing::TestWithParam<std::size_t> {};

// A section's rows are made anew and held against the committed ones.
void check(std::size_t index, Which which) {
  const Section& section = all_sections()[index];
  const std::string table = committed()[section.heading];
  ASSERT_FALSE(table.empty()) << "docs/validation/extremes.md has no section " << section.heading
                              << "; write it anew: extremes_test --write docs/validation/extremes.md";
  std::string rows;
  for (const Case& c : section.cases()) {
    const std::string was = committed_row(table, key_of(c));
    rows += was;
    EXPECT_NE(was, "") << "not in docs/validation/extremes.md: " << c.extreme;
    if (c.slow != (which == Which::slow)) continue;
    const std::string outcome = outcome_of(section.heading + ": " + c.extreme, c.run);
    EXPECT_NE(outcome.substr(0, 5), "FAULT") << section.heading << ": " << c.extreme << ": " << outcome;
    EXPECT_EQ(row(key_of(c), outcome), was) << section.heading;
  }
  // Nothing stands there that is not swept any more.
  std::string stands = table.substr(table.find("|---|---|\n") + 10);
  while (!stands.empty() && stands.size() >= 2 && stands.compare(stands.size() - 2, 2, "\n\n") == 0) stands.pop_back();
  if (stands == "\n") stands.clear();
  EXPECT_EQ(rows, stands);
}

TEST_P(Extremes, DoWhatTheTableSays) { check(GetParam(), Which::quick); }

class LongExtremes : public testing::TestWithParam<std::size_t> {};
TEST_P(LongExtremes, DoWhatTheTableSays) { check(GetParam(), Which::slow); }

std::string name_of(const testing::TestParamInfo<std::size_t>& info) { return all_sections()[info.param].name; }

INSTANTIATE_TEST_SUITE_P(, Extremes, testing::Range<std::size_t>(0, all_sections().size()), name_of);
INSTANTIATE_TEST_SUITE_P(, LongExtremes, testing::Range<std::size_t>(0, all_sections().size()), name_of);

// A stage's source says its name; a new one is swept, or this fails.
TEST(ExtremesOf, EveryStage) {
  std::set<std::string> swept, declared;
  for (const stages::StageType& stage : all_stages()) EXPECT_TRUE(swept.insert(stage.name).second) << stage.name;
  const std::regex name(R"re(\bs\.name = "([a-z_0-9]+)";)re");
  for (const auto& file : std::filesystem::directory_iterator(TREPHINE_SOURCE_DIR "/lib/stages")) {
    if (file.path().extension() != ".cpp") continue;
    std::ifstream in(file.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    for (std::sregex_iterator m(text.begin(), text.end(), name), end; m != end; ++m) declared.insert((*m)[1]);
  }
  EXPECT_GT(declared.size(), 20U);
  EXPECT_EQ(swept, declared);
}

// A section that is no more is taken out of the table.
TEST(ExtremesOf, TheTablesSections) {
  std::set<std::string> swept{""}, written;
  for (const Section& section : all_sections()) EXPECT_TRUE(swept.insert(section.heading).second) << section.heading;
  for (const auto& [heading, lines] : committed()) written.insert(heading);
  EXPECT_EQ(swept, written);
}

double cpu_s() { return double(std::clock()) / CLOCKS_PER_SEC; }

std::string rows_of(const Section& section, const std::string& committed_rows, bool slow_too, std::size_t& faults) {
  std::string rows;
  const double section_began_s = cpu_s();
  double quick_s = 0;
  for (const Case& c : section.cases()) {
    if (c.slow && !slow_too) {
      rows += committed_row(committed_rows, key_of(c));
      continue;
    }
    const double began_s = cpu_s();
    const std::string outcome = outcome_of(section.heading + ": " + c.extreme, c.run);
    const double s = cpu_s() - began_s;
    if (!c.slow) quick_s += s;
    if (!c.slow && s > 0.7) std::cerr << rounded(s) << " s: " << section.heading << ": " << c.extreme << std::endl;
    rows += row(key_of(c), outcome);
    if (outcome.rfind("FAULT", 0) != 0) continue;
    ++faults;
    std::cerr << section.heading << ": " << c.extreme << ": " << outcome << std::endl;
  }
  std::cerr << rounded(cpu_s() - section_began_s) << " s (" << rounded(quick_s) << " s quick): " << section.heading
            << std::endl;
  return rows;
}

// Writes the table; 1 where it holds a fault. Slow lines, and sections whose names do not hold `only`, stay as they are
// committed.
int write(const std::string& path, bool slow_too, const std::string& only) {
  std::string text = preamble;
  std::map<std::string, std::string> before = committed();
  std::size_t faults = 0;
  for (const Section& section : all_sections()) {
    if (section.name.find(only) == std::string::npos)
      text += "\n" + before[section.heading].substr(0, before[section.heading].find_last_not_of('\n') + 1) + "\n";
    else
      text += top_of(section) + rows_of(section, before[section.heading], slow_too, faults);
  }
  std::ofstream(path, std::ios::binary) << text;
  std::cout << std::count(text.begin(), text.end(), '\n') << " lines, " << faults << " faults\n";
  return faults > 0;
}

}  // namespace
}  // namespace trephine::extremes

int main(int argc, char** argv) {
  trephine::run_child_if_asked(argc, argv);
  if (argc >= 3 && std::string(argv[1]) == "--write") {
    const bool slow_too = argc > 3 && std::string(argv[3]) == "--long";
    return trephine::extremes::write(argv[2], slow_too, argc > 3 + slow_too ? argv[3 + slow_too] : "");
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
