// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "dicom/elements.h"

namespace trephine::dicom {

/// The tags that a header is read from, by what they hold.
constexpr std::uint32_t t_transfer_syntax = make_tag(0x0002, 0x0010), t_media_class = make_tag(0x0002, 0x0002),
                        t_image_type = make_tag(0x0008, 0x0008), t_sop_class = make_tag(0x0008, 0x0016),
                        t_modality = make_tag(0x0008, 0x0060), t_contrast = make_tag(0x0018, 0x0010),
                        t_thickness = make_tag(0x0018, 0x0050), t_tilt = make_tag(0x0018, 0x1120),
                        t_kernel = make_tag(0x0018, 0x1210), t_patient_position = make_tag(0x0018, 0x5100),
                        t_series = make_tag(0x0020, 0x000e), t_position = make_tag(0x0020, 0x0032),
                        t_orientation = make_tag(0x0020, 0x0037), t_frame_uid = make_tag(0x0020, 0x0052),
                        t_samples = make_tag(0x0028, 0x0002), t_photometric = make_tag(0x0028, 0x0004),
                        t_frames = make_tag(0x0028, 0x0008), t_rows = make_tag(0x0028, 0x0010),
                        t_columns = make_tag(0x0028, 0x0011), t_spacing = make_tag(0x0028, 0x0030),
                        t_allocated = make_tag(0x0028, 0x0100), t_stored = make_tag(0x0028, 0x0101),
                        t_high_bit = make_tag(0x0028, 0x0102), t_representation = make_tag(0x0028, 0x0103),
                        t_padding = make_tag(0x0028, 0x0120), t_padding_limit = make_tag(0x0028, 0x0121),
                        t_intercept = make_tag(0x0028, 0x1052), t_slope = make_tag(0x0028, 0x1053),
                        t_study = make_tag(0x0020, 0x000d), t_acquisition = make_tag(0x0020, 0x0012),
                        t_kvp = make_tag(0x0018, 0x0060), t_burned_in = make_tag(0x0028, 0x0301),
                        t_rescale_type = make_tag(0x0028, 0x1054), t_aspect = make_tag(0x0028, 0x0034),
                        t_lossy = make_tag(0x0028, 0x2110), t_quality = make_tag(0x0028, 0x0300),
                        t_modality_lut = make_tag(0x0028, 0x3000), t_shared_groups = make_tag(0x5200, 0x9229),
                        t_frame_groups = make_tag(0x5200, 0x9230), t_pixels = make_tag(0x7fe0, 0x0010);

/// More frames than that are not read from one file.
constexpr int max_frames = 65536;

}  // namespace trephine::dicom
