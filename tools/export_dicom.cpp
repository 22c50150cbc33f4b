// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_dicom.h"

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/joined.h"
#include "base/write_file.h"
#include "case_shapes.h"
#include "cases/load_case.h"
#include "export_parts.h"
#include "meshio/export_format.h"
#include "pacs/object.h"
#include "pacs/original_slices.h"
#include "pacs/removed_face.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

std::string image_name(std::size_t slice) {
  char name[24];
  std::snprintf(name, sizeof name, "ct_%04zu.dcm", slice + 1);
  return name;
}

// The parameters by which the case chose its series.
dicom::ImportParams import_of(const cases::CaseManifest& manifest) {
  AnyParams params = AnyParams::make<dicom::ImportParams>();
  for (const ParameterLeaf& leaf : leaves_of(params))
    if (const ParameterValue* said = find_item(manifest.parameters, "import." + leaf.path)) {
      const std::string* text = std::get_if<std::string>(said);
      ParameterValue value;
      if (parse_parameter(*leaf.parameter, {text ? *text : to_text(*said)}, value).empty())
        leaf.parameter->set(leaf.object, value);
    }
  return params.as<dicom::ImportParams>();
}

void add_object(DicomExport& made, const std::string& name, std::string bytes, const std::string& what) {
  char line[200];
  std::snprintf(line, sizeof line, "%-28s %9.1f   %s\n", name.c_str(), double(bytes.size()) / 1e6, what.c_str());
  made.table += line;
  made.objects.push_back({name, std::move(bytes)});
}

void add_stl(DicomExport& made, const pacs::CaseIdentity& identity, const std::vector<ShownShape>& shown,
             Report& report, const Progress& progress) {
  const meshio::ExportFormat& stl = meshio::export_format("stl");
  std::size_t done = 0;
  for (const ShownShape& s : shown) {
    const Progress here = progress.part(double(done) / double(shown.size()), double(done + 1) / double(shown.size()));
    ++done;
    if (s.is_felt) {
      report.warn(s.name + ": the case holds no surface of it; it is displayed from the haptic volume");
      continue;
    }
    const std::vector<meshio::ExportSurface> surface{{s.mesh, s.name, s.colour_rgb, 1, false}};
    const auto files = meshio::encode_surfaces(stl, surface, s.name, here.part(0, 0.5));
    meshio::verify_export(stl, surface, files, here.part(0.5, 1));
    report.add(s.name + ".stl.triangles_count", s.mesh->triangles.size());
    add_object(made, s.name + ".stl.dcm", pacs::encode_stl_object(identity, s.name, files.back().bytes).bytes,
               "encapsulated STL");
  }
}

void add_segmentation(DicomExport& made, const std::string& stem, const pacs::CaseIdentity& identity,
                      const pacs::SliceSet& slices, const std::vector<ShownShape>& shown, Report& report,
                      const Progress& progress) {
  std::vector<pacs::Segment> segments;
  for (const ShownShape& s : shown) {
    pacs::Segment segment{s.name, s.colour_rgb, pacs::bits_inside(*s.mesh, slices, progress)};
    std::size_t pixels = 0;
    for (const std::string& frame : segment.bits)
      for (const char byte : frame) pixels += std::size_t(__builtin_popcount(static_cast<unsigned char>(byte)));
    report.add(s.name + ".seg.pixels_count", pixels);
    if (pixels == 0)
      report.warn(s.name + ": no pixel's middle on any slice lies in it, so that it is no segment");
    else
      segments.push_back(std::move(segment));
  }
  if (segments.empty()) throw Error(ExitCode::bad_input, "", "dicom-seg", "no anatomy has a pixel on any slice");
  add_object(made, stem + ".seg.dcm", pacs::encode_segmentation(identity, slices, segments).bytes,
             std::to_string(segments.size()) + " segments");
}

void add_structure_set(DicomExport& made, const std::string& stem, const pacs::CaseIdentity& identity,
                       const pacs::SliceSet& slices, const std::vector<ShownShape>& shown, const Progress& progress) {
  std::vector<pacs::ContouredSurface> surfaces;
  for (const ShownShape& s : shown) surfaces.push_back({s.name, s.colour_rgb, s.mesh});
  add_object(made, stem + ".rtss.dcm", pacs::encode_structure_set(identity, slices, surfaces, progress).bytes,
             std::to_string(surfaces.size()) + " contoured surfaces");
}

void add_ct(DicomExport& made, const pacs::CaseIdentity& identity, const grid::Grid<std::int16_t>& ct,
            pacs::SliceSet& slices, const Progress& progress) {
  std::size_t bytes = 0;
  const auto take = [&](std::size_t slice, const std::string& file) {
    bytes += file.size();
    made.images.push_back({image_name(slice), file});
  };
  pacs::encode_ct(identity, ct, slices, take, progress);
  char line[200];
  std::snprintf(line, sizeof line, "%-28s %9.1f   %zu images\n", dicom_ct_folder, double(bytes) / 1e6,
                made.images.size());
  made.table += line;
}

}  // namespace

const std::vector<std::string>& dicom_format_names() {
  static const std::vector<std::string> names{"dicom-seg", "dicom-stl", "dicom-ct", "dicom-rtss"};
  return names;
}

