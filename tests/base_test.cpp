// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/hash.h"
#include "base/params.h"
#include "base/text.h"
#include "base/text_table.h"

namespace trephine {
namespace {

TEST(Text, IsSplitAtEverySeparator) {
  using Pieces = std::vector<std::string>;
  EXPECT_EQ(split_at("1,2,3", ','), (Pieces{"1", "2", "3"}));
  EXPECT_EQ(split_at(",a,,", ','), (Pieces{"", "a", "", ""}));
  EXPECT_EQ(split_at("", ','), Pieces{""});
}

TEST(Text, NumbersAreShortAndReadBack) {
  EXPECT_EQ(to_text(0.2), "0.2");
  EXPECT_EQ(to_text(80000.0), "80000");
  EXPECT_EQ(to_text(100000.0), "100000");
  EXPECT_EQ(to_text(-0.0), "0");
  EXPECT_EQ(to_text(-1.5), "-1.5");
  for (double v : {1e-9, 0.1 + 0.2, 1e300, -5e-324, 123456789012345678.0, 1.0 / 3})
    EXPECT_EQ(parse_number(to_text(v)), v) << to_text(v);
}

TEST(Text, TablesHaveEvenColumnsAndNoBlanksAtTheEnd) {
  EXPECT_EQ(text_table({{"name", "mm", "why"}, {"skin", "12.5", ""}, {"s", "1", "thin"}}, "lrl"),
            "name    mm  why\nskin  12.5\ns        1  thin\n");
  EXPECT_EQ(text_table({{"a", "1", "22"}, {"bb", "333", "4"}}, "lr"), "a     1  22\nbb  333   4\n");
  EXPECT_EQ(text_table({}, "l"), "");
}

TEST(Text, ParsesOnlyDecimalNumbers) {
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_EQ(parse_number("-12.50"), -12.5);
  EXPECT_EQ(parse_number("0"), 0.0);
  for (const char* bad : {"",   "-",  "010", "0x8", ".nan", "nan", "inf",   "-inf",  "1,5", " 1",
                          "1 ", "+1", ".5",  "5.",  "1e",   "1e+", "1.5mm", "1e999", "--1", "1_000"})
    EXPECT_FALSE(parse_number(bad)) << bad;
  EXPECT_EQ(parse_integer("-42"), -42);
  for (const char* bad : {"", "1.0", "1e3", "010", "99999999999999999999", "+1"})
    EXPECT_FALSE(parse_integer(bad)) << bad;
}

TEST(Text, FindsTheNearestName) {
  const std::vector<std::string> known = {"max_deviation_mm", "keep_ratio", "triangles_count"};
  EXPECT_EQ(nearest_name("max_deviaton_mm", known), "max_deviation_mm");
  EXPECT_EQ(nearest_name("max", known), "max_deviation_mm");
  EXPECT_EQ(nearest_name("triangels_count", known), "triangles_count");
  EXPECT_EQ(nearest_name("colour", known), "");
  EXPECT_EQ(nearest_name("", known), "");
}

TEST(Text, ControlCharactersAreReplaced) {
  EXPECT_EQ(printable("a\nb\x1b[2J\x7f"), "a?b?[2J?");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J \xc3\xa9"),
            "?2J \xc3\xa9");
}

TEST(Error, IsOneLine) {
  Error e(ExitCode::bad_input, "a\nb.dcm", "", "slope is 0");
  e.in_field("0028,1053").in_field("import").in_case("x1").in_case("x2").in_file("other");
  EXPECT_EQ(e.line("trephine import"), "trephine import: x1: a?b.dcm: import: 0028,1053: slope is 0");
}

TEST(Hash, KnownDigests) {
  EXPECT_EQ(sha256_of_bytes(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_of_bytes("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256().bytes("a", 1).bytes("bc", 2).hex(), sha256_of_bytes("abc"));
}

TEST(Hash, PiecesDoNotCollide) {
  EXPECT_NE(Sha256().text("ab").text("c").hex(), Sha256().text("a").text("bc").hex());
  EXPECT_EQ(Sha256().number(-0.0).hex(), Sha256().number(0.0).hex());
  EXPECT_EQ(Sha256().integer(1).hex(), sha256_of_bytes(std::string_view("\1\0\0\0\0\0\0\0", 8)));
  EXPECT_EQ(Sha256().number(1.0).hex(), sha256_of_bytes(std::string_view("\0\0\0\0\0\0\xf0\x3f", 8)));
  Sha256 finished;
  finished.hex();
  EXPECT_THROW(finished.hex(), Error);
}

enum class Way { quick, exact };
struct Sample {
  double max_deviation_mm = 0.2;
  int triangles_count = 80000;
  bool check = true;
  Way way = Way::exact;
  std::string note = "a \"b\"";
  std::array<double, 3> origin_mm{1, 2.5, -3};
  template <class V>
  static void describe(V& v) {
    using P = Sample;
    v.number(&P::max_deviation_mm, "max_deviation_mm", Range{0, 5}, "Largest distance.");
    v.integer(&P::triangles_count, "triangles_count", Range{4}, "Triangles wanted.");
    v.flag(&P::check, "check", "Check the result.");
    v.choice(&P::way, "way", {{"quick", Way::quick}, {"exact", Way::exact}}, "How.");
    v.text(&P::note, "note", "A note.");
    v.numbers(&P::origin_mm, "origin_mm", Range{-100, 100}, "Where.");
  }
};

TEST(Params, DefaultsAsText) {
  const AnyParams p = AnyParams::make<Sample>();
  std::vector<std::string> all;
  for (const auto& d : p.set->parameters) all.push_back(describe_parameter(d, p.get(d)));
  EXPECT_EQ(
      all, (std::vector<std::string>{"number, 0 to 5, default 0.2", "whole number, at least 4, default 80000",
                                     "true or false, default true", "one of quick, exact, default exact",
                                     "text, default \"a \\\"b\\\"\"", "3 numbers, -100 to 100, default [1, 2.5, -3]"}));
}

// A default of its own for each choice of another parameter, whatever is set first, until it is given.
struct ByChoice {
  Way way = Way::quick;
  DefaultBy<double, Way, 2> step_mm{{0.5, 2}};
  template <class V>
  static void describe(V& v) {
    using P = ByChoice;
    v.choice(&P::way, "way", {{"quick", Way::quick}, {"exact", Way::exact}}, "How.");
    v.number(&P::step_mm, "step_mm", Range{0, 5}, "Step.", &P::way, "way");
  }
};

TEST(Params, ADefaultMayHangOnAChoice) {
  AnyParams p = AnyParams::make<ByChoice>();
  const Parameter &way = *p.set->find("way"), &step = *p.set->find("step_mm");
  EXPECT_EQ(describe_parameter(step, p.get(step)), "number, 0 to 5, default 0.5 (2 with way exact)");
  EXPECT_EQ(other_defaults(step, p.get(step)), "2 with way exact");
  way.set(p.object.get(), std::string("exact"));
  EXPECT_EQ(p.get(step), ParameterValue(2.0));
  way.set(p.object.get(), std::string("quick"));
  step.set(p.object.get(), 0.5);
  way.set(p.object.get(), std::string("exact"));
  EXPECT_EQ(p.get(step), ParameterValue(0.5)) << "what is given stays, though it is another's default";
}

std::string fault(const std::string& name, const std::vector<std::string>& items) {
  ParameterValue v;
  return parse_parameter(*parameters_of<Sample>().find(name), items, v);
}

TEST(Params, FaultsSayWhatIsAsked) {
  EXPECT_EQ(fault("max_deviation_mm", {"5.1"}), "must be a number from 0 to 5");
  EXPECT_EQ(fault("max_deviation_mm", {"nan"}), "must be a number from 0 to 5");
  EXPECT_EQ(fault("max_deviation_mm", {"1", "2"}), "must be a number from 0 to 5");
  EXPECT_EQ(fault("triangles_count", {"3"}), "must be a whole number of at least 4");
  EXPECT_EQ(fault("triangles_count", {"4294967300"}), "must be a whole number of at least 4");
  EXPECT_EQ(fault("triangles_count", {"1e4"}), "must be a whole number of at least 4");
  EXPECT_EQ(fault("check", {"yes"}), "must be true or false");
  EXPECT_EQ(fault("way", {"exat"}), "must be one of quick, exact; did you mean exact?");
  EXPECT_EQ(fault("origin_mm", {"1", "2"}), "must be 3 numbers, each from -100 to 100");
  EXPECT_EQ(fault("origin_mm", {"1", "2", "101"}), "must be 3 numbers, each from -100 to 100");
}

TEST(Params, GoodValuesAreSet) {
  AnyParams p = AnyParams::make<Sample>();
  const std::vector<std::pair<std::string, std::vector<std::string>>> given = {{"max_deviation_mm", {"5"}},
                                                                               {"triangles_count", {"4"}},
                                                                               {"check", {"false"}},
                                                                               {"way", {"quick"}},
                                                                               {"note", {""}},
                                                                               {"origin_mm", {"-100", "0", "1e1"}}};
  for (const auto& g : given) {
    const Parameter* d = p.set->find(g.first);
    ASSERT_NE(d, nullptr);
    ParameterValue v;
    ASSERT_EQ(parse_parameter(*d, g.second, v), "") << g.first;
    d->set(p.object.get(), v);
  }
  const auto& s = p.as<Sample>();
  EXPECT_EQ(s.max_deviation_mm, 5);
  EXPECT_EQ(s.triangles_count, 4);
  EXPECT_FALSE(s.check);
  EXPECT_EQ(s.way, Way::quick);
  EXPECT_EQ(s.note, "");
  EXPECT_EQ(s.origin_mm, (std::array<double, 3>{-100, 0, 10}));
  EXPECT_EQ(p.set->find("nothing"), nullptr);
}

}  // namespace
}  // namespace trephine
