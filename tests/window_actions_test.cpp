// SPDX-License-Identifier: GPL-3.0-or-later
// What a user can do in the window: one table, from which keys, help, the remote's lines and pages come.
#include "window/actions.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "base/error.h"
#include "window/texts.h"

using namespace trephine;

namespace {

const std::string page_file = std::string(TREPHINE_SOURCE_DIR) + "/docs/play.md";

std::string page_text() {
  std::ostringstream text;
  text << std::ifstream(page_file).rdbuf();
  return text.str();
}

// Puts a table between its marks; an empty text where the page has no such marks.
std::string with_table(const std::string& page, const std::string& name, const std::string& table) {
  const std::string begin = "<!-- table of actions: " + name + " -->\n\n", end = "\n<!-- end -->";
  const std::size_t from = page.find(begin);
  const std::size_t to = page.find(end, from);
  if (from == std::string::npos || to == std::string::npos) return "";
  return page.substr(0, from + begin.size()) + table + page.substr(to);
}

}  // namespace

TEST(Actions, EachIsDeclaredWhole) {
  std::set<std::string> names;
  std::set<std::pair<int, KeyUse::How>> uses;
  ASSERT_GT(all_actions().size(), 30u);
  for (const Action& a : all_actions()) {
    SCOPED_TRACE(a.what.of(Language::english));
    EXPECT_TRUE(a.name.empty() || names.insert(a.name).second) << "two of one name";
    EXPECT_TRUE(a.name.empty() || a.run) << "a line of the remote that does nothing";
    EXPECT_FALSE(a.name.empty() && a.keys.empty()) << "nobody can do it";
    for (const Language language : {Language::english, Language::german}) {
      if (!a.keys.empty()) EXPECT_TRUE(a.what.of(language)) << "no help";
      EXPECT_EQ(!a.label.of(language), !a.label.of(Language::english)) << "a button in one language";
      EXPECT_EQ(keys_text(a, language).empty(), a.keys.empty());
    }
    if (!a.keys.empty()) EXPECT_STRNE(a.what.of(Language::english), a.what.of(Language::german));
    for (const KeyUse& use : a.keys) {
      EXPECT_TRUE(uses.insert({use.key, use.how}).second) << key_name(use.key, Language::english) << " does two things";
      const bool goes_on = use.how == KeyUse::How::held || use.how == KeyUse::How::drag;
      EXPECT_TRUE(goes_on ? a.during != nullptr : bool(a.run));
      EXPECT_EQ(use.how == KeyUse::How::numbered, use.how == KeyUse::How::numbered && a.choices);
    }
  }
  for (const char* name : {"tool", "view", "cut", "arm", "places", "slices", "erase", "incise", "aspirate", "pause",
                           "next", "back", "finish"})
    EXPECT_NO_THROW(action_of(name)) << "a button of the panels";
}

TEST(Actions, WordsAreReadAsTheRemoteSendsThem) {
  Words words("place 1 -2.5 3e1 0 0 x");
  EXPECT_EQ(words.verb(), "place");
  const Vec3 p = words.point();
  EXPECT_EQ(p.x, 1);
  EXPECT_EQ(p.y, -2.5);
  EXPECT_EQ(p.z, 30);
  EXPECT_TRUE(words.more());
  EXPECT_THROW(words.point(), Error);
  for (const char* wrong : {"zoom", "zoom 1x", "zoom nan", "zoom inf", "zoom 1e999"})
    EXPECT_THROW(Words(wrong).number(), Error) << wrong;
  EXPECT_TRUE(Words("trace on").on(false));
  EXPECT_FALSE(Words("trace off").on(true));
  EXPECT_FALSE(Words("trace toggle").on(true));
  EXPECT_THROW(Words("trace maybe").on(true), Error);
  EXPECT_EQ(Words("").verb(), "");
  EXPECT_EQ(Words("", "orbit_more").word(), "orbit_more") << "of an action that only keys have";
}

TEST(Actions, KeysHaveNames) {
  EXPECT_EQ(keys_text(action_of("tool"), Language::english), "1 to 9");
  EXPECT_EQ(keys_text(action_of("view"), Language::german), "F1 bis F8");
  EXPECT_EQ(keys_text(action_of("finish"), Language::german), "Eingabe, zweimal");
  EXPECT_EQ(keys_text(action_of("move_cut"), Language::english), "[, ]");
  EXPECT_EQ(keys_text(action_of("zoom"), Language::english), "Ctrl + wheel, +, -");
}

// With TREPHINE_WRITE=1 the page is written instead: what CONTRIBUTING says of a new action.
TEST(Actions, ThePageHasTheTablesThatTheProgramWrites) {
  std::string page = page_text();
  const std::pair<const char*, std::string> tables[] = {{"keys", keys_table(Action::Group::work)},
                                                        {"keys of a lesson", keys_table(Action::Group::lesson)},
                                                        {"keys of the C-arm", keys_table(Action::Group::arm)},
                                                        {"lines of the remote", remote_table()}};
  for (const auto& [name, table] : tables) {
    page = with_table(page, name, table);
    ASSERT_FALSE(page.empty()) << "docs/play.md has no place for the table: " << name;
  }
  if (std::getenv("TREPHINE_WRITE")) std::ofstream(page_file) << page;
  EXPECT_EQ(page_text(), page) << "run: TREPHINE_WRITE=1 build/release/bin/window_test --gtest_filter='Actions.*'";
}
