// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/identity.h"

#include <map>

#include "dicom/attributes.h"
#include "dicom/catalogue.h"
#include "dicom/input_files.h"
#include "dicom/values.h"
#include "dicom/volume_source.h"

namespace trephine::dicom {
namespace {

struct Kind {
  std::uint32_t tag;
  const char* keyword;
};
constexpr Kind kinds[identity_count] = {
    {make_tag(0x0010, 0x0020), "PatientID"},        {make_tag(0x0010, 0x0021), "IssuerOfPatientID"},
    {make_tag(0x0010, 0x0010), "PatientName"},      {make_tag(0x0010, 0x0030), "PatientBirthDate"},
    {make_tag(0x0010, 0x0032), "PatientBirthTime"}, {make_tag(0x0010, 0x0040), "PatientSex"},
    {make_tag(0x0010, 0x1005), "PatientBirthName"}, {make_tag(0x0010, 0x1060), "PatientMotherBirthName"}};
constexpr int birth_date = 3, birth_time = 4, sex = 5;

bool is_whose(int which) { return which == 0 || which == 2; }
bool is_name(int which) { return which == 2 || which >= 6; }

/// One name has one text, however its parts are parted and its letters are written. Other alphabets' forms of it, which
/// not every program writes, do not count.
std::string plain_name(std::string_view value) {
  std::string plain;
  for (const char c : value.substr(0, value.find('='))) {
    if (c >= 'a' && c <= 'z')
      plain += static_cast<char>(c - 'a' + 'A');
    else if (c == '^' || c == ' ' || c == ',' || c == '.' || c == '\0')
      plain += plain.empty() || plain.back() == ' ' ? "" : " ";
    else
      plain += c;
  }
  return std::string(trimmed(plain));
}

std::string digits_of(std::string_view value) {
  std::string digits;
  for (const char c : value)
    if (c >= '0' && c <= '9') digits += c;
  return digits;
}

}  // namespace

bool is_identity_tag(std::uint32_t tag) {
  for (const Kind& k : kinds)
    if (k.tag == tag) return true;
  return false;
}

std::uint32_t identity_tag(int which) { return kinds[which].tag; }
const char* identity_keyword(int which) { return kinds[which].keyword; }

void Identity::take(std::uint32_t tag, std::string_view value) {
  int which = 0;
  while (which < identity_count && kinds[which].tag != tag) ++which;
  if (which == identity_count) return;
  std::string plain(trimmed(value));
  if (which == birth_date) {
    plain = digits_of(plain);
    if (plain.size() < 4 || is_shared_patient_id(plain) || plain == "19000101" || plain == "18000101" ||
        plain == "10000101" || plain == "00010101")
      return;
    birth_year = digest_of(plain.substr(0, 4), "DA");
    const std::string day = plain.substr(4);
    only_year = day.empty() || day == "0101" || day == "0000";
  } else if (which == birth_time) {
    plain = digits_of(plain);
    if (is_shared_patient_id(plain)) return;
  } else if (which == sex) {
    if (plain != "M" && plain != "F") return;  // O is "other", and what is written where it was taken off
  } else {
    if (is_shared_patient_id(plain)) return;
    if (is_name(which)) plain = plain_name(plain);
  }
  said[static_cast<std::size_t>(which)] = digest_of(plain, "LO");
}

bool Identity::contradicts(const Identity& other, int which) const {
  const auto i = static_cast<std::size_t>(which);
  if (said[i] == 0 || other.said[i] == 0 || said[i] == other.said[i]) return false;
  if (which == birth_date && (only_year || other.only_year)) return birth_year != other.birth_year;
  return true;
}

SeriesIdentity identity_of(const std::vector<FrameRef>& slices) {
  SeriesIdentity out;
  for (int which = 0; which < identity_count; ++which) {
    const auto at = static_cast<std::size_t>(which);
    std::map<std::uint64_t, std::vector<const FrameRef*>> values;
    for (const FrameRef& r : slices) {
      const std::uint64_t said = r.header->identity.said[at];
      if (said == 0)
        ++out.absent[at];
      else
        values[said].push_back(&r);
    }
    if (values.empty()) continue;
    const FrameRef *most = nullptr, *odd = nullptr;
    std::size_t of_most = 0, of_odd = slices.size() + 1;
    for (const FrameRef& r : slices) {  // in the slices' order, so that a draw is decided by what stands first
      const std::uint64_t said = r.header->identity.said[at];
      if (said == 0) continue;
      const std::size_t count = values[said].size();
      if (count > of_most) most = &r, of_most = count;
    }
    bool apart = false;
    for (const FrameRef& r : slices) {
      const Identity& i = r.header->identity;
      if (!i.contradicts(most->header->identity, which)) continue;
      apart = true;
      const std::size_t count = values[i.said[at]].size();
      if (count < of_odd) odd = &r, of_odd = count;
    }
    out.identity.said[at] = most->header->identity.said[at];
    if (which == birth_date) {
      out.identity.birth_year = most->header->identity.birth_year;
      out.identity.only_year = most->header->identity.only_year;
    }
    if (!apart && is_whose(which) && out.absent[at] > 0) {  // one source names its patient in all files or in none
      const bool few_say = 2 * static_cast<std::size_t>(out.absent[at]) > slices.size();
      for (const FrameRef& r : slices)
        if (!odd && (r.header->identity.said[at] != 0) == few_say) odd = &r;
      out.contradictions.push_back({which, 1, odd});
    }
    if (!apart) continue;
    if (values.size() > 2 && 2 * values.size() > slices.size())
      out.own_for_each.push_back(which);
    else
      out.contradictions.push_back({which, values.size(), odd});
  }
  return out;
}

PatientMatch compare_patients(const SeriesChoice& a, const SeriesChoice& b, const Progress& progress) {
  std::array<Identity, 2> said;
  for (const SeriesChoice* c : {&a, &b}) {
    if (!volume_sources(c->folder_or_file, progress).empty()) return {};
    said[c == &b] = with_scan(c->folder_or_file, [&] {
      Catalogue catalogue = scan(c->folder_or_file, c->params.modality, progress);
      return identity_of(choose(catalogue, c->params).slices).identity;
    });
  }
  PatientMatch match;
  for (int which = 0; which < identity_count; ++which) {
    const auto at = static_cast<std::size_t>(which);
    if (said[0].contradicts(said[1], which))
      match.contradicting.push_back(identity_keyword(which));
    else if (said[0].said[at] != 0 && said[1].said[at] != 0)
      match.agreeing.push_back(identity_keyword(which));
  }
  return match;
}

}  // namespace trephine::dicom
