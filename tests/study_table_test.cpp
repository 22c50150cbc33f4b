// SPDX-License-Identifier: GPL-3.0-or-later
// What a study takes of a table, and what it says of that which is missing.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "study/plots.h"
#include "study/study.h"

namespace {

using namespace trephine;
using namespace trephine::study;

Study of(const std::string& csv, const StudyParams& params = {}) { return evaluate(parse_table(csv), params); }

std::string refused(const std::string& csv, const StudyParams& params = {}) {
  try {
    of(csv, params);
  } catch (const Error& e) {
    return std::to_string(int(e.code())) + " " + e.field() + ": " + e.what();
  }
  return "";
}
bool says(const std::vector<std::string>& notes, const std::string& what) {
  return std::any_of(notes.begin(), notes.end(), [&](const std::string& n) { return n.find(what) != n.npos; });
}
const NamedTest& test_of(const PairTests& pair, const std::string& name) {
  return *std::find_if(pair.tests.begin(), pair.tests.end(), [&](const NamedTest& t) { return t.name == name; });
}

TEST(StudyTable, CsvAsOthersWriteIt) {
  const Table t = parse_table(
      "\xEF\xBB\xBF"
      "a, b ,c\r\n1,\"x, \"\"y\"\"\",\r\n\r\n2,\"two\nlines\",3\n4,5,6");
  EXPECT_EQ(t.columns, (std::vector<std::string>{"a", "b", "c"}));
  ASSERT_EQ(t.rows.size(), 3u);
  EXPECT_EQ(t.rows[0][1], "x, \"y\"");
  EXPECT_EQ(t.rows[1][1], "two\nlines");
  EXPECT_EQ(t.lines, (std::vector<std::size_t>{2, 4, 6}));
  EXPECT_EQ(parse_table(table_csv(t)).rows, t.rows);
  EXPECT_NE(refused("a;b\n1;2\n").find("saved with commas"), std::string::npos);
  EXPECT_NE(refused("a,b\n1\n").find("65 line 2: has 1 cells"), std::string::npos);
  EXPECT_NE(refused("a,b\n1,\"x\n").find("65 line 2: has a quote that is not closed"), std::string::npos);
  EXPECT_NE(refused("a,a\n").find("named twice"), std::string::npos);
}

// No message repeats what might be a name.
TEST(StudyTable, ParticipantsAreTokens) {
  const std::string said = refused("participant,points\nr-01,3\nJohn Doe,4\n");
  EXPECT_NE(said.find("65 line 3, participant: must be a token"), std::string::npos) << said;
  EXPECT_EQ(said.find("John"), std::string::npos);
}

TEST(StudyTable, MissingValuesAreTold) {
  const Study s = of("participant,attempt,points\na,1,3\na,2,\nb,1,5\nb,2,6\nc,1,NA\nd,1,4\nd,2,8\n");
  ASSERT_EQ(s.measures.size(), 1u);
  EXPECT_TRUE(says(s.measures[0].notes, "2 of 7 rows have no value, and are left out: a, c"));
  const Comparison& c = s.measures[0].comparisons.at(0);
  EXPECT_TRUE(says(c.notes, "one participant is in one of both alone, and makes no pair: a"));
  EXPECT_EQ(c.pairs.at(0).pairs_count, 2u);
  EXPECT_NE(refused("participant,points\na,3\nb,many\n",
                    [] {
                      StudyParams p;
                      p.measures = "points";
                      return p;
                    }())
                .find("65 line 3, points: is no finite number"),
            std::string::npos);
}

TEST(StudyTable, EqualAndTooFewAreTold) {
  const Study s = of("participant,group,points\na,x,3\nb,x,3\nc,y,3\n");
  EXPECT_TRUE(says(s.measures[0].notes, "all values are equal (3)"));
  const Comparison& c = s.measures[0].comparisons.at(0);
  EXPECT_EQ(c.all->result.why_not, "all values are equal");
  EXPECT_EQ(test_of(c.pairs[0], "Welch").result.why_not, "fewer than two values on a side");
  EXPECT_NE(study_text(s).find("Welch: not tested: fewer than two values on a side"), std::string::npos);
  EXPECT_TRUE(says(of("participant,points\na,3\n").measures[0].notes, "nothing is compared"));
}

TEST(StudyTable, AParticipantIsOneObservationOfAGroup) {
  const std::string csv = "participant,group,points\na,x,3\na,x,5\nb,x,6\nc,y,9\nd,y,7\n";
  const Study s = of(csv);
  EXPECT_EQ(s.measures[0].comparisons[0].samples[0].values, (std::vector<double>{4, 6}));
  EXPECT_TRUE(says(s.measures[0].comparisons[0].notes, "1 value stands for the mean of several rows"));
  StudyParams rows;
  rows.unit = StudyParams::Unit::row;
  EXPECT_EQ(of(csv, rows).measures[0].comparisons[0].samples[0].values, (std::vector<double>{3, 5, 6}));
  EXPECT_NE(refused("participant,group,points\na,x,3\na,y,5\n").find("participant a is in two groups"),
            std::string::npos);
}

TEST(StudyTable, PhasesArePairedInTheirOwnOrder) {
  const Study s = of("participant,phase,points\na,after,9\na,before,3\nb,before,4\nb,after,8\nc,before,1\nc,after,9\n");
  const Comparison& c = s.measures[0].comparisons.at(0);
  EXPECT_EQ(c.samples[0].name, "before");
  const TestResult& t = test_of(c.pairs[0], "paired t").result;
  EXPECT_NEAR(t.difference->value, 6, 1e-12);
  EXPECT_NEAR(*c.pairs[0].change_ratio, 6 / (8.0 / 3), 1e-12);
  EXPECT_EQ(test_of(c.pairs[0], "signed rank").result.statistic, 6);
}

TEST(StudyTable, TheLearningCurveIsTheMeanOfTheParticipantsSlopes) {
  const Study s = of("participant,attempt,time_s\na,1,100\na,2,90\na,4,80\nb,1,60\nb,2,40\nc,1,10\n");
  const LearningCurve& curve = *s.measures[0].curve;
  EXPECT_NEAR(curve.slope.difference->value, (-10 + -20) / 2.0, 1e-12);
  EXPECT_TRUE(says(curve.notes, "one participant made a single attempt, and has no slope: c"));
  EXPECT_EQ(curve.points[0].summary.count, 3u);
}

// The dissertation's Table XVI: the relative changes are differences of the printed frequencies; the text's are ratios
// of the printed means. The errors of each screw are the only distribution that gives all that is printed
// (bench/table_sixteen.py), so its p values come out as well.
TEST(StudyTable, TableSixteenComesOut) {
  StudyParams p;
  p.count = "screws";
  p.acceptable = "acceptable";
  p.measures = "errors";
  const Study s = evaluate(read_table(TREPHINE_SOURCE_DIR "/examples/study/table_sixteen.csv"), p);
  ASSERT_EQ(s.acceptable.size(), 3u);
  const std::size_t acceptable[] = {17, 20, 24}, all[] = {26, 24, 26};
  const double shares[] = {65.4, 83.3, 92.3}, changes[] = {0, 17.9, 26.9}, means[] = {2.08, 1.58, 0.96},
               deviations[] = {1.23, 0.88, 0.96};
  const Comparison& c = s.measures.at(0).comparisons.at(0);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(s.acceptable[n].acceptable, acceptable[n]);
    EXPECT_EQ(s.acceptable[n].all, all[n]);
    EXPECT_NEAR(100 * s.acceptable[n].share(), shares[n], 0.05);
    EXPECT_NEAR(s.acceptable[n].more_points_percent, changes[n], 0.051);
    EXPECT_NEAR(c.samples[n].summary.mean, means[n], 0.005);
    EXPECT_NEAR(*c.samples[n].summary.sd, deviations[n], 0.005);
  }
  const double improved[] = {24.0, 53.8, 39.2}, printed_p[] = {0.1505, 0.0005, 0.0078};
  for (std::size_t n = 0; n < 3; ++n) {  // A to B, A to C, B to C
    EXPECT_NEAR(-100 * *c.pairs[n].change_ratio, improved[n], 0.25);
    EXPECT_NEAR(test_of(c.pairs[n], "Kruskal-Wallis").result.p, printed_p[n], 0.00005);
  }
}

