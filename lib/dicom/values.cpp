// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/text_shape.h"

namespace trephine::dicom {
namespace {

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t next = text.find('\\', at);
    parts.push_back(trimmed(text.substr(at, next == std::string_view::npos ? next : next - at)));
    if (next == std::string_view::npos) return parts;
    at = next + 1;
  }
}

template <class List>
bool contains(const List& list, std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

constexpr SopClass sop_classes[] = {
    {"1.2.840.10008.5.1.4.1.1.2", "CT Image Storage", true, false},
    {"1.2.840.10008.5.1.4.1.1.2.1", "Enhanced CT Image Storage", true, true},
    {"1.2.840.10008.5.1.4.1.1.2.2", "Legacy Converted Enhanced CT Image Storage", true, true},
    {"1.2.840.10008.5.1.4.1.1.4", "MR Image Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.4.1", "Enhanced MR Image Storage", false, true},
    {"1.2.840.10008.5.1.4.1.1.7", "Secondary Capture Image Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.7.1", "Multi-frame Secondary Capture", false, false},
    {"1.2.840.10008.5.1.4.1.1.7.2", "Multi-frame Secondary Capture", false, false},
    {"1.2.840.10008.5.1.4.1.1.7.3", "Multi-frame Secondary Capture", false, false},
    {"1.2.840.10008.5.1.4.1.1.7.4", "Multi-frame Secondary Capture", false, false},
    {"1.2.840.10008.5.1.4.1.1.1", "Computed Radiography Image Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.128", "PET Image Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.481.2", "RT Dose Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.481.3", "RT Structure Set Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.481.5", "RT Plan Storage", false, false},
    {"1.2.840.10008.5.1.4.1.1.88.67", "X-Ray Radiation Dose SR", false, false},
};

// Its letters of the Latin alphabet, as capitals, and its digits.
std::string plain_letters(std::string_view text) {
  std::string plain;
  for (const char c : text) {
    if (c >= 'a' && c <= 'z') plain += static_cast<char>(c - 'a' + 'A');
    if ((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

}  // namespace

bool is_shared_patient_id(std::string_view id) {
  if (std::any_of(id.begin(), id.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }))
    return false;  // letters of another alphabet
  const std::string plain = plain_letters(id);
  if (plain.find_first_not_of(plain.empty() ? '0' : plain[0]) == std::string::npos) return true;  // 0, 000, XXXX, "-"
  constexpr std::string_view shared[] = {
      "ANON",    "ANONYM",      "ANONYMOUS", "ANONYMISED",   "ANONYMIZED",  "ANONYMOUSPATIENT", "ANONYMOUSID",
      "ANONID",  "ANONPATIENT", "PSEUDONYM", "DEIDENTIFIED", "DEID",        "REMOVED",          "DELETED",
      "HIDDEN",  "REDACTED",    "UNKNOWN",   "UNDEFINED",    "UNSPECIFIED", "NOTKNOWN",         "NONE",
      "NOID",    "NULL",        "NA",        "NOTAVAILABLE", "PATIENT",     "PATIENTID",        "NONAME",
      "NONAMED", "TEST",        "ID",        "EMPTY"};
  return contains(shared, plain);
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\0' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<std::vector<double>> parse_decimals(std::string_view text) {
  std::vector<double> values;
  for (std::string_view part : split(text)) {
    if (!part.empty() && part.front() == '+') part.remove_prefix(1);
    // from_chars would also take "inf" and "nan".
    if (part.empty() || part.find_first_not_of("0123456789+-.eE") != std::string_view::npos || part.front() == '+')
      return std::nullopt;
    double v = 0;
    const auto r = std::from_chars(part.data(), part.data() + part.size(), v);
    if (r.ec != std::errc() || r.ptr != part.data() + part.size() || !std::isfinite(v)) return std::nullopt;
    values.push_back(v);
  }
  return values;
}

std::string known_contrast(std::string_view text) {
  const std::string_view said = trimmed(text);
  if (said.empty()) return "";
  const std::string plain = plain_letters(said);
  constexpr std::string_view nothing[] = {"NA", "NOTAVAILABLE", "UNKNOWN", "UNBEKANNT", "NULL", "UNSPECIFIED"};
  constexpr std::string_view none[] = {
      "NO",         "N",           "NON",   "NONE",   "NIL",  "NOCONTRAST", "WITHOUT", "WITHOUTCONTRAST", "WO",
      "WOCONTRAST", "NONCONTRAST", "NATIV", "NATIVE", "OHNE", "OHNEKM",     "KEIN",    "KEINES",          "0"};
  // Of another alphabet's name nothing is left as plain letters; a dash or a dot names nothing.
  const bool foreign =
      std::any_of(said.begin(), said.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
  if ((plain.empty() && !foreign) || contains(nothing, plain)) return "";
  return contains(none, plain) ? "no" : "yes";
}

std::string known_kernel(std::string_view text) {
  const std::string_view first = split(text).front();
  if (first.empty()) return "";
  static constexpr std::array<std::string_view, 20> words = {
      "STANDARD", "STAND", "STD",   "STD+",  "SOFT", "DETAIL", "BONE",   "BONE+", "BONEPLUS", "LUNG",
      "CHST",     "EDGE",  "ULTRA", "BRAIN", "ND",   "SHARP",  "SMOOTH", "HEAD",  "STND",     "SOFT+"};
  std::string upper(first);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  if (contains(words, std::string_view(upper))) return upper;
  // Siemens B30f, Hr38s, J70h, 59.10.AH40; Toshiba FC21; Philips A to L, UA, YC; Hitachi 22: too short and too odd for
  // a name.
  const bool two =
      first.size() == 2 && std::string_view("UYEI").find(first[0]) < 4 && first[1] >= 'A' && first[1] <= 'E';
  static constexpr std::string_view shapes[] = {"Aa99a", "99.99.AA99", "99 .99.AA99", "FC99", "A", "988"};
  const bool is = two || std::any_of(std::begin(shapes), std::end(shapes), [&](auto s) { return has_shape(first, s); });
  return is ? std::string(first) : "other";
}

int kernel_sharpness(std::string_view known) {
  constexpr int unknown = 50;
  static constexpr std::pair<std::string_view, int> words[] = {
      {"SMOOTH", 20}, {"SOFT", 30},  {"SOFT+", 35},    {"BRAIN", 35}, {"HEAD", 35},   {"STANDARD", 40}, {"STAND", 40},
      {"STD", 40},    {"STND", 40},  {"STD+", 45},     {"CHST", 50},  {"DETAIL", 55}, {"LUNG", 65},     {"SHARP", 65},
      {"BONE", 70},   {"BONE+", 75}, {"BONEPLUS", 75}, {"EDGE", 80},  {"ULTRA", 80},  {"A", 30},        {"B", 35},
      {"C", 45},      {"D", 65},     {"E", 75},        {"UA", 30},    {"UB", 35},     {"UC", 45}};
  for (const auto& [word, sharpness] : words)
    if (known == word) return sharpness;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t at = known.size();
  while (at > 0 && !digit(known[at - 1])) --at;  // H40s: what follows the number is no part of it
  if (at < 2 || !digit(known[at - 2])) return unknown;
  const int number = 10 * (known[at - 2] - '0') + (known[at - 1] - '0');
  if (known.rfind("FC", 0) == 0) {  // Toshiba: 30 to 39 and 80 on are for bone, 50 to 59 for lung
    const int tens = number / 10;
    return tens == 3 || tens >= 8 ? 70 : tens == 5 ? 65 : 40;
  }
  return digit(known.front()) && known.find('.') == std::string_view::npos ? unknown : number;
}

std::string known_image_type(std::string_view text) {
  static constexpr std::array<std::string_view, 22> words = {
      "ORIGINAL",    "DERIVED", "PRIMARY", "SECONDARY", "AXIAL", "LOCALIZER", "VOLUME", "MPR",
      "REFORMATTED", "AVERAGE", "MIN_IP",  "MAX_IP",    "MIP",   "SCOUT",     "HELIX",  "CT_SOM5",
      "SPI",         "SPR",     "OTHER",   "JP2K",      "NONE",  "RESAMPLED"};
  std::string out;
  if (trimmed(text).empty()) return out;
  for (const std::string_view part : split(text)) {
    if (!out.empty()) out += '/';
    out += contains(words, part) ? std::string(part) : "other";
  }
  return out.size() > 80 ? out.substr(0, 80) : out;
}

std::string known_modality(std::string_view text) {
  static constexpr std::array<std::string_view, 27> words = {
      "CT", "MR",  "CR",  "DX",       "MG",     "US",     "PT",      "NM",  "XA",  "RF", "SC", "OT", "SR", "PR",
      "KO", "SEG", "REG", "RTSTRUCT", "RTPLAN", "RTDOSE", "RTIMAGE", "ECG", "DOC", "IO", "PX", "HC", "ES"};
  text = trimmed(text);
  return contains(words, text) ? std::string(text) : "unknown";
}

std::string known_rescale_type(std::string_view text) {
  static constexpr std::array<std::string_view, 11> words = {"HU", "OD",  "HU_MOD", "US",   "MGML",  "Z_EFF",
                                                             "ED", "EDW", "PCT",    "CONC", "IMAGED"};
  text = trimmed(text);
  if (text.empty()) return "";
  return contains(words, text) ? std::string(text) : "other";
}

std::string known_patient_position(std::string_view text) {
  static constexpr std::array<std::string_view, 8> words = {"HFS", "HFP", "HFDR", "HFDL", "FFS", "FFP", "FFDR", "FFDL"};
  text = trimmed(text);
  if (text.empty()) return "";
  return contains(words, text) ? std::string(text) : "unknown";
}

const SopClass* find_sop_class(std::string_view uid) {
  for (const auto& s : sop_classes)
    if (trimmed(uid) == s.uid) return &s;
  return nullptr;
}

}  // namespace trephine::dicom
