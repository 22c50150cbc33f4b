// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <sstream>

#include "texts/phrase.h"

namespace {

using namespace trephine;
using texts::Phrase;

TEST(TextsPhrase, ValuesStandInTheirPlacesInOrder) {
  EXPECT_EQ(Phrase("{} of {} errors", {"2", "5"}).english(), "2 of 5 errors");
  EXPECT_EQ(Phrase("an error: {}", {Phrase("through the {} wall", {"medial"})}).english(),
            "an error: through the medial wall");
  std::ostringstream out;
  out << Phrase("no error: {}", {"in the axial plane"});
  EXPECT_EQ(out.str(), "no error: in the axial plane");
}

TEST(TextsPhrase, WhatAValueSaysIsNoPlace) {
  EXPECT_EQ(Phrase("{}: left out: {}", {"{}.json", "damaged {}"}).english(), "{}.json: left out: damaged {}");
}

TEST(TextsPhrase, TooFewValuesLeaveThePlaceToBeSeenAndTooManyAreNotSaid) {
  EXPECT_EQ(Phrase("{} of {}", {"2"}).english(), "2 of {}");
  EXPECT_EQ(Phrase("two", {"2"}).english(), "two");
}

TEST(TextsPhrase, ItsWordsAndItsValuesAreCompared) {
  EXPECT_EQ(Phrase("{} of five errors", {"2"}), Phrase("{} of five errors", {"2"}));
  EXPECT_NE(Phrase("{} of five errors", {"2"}), Phrase("2 of five errors"));
  EXPECT_TRUE(Phrase("").empty());
  EXPECT_TRUE(Phrase().empty());
}

}  // namespace