TEST(StudyTable, RostersAddColumns) {
  const Table t = joined(parse_table("participant,points\na,1\nb,2\n"), parse_table("participant,level\na,junior\n"),
                         "participant");
  EXPECT_EQ(t.columns.back(), "level");
  EXPECT_EQ(t.rows[0][2], "junior");
  EXPECT_EQ(t.rows[1][2], "");
  EXPECT_THROW(joined(t, parse_table("participant,level\nb,senior\n"), "participant"), Error);
  EXPECT_THROW(joined(parse_table("participant\na\n"), parse_table("participant,l\na,1\na,2\n"), "participant"), Error);
}

TEST(StudyTable, BinsHoldEveryValue) {
  const Bins whole = bins_for({1, 2, 2, 5}, 0);
  EXPECT_EQ(whole.count, 5);
  EXPECT_EQ(whole.begin, 0.5);
  std::vector<double> values;
  for (int n = 0; n < 200; ++n) values.push_back(0.37 * n - 11);
  const Bins bins = bins_for(values, 0);
  EXPECT_LE(bins.begin, values.front());
  EXPECT_GE(bins.begin + bins.width * bins.count, values.back());
  EXPECT_GT(bins.count, 4);
  EXPECT_EQ(bins_for({3, 3}, 0).count, 1);
}

// Whoever words the plots words all of them: what is in angles went through the words, and a group's name is not ours.
TEST(StudyTable, APlotIsDrawnInTheWordsThatAreGiven) {
  const auto marked = [](const texts::Phrase& p) {
    return p.values.empty() ? "<" + p.words + ">" : "<" + p.english() + ">";
  };
  const std::string csv =
      "participant,group,phase,attempt,points\na,mean,before,1,3\na,mean,after,2,5\nb,mean,before,1,4\n"
      "b,mean,after,2,9\nc,y,before,1,6\nc,y,after,2,8\n";
  std::string all;
  for (const StudyPlot& plot : plots_of(of(csv), marked)) {
    EXPECT_EQ(plot.title.front(), '<') << plot.title;
    all += plot.script;
  }
  for (const char* word : {"'<points>'", "'<median>'", "'<mean>'", "'<count>'", "'<attempt>'", "'<participants>'",
                           "'<mean, interval>'", "<group> mean, n =", "<phase> <before>, n ="})
    EXPECT_NE(all.find(word), std::string::npos) << word << "\n" << all;
  for (const char* word : {"'points'", "'median'", "'mean'", "'count'", "'attempt'", "'participants'", " phase before"})
    EXPECT_EQ(all.find(word), std::string::npos) << word;
}

// The same table in another order of rows and columns gives the same figures.
TEST(StudyTable, TheOrderOfRowsSaysNothing) {
  const std::string a = "participant,group,points\na,x,3\nb,x,7\nc,y,9\nd,y,4\n";
  const std::string b = "points,participant,group\n3,a,x\n9,c,y\n4,d,y\n7,b,x\n";
  EXPECT_EQ(study_json(of(a)), study_json(of(b)));
}

}  // namespace
