// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "dicom/archive.h"
#include "dicom/decode.h"
#include "dicom/geometry.h"
#include "dicom/header.h"
#include "dicom/import.h"

namespace trephine::dicom {

/// An image that was left out before it came to any series, and why.
struct LeftOut {
  const FileHeader* header = nullptr;
  std::uint32_t tag = 0;
  std::string what;
};

/// A slice that has a series' UID or continues it, and was parted from it, and how it differs.
struct OddSlice {
  std::string file, field, what;
  double along_mm = 0;  ///< along the normal of the series' slices; NaN: it has no position
  bool within = false;  ///< between its first and last slice
};

/// The files of one series that share matrix, spacing and orientation.
struct Series {
  std::vector<FrameRef> slices;  ///< ordered by content, not by name
  SliceStack stack;              ///< positions in the order of `slices`
  SeriesSummary summary;
  std::string sort_uid;  ///< decides between equal series; never shown
  bool is_ct = false;
  std::vector<OddSlice> odd;  ///< ascending along the normal
  std::string refusal_file, refusal_field;
  Message refusal;             ///< why it is not usable; empty: it is usable
  std::string part_of;         ///< the token of the series of which it scans a part again
  std::string rectified_for;   ///< by judge: what import would correct by resampling
  std::exception_ptr refused;  ///< by judge: what import would throw
};

/// The files of a folder or an archive, grouped. Not copyable: series point into `headers`.
struct Catalogue {
  Catalogue() = default;
  Catalogue(Catalogue&&) = default;
  Catalogue(const Catalogue&) = delete;

  Archive archive;  ///< holds the bytes to which the headers of an archive's members point
  std::vector<FileHeader> headers;
  std::vector<Series> series;  ///< usable ones first, then CT, then larger ones; tokens follow this order
  struct Broken {
    std::string name, field, what;
    bool is_dicom;          ///< it begins as a DICOM file does
    int number = 0;         ///< among the files by name, from 1
    bool is_empty = false;  ///< it has no bytes
  };
  std::vector<LeftOut> left_out;
  std::vector<Broken> broken;  ///< files that are not DICOM or end before their pixel data
  int files = 0, hidden = 0, links = 0, without_geometry = 0, localizers = 0;
  bool is_single_file = false;
};

/// Searches a folder five levels deep, or a ZIP archive, or takes one file. (A DICOMDIR in the folder is used neither
/// as an image nor as an index: the files themselves say what they are.) Throws Error 66; for an archive, what
/// read_archive throws.
Catalogue scan(const std::filesystem::path& folder_or_file, ModalityPolicy modality, const Progress& progress);

/// Asks of a series that is usable by its headers what import would say of it, short of decoding, and refuses it with
/// the same words. Compressed slices at one position are not compared.
void judge(Series& series, const ImportParams& params, const Progress& progress);

/// "axial", "coronal", "sagittal", or "oblique": at least 30 degrees off all three.
std::string plane_of(const SliceStack& stack);

/// "original" or "derived" by the first word of ImageType; empty where it says neither.
std::string origin_of(const SeriesSummary& summary);

/// The best of the usable series by rule, null where none is: CT, axial, at least two thirds as long as the longest of
/// these, original, of a soft kernel, thin. What is equal in all of it is taken in the catalogue's order.
const Series* proposed(const Catalogue& catalogue);

/// How many series say another patient than that one.
int of_other_patients(const Catalogue& catalogue, const Series& chosen);

/// The requested series; where none is named, the only usable one, or the proposed one if the rule is best. Several
/// that are usable by their headers are judged first, so that what the list refuses is no choice. Throws Error 64
/// listing the series, else why none is usable.
const Series& choose(Catalogue& catalogue, const ImportParams& params, const Progress& progress = {});

/// The other content of the folder, for ImportResult::folder. With `chosen` null, everything that is not a series.
FolderRest describe_rest(const Catalogue& catalogue, const Series* chosen);

}  // namespace trephine::dicom
