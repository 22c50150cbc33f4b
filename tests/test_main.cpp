// SPDX-License-Identifier: GPL-3.0-or-later
// Every test program can be its own bounded child.
#include <gtest/gtest.h>

#include "base/child.h"

int main(int argc, char** argv) {
  trephine::run_child_if_asked(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
