// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <string>

#include "pacs/elements.h"
#include "pacs/slices.h"

namespace trephine::pacs {

/// Whose objects these are. The patient is the case's token: nothing of the source's identity is in them.
struct CaseIdentity {
  std::string case_token;
  std::string study_uid, frame_uid;
  std::string program_version;  ///< "trephine 0.2.0"
};
/// With UIDs that follow from the case's token and the hash of its scan: cases of one scan share the frame of
/// reference, and the objects of one case the study.
CaseIdentity identity_of_case(const std::string& case_token, const std::string& input_sha256,
                              const std::string& program_version);

/// The modules that all objects have: patient, study, series, equipment, frame of reference.
Elements described(const CaseIdentity& identity, const char* modality, int series_number, const char* description);

/// DICOM has no object without a date of its content. This one is no time of anything, so that equal cases give equal
/// bytes.
constexpr const char* content_date = "20000101";
constexpr const char* content_time = "120000";

std::string vector_text(const SliceSet& slices);  ///< ImageOrientationPatient
std::string place_text(Vec3 position_mm);

/// The CT on the slices (resampled_on): images that the other objects refer to. `slices` gets their UIDs. Files are
/// handed over one by one, in the slices' order.
void encode_ct(const CaseIdentity& identity, const grid::Grid<std::int16_t>& ct, SliceSet& slices,
               const std::function<void(std::size_t slice, const std::string& bytes)>& take,
               const Progress& progress = {});

struct Segment {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};  ///< sRGB
  SliceBits bits;
};
/// A BINARY segmentation: one frame for each slice on which a segment has a pixel. Throws Error 70 where there is none.
ObjectFile encode_segmentation(const CaseIdentity& identity, const SliceSet& slices,
                               const std::vector<Segment>& segments);

/// sRGB as CIELab of the white point D65, as DICOM scales it to 16 bits: what readers of segmentations invert.
std::array<int, 3> lab_of(std::array<double, 3> colour_rgb);

/// The bytes of a binary STL file, LPS mm, as an object.
ObjectFile encode_stl_object(const CaseIdentity& identity, const std::string& anatomy, const std::string& stl);

struct ContouredSurface {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  const surface::TriMesh* mesh = nullptr;
};
/// An RT structure set: the surfaces' contours on the slices, to 0.001 mm. A contour within another, such as the inner
/// table of a skull, is joined to that by a keyhole, as planning systems expect it.
ObjectFile encode_structure_set(const CaseIdentity& identity, const SliceSet& slices,
                                const std::vector<ContouredSurface>& surfaces, const Progress& progress = {});

}  // namespace trephine::pacs
