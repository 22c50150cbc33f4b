// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dicom/import.h"

namespace trephine::dicom {

/// Whether two series are of one patient, by all attributes of identity that both say. Values are compared as digests
/// and leave nothing behind; what programs that anonymise write for everybody (ANONYMOUS, 0, 19000101) says nothing.
struct PatientMatch {
  std::vector<std::string> contradicting;  ///< keywords: PatientID, PatientName, ...
  std::vector<std::string> agreeing;
};
/// Of a volume file nothing is said. Throws as import_series does up to the decoding.
PatientMatch compare_patients(const SeriesChoice& a, const SeriesChoice& b, const Progress& progress = {});
/// Whether positions in two series mean the same places, by FrameOfReferenceUID: two reconstructions of one scan have
/// one. Nothing where one of them does not say (a volume file). Throws as compare_patients does. (import.cpp)
std::optional<bool> of_one_frame(const SeriesChoice& a, const SeriesChoice& b, const Progress& progress = {});

struct FrameRef;

/// Attributes of identity, in this order: PatientID, IssuerOfPatientID, PatientName, PatientBirthDate,
/// PatientBirthTime, PatientSex, PatientBirthName, PatientMotherBirthName.
constexpr int identity_count = 8;

/// What a file says of who the patient is: digests (attributes.h), 0 where it says nothing.
struct Identity {
  std::array<std::uint64_t, identity_count> said{};
  std::uint64_t birth_year = 0;
  bool only_year = false;  ///< the date of birth is the first day of its year, as anonymising programs write it

  /// Takes the value of an attribute of identity; others are left alone.
  void take(std::uint32_t tag, std::string_view value);
  bool contradicts(const Identity& other, int which) const;
};
bool is_identity_tag(std::uint32_t tag);
std::uint32_t identity_tag(int which);
const char* identity_keyword(int which);

/// What the slices of a series say of the patient.
struct SeriesIdentity {
  struct Contradiction {
    int which;
    std::size_t values;   ///< 1: some slices say it, others do not (of ID and name alone)
    const FrameRef* odd;  ///< a slice that says what the fewest say
  };
  Identity identity;  ///< what most slices say
  std::vector<Contradiction> contradictions;
  std::vector<int> own_for_each;             ///< attributes of which most slices have a value of their own
  std::array<int, identity_count> absent{};  ///< how many slices do not say it
};
SeriesIdentity identity_of(const std::vector<FrameRef>& slices);

}  // namespace trephine::dicom
