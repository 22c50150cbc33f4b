// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of strangers in pages and in what a page asks for: no character in them controls how others are shown.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/html_text.h"
#include "base/printable_lines.h"

namespace trephine {
namespace {

using Json = nlohmann::json;
const std::string turns = "a\u202egpj.exe\u2069\u200f", plain = "a?gpj.exe??";

TEST(HtmlText, HoldsNoCharacterThatTurnsTheDirection) {
  EXPECT_EQ(html_text(turns), plain);
  EXPECT_EQ(html_text("<b>'\"&\x1b[2J\n\tc\u00e9"), "&lt;b&gt;&#39;&quot;&amp;?[2J\n\tc\u00e9");
  EXPECT_EQ(printable_lines("a\n\u202eb\tc\r\n"), "a\n?b\tc?\n");
}

TEST(HtmlText, NorDoesJsonOfAPage) {
  const Json said = {{"why" + turns, turns}, {"lines", "a\nb\tc \\u202e \" \u2013 </script>"}};
  const Json shown = {{"why" + plain, plain}, {"lines", "a\nb\tc \\u202e \" \u2013 </script>"}};
  for (const bool as_escapes : {false, true})
    for (const int indent : {-1, 1}) {
      const std::string text = html_json(said.dump(indent, ' ', as_escapes));
      EXPECT_EQ(Json::parse(text), shown) << text;
      EXPECT_EQ(text.find('<'), std::string::npos) << text;
    }
  EXPECT_EQ(Json::parse(html_json("\"\\u001b\\u009b\\b\\f\\u061C\\u00e9\\ud83d\\ude00\"")), "?????\u00e9\U0001f600");
  EXPECT_EQ(html_json("\"\\u20"), "\"\\u20") << "a text that is cut short";
}

}  // namespace
}  // namespace trephine
