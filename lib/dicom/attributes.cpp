// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/attributes.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>

#include "base/hash.h"
#include "base/text.h"
#include "dicom/elements.h"
#include "dicom/header_tags.h"
#include "dicom/values.h"

namespace trephine::dicom {
namespace {

std::vector<Attribute> all_attributes() {
  using R = AttributeRule;
  constexpr const char *image = "General Image", *pixel = "Image Pixel", *plane = "Image Plane", *ct = "CT Image",
                       *lut = "Modality LUT", *series = "General Series", *device = "General Equipment",
                       *frame = "Frame of Reference", *person = "Patient Study", *contrast = "Contrast/Bolus";
  constexpr auto at = make_tag;
  std::vector<Attribute> all = {
      {t_image_type, "ImageType", "CS", image, R::told, "its first three values; a localizer is left out and noted"},
      {t_sop_class, "SOPClassUID", "UI", image, R::parted, "only CT storage classes are read"},
      {at(0x0008, 0x0022), "AcquisitionDate", "DA", image, R::told, ""},
      {at(0x0008, 0x0023), "ContentDate", "DA", image, R::own, ""},
      {at(0x0008, 0x002a), "AcquisitionDateTime", "DT", image, R::own, ""},
      {at(0x0008, 0x0032), "AcquisitionTime", "TM", image, R::own, ""},
      {at(0x0008, 0x0033), "ContentTime", "TM", image, R::own, ""},
      {t_modality, "Modality", "CS", series, R::parted, "only CT is read, unless `modality` is any"},
      {at(0x0008, 0x0070), "Manufacturer", "LO", device, R::told, ""},
      {at(0x0008, 0x1090), "ManufacturerModelName", "LO", device, R::told, ""},
      {at(0x0008, 0x2111), "DerivationDescription", "ST", image, R::told, ""},
      {at(0x0008, 0x2112), "SourceImageSequence", "SQ", image, R::own, ""},
      {at(0x0008, 0x9215), "DerivationCodeSequence", "SQ", image, R::own, ""},
      {at(0x0010, 0x1010), "PatientAge", "AS", person, R::told, ""},
      {at(0x0010, 0x1020), "PatientSize", "DS", person, R::told, ""},
      {at(0x0010, 0x1030), "PatientWeight", "DS", person, R::told, ""},
      {t_contrast, "ContrastBolusAgent", "LO", contrast, R::told, ""},
      {at(0x0018, 0x0015), "BodyPartExamined", "CS", series, R::told, ""},
      {at(0x0018, 0x0022), "ScanOptions", "CS", ct, R::told, ""},
      {t_thickness, "SliceThickness", "DS", plane, R::told, ""},
      {t_kvp, "KVP", "DS", ct, R::told, ""},
      {at(0x0018, 0x0088), "SpacingBetweenSlices", "DS", plane, R::told, "not used: positions count"},
      {at(0x0018, 0x0090), "DataCollectionDiameter", "DS", ct, R::told, ""},
      {at(0x0018, 0x1000), "DeviceSerialNumber", "LO", device, R::told, ""},
      {at(0x0018, 0x1100), "ReconstructionDiameter", "DS", ct, R::told, "not used: PixelSpacing counts"},
      {at(0x0018, 0x1110), "DistanceSourceToDetector", "DS", ct, R::told, ""},
      {at(0x0018, 0x1111), "DistanceSourceToPatient", "DS", ct, R::told, ""},
      {t_tilt, "GantryDetectorTilt", "DS", ct, R::told,
       "not used: positions count; warned of where they contradict it"},
      {at(0x0018, 0x1130), "TableHeight", "DS", ct, R::told, "not used: positions count"},
      {at(0x0018, 0x1140), "RotationDirection", "CS", ct, R::own, ""},
      {at(0x0018, 0x1150), "ExposureTime", "IS", ct, R::own, ""},
      {at(0x0018, 0x1151), "XRayTubeCurrent", "IS", ct, R::own, ""},
      {at(0x0018, 0x1152), "Exposure", "IS", ct, R::own, ""},
      {at(0x0018, 0x1160), "FilterType", "SH", ct, R::told, ""},
      {at(0x0018, 0x1170), "GeneratorPower", "IS", ct, R::own, ""},
      {at(0x0018, 0x1190), "FocalSpots", "DS", ct, R::told, ""},
      {t_kernel, "ConvolutionKernel", "SH", ct, R::parted, "where kernels lie within each other; slabs are noted"},
      {t_patient_position, "PatientPosition", "CS", series, R::told, ""},
      {at(0x0018, 0x9305), "RevolutionTime", "FD", ct, R::own, ""},
      {at(0x0018, 0x9306), "SingleCollimationWidth", "FD", ct, R::told, ""},
      {at(0x0018, 0x9307), "TotalCollimationWidth", "FD", ct, R::told, ""},
      {at(0x0018, 0x9309), "TableSpeed", "FD", ct, R::own, ""},
      {at(0x0018, 0x9310), "TableFeedPerRotation", "FD", ct, R::own, ""},
      {at(0x0018, 0x9311), "SpiralPitchFactor", "FD", ct, R::own, ""},
      {at(0x0018, 0x9313), "DataCollectionCenterPatient", "FD", ct, R::own, ""},
      {at(0x0018, 0x9318), "ReconstructionTargetCenterPatient", "FD", ct, R::own, ""},
      {at(0x0018, 0x9323), "ExposureModulationType", "CS", ct, R::own, ""},
      {at(0x0018, 0x9345), "CTDIvol", "FD", ct, R::own, ""},
      {at(0x0018, 0x9353), "EnergyWeightingFactor", "FL", ct, R::told, ""},
      {at(0x0018, 0x9361), "MultienergyCTAcquisition", "CS", ct, R::told, ""},
      {t_series, "SeriesInstanceUID", "UI", series, R::parted, "one or two slices that continue a series are noted"},
      {t_acquisition, "AcquisitionNumber", "IS", image, R::parted, "where they lie within each other; slabs are noted"},
      {at(0x0020, 0x0013), "InstanceNumber", "IS", image, R::own, "not used: positions count"},
      {at(0x0020, 0x0020), "PatientOrientation", "CS", image, R::told, "not used: ImageOrientationPatient counts"},
      {t_position, "ImagePositionPatient", "DS", plane, R::own, "checked: see Geometry"},
      {t_orientation, "ImageOrientationPatient", "DS", plane, R::parted, ""},
      {t_frame_uid, "FrameOfReferenceUID", "UI", frame, R::parted, "noted where each slice has its own"},
      {at(0x0020, 0x1002), "ImagesInAcquisition", "IS", image, R::own, ""},
      {at(0x0020, 0x1040), "PositionReferenceIndicator", "LO", frame, R::told, ""},
      {at(0x0020, 0x1041), "SliceLocation", "DS", plane, R::own, "not used: positions count"},
      {at(0x0020, 0x4000), "ImageComments", "LT", image, R::own, ""},
      {t_samples, "SamplesPerPixel", "US", pixel, R::fixed, "must be 1"},
      {t_photometric, "PhotometricInterpretation", "CS", pixel, R::equal,
       "must be MONOCHROME1 or MONOCHROME2; the former is warned of"},
      {at(0x0028, 0x0006), "PlanarConfiguration", "US", pixel, R::own, "means nothing of one sample"},
      {t_rows, "Rows", "US", pixel, R::parted, ""},
      {t_columns, "Columns", "US", pixel, R::parted, ""},
      {t_spacing, "PixelSpacing", "DS", plane, R::parted, ""},
      {t_aspect, "PixelAspectRatio", "IS", pixel, R::fixed, "must not contradict PixelSpacing"},
      {t_allocated, "BitsAllocated", "US", pixel, R::equal, "must be 8, 16 or 32"},
      {t_stored, "BitsStored", "US", pixel, R::applied, "65 where a pixel would be another number by all its bits"},
      {t_high_bit, "HighBit", "US", pixel, R::applied, "must be BitsStored - 1"},
      {t_representation, "PixelRepresentation", "US", pixel, R::equal, "must be 0 or 1"},
      {at(0x0028, 0x0106), "SmallestImagePixelValue", "US", pixel, R::own, "not used: the pixels count"},
      {at(0x0028, 0x0107), "LargestImagePixelValue", "US", pixel, R::own, "not used: the pixels count"},
      {t_padding, "PixelPaddingValue", "US", device, R::applied, ""},
      {t_padding_limit, "PixelPaddingRangeLimit", "US", pixel, R::applied, ""},
      {at(0x0028, 0x0300), "QualityControlImage", "CS", image, R::told, "YES is warned of"},
      {t_burned_in, "BurnedInAnnotation", "CS", image, R::fixed, "YES needs `burned_in_reason` (81)"},
      {at(0x0028, 0x0302), "RecognizableVisualFeatures", "CS", image, R::own, ""},
      {at(0x0028, 0x0a02), "PixelSpacingCalibrationType", "CS", pixel, R::told, ""},
      {at(0x0028, 0x1040), "PixelIntensityRelationship", "CS", pixel, R::told, ""},
      {at(0x0028, 0x1041), "PixelIntensityRelationshipSign", "SS", pixel, R::told, ""},
      {t_intercept, "RescaleIntercept", "DS", lut, R::applied, ""},
      {t_slope, "RescaleSlope", "DS", lut, R::applied, "must not be 0"},
      {t_rescale_type, "RescaleType", "LO", lut, R::told, "must be HU or absent, unless `units` is any"},
      {t_lossy, "LossyImageCompression", "CS", image, R::told, "01 is warned of"},
      {at(0x0028, 0x2112), "LossyImageCompressionRatio", "DS", image, R::own, ""},
      {at(0x0028, 0x2114), "LossyImageCompressionMethod", "CS", image, R::own, ""},
      {t_modality_lut, "ModalityLUTSequence", "SQ", lut, R::fixed,
       "must be absent: HU follow from slope and intercept"},
      {at(0x0028, 0x7fe0), "PixelDataProviderURL", "UR", pixel, R::own, "not followed"},
      {at(0x0088, 0x0200), "IconImageSequence", "SQ", image, R::own, ""},
      {at(0x2050, 0x0020), "PresentationLUTShape", "CS", image, R::told, ""},
  };
  std::sort(all.begin(), all.end(), [](const Attribute& a, const Attribute& b) { return a.tag < b.tag; });
  return all;
}

const std::array<char, 32>& salt() {
  static const std::array<char, 32> bytes = [] {
    std::array<char, 32> b{};
    (void)!getrandom(b.data(), b.size(), 0);
    return b;
  }();
  return bytes;
}

}  // namespace

const std::vector<Attribute>& attributes() {
  static const std::vector<Attribute> all = all_attributes();
  return all;
}

int find_attribute(std::uint32_t tag) {
  const auto& all = attributes();
  const auto it =
      std::lower_bound(all.begin(), all.end(), tag, [](const Attribute& a, std::uint32_t t) { return a.tag < t; });
  return it != all.end() && it->tag == tag ? static_cast<int>(it - all.begin()) : -1;
}

const char* to_text(AttributeRule rule) {
  switch (rule) {
    case AttributeRule::own:
      return "own";
    case AttributeRule::told:
      return "warned";
    case AttributeRule::applied:
      return "applied";
    case AttributeRule::parted:
      return "parted";
    case AttributeRule::equal:
      return "equal";
    case AttributeRule::fixed:
      return "fixed";
  }
  return "";
}

std::uint64_t digest_of(std::string_view value, std::string_view vr) {
  const bool binary = vr == "US" || vr == "SS" || vr == "FD" || vr == "FL";
  std::string plain(binary ? value : trimmed(value));
  if (plain.empty()) return 0;
  if (vr == "DS" || vr == "IS")
    if (const auto numbers = parse_decimals(plain)) {
      plain.clear();
      for (const double v : *numbers) plain += trephine::to_text(v + 0.0) + '\\';
    }
  Sha256 sha;
  sha.bytes(salt().data(), salt().size()).text(plain);
  const std::uint64_t digest = std::stoull(sha.hex().substr(0, 16), nullptr, 16);
  return digest ? digest : 1;
}

std::string attributes_table() {
  std::string out = "| attribute | tag | VR | module | rule | besides |\n|---|---|---|---|---|---|\n";
  for (const Attribute& a : attributes())
    out += fmt::format("| {} | ({:04X},{:04X}) | {} | {} | {} | {} |\n", a.keyword, a.tag >> 16, a.tag & 0xffff, a.vr,
                       a.module, to_text(a.rule), a.note);
  return out;
}

}  // namespace trephine::dicom
