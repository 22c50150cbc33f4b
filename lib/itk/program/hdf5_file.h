// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <hdf5.h>

#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"

namespace trephine::hdf5 {

/// What the workers that read and write HDF5 share. A file is written without dates, so that the same content gives the
/// same bytes.

/// A handle of the library, closed by what closes its kind.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it stands for the handle
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

[[noreturn]] inline void bad(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

/// Throws Error 74 where a call that writes failed.
inline hid_t made(hid_t id) {
  if (id < 0) throw Error(ExitCode::io, "", "", "HDF5 could not write the file");
  return id;
}

/// Whether numbers are stored as other programs store them. A damaged description of a type may say a float of an
/// exponent or a mantissa of its own, which the library then reads.
inline bool is_usual(hid_t type) {
  for (const hid_t known : {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_IEEE_F64BE, H5T_IEEE_F32BE, H5T_STD_I32LE,
                            H5T_STD_I16LE, H5T_STD_I8LE, H5T_STD_U8LE, H5T_STD_U16LE, H5T_STD_U32LE, H5T_STD_I32BE,
                            H5T_STD_I16BE, H5T_STD_U16BE, H5T_STD_U32BE, H5T_STD_I64LE, H5T_STD_U64LE})
    if (H5Tequal(type, known) > 0) return true;
  return false;
}

/// Throws Error 65 where anything of the file lies in another file: HDF5 would read it there without a word.
inline void require_self_contained(hid_t file) {
  const auto look_at_link = [](hid_t, const char*, const H5L_info_t* link, void*) -> herr_t {
    return link->type == H5L_TYPE_HARD || link->type == H5L_TYPE_SOFT ? 0 : 1;
  };
  const auto look_at_object = [](hid_t root, const char* name, const H5O_info_t* object, void*) -> herr_t {
    if (object->type != H5O_TYPE_DATASET) return 0;
    const Id data(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
    if (!data.valid()) return -1;
    const Id layout(H5Dget_create_plist(data), H5Pclose);
    return H5Pget_external_count(layout) != 0 || H5Pget_layout(layout) == H5D_VIRTUAL ? 1 : 0;
  };
  const herr_t links = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_link, nullptr);
  const herr_t objects =
      links == 0 ? H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_object, nullptr, H5O_INFO_BASIC) : 0;
  if (links < 0 || objects < 0) bad("", "is damaged");
  if (links > 0 || objects > 0) bad("links", "lead into another file, which is not read");
}

/// The numbers of an attribute of an object; none where there is no such attribute.
inline std::vector<double> numbers_of(hid_t file, const std::string& object, const char* name) {
  if (H5Aexists_by_name(file, object.c_str(), name, H5P_DEFAULT) <= 0) return {};
  const Id attribute(H5Aopen_by_name(file, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) bad(name, "is damaged");
  const Id type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (!is_usual(type) || count < 1 || count > 16) bad(name, "is no number of a usual type");
  std::vector<double> numbers(static_cast<std::size_t>(count));
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, numbers.data()) < 0) bad(name, "is damaged");
  return numbers;
}

/// The text of an attribute; empty where there is none.
inline std::string text_of(hid_t file, const std::string& object, const char* name) {
  if (H5Aexists_by_name(file, object.c_str(), name, H5P_DEFAULT) <= 0) return {};
  const Id attribute(H5Aopen_by_name(file, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) bad(name, "is damaged");
  const Id type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
  constexpr std::size_t most = 4096;
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Tget_size(type) > most ||
      H5Sget_simple_extent_npoints(space) != 1)
    bad(name, "is no short text of a fixed length");
  std::string text(H5Tget_size(type) + 1, '\0');
  const Id memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(memory, text.size());
  if (H5Aread(attribute, memory, text.data()) < 0) bad(name, "is damaged");
  text.resize(std::strlen(text.c_str()));
  return text;
}

inline void put_numbers(hid_t object, const char* name, const std::vector<double>& numbers) {
  const hsize_t count = numbers.size();
  const Id space(made(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr)), H5Sclose);
  const Id attribute(made(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  made(H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data()));
}

inline void put_integer(hid_t object, const char* name, int number) {
  const Id space(made(H5Screate(H5S_SCALAR)), H5Sclose);
  const Id attribute(made(H5Acreate2(object, name, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  made(H5Awrite(attribute, H5T_NATIVE_INT, &number));
}

inline void put_text(hid_t object, const char* name, const std::string& text) {
  const Id space(made(H5Screate(H5S_SCALAR)), H5Sclose), type(made(H5Tcopy(H5T_C_S1)), H5Tclose);
  made(H5Tset_size(type, text.size() + 1));
  const Id attribute(made(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  made(H5Awrite(attribute, type, text.c_str()));
}

/// Properties of a group or a data set that does not keep when it was made.
inline hid_t dateless(hid_t kind) {
  const hid_t properties = made(H5Pcreate(kind));
  made(H5Pset_obj_track_times(properties, false));
  return properties;
}

inline hid_t made_group(hid_t file, const char* name) {
  const Id properties(dateless(H5P_GROUP_CREATE), H5Pclose);
  return made(H5Gcreate2(file, name, H5P_DEFAULT, properties, H5P_DEFAULT));
}

}  // namespace trephine::hdf5
