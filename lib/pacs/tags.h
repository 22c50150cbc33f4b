// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

namespace trephine::pacs {

// Tags of what is written and read here, by the keywords of PS3.6.
constexpr std::uint32_t t_charset = 0x00080005, t_image_type = 0x00080008, t_sop_class = 0x00080016,
                        t_sop_instance = 0x00080018, t_study_date = 0x00080020, t_content_date = 0x00080023,
                        t_acquisition_datetime = 0x0008002a, t_study_time = 0x00080030, t_content_time = 0x00080033,
                        t_accession = 0x00080050, t_modality = 0x00080060, t_manufacturer = 0x00080070,
                        t_referring = 0x00080090, t_code_value = 0x00080100, t_code_scheme = 0x00080102,
                        t_code_meaning = 0x00080104, t_series_description = 0x0008103e, t_operators = 0x00081070,
                        t_model = 0x00081090, t_referenced_series = 0x00081115, t_referenced_instance = 0x0008114a,
                        t_referenced_class = 0x00081150, t_referenced_uid = 0x00081155, t_referenced_frame = 0x00081160,
                        t_derivation_text = 0x00082111, t_source_image = 0x00082112, t_derivation_image = 0x00089124,
                        t_derivation_code = 0x00089215;
constexpr std::uint32_t t_patient_name = 0x00100010, t_patient_id = 0x00100020, t_birth_date = 0x00100030,
                        t_sex = 0x00100040, t_identity_removed = 0x00120062, t_removal_method = 0x00120063;
constexpr std::uint32_t t_thickness = 0x00180050, t_kvp = 0x00180060, t_serial = 0x00181000, t_software = 0x00181020,
                        t_patient_position = 0x00185100, t_step = 0x00180088;
constexpr std::uint32_t t_study = 0x0020000d, t_series = 0x0020000e, t_study_id = 0x00200010,
                        t_series_number = 0x00200011, t_acquisition_number = 0x00200012, t_instance_number = 0x00200013,
                        t_position = 0x00200032, t_orientation = 0x00200037, t_frame_uid = 0x00200052,
                        t_laterality = 0x00200060, t_position_reference = 0x00201040, t_frame_content = 0x00209111,
                        t_plane_position = 0x00209113, t_plane_orientation = 0x00209116,
                        t_dimension_values = 0x00209157, t_organization_uid = 0x00209164,
                        t_dimension_pointer = 0x00209165, t_group_pointer = 0x00209167, t_organization = 0x00209221,
                        t_dimension_index = 0x00209222, t_dimension_label = 0x00209421;
constexpr std::uint32_t t_samples = 0x00280002, t_photometric = 0x00280004, t_frames = 0x00280008, t_rows = 0x00280010,
                        t_columns = 0x00280011, t_spacing = 0x00280030, t_allocated = 0x00280100, t_stored = 0x00280101,
                        t_high_bit = 0x00280102, t_representation = 0x00280103, t_burned_in = 0x00280301,
                        t_window_centre = 0x00281050, t_window_width = 0x00281051, t_intercept = 0x00281052,
                        t_slope = 0x00281053, t_rescale_type = 0x00281054, t_locations_preserved = 0x0028135a,
                        t_lossy = 0x00282110, t_pixel_measures = 0x00289110;
constexpr std::uint32_t t_concept = 0x0040a043, t_purpose = 0x0040a170, t_units = 0x004008ea,
                        t_document_title = 0x00420010, t_document = 0x00420011, t_document_type = 0x00420012,
                        t_document_length = 0x00420015;
constexpr std::uint32_t t_segmentation_type = 0x00620001, t_segments = 0x00620002, t_segment_category = 0x00620003,
                        t_segment_number = 0x00620004, t_segment_label = 0x00620005, t_segment_algorithm = 0x00620008,
                        t_algorithm_name = 0x00620009, t_segment_identification = 0x0062000a,
                        t_referenced_segment = 0x0062000b, t_segment_lab = 0x0062000d, t_segment_type = 0x0062000f;
constexpr std::uint32_t t_model_modification = 0x00687001, t_model_mirroring = 0x00687002, t_model_usage = 0x00687003,
                        t_content_label = 0x00700080, t_content_description = 0x00700081,
                        t_content_creator = 0x00700084;
constexpr std::uint32_t t_set_label = 0x30060002, t_set_date = 0x30060008, t_set_time = 0x30060009,
                        t_referenced_frame_of_reference = 0x30060010, t_rt_study = 0x30060012, t_rt_series = 0x30060014,
                        t_contour_image = 0x30060016, t_rois = 0x30060020, t_roi_number = 0x30060022,
                        t_roi_frame = 0x30060024, t_roi_name = 0x30060026, t_roi_colour = 0x3006002a,
                        t_roi_algorithm = 0x30060036, t_roi_contours = 0x30060039, t_contours = 0x30060040,
                        t_contour_type = 0x30060042, t_contour_points = 0x30060046, t_contour_data = 0x30060050,
                        t_observations = 0x30060080, t_observation_number = 0x30060082, t_referenced_roi = 0x30060084,
                        t_roi_code = 0x30060086, t_roi_interpreted = 0x300600a4, t_roi_interpreter = 0x300600a6;
constexpr std::uint32_t t_shared_groups = 0x52009229, t_frame_groups = 0x52009230, t_pixels = 0x7fe00010;

// SOP classes (PS3.6 annex A).
constexpr const char* class_ct = "1.2.840.10008.5.1.4.1.1.2";
constexpr const char* class_seg = "1.2.840.10008.5.1.4.1.1.66.4";
constexpr const char* class_stl = "1.2.840.10008.5.1.4.1.1.104.3";
constexpr const char* class_rtss = "1.2.840.10008.5.1.4.1.1.481.3";
constexpr const char* class_study_component = "1.2.840.10008.3.1.2.3.1";

}  // namespace trephine::pacs
