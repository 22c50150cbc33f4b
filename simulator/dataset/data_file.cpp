// SPDX-License-Identifier: GPL-3.0-or-later
#include "dataset/data_file.h"

#include <fstream>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/write_file.h"
#include "dataset/hdf5/hdf5_file.h"

namespace trephine::dataset {
namespace {

constexpr const char* file_name = "data.hdf5";
constexpr std::size_t piece_bytes = std::size_t{1} << 20;

constexpr std::uint64_t room_bytes = std::uint64_t{8}
                                     << 20;  // that is asked for beside a row, for what HDF5 keeps back

std::uint64_t bytes_of(Number type, const std::vector<std::uint64_t>& sides) {
  std::uint64_t n = type == Number::uint8 ? 1 : 8;
  for (const std::uint64_t side : sides) n *= side;
  return n;
}

void put(const TemporaryFolder& folder, void* file, const std::string& path, Number type,
         const std::vector<std::uint64_t>& sides, const void* data) {
  const DataForm form{path.c_str(), type, sides, !sides.empty()};
  folder.fill(data ? bytes_of(type, sides) + room_bytes : room_bytes, [&] { hdf5().numbers(file, &form, data); });
}

}  // namespace

DataFile::DataFile() {
  ignore_file_size_signal();  // a limit on file sizes is Error 74, as a full disk
  file_ = hdf5().create((folder_.path() / file_name).c_str());
}
DataFile::~DataFile() { hdf5().forget(file_); }

void DataFile::group(const std::string& path) { hdf5().group(file_, path.c_str()); }
void DataFile::text(const std::string& path, const std::string& text) {
  hdf5().text(file_, path.c_str(), text.c_str());
}
void DataFile::texts(const std::string& path, const std::vector<std::string>& texts) {
  std::vector<const char*> all;
  all.reserve(texts.size());
  for (const std::string& t : texts) all.push_back(t.c_str());
  hdf5().texts(file_, path.c_str(), all.data(), all.size());
}
void DataFile::numbers(const std::string& path, const std::vector<double>& data,
                       const std::vector<std::uint64_t>& sides) {
  put(folder_, file_, path, Number::float64, sides, data.data());
}
void DataFile::whole_numbers(const std::string& path, const std::vector<std::int64_t>& data,
                             const std::vector<std::uint64_t>& sides) {
  put(folder_, file_, path, Number::int64, sides, data.data());
}
void DataFile::bytes(const std::string& path, const std::vector<std::uint8_t>& data,
                     const std::vector<std::uint64_t>& sides) {
  put(folder_, file_, path, Number::uint8, sides, data.data());
}
void DataFile::begin_numbers(const std::string& path, const std::vector<std::uint64_t>& sides) {
  put(folder_, file_, path, Number::float64, sides, nullptr);
}
void DataFile::begin_bytes(const std::string& path, const std::vector<std::uint64_t>& sides) {
  put(folder_, file_, path, Number::uint8, sides, nullptr);
}
void DataFile::row(const std::string& path, std::uint64_t row, const std::vector<double>& data) {
  folder_.fill(8 * data.size() + room_bytes, [&] { hdf5().row(file_, path.c_str(), row, data.data()); });
}
void DataFile::row(const std::string& path, std::uint64_t row, const std::vector<std::uint8_t>& data) {
  folder_.fill(data.size() + room_bytes, [&] { hdf5().row(file_, path.c_str(), row, data.data()); });
}
void DataFile::attribute(const std::string& path, const std::string& name, const std::string& text) {
  hdf5().attribute(file_, path.c_str(), name.c_str(), text.c_str());
}

std::uint64_t DataFile::commit(const std::filesystem::path& target) {
  folder_.fill(room_bytes, [&] { hdf5().close(file_); });
  std::ifstream made(folder_.path() / file_name, std::ios::binary);
  FileWriter out(target);
  std::vector<char> piece(piece_bytes);
  do {
    made.read(piece.data(), std::streamsize(piece.size()));
    out.write(piece.data(), std::size_t(made.gcount()));
  } while (made);
  if (!made.eof()) throw Error(ExitCode::io, target.string(), "", "the temporary file cannot be read again");
  const std::uint64_t bytes = out.bytes_written();
  out.commit();
  return bytes;
}

}  // namespace trephine::dataset
