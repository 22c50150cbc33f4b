// SPDX-License-Identifier: GPL-3.0-or-later
// What a MINC 2 file says beyond what is read of it: nothing of it may change voxels or their places, and what the
// format does not know is told.
#include <algorithm>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "grid/nrrd_header.h"
#include "hdf5_file.h"
#include "minc.h"

namespace trephine::itk {
namespace {

using namespace hdf5;
using Names = std::set<std::string>;

constexpr std::size_t max_names = 1000;

struct Search {
  const Names& known;
  std::vector<std::string>& unknown;
  void look_at(const char* name) {
    if (known.count(name) == 0 && unknown.size() < max_names) unknown.push_back(grid::detail::tellable_key(name));
  }
};

void attributes_of(hid_t file, const std::string& object, const Names& known, std::vector<std::string>& unknown) {
  Search search{known, unknown};
  const auto look = [](hid_t, const char* name, const H5A_info_t*, void* to) -> herr_t {
    static_cast<Search*>(to)->look_at(name);
    return 0;
  };
  if (H5Aiterate_by_name(file, object.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, look, &search, H5P_DEFAULT) < 0)
    bad("", "is damaged");
}

void members_of(hid_t file, const std::string& group, const Names& known, std::vector<std::string>& unknown) {
  Search search{known, unknown};
  const auto look = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
    static_cast<Search*>(to)->look_at(name);
    return 0;
  };
  if (H5Literate_by_name(file, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, look, &search, H5P_DEFAULT) < 0)
    bad("", "is damaged");
}

/// What every object of a MINC file may have besides.
Names with(Names names) {
  names.insert({"varid", "vartype", "version", "parent", "children", "comments", "long_name", "title"});
  return names;
}

}  // namespace

std::vector<std::string> minc_unknown_keys(const std::string& name) {
  const Id file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.valid()) bad("", "is damaged");
  std::vector<std::string> unknown;
  const Names of_axis = with({"alignment", "spacing", "spacetype", "units", "length", "start", "step",
                              "direction_cosines", "dimorder", "class", "attributes", "sampling_flag"});
  for (const char* axis : {"xspace", "yspace", "zspace"}) {
    const std::string object = std::string("/minc-2.0/dimensions/") + axis;
    // Whether start is the middle of the first voxel or its edge.
    const std::string alignment = text_of(file, object, "alignment");
    if (!alignment.empty() && alignment.rfind("centre", 0) != 0)
      bad("alignment", "must be centre: the volume would lie half a voxel elsewhere");
    attributes_of(file, object, of_axis, unknown);
  }
  const std::string image = "/minc-2.0/image/0/image";
  if (const std::string complete = text_of(file, image, "complete");
      !complete.empty() && complete.rfind("true", 0) != 0)
    bad("complete", "says that the image was not written whole");
  attributes_of(file, image,
                with({"dimorder", "complete", "valid_range", "valid_max", "valid_min", "signtype", "_FillValue",
                      "image-min", "image-max", "units", "DIMENSION_LIST"}),
                unknown);
  for (const char* range : {"/minc-2.0/image/0/image-min", "/minc-2.0/image/0/image-max"})
    attributes_of(file, range, with({"dimorder", "_FillValue", "units"}), unknown);
  members_of(file, "/minc-2.0/image/0", {"image", "image-min", "image-max"}, unknown);
  members_of(file, "/minc-2.0/dimensions",
             {"xspace", "yspace", "zspace", "xspace-width", "yspace-width", "zspace-width"}, unknown);
  members_of(file, "/minc-2.0", {"image", "dimensions", "info"}, unknown);
  return unknown;
}

}  // namespace trephine::itk