bool DicomFormats::take(const std::string& name) {
  const auto& names = dicom_format_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return false;
  bool* const members[] = {&seg, &stl, &ct, &rtss};
  *members[found - names.begin()] = true;
  return true;
}

const char* dicom_formats_help =
    "Formats of DICOM, of a case: dicom-seg is a segmentation (CASE.seg.dcm; binary, all anatomies in one object, with "
    "names, SNOMED CT codes and colours) and dicom-rtss an RT structure set (CASE.rtss.dcm), both on the slices of the "
    "scan as it was made, tilted and uneven ones too; they need --series, the scan that the case was made of. dicom-ct "
    "is the case's CT as images (in the folder dicom-ct), on these slices with --series and on the case's own without; "
    "it is written beside dicom-seg and dicom-rtss too, which refer to it. dicom-stl is a surface as an encapsulated "
    "STL "
    "file (ANATOMY.stl.dcm). The objects of a case are one study of a patient whose name is the case's, with UIDs of "
    "their own: nothing of the source's patient is copied.";

void check_dicom(const cli::ParsedCommand& parsed, const DicomFormats& formats) {
  const bool source_uids = parsed.params<DicomParams>().source_uids;
  if (!formats.any()) {
    if (parsed.has("series")) export_usage("--series", "is for " + joined(dicom_format_names()));
    if (source_uids) export_usage("--source-uids", "is for dicom-seg and dicom-rtss");
    return;
  }
  if (!parsed.has("input") || !fs::is_directory(parsed.path("input")))
    export_usage("INPUT", "must be a case's folder for " + joined(dicom_format_names()));
  if (formats.on_slices() && !parsed.has("series"))
    export_usage("--series",
                 "is needed for dicom-seg and dicom-rtss: the folder of the scan that the case was made of, "
                 "on whose slices they lie; seg.nrrd and stl need none");
  if (source_uids && !formats.on_slices()) export_usage("--source-uids", "is for dicom-seg and dicom-rtss");
  if (source_uids && (formats.ct || formats.stl))
    export_usage("--source-uids",
                 "is for dicom-seg and dicom-rtss alone: dicom-ct and dicom-stl would be images and surfaces in the "
                 "patient's own study; export them by themselves, without it");
}

DicomExport export_dicom(const cli::ParsedCommand& parsed, const DicomFormats& formats, const std::string& name,
                         Report& report, const Progress& progress) {
  const bool source_uids = parsed.params<DicomParams>().source_uids;
  const fs::path folder = parsed.path("input");
  cases::LoadParts parts;
  parts.ct = true;
  const cases::LoadedCase loaded = cases::load_case(folder, parts);
  const cases::CaseManifest& m = loaded.manifest;
  const bool needs_ct = formats.ct || (formats.on_slices() && !source_uids);
  if (needs_ct && !loaded.has_ct())
    throw Error(
        ExitCode::bad_input, folder.string(), "ct",
        "the case holds none, so that there are no images to refer to; run it again with `ct: {}` in its scene, "
        "or refer to the scan's own images by --source-uids");
  pacs::CaseIdentity identity = pacs::identity_of_case(m.case_token, m.input_sha256, "trephine " TREPHINE_VERSION);
  pacs::SliceSet slices;
  if (parsed.has("series")) {
    auto original =
        pacs::original_slices(parsed.path("series"), import_of(m), m.input_sha256,
                              source_uids ? pacs::OwnUids::read : pacs::OwnUids::left, progress.part(0, 0.2));
    slices = std::move(original.slices);
    if (source_uids) {
      identity.study_uid = original.source.study_uid;
      identity.frame_uid = original.source.frame_uid;
    }
  } else if (loaded.has_ct()) {
    slices = pacs::slices_of(loaded.ct);
  }
  const std::string stem = name.empty() ? m.case_token : name;
  DicomExport made;
  if (needs_ct) {
    pacs::SliceSet on = slices;
    const bool faceless = m.face_policy == "deface" || m.face_policy == "crop";
    add_ct(made, identity, faceless ? pacs::with_room_around_removed(loaded.ct, on, progress) : loaded.ct, on,
           progress.part(0.2, 0.4));
    slices = std::move(on);
  }
  const CaseShapes shapes(loaded, items_of(parsed, "anatomy"), progress.part(0.4, 0.5));
  if (shapes.all().empty() && (formats.seg || formats.stl || formats.rtss))
    throw Error(ExitCode::bad_input, folder.string(), "", "holds no surface");
  if (formats.seg) add_segmentation(made, stem, identity, slices, shapes.all(), report, progress.part(0.5, 0.7));
  if (formats.rtss) add_structure_set(made, stem, identity, slices, shapes.all(), progress.part(0.7, 0.8));
  if (formats.stl) add_stl(made, identity, shapes.all(), report, progress.part(0.8, 1));
  return made;
}

void write_dicom(const fs::path& out, const DicomExport& made) {
  meshio::write_export(out, made.objects);
  if (made.images.empty()) return;
  const fs::path folder = out / dicom_ct_folder;
  make_output_folder(folder);
  meshio::write_export(folder, made.images);
  std::error_code ignored;
  for (std::size_t k = made.images.size(); fs::remove(folder / image_name(k), ignored); ++k) {
  }
}

}  // namespace trephine::tools
