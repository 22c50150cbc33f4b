// SPDX-License-Identifier: GPL-3.0-or-later
// A second, plain reading of a DICOM file, to hold the reader against: written from the standard's tables alone, with
// nothing of lib/dicom. Not bounded and not for hostile sizes beyond what a test makes.
#pragma once
#include <cctype>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dicom_synthetic.h"

namespace synthetic {

struct Naive {
  using Elements = std::map<std::uint32_t, std::string>;
  std::string syntax;
  Elements top;
  std::vector<Elements> shared, frames;  ///< functional groups: an item's elements with those of its sequences
  std::string pixels;                    ///< native: the value; encapsulated: the fragments joined
  int fragments = 0;
  bool twice = false;  ///< some element came twice at its level

  const std::string* find(std::uint32_t t, std::size_t frame) const {
    if (frame < frames.size())
      if (auto i = frames[frame].find(t); i != frames[frame].end()) return &i->second;
    if (!shared.empty())
      if (auto i = shared[0].find(t); i != shared[0].end()) return &i->second;
    if (auto i = top.find(t); i != top.end()) return &i->second;
    return nullptr;
  }
  std::optional<std::vector<double>> decimals(std::uint32_t t, std::size_t frame = 0) const {
    const std::string* s = find(t, frame);
    if (!s) return std::nullopt;
    std::vector<double> out;
    for (std::size_t at = 0; at <= s->size();) {
      const std::size_t next = std::min(s->find('\\', at), s->size());
      std::string part = s->substr(at, next - at);
      while (!part.empty() && std::string(" \t\0", 3).find(part.back()) != std::string::npos) part.pop_back();
      const std::size_t blank = part.find_first_not_of(std::string(" \t\0", 3));
      part = blank == std::string::npos ? "" : part.substr(blank);
      char* end = nullptr;
      const double v = std::strtod(part.c_str(), &end);
      if (part.empty() || end != part.c_str() + part.size() || !std::isfinite(v)) return std::nullopt;
      out.push_back(v);
      at = next + 1;
    }
    return out;
  }
  std::optional<int> word(std::uint32_t t) const {
    const auto i = top.find(t);
    if (i == top.end() || i->second.size() < 2) return std::nullopt;
    return static_cast<unsigned char>(i->second[0]) | (static_cast<unsigned char>(i->second[1]) << 8);
  }
};

class NaiveReader {
 public:
  explicit NaiveReader(const std::string& bytes) : b_(bytes) {}

  /// Empty where it cannot be read to its pixel data.
  std::optional<Naive> read() {
    std::size_t at = b_.compare(std::min<std::size_t>(128, b_.size()), 4, "DICM") == 0 ? 132 : 0;
    while (at + 8 <= b_.size() && u(at, 2) == 2) {
      Head h;
      if (!head(at, b_.size(), true, h)) return std::nullopt;
      if (h.tag == tag(2, 0x10)) out_.syntax = strip(b_.substr(h.value, h.length));
      at = h.value + h.length;
    }
    explicit_ = out_.syntax.empty() ? at + 6 <= b_.size() && std::isupper(b_[at + 4]) && std::isupper(b_[at + 5])
                                    : out_.syntax != "1.2.840.10008.1.2";
    if (!elements(at, b_.size(), explicit_, false, 0, &out_.top) || !done_) return std::nullopt;
    return std::move(out_);
  }

