// SPDX-License-Identifier: GPL-3.0-or-later
// What hdf5_writer.so gives the simulator (dataset/hdf5/hdf5_file.h).
#include <hdf5.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/shared_library.h"
#include "dataset/hdf5/hdf5_file.h"

#define GIVEN extern "C" __attribute__((visibility("default")))

namespace trephine::dataset {
namespace {

constexpr hsize_t rows_of_few = 4096;  // of a chunk, where a row is a few numbers
constexpr hsize_t few = 64;
constexpr unsigned level = 4;  // of gzip, as h5py takes by default

[[noreturn]] void fail() { throw Error(ExitCode::io, "", "", "HDF5 could not write the file: is the disk full?"); }
void need(herr_t done) {
  if (done < 0) fail();
}

// A handle of the library, closed by what closes its kind.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) fail();
  }
  ~Id() { close_(id_); }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it stands for the handle

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

struct File {
  hid_t id = -1;
  std::map<std::string, std::unique_ptr<Id>> open;  // data sets whose rows follow
};
File& file_of(void* file) { return *static_cast<File*>(file); }

hid_t stored(Number n) {
  return n == Number::float64 ? H5T_IEEE_F64LE : n == Number::int64 ? H5T_STD_I64LE : H5T_STD_U8LE;
}
hid_t in_memory(Number n) {
  return n == Number::float64 ? H5T_NATIVE_DOUBLE : n == Number::int64 ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT8;
}

// Text as h5py writes it: UTF-8 of any length.
std::unique_ptr<Id> text_type() {
  auto type = std::make_unique<Id>(H5Tcopy(H5T_C_S1), H5Tclose);
  need(H5Tset_size(*type, H5T_VARIABLE));
  need(H5Tset_cset(*type, H5T_CSET_UTF8));
  return type;
}

std::unique_ptr<Id> dateless(hid_t kind) {
  auto properties = std::make_unique<Id>(H5Pcreate(kind), H5Pclose);
  need(H5Pset_obj_track_times(*properties, false));
  return properties;
}

void close_all(File& f) {
  f.open.clear();
  const hid_t id = f.id;
  f.id = -1;
  if (id >= 0) need(H5Fclose(id));
}

}  // namespace

GIVEN int trephine_hdf5_version() { return own_library_version; }

GIVEN void* trephine_hdf5_create(const char* name) {
  H5dont_atexit();  // what could not be written is not tried again at the end of the program
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what fails is said by what is thrown
  auto file = std::make_unique<File>();
  file->id = H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file->id < 0) fail();
  return file.release();
}

GIVEN void trephine_hdf5_group(void* file, const char* path) {
  const auto properties = dateless(H5P_GROUP_CREATE);
  const Id group(H5Gcreate2(file_of(file).id, path, H5P_DEFAULT, *properties, H5P_DEFAULT), H5Gclose);
}

GIVEN void trephine_hdf5_text(void* file, const char* path, const char* text) {
  const auto type = text_type(), properties = dateless(H5P_DATASET_CREATE);
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id set(H5Dcreate2(file_of(file).id, path, *type, space, H5P_DEFAULT, *properties, H5P_DEFAULT), H5Dclose);
  need(H5Dwrite(set, *type, H5S_ALL, H5S_ALL, H5P_DEFAULT, static_cast<const void*>(&text)));
}

GIVEN void trephine_hdf5_texts(void* file, const char* path, const char* const* texts, std::uint64_t count) {
  const auto type = text_type(), properties = dateless(H5P_DATASET_CREATE);
  const hsize_t side = count;
  const Id space(H5Screate_simple(1, &side, nullptr), H5Sclose);
  const Id set(H5Dcreate2(file_of(file).id, path, *type, space, H5P_DEFAULT, *properties, H5P_DEFAULT), H5Dclose);
  need(H5Dwrite(set, *type, H5S_ALL, H5S_ALL, H5P_DEFAULT, static_cast<const void*>(texts)));
}

GIVEN void trephine_hdf5_numbers(void* file, const DataForm* form, const void* data) {
  const std::vector<hsize_t> sides(form->sides.begin(), form->sides.end());
  const Id space(sides.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(int(sides.size()), sides.data(), nullptr),
                 H5Sclose);
  const auto properties = dateless(H5P_DATASET_CREATE);
  if (form->packed && !sides.empty()) {
    std::vector<hsize_t> chunk = sides;
    hsize_t in_row = 1;
    for (std::size_t n = 1; n < sides.size(); ++n) in_row *= sides[n];
    chunk[0] = std::min(sides[0], in_row > few ? 1 : rows_of_few);
    need(H5Pset_chunk(*properties, int(chunk.size()), chunk.data()));
    need(H5Pset_shuffle(*properties));
    need(H5Pset_deflate(*properties, level));
  }
  auto set = std::make_unique<Id>(
      H5Dcreate2(file_of(file).id, form->path, stored(form->type), space, H5P_DEFAULT, *properties, H5P_DEFAULT),
      H5Dclose);
  if (data)
    need(H5Dwrite(*set, in_memory(form->type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  else
    file_of(file).open[form->path] = std::move(set);
}

GIVEN void trephine_hdf5_row(void* file, const char* path, std::uint64_t row, const void* data) {
  const Id& set = *file_of(file).open.at(path);
  const Id space(H5Dget_space(set), H5Sclose), type(H5Dget_type(set), H5Tclose);
  std::vector<hsize_t> sides(std::size_t(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, sides.data(), nullptr);
  std::vector<hsize_t> from(sides.size(), 0);
  from[0] = row;
  sides[0] = 1;
  need(H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, sides.data(), nullptr));
  const Id memory(H5Screate_simple(int(sides.size()), sides.data(), nullptr), H5Sclose);
  const Id native(H5Tget_native_type(type, H5T_DIR_ASCEND), H5Tclose);
  need(H5Dwrite(set, native, memory, space, H5P_DEFAULT, data));
}

GIVEN void trephine_hdf5_attribute(void* file, const char* path, const char* name, const char* text) {
  const auto type = text_type();
  const Id space(H5Screate(H5S_SCALAR), H5Sclose), object(H5Oopen(file_of(file).id, path, H5P_DEFAULT), H5Oclose);
  const Id attribute(H5Acreate2(object, name, *type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  need(H5Awrite(attribute, *type, static_cast<const void*>(&text)));
}

GIVEN void trephine_hdf5_close(void* file) { close_all(file_of(file)); }

GIVEN void trephine_hdf5_forget(void* file) {
  const std::unique_ptr<File> own(&file_of(file));
  try {
    close_all(*own);
  } catch (const Error&) {  // of a file that nobody wants any more
  }
}

}  // namespace trephine::dataset
