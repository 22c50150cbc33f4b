// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "codecs/codecs.h"

namespace trephine::pacs {

/// The elements of a data set, or of an item of a sequence, in any order. Tags are 0xggggeeee.
class Elements {
 public:
  /// Text of any VR, padded to even length as the VR asks.
  Elements& text(std::uint32_t tag, const char* vr, std::string value = "");
  Elements& words(std::uint32_t tag, std::initializer_list<int> values);            ///< VR US
  Elements& longs(std::uint32_t tag, std::initializer_list<std::uint32_t> values);  ///< VR UL
  Elements& tag(std::uint32_t tag, std::uint32_t value);                            ///< VR AT
  Elements& bytes(std::uint32_t tag, const char* vr, std::string value);
  Elements& sequence(std::uint32_t tag, std::vector<Elements> items);
  Elements& item(std::uint32_t tag, Elements only) { return sequence(tag, {std::move(only)}); }
  /// A sequence of one code: value, scheme, meaning.
  Elements& code(std::uint32_t tag, const std::string& value, const std::string& scheme, const std::string& meaning);

  const std::vector<codecs::FileElement>& all() const { return elements_; }

 private:
  codecs::FileElement& add(std::uint32_t tag, const char* vr);
  std::vector<codecs::FileElement> elements_;
};

/// One object as a file, with the UID that others refer to it by.
struct ObjectFile {
  std::string instance_uid, bytes;
};

/// Writes the data set as a file. What is written decides the SOPInstanceUID, and so does the SeriesInstanceUID where
/// `series_uid` is empty: equal content has equal UIDs and bytes. Throws Error 70.
ObjectFile encode_object(Elements elements, const std::string& class_uid, const std::string& series_uid = "",
                         bool explicit_vr = true);

/// A UID that follows from the texts.
std::string uid_of(std::initializer_list<std::string> texts);

}  // namespace trephine::pacs
