// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

namespace trephine::cli {

/// While it lives, what is written to std::cout passes `printable` (base/text.h), line by line: a text of a case, a
/// scan or a configuration cannot control the terminal, whoever prints it. Only line ends and tabs stay. It is the one
/// way to standard output (house.sinks); what goes to standard error passes `printable` in base/log.h.
class PlainOutput {
 public:
  PlainOutput();
  ~PlainOutput();
  PlainOutput(const PlainOutput&) = delete;
  PlainOutput& operator=(const PlainOutput&) = delete;

 private:
  class Filter;
  std::unique_ptr<Filter> filter_;
};

}  // namespace trephine::cli
