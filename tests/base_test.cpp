// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/hash.h"
#include "base/params.h"
#include "base/result.h"
#include "base/text.h"
#include "base/text_table.h"
#include "base/warning.h"

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
  // What turns the direction of writing: "gpj.exe" would read as "exe.jpg".
  EXPECT_EQ(printable("a\u202egpj.exe"), "a?gpj.exe");
  for (const char* turns : {"\u061c", "\u200e", "\u200f", "\u2028", "\u2029", "\u202a", "\u202d", "\u2066", "\u2069"})
    EXPECT_EQ(printable(std::string("a") + turns + "b"), "a?b") << turns;
  EXPECT_EQ(printable("\u2013\u2030\u00e9\u05d0\u0648\u202f\u2065"), "\u2013\u2030\u00e9\u05d0\u0648\u202f\u2065");
  EXPECT_EQ(printable("\xe2\x80"), "\xe2\x80") << "a character that is cut short";
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
  for (const auto& d : p.set->parameters) all.push_back(describe_parameter(d, p.object.get()));
  EXPECT_EQ(
      all, (std::vector<std::string>{"number, 0 to 5, default 0.2", "whole number, at least 4, default 80000",
                                     "true or false, default true", "one of quick, exact, default exact",
                                     "text, default \"a \\\"b\\\"\"", "3 numbers, -100 to 100, default [1, 2.5, -3]"}));
}

// Structs in structs: what a scene says of shapes, and a case of holes.
struct Item {
  double size_mm = 2;
  std::string of;
  std::array<double, 2> window_hu{0, 0};
  template <class V>
  static void describe(V& v) {
    v.number(&Item::size_mm, "size_mm", Range{1, 5}, "Size.").none_at_zero();
    v.text(&Item::of, "of", "Of what.");
    v.numbers(&Item::window_hu, "window_hu", Range{-1000, 3000}, "Window.");
  }
  std::string fault() const { return of == "nothing" ? "of: must be something" : ""; }
};
struct Share {
  double ratio = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&Share::ratio, "", Range{0, 1}, "Share.");
  }
};
struct Base {
  int count = 1;
  template <class V>
  static void describe(V& v) {
    v.integer(&Base::count, "count", Range{0, 9}, "Count.");
  }
};
struct Nested : Base {
  Item one;
  std::optional<Item> maybe;
  std::vector<Item> several;
  Named<Item> named;
  Named<Share> shares;
  template <class V>
  static void describe(V& v) {
    using P = Nested;
    v.template all_of<Base>();
    v.group(&P::one, "one", "One.");
    v.group(&P::maybe, "maybe", "Perhaps one.");
    v.list(&P::several, "several", "Several.").at_most(2);
    v.map(&P::named, "named", "By name.");
    v.map(&P::shares, "shares", "Shares by name.");
  }
};

std::vector<std::string> paths_of(const AnyParams& p) {
  std::vector<std::string> all;
  for (const ParameterLeaf& leaf : leaves_of(p)) all.push_back(leaf.path + "=" + to_text(leaf.value()));
  return all;
}

TEST(Params, StructsOfStructsListsAndMapsHaveLeaves) {
  Nested n;
  n.count = 3;
  n.named = {{"skin", {3, "bone", {1, 2}}}};
  n.shares = {{"a", {0.5}}};
  n.several.resize(1);
  const AnyParams p = AnyParams::make(n);
  EXPECT_EQ(paths_of(p), (std::vector<std::string>{
                             "count=3", "one.size_mm=2", "one.of=\"\"", "one.window_hu=[0, 0]", "several.0.size_mm=2",
                             "several.0.of=\"\"", "several.0.window_hu=[0, 0]", "named.skin.size_mm=3",
                             "named.skin.of=\"bone\"", "named.skin.window_hu=[1, 2]", "shares.a=0.5"}));
  // Every difference shows in the text that a cache's key is made of, an item without a difference in values too.
  Nested other = n;
  other.maybe.emplace();
  EXPECT_NE(to_text(AnyParams::make(other)), to_text(p));
  other = n;
  other.named[0].first = "skull";
  EXPECT_NE(to_text(AnyParams::make(other)), to_text(p));
  EXPECT_EQ(to_text(AnyParams::make(n)), to_text(p));
  // So do texts that look the same where they are printed.
  Nested tab = n, newline = n;
  tab.named[0].second.of = "a\tb";
  newline.named[0].second.of = "a\nb";
  EXPECT_NE(to_text(AnyParams::make(tab)), to_text(AnyParams::make(newline)));
}

TEST(Params, ItemsAreReadFromTheirTextOnACommandLine) {
  const ParameterSet& set = parameters_of<Nested>();
  Nested n;
  const auto give = [&](const char* name, const char* text) { return parse_item(*set.find(name), &n, text); };
  EXPECT_EQ(give("named", "skin:size_mm=4,of=bone,window_hu=-5,7"), "");
  EXPECT_EQ(give("named", "skull"), "");
  EXPECT_EQ(give("shares", "a=0.25"), "");
  EXPECT_EQ(give("several", "of=x"), "");
  ASSERT_EQ(n.named.size(), 2u);
  EXPECT_EQ(n.named[0].second.window_hu, (std::array<double, 2>{-5, 7}));
  EXPECT_EQ(n.named[1].second.size_mm, 2);
  EXPECT_EQ(n.shares[0].second.ratio, 0.25);
  EXPECT_EQ(give("named", "skin:size=4"), "size, no such key, did you mean size_mm?");
  EXPECT_EQ(give("named", "skin:size_mm=0.5"), "size_mm, must be a number from 1 to 5");
  EXPECT_EQ(give("named", "skin:size_mm=0"), "") << "0 stands for none";
  EXPECT_EQ(give("named", "skin:of=nothing"), "of: must be something");
  EXPECT_EQ(give("shares", "a"), "must be NAME=VALUE");
  EXPECT_EQ(give("several", "of=x"), "");
  EXPECT_EQ(give("several", "of=x"), "at most 2 can be given");
}

