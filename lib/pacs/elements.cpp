// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/elements.h"

#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "codecs/element_text.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

void put16(std::string& out, std::uint32_t v) {
  out += static_cast<char>(v & 0xff);
  out += static_cast<char>(v >> 8 & 0xff);
}

void add_to(Sha256& sha, const std::vector<codecs::FileElement>& elements) {
  sha.integer(static_cast<std::int64_t>(elements.size()));
  for (const codecs::FileElement& e : elements) {
    sha.integer(e.group).integer(e.element).text(e.vr).text(e.value).integer(std::int64_t(e.items.size()));
    for (const auto& item : e.items) add_to(sha, item);
  }
}

}  // namespace

codecs::FileElement& Elements::add(std::uint32_t tag, const char* vr) {
  elements_.push_back({static_cast<std::uint16_t>(tag >> 16), static_cast<std::uint16_t>(tag & 0xffff), vr, {}, {}});
  return elements_.back();
}

Elements& Elements::text(std::uint32_t tag, const char* vr, std::string value) {
  if (value.size() % 2) value += std::strcmp(vr, "UI") == 0 ? '\0' : ' ';
  add(tag, vr).value = std::move(value);
  return *this;
}

Elements& Elements::words(std::uint32_t tag, std::initializer_list<int> values) {
  std::string& out = add(tag, "US").value;
  for (const int v : values) put16(out, static_cast<std::uint32_t>(v));
  return *this;
}

Elements& Elements::longs(std::uint32_t tag, std::initializer_list<std::uint32_t> values) {
  std::string& out = add(tag, "UL").value;
  for (const std::uint32_t v : values) {
    put16(out, v & 0xffff);
    put16(out, v >> 16);
  }
  return *this;
}

Elements& Elements::tag(std::uint32_t tag, std::uint32_t value) {
  std::string& out = add(tag, "AT").value;
  put16(out, value >> 16);
  put16(out, value & 0xffff);
  return *this;
}

Elements& Elements::bytes(std::uint32_t tag, const char* vr, std::string value) {
  if (value.size() % 2) value += '\0';
  add(tag, vr).value = std::move(value);
  return *this;
}

Elements& Elements::sequence(std::uint32_t tag, std::vector<Elements> items) {
  auto& out = add(tag, "SQ").items;
  for (Elements& item : items) out.push_back(std::move(item.elements_));
  return *this;
}

Elements& Elements::code(std::uint32_t tag, const std::string& value, const std::string& scheme,
                         const std::string& meaning) {
  return item(
      tag,
      Elements().text(t_code_value, "SH", value).text(t_code_scheme, "SH", scheme).text(t_code_meaning, "LO", meaning));
}

ObjectFile encode_object(Elements elements, const std::string& class_uid, const std::string& series_uid,
                         bool explicit_vr) {
  elements.text(t_sop_class, "UI", class_uid);
  Sha256 sha;
  add_to(sha.text("trephine object").text(series_uid), elements.all());
  const std::string hash = sha.hex();
  ObjectFile made;
  made.instance_uid = uid_of({"instance", hash});
  elements.text(t_sop_instance, "UI", made.instance_uid);
  elements.text(t_series, "UI", series_uid.empty() ? uid_of({"series", hash}) : series_uid);
  const std::string syntax = explicit_vr ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2";
  std::string fault;
  if (!codecs::codecs().write_object(&elements.all(), &syntax, &made.bytes, &fault))
    throw Error(ExitCode::internal, "", "dicom", fault);
  return made;
}

std::string uid_of(std::initializer_list<std::string> texts) {
  Sha256 sha;
  sha.text("trephine pacs");
  for (const std::string& text : texts) sha.text(text);
  return codecs::uid_of_hash(sha.hex());
}

}  // namespace trephine::pacs