 private:
  struct Head {
    std::uint32_t tag = 0;
    std::string vr;
    std::size_t value = 0, length = 0;
    bool open = false;
  };
  std::uint64_t u(std::size_t at, int n) const {
    std::uint64_t v = 0;
    for (int i = n - 1; i >= 0; --i) v = v << 8 | static_cast<unsigned char>(b_[at + static_cast<std::size_t>(i)]);
    return v;
  }
  static std::string strip(std::string s) {
    while (!s.empty() && (s.back() == ' ' || s.back() == '\0')) s.pop_back();
    return s;
  }
  bool head(std::size_t at, std::size_t end, bool explicit_vr, Head& h) const {
    if (at + 8 > end) return false;
    h.tag = tag(static_cast<unsigned>(u(at, 2)), static_cast<unsigned>(u(at + 2, 2)));
    h.value = at + 8;
    std::uint64_t length = u(at + 4, 4);
    if (explicit_vr && (h.tag >> 16) != 0xfffe) {
      h.vr = b_.substr(at + 4, 2);
      static const std::string wide = "OB OD OF OL OV OW SQ UC UN UR UT SV UV";
      static const std::string narrow = "AE AS AT CS DA DS DT FL FD IS LO LT PN SH SL SS ST TM UI UL US";
      if (narrow.find(h.vr) != std::string::npos && h.vr.find(' ') == std::string::npos) {
        length = u(at + 6, 2);
      } else {
        if (at + 12 > end) return false;
        length = u(at + 8, 4);
        h.value = at + 12;
      }
    }
    if (h.tag == tag(0xfffe, 0xe00d) || h.tag == tag(0xfffe, 0xe0dd)) length = 0;  // delimiters have none
    h.open = length == 0xffffffff;
    h.length = h.open ? 0 : static_cast<std::size_t>(length);
    return h.open || h.length <= end - h.value;
  }

  /// The elements of a data set (depth 0) or of an item, into `into`.
  bool elements(std::size_t& at, std::size_t end, bool explicit_vr, bool until_mark, int depth, Naive::Elements* into) {
    if (depth > 40) return false;
    while (at < end) {
      Head h;
      if (!head(at, end, explicit_vr, h)) return false;
      if (h.tag == tag(0xfffe, 0xe00d) && until_mark) {
        at = h.value;
        return true;
      }
      if (depth == 0 && h.tag == tag(0x7fe0, 0x10)) return pixels(h);
      const bool sequence = h.vr == "SQ" || h.open || is_group(h.tag);
      if (sequence) {
        std::vector<Naive::Elements>* list = nullptr;
        if (depth == 0 && h.tag == tag(0x5200, 0x9229)) list = &out_.shared;
        if (depth == 0 && h.tag == tag(0x5200, 0x9230)) list = &out_.frames;
        at = h.value;
        if (!items(at, h.open ? end : h.value + h.length, h.open, explicit_vr && h.vr != "UN", depth + 1, h.tag, list,
                   into))
          return false;
      } else {
        if (into && !into->emplace(h.tag, b_.substr(h.value, h.length)).second) out_.twice = true;
        at = h.value + h.length;
      }
    }
    return !until_mark;
  }
  static bool is_group(std::uint32_t t) {
    return t == tag(0x5200, 0x9229) || t == tag(0x5200, 0x9230) || t == tag(0x20, 0x9113) || t == tag(0x20, 0x9116) ||
           t == tag(0x28, 0x9110) || t == tag(0x28, 0x9145);
  }
  bool items(std::size_t& at, std::size_t end, bool until_mark, bool explicit_vr, int depth, std::uint32_t owner,
             std::vector<Naive::Elements>* list, Naive::Elements* outer) {
    while (until_mark || at < end) {
      Head h;
      if (!head(at, end, false, h)) return false;
      at = h.value;
      if (h.tag == tag(0xfffe, 0xe0dd) && until_mark) return true;
      if (h.tag != tag(0xfffe, 0xe000)) return false;
      if (list) list->emplace_back();
      // Items of a functional group's sequences (depth 2) tell of the frame; all others of nothing.
      Naive::Elements* into = list ? &list->back() : depth == 2 && is_group(owner) ? outer : nullptr;
      Naive::Elements unused;
      std::size_t to = h.open ? end : h.value + h.length;
      if (!elements(at, to, explicit_vr, h.open, depth, into ? into : &unused)) return false;
      if (!h.open) at = to;
    }
    return true;
  }
  bool pixels(const Head& h) {
    done_ = true;
    if (!h.open) {
      out_.pixels = b_.substr(h.value, h.length);
      return true;
    }
    std::size_t at = h.value;
    for (int n = 0;; ++n) {
      Head f;
      if (!head(at, b_.size(), false, f)) return false;
      if (f.tag == tag(0xfffe, 0xe0dd)) return true;
      if (f.tag != tag(0xfffe, 0xe000) || f.open) return false;
      if (n > 0) out_.pixels += b_.substr(f.value, f.length), ++out_.fragments;
      at = f.value + f.length;
    }
  }

  const std::string& b_;
  Naive out_;
  bool explicit_ = true, done_ = false;
};

}  // namespace synthetic
