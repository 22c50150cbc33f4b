// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plain_output.h"

#include <iostream>
#include <streambuf>
#include <string>

#include "base/printable_lines.h"

namespace trephine::cli {
namespace {

constexpr std::size_t longest_wait = 1 << 16;  // of a text without an end of line

}  // namespace

class PlainOutput::Filter : public std::streambuf {
 public:
  explicit Filter(std::ostream& stream) : stream_(stream), to_(stream.rdbuf(this)) {}
  ~Filter() override {
    sync();
    stream_.rdbuf(to_);
  }

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char one = traits_type::to_char_type(c);
    return xsputn(&one, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    waiting_.append(text, static_cast<std::size_t>(count));
    // A character of several bytes may come in parts, so only whole lines go on.
    const std::size_t end = waiting_.rfind('\n');
    if (end != std::string::npos && !pass(end + 1)) return 0;
    return waiting_.size() < longest_wait || pass(waiting_.size()) ? count : 0;
  }
  int sync() override { return pass(waiting_.size()) && to_->pubsync() == 0 ? 0 : -1; }

 private:
  bool pass(std::size_t count) {
    const std::string text = printable_lines(waiting_.substr(0, count));
    waiting_.erase(0, count);
    return to_->sputn(text.data(), static_cast<std::streamsize>(text.size())) ==
           static_cast<std::streamsize>(text.size());
  }
  std::ostream& stream_;
  std::streambuf* to_;
  std::string waiting_;
};

PlainOutput::PlainOutput() : filter_(std::make_unique<Filter>(std::cout)) {}
PlainOutput::~PlainOutput() = default;

}  // namespace trephine::cli
