// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codecs/transfer_syntax.h"

namespace trephine::dicom {

/// Reads decimal strings ("1.5\\-2\\+004.785156E-01 "), whatever the locale. Padding by blanks and NULs, a leading plus
/// and leading zeros are tolerated, as real files have them. Empty where a component is not a finite decimal number.
std::optional<std::vector<double>> parse_decimals(std::string_view text);

/// The text without padding by blanks and NULs at either end.
std::string_view trimmed(std::string_view text);

// Free text of a file must not reach a message or a report. Text that may pass goes through one of these functions.

/// A convolution kernel's name where it looks like one of a scanner's, else "other"; empty stays empty.
std::string known_kernel(std::string_view text);

/// How sharp a known kernel is, 0 to 100 as Siemens numbers them (40: soft tissue, 60: bone); 50 where it is unknown.
int kernel_sharpness(std::string_view known);
/// The known words of ImageType joined by '/', unknown ones as "other".
std::string known_image_type(std::string_view text);
/// One of DICOM's modality codes, else "unknown".
std::string known_modality(std::string_view text);
/// HU, or another unit that RescaleType may name, else "other"; empty stays empty.
std::string known_rescale_type(std::string_view text);
/// HFS, FFP, ..., else "unknown"; empty stays empty.
std::string known_patient_position(std::string_view text);
/// Whether contrast agent was given by ContrastBolusAgent: "yes" where it names one, "no" where it says that there was
/// none; empty where it says nothing, which is no "no": the tag is left out of most scans.
std::string known_contrast(std::string_view text);

/// Whether a PatientID says nothing of the patient, because programs that anonymise, or people who know none, write it
/// for everybody: ANONYMOUS, UNKNOWN, 0, XXXX and the like, whatever their case and punctuation.
bool is_shared_patient_id(std::string_view id);

using codecs::Encoding, codecs::TransferSyntax, codecs::find_transfer_syntax, codecs::implicit_little_endian,
    codecs::explicit_little_endian;

/// A short name of an image storage class that we know, else null.
struct SopClass {
  const char* uid;
  const char* name;
  bool is_ct;
  bool enhanced;  ///< geometry in functional groups
};
const SopClass* find_sop_class(std::string_view uid);

}  // namespace trephine::dicom
