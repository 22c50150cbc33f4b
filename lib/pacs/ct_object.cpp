// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mutex>

#include "base/hash.h"
#include "base/parallel.h"
#include "codecs/element_text.h"
#include "dicom/hu.h"
#include "pacs/object.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

std::string stored(const std::vector<std::int16_t>& hu) {
  std::string out;
  out.reserve(2 * hu.size());
  for (const std::int16_t v : hu) {
    out += static_cast<char>(v & 0xff);
    out += static_cast<char>(v >> 8 & 0xff);
  }
  return out;
}

Elements image_of(const CaseIdentity& identity, const SliceSet& slices, std::size_t slice, std::string pixels) {
  Elements e = described(identity, "CT", 1, "CT of the case");
  const bool axial = std::abs(slices.normal().z) > 0.7;
  e.text(t_image_type, "CS", axial ? "DERIVED\\SECONDARY\\AXIAL" : "DERIVED\\SECONDARY\\REFORMATTED")
      .text(t_derivation_text, "ST", "HU of the case's CT, after its face policy")
      .text(t_thickness, "DS", codecs::decimal(slices.thickness_mm))
      .text(t_kvp, "DS")
      .text(t_patient_position, "CS")
      .text(t_acquisition_number, "IS")
      .text(t_laterality, "CS")
      .text(t_instance_number, "IS", std::to_string(slice + 1))
      .text(t_position, "DS", place_text(slices.origins_mm[slice]))
      .text(t_orientation, "DS", vector_text(slices))
      .text(t_spacing, "DS", codecs::decimals({slices.dy_mm, slices.dx_mm}))
      .words(t_samples, {1})
      .text(t_photometric, "CS", "MONOCHROME2")
      .words(t_rows, {slices.rows})
      .words(t_columns, {slices.columns})
      .words(t_allocated, {16})
      .words(t_stored, {16})
      .words(t_high_bit, {15})
      .words(t_representation, {1})
      .text(t_burned_in, "CS", "NO")
      .text(t_window_centre, "DS", "40")
      .text(t_window_width, "DS", "100")
      .text(t_intercept, "DS", "0")
      .text(t_slope, "DS", "1")
      .text(t_rescale_type, "LO", "HU")
      .bytes(t_pixels, "OW", std::move(pixels));
  return e;
}

}  // namespace

void encode_ct(const CaseIdentity& identity, const grid::Grid<std::int16_t>& ct, SliceSet& slices,
               const std::function<void(std::size_t, const std::string&)>& take, const Progress& progress) {
  const std::size_t count = slices.origins_mm.size();
  // The series is known by all that it shows, so that another CT never takes its place in an archive.
  std::vector<std::string> pixels(count), hashes(count);
  parallel_for(0, std::int64_t(count), 1, [&](std::int64_t k, std::int64_t) {
    progress.check();
    pixels[std::size_t(k)] = stored(resampled_on(ct, slices, std::size_t(k), static_cast<std::int16_t>(dicom::air_hu)));
    hashes[std::size_t(k)] = sha256_of_bytes(pixels[std::size_t(k)]);
  });
  Sha256 sha;
  for (std::size_t k = 0; k < count; ++k) sha.text(hashes[k]).text(place_text(slices.origins_mm[k]));
  slices.class_uid = class_ct;
  slices.series_uid = uid_of({"ct", identity.study_uid, vector_text(slices), sha.hex()});
  slices.images.clear();
  for (std::size_t k = 0; k < count; ++k) {
    progress.report(double(k) / double(count));
    const ObjectFile made =
        encode_object(image_of(identity, slices, k, std::move(pixels[k])), class_ct, slices.series_uid);
    slices.images.push_back({made.instance_uid, 0});
    take(k, made.bytes);
  }
}

}  // namespace trephine::pacs
