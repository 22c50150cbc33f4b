// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/original_slices.h"

#include "base/error.h"
#include "dicom/catalogue.h"
#include "dicom/geometry.h"
#include "dicom/input_files.h"
#include "dicom/volume_source.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

Error refused(const std::string& what) { return Error(ExitCode::bad_input, "", "series", what); }

bool has_hash(const std::filesystem::path& path, const dicom::ImportParams& params, const std::string& sha256,
              const Progress& progress) {
  try {
    return dicom::hash_of_series_input(path, params, progress) == sha256;
  } catch (const Error& e) {
    if (e.code() != ExitCode::usage && e.code() != ExitCode::bad_input) throw;
    return false;  // several and no choice, none of that name, or one that is no volume
  }
}

// The parameters that choose the series with the hash.
dicom::ImportParams choice_of(const std::filesystem::path& path, dicom::ImportParams params, const std::string& sha256,
                              const Progress& progress) {
  if (has_hash(path, params, sha256, progress)) return params;
  for (const dicom::SeriesSummary& s : dicom::list_series(path, params, progress).series) {
    params.series = s.token;
    if (s.usable && has_hash(path, params, sha256, progress)) return params;
  }
  throw refused("no series here is the scan that the case was made of (its hash is not the case's input_sha256)");
}

// The UIDs of an image, which the importer does not keep.
struct ImageUids {
  std::string class_uid, instance_uid;
};
ImageUids uids_of(const dicom::FileHeader& h) {
  ImageUids out;
  dicom::ByteSource source(h.origin);
  const auto visit = [&](const dicom::Element& e, const std::vector<dicom::Level>& levels) {
    std::string* to = e.tag == t_sop_class ? &out.class_uid : e.tag == t_sop_instance ? &out.instance_uid : nullptr;
    if (!to || !levels.empty() || e.length > 64) return;
    if (const std::uint8_t* p = source.get(e.offset, e.length))
      *to = dicom::trimmed({reinterpret_cast<const char*>(p), e.length});
  };
  const auto nowhere = [](std::uint32_t) { return false; };
  // The data set follows the file meta information, whose first element says how long that is.
  const std::uint8_t* p = source.get(128, 16);
  if (!p || dicom::le16(p + 4) != 2 || dicom::le16(p + 6) != 0) return out;
  const std::uint64_t begin = 144 + std::uint64_t{dicom::le32(p + 12)};
  dicom::walk_elements(source, begin, source.size(), h.syntax->explicit_vr, nowhere, visit);
  return out;
}

void take_uids(const dicom::Series& series, const std::vector<int>& order, OriginalSlices& out) {
  const dicom::FileHeader& first = *series.slices.front().header;
  out.source = {first.study_uid, first.frame_uid};
  out.slices.series_uid = first.series_uid;
  for (const int slice : order) {
    const dicom::FrameRef& ref = series.slices[std::size_t(slice)];
    const ImageUids uids = uids_of(*ref.header);
    if (uids.instance_uid.empty() || first.study_uid.empty() || first.frame_uid.empty() || first.series_uid.empty())
      throw refused("has images without the UIDs that objects refer to; leave --source-uids out");
    out.slices.class_uid = uids.class_uid;
    out.slices.images.push_back({uids.instance_uid, ref.header->frame_count > 1 ? ref.frame + 1 : 0});
  }
}

}  // namespace

OriginalSlices original_slices(const std::filesystem::path& folder_or_file, dicom::ImportParams params,
                               const std::string& input_sha256, OwnUids uids, const Progress& progress) {
  return dicom::with_scan(folder_or_file, [&] {
    if (!dicom::volume_sources(folder_or_file, progress).empty())
      throw refused("is no DICOM: it has no slices that an object could lie on; export seg.nrrd, nii.gz or mha");
    params = choice_of(folder_or_file, std::move(params), input_sha256, progress.part(0, 0.7));
    if (!params.axes.empty())
      throw refused("the case was made with axes " + params.axes +
                    " against what the files say, so that their slices "
                    "lie elsewhere than the case; export seg.nrrd, nii.gz or mha");
    dicom::Catalogue catalogue = dicom::scan(folder_or_file, params.modality, progress.part(0.7, 1));
    const dicom::Series& series = dicom::choose(catalogue, params);
    const dicom::SliceStack& stack = series.stack;
    const dicom::StackGeometry g = dicom::analyse_stack(stack, dicom::GapPolicy::interpolate, params.max_gap_mm);
    OriginalSlices out;
    SliceSet& s = out.slices;
    s.columns = stack.columns;
    s.rows = stack.rows;
    s.dx_mm = stack.dx_mm;
    s.dy_mm = stack.dy_mm;
    s.u = stack.u;
    s.v = stack.v;
    s.thickness_mm =
        series.summary.slice_thickness_mm > 0 ? series.summary.slice_thickness_mm : dicom::median_step_mm(stack);
    std::vector<int> order;
    for (const std::vector<int>& level : g.levels) order.push_back(level.front());
    for (const int slice : order) s.origins_mm.push_back(stack.positions_mm[std::size_t(slice)]);
    if (uids == OwnUids::read) take_uids(series, order, out);
    return out;
  });
}

}  // namespace trephine::pacs
