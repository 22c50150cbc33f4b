// SPDX-License-Identifier: GPL-3.0-or-later
// What a user can do in the window: one table, from which keys, help, the remote's lines and pages come.
#include "window/actions.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <tuple>

#include "base/error.h"
#include "window/texts.h"

using namespace trephine;

namespace {

const std::string page_file = std::string(TREPHINE_SOURCE_DIR) + "/docs/reference/window.md";

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
  std::set<std::tuple<int, window::KeyUse::How, window::KeyUse::With, bool>> uses;  // an action that is first may share
  ASSERT_GT(window::all_actions().size(), 30u);
  for (const window::Action& a : window::all_actions()) {
    SCOPED_TRACE(a.what.of(texts::Language::english));
    EXPECT_TRUE(a.name.empty() || names.insert(a.name).second) << "two of one name";
    EXPECT_TRUE(a.name.empty() || a.run) << "a line of the remote that does nothing";
    EXPECT_FALSE(a.name.empty() && a.keys.empty()) << "nobody can do it";
    for (const texts::Language language : {texts::Language::english, texts::Language::german}) {
      if (!a.keys.empty()) EXPECT_TRUE(a.what.of(language)) << "no help";
      EXPECT_EQ(!a.label.of(language), !a.label.of(texts::Language::english)) << "a button in one language";
      EXPECT_EQ(window::keys_text(a, language).empty(), a.keys.empty());
    }
    if (!a.keys.empty()) EXPECT_STRNE(a.what.of(texts::Language::english), a.what.of(texts::Language::german));
    for (const window::KeyUse& use : a.keys) {
      EXPECT_TRUE(uses.insert({use.key, use.how, use.with, a.first}).second)
          << window::key_name(use.key, texts::Language::english) << " does two things";
      const bool goes_on = use.how == window::KeyUse::How::held || use.how == window::KeyUse::How::drag;
      EXPECT_TRUE(goes_on ? a.during != nullptr : bool(a.run));
      EXPECT_EQ(use.how == window::KeyUse::How::numbered, use.how == window::KeyUse::How::numbered && a.choices);
    }
  }
  for (const char* name : {"tool", "view", "cut", "arm", "places", "slices", "erase", "incise", "aspirate", "pause",
                           "next", "back", "finish"})
    EXPECT_NO_THROW(window::action_of(name)) << "a button of the panels";
}

TEST(Actions, WordsAreReadAsTheRemoteSendsThem) {
  window::Words words("place 1 -2.5 3e1 0 0 x");
  EXPECT_EQ(words.verb(), "place");
  const Vec3 p = words.point();
  EXPECT_EQ(p.x, 1);
  EXPECT_EQ(p.y, -2.5);
  EXPECT_EQ(p.z, 30);
  EXPECT_TRUE(words.more());
  EXPECT_THROW(words.point(), Error);
  for (const char* wrong : {"zoom", "zoom 1x", "zoom nan", "zoom inf", "zoom 1e999"})
    EXPECT_THROW(window::Words(wrong).number(), Error) << wrong;
  EXPECT_TRUE(window::Words("trace on").on(false));
  EXPECT_FALSE(window::Words("trace off").on(true));
  EXPECT_FALSE(window::Words("trace toggle").on(true));
  EXPECT_THROW(window::Words("trace maybe").on(true), Error);
  EXPECT_EQ(window::Words("").verb(), "");
  EXPECT_EQ(window::Words("", "orbit_more").word(), "orbit_more") << "of an action that only keys have";
}

TEST(Actions, KeysHaveNames) {
  EXPECT_EQ(window::keys_text(window::action_of("tool"), texts::Language::english), "1 to 9");
  EXPECT_EQ(window::keys_text(window::action_of("view"), texts::Language::german), "F1 bis F8");
  EXPECT_EQ(window::keys_text(window::action_of("finish"), texts::Language::german), "Eingabe, zweimal");
  EXPECT_EQ(window::keys_text(window::action_of("move_cut"), texts::Language::english), "[, ]");
  EXPECT_EQ(window::keys_text(window::action_of("move"), texts::Language::english),
            "mouse, Shift + left, right, up, down");
  EXPECT_EQ(window::keys_text(window::action_of("zoom"), texts::Language::english), "Ctrl + wheel, +, -");
}

// With TREPHINE_WRITE=1 the page is written instead: what CONTRIBUTING says of a new action.
TEST(Actions, ThePageHasTheTablesThatTheProgramWrites) {
  std::string page = page_text();
  const std::pair<const char*, std::string> tables[] = {
      {"keys", window::keys_table(window::Action::Group::work)},
      {"keys of a lesson", window::keys_table(window::Action::Group::lesson)},
      {"keys of the C-arm", window::keys_table(window::Action::Group::arm)},
      {"lines of the remote", window::remote_table()}};
  for (const auto& [name, table] : tables) {
    page = with_table(page, name, table);
    ASSERT_FALSE(page.empty()) << "docs/reference/window.md has no place for the table: " << name;
  }
  if (std::getenv("TREPHINE_WRITE")) std::ofstream(page_file) << page;
  EXPECT_EQ(page_text(), page) << "run: TREPHINE_WRITE=1 build/release/bin/window_test --gtest_filter='Actions.*'";
}
