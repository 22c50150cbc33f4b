// SPDX-License-Identifier: GPL-3.0-or-later
// write_sample_case FOLDER [full]: writes a small case of every part, or one of full size, for the tests of programs.
#include <iostream>

#include "case_samples.h"

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  try {
    const bool full = argc > 2 && std::string(argv[2]) == "full";
    (full ? case_samples::full_size_case() : case_samples::minimal_case()).write(argv[1]);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 70;
  }
}