TEST(Params, WhatIsDeclaredWithinIsListed) {
  std::vector<std::string> all;
  for (const DeclaredParameter& d : declared_of(AnyParams::make<Nested>()))
    all.push_back(d.path + ": " + describe_parameter(*d.parameter, d.defaults.get()));
  EXPECT_EQ(all[0], "count: whole number, 0 to 9, default 1");
  EXPECT_NE(std::find(all.begin(), all.end(), "named.NAME.size_mm: number, 1 to 5, default 2"), all.end());
  EXPECT_NE(std::find(all.begin(), all.end(), "shares: names: number, 0 to 1"), all.end());
}

struct Lengths {
  double length_mm = 0;
  std::optional<double> width_mm;
  std::vector<double> places_mm = {};  // left out where there are none, in a struct that may be missing, too
  template <class V>
  static void describe(V& v) {
    v.number(&Lengths::length_mm, "length_mm", Range{}, "Length.");
    v.number(&Lengths::width_mm, "width_mm", "Width.");
    v.numbers(&Lengths::places_mm, "places_mm", "Where.");
  }
};

struct Found {
  std::array<int, 3> size{5, 6, 7};
  Named<Lengths> shapes, sides;
  std::vector<Lengths> list;
  Named<double> clear_of;
  std::optional<Lengths> whole;
  std::vector<std::string> concerns;
  std::optional<bool> doubted;
  template <class V>
  static void describe(V& v) {
    using P = Found;
    v.extent(&P::size, "size", "Voxels.");
    v.map(&P::shapes, "shapes", "By shape.").items_alone();
    v.map(&P::sides, "sides", "By side.").items_joined("_");
    v.list(&P::list, "list", "One by one.").items_alone();
    v.map(&P::clear_of, "clear_of", "Distances.").items_between("clear_of_", "_mm");
    v.all_of(&P::whole);
    v.words(&P::concerns, "concerns", "What it is about.");
    v.flag(&P::doubted, "doubted", "Whether.");
  }
};

std::string text_of(const Named<ParameterValue>& figures) {
  std::string text;
  for (const auto& [name, value] : figures) text += name + "=" + to_text(value) + " ";
  return text;
}

TEST(Results, ArePrintedByTheirDeclaration) {
  Found found;
  EXPECT_EQ(text_of(figures_of(found)), "size=\"5x6x7\" concerns=\"\" ");
  found.shapes = {{"skin", {1, {}}}, {"skull", {2, 3}}};
  found.sides = {{"left", {-0.0, {}}}};
  found.list = {{4, {}}, {5, 6}};
  found.clear_of = {{"sinus", 7}};
  found.whole = Lengths{8, 9};
  found.concerns = {"brain", "skull"};
  found.doubted = false;
  EXPECT_EQ(
      text_of(figures_of(found)),
      "size=\"5x6x7\" skin.length_mm=1 skull.length_mm=2 skull.width_mm=3 left_length_mm=0 1.length_mm=4 2.length_mm=5 "
      "2.width_mm=6 clear_of_sinus_mm=7 length_mm=8 width_mm=9 concerns=\"brain skull\" doubted=false ");
}

TEST(Results, AreKnownByTheirStruct) {
  const AnyParams any = AnyParams::make<Lengths>({3, {}});
  EXPECT_EQ(result_as<Lengths>(any).length_mm, 3);
  EXPECT_EQ(result_if<Found>(any), nullptr);
  try {
    result_as<Found>(any);
    ADD_FAILURE() << "another struct";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::internal);
  }
}

TEST(Warnings, AreWordedWithTheirValues) {
  EXPECT_EQ(to_text(Warning{"plain", "nothing {to} fill", {}}), "nothing {to} fill");
  EXPECT_EQ(to_text(Warning{"shift",
                            "{mm:.1f} mm to the {side}, {count} times",
                            {{"mm", 2.26}, {"side", "left"}, {"count", std::int64_t{3}}}}),
            "2.3 mm to the left, 3 times");
  EXPECT_THROW(to_text(Warning{"lacks", "{missing}", {{"mm", 1.0}}}), Error);
}

TEST(Errors, WordTheirSettingsWhereTheyAreShown) {
  Error e(ExitCode::bad_input, "", "series", "a gap; " + Setting{"max_gap_mm", "9_9"} + " reads it");
  EXPECT_STREQ(e.what(), "a gap; --max-gap-mm 9_9 reads it");
  e.worded_for("mr.import");
  EXPECT_STREQ(e.what(), "a gap; --set mr.import.max_gap_mm=9_9 reads it");
  ASSERT_EQ(e.message().settings().size(), 1u);
  EXPECT_EQ(e.message().settings()[0].parameter, "max_gap_mm");
  e.in_stage("mr.import").in_stage("other");
  EXPECT_EQ(e.stage(), "mr.import");
  EXPECT_EQ(e.because(Cause::child_died).because(Cause::child_limit).cause(), Cause::child_died);
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
