// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/joined.h"

#include <gtest/gtest.h>

#include <array>

#include "base/error_text.h"
#include "base/rank.h"

namespace trephine {
namespace {

TEST(Joined, WordsStandBesideEachOther) {
  EXPECT_EQ(joined(std::vector<std::string>{}), "");
  EXPECT_EQ(joined(std::vector<std::string>{"a", "b", "c"}), "a, b, c");
  struct Item {
    std::string name;
  };
  const std::vector<Item> items = {{"skin"}, {"skull"}};
  EXPECT_EQ(joined(items, "; ", &Item::name), "skin; skull");
  EXPECT_EQ(joined(std::array<int, 2>{3, 4}, "+", [](int n) { return std::to_string(n); }), "3+4");
}

TEST(Joined, AListEndsInAWord) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b"}), "a and b");
  EXPECT_EQ(listed({"a", "b", "c"}, "or"), "a, b or c");
}

TEST(Joined, QuotesAndBackslashesAreEscaped) {
  EXPECT_EQ(in_quotes("a \"b\" \\ c"), R"("a \"b\" \\ c")");
  EXPECT_EQ(in_quotes("two\nlines"), "\"two?lines\"");
}

TEST(ErrorText, TheCaseIsLeftOutWhereItIsKnown) {
  Error e(ExitCode::quality, "file", "field", "is wrong");
  e.in_case("case-1");
  EXPECT_EQ(error_text(e), "case-1: file: field: is wrong");
  EXPECT_EQ(error_text(e, false), "file: field: is wrong");
  EXPECT_EQ(error_text(Error(ExitCode::quality, "", "", "is wrong")), "is wrong");
  EXPECT_EQ(e.line("trephine"), "trephine: case-1: file: field: is wrong");
}

TEST(Rank, OfAnEvenNumberTheUpperOneIsTheMedian) {
  EXPECT_EQ(median_of(std::vector<double>{4, 1, 3, 2}), 3);
  EXPECT_EQ(median_of(std::vector<int>{7}), 7);
  std::vector<float> values = {5, 9, 1};
  EXPECT_EQ(value_at_rank(values, 0), 1);
  EXPECT_EQ(value_at_rank(values, 2), 9);
}

}  // namespace
}  // namespace trephine
