// SPDX-License-Identifier: GPL-3.0-or-later
// Reads one volume with the reader of its format.
#include <hdf5.h>
#include <itkGiplImageIO.h>
#include <itkMINCImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkVTKImageIO.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/child.h"
#include "base/error.h"
#include "itk/itk_child.h"
#include "itk/volume_header.h"
#include "itk/volume_message.h"
#include "minc.h"
#include "plain_header.h"
#include "stored_data.h"

namespace trephine::itk {
namespace {

constexpr std::uint64_t max_voxels = 4000000000u;

[[noreturn]] void bad(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

::itk::ImageIOBase::Pointer reader_of(ItkFormat format) {
  switch (format) {
    case ItkFormat::meta_image:
      return ::itk::MetaImageIO::New().GetPointer();
    case ItkFormat::nrrd:
      return ::itk::NrrdImageIO::New().GetPointer();
    case ItkFormat::gipl:
      return ::itk::GiplImageIO::New().GetPointer();
    case ItkFormat::vtk:
      return ::itk::VTKImageIO::New().GetPointer();
    case ItkFormat::minc:
      return ::itk::MINCImageIO::New().GetPointer();
  }
  bad("", "no reader of that format");
}

/// The head, what was not known, and the voxels.
template <class T>
void put_voxels(ItkVolume head, const std::vector<std::string>& unknown, const std::vector<char>& bytes,
                ChildRequest& to) {
  const std::size_t count = bytes.size() / sizeof(T);
  const T* from = reinterpret_cast<const T*>(bytes.data());
  const bool whole = std::all_of(from, from + count, [](T v) {
    const double d = static_cast<double>(v);
    return d >= -32768 && d <= 32767 && d == std::floor(d);
  });
  head.is_int16 = whole;
  MessageWriter out;
  out.value(head);
  out.number(unknown.size());
  for (const std::string& key : unknown) out.text(key);
  to.write(out.bytes());
  const auto in_pieces = [&](auto zero) {
    using Out = decltype(zero);
    std::vector<Out> piece;
    for (std::size_t at = 0; at < count; at += piece.size()) {
      piece.resize(std::min<std::size_t>(count - at, std::size_t{1} << 20));
      for (std::size_t i = 0; i < piece.size(); ++i) piece[i] = static_cast<Out>(from[at + i]);
      to.write(piece.data(), piece.size() * sizeof(Out));
    }
  };
  if (whole)
    in_pieces(std::int16_t{});
  else
    in_pieces(float{});
}

/// Calls `use` with a zero of the type that ITK gives.
template <class Use>
void with_type(::itk::ImageIOBase::IOComponentEnum type, const Use& use) {
  using Type = ::itk::ImageIOBase::IOComponentEnum;
  switch (type) {
    case Type::CHAR:
      return use(static_cast<signed char>(0));
    case Type::UCHAR:
      return use(static_cast<unsigned char>(0));
    case Type::SHORT:
      return use(short{0});
    case Type::USHORT:
      return use(static_cast<unsigned short>(0));
    case Type::INT:
      return use(0);
    case Type::UINT:
      return use(0u);
    case Type::FLOAT:
      return use(0.0f);
    case Type::DOUBLE:
      return use(0.0);
    default:
      bad("type", "values of this type are not read: 8, 16 and 32 bits, float and double are");
  }
}

void require_values(const std::string& file, ::itk::ImageIOBase::IOComponentEnum type, const std::vector<char>& bytes) {
  ValueFigures figures;
  with_type(type, [&](auto zero) {
    using T = decltype(zero);
    const T* from = reinterpret_cast<const T*>(bytes.data());
    for (std::size_t n = 0; n < bytes.size() / sizeof(T); ++n) figures.add(static_cast<double>(from[n]));
  });
  if (!minc_values(file).agree(figures))
    bad("data", "its values are not what valid_range, image-min and image-max say, or are no numbers");
}

/// What we read of the file ourselves; refuses, with a reason, what ITK would stumble over or pass over. The geometry
/// in the text headers of MetaImage and NRRD is compared by the parent.
VolumeHeader own_look(ItkFormat format, const std::string& file) {
  if (format == ItkFormat::vtk) return check_vtk_file(file);
  if (format == ItkFormat::gipl) return check_gipl_file(file);
  VolumeHeader own;
  if (format == ItkFormat::meta_image || format == ItkFormat::nrrd) {
    const bool meta = format == ItkFormat::meta_image;
    const VolumeHeader text = meta ? check_meta_header(head_of(file), file) : check_nrrd_text(head_of(file), file);
    own.data_file = text.data_file;
    own.data_at = text.data_at;
    own.stored = text.stored;
  }
  if (format == ItkFormat::minc) {
    own.said = minc_geometry(file);
    own.unknown = minc_unknown_keys(file);
  }
  return own;
}

void read(ItkFormat format, const std::string& file, ChildRequest& request) {
  const VolumeHeader own = own_look(format, file);
  const ::itk::ImageIOBase::Pointer io = reader_of(format);
  io->SetFileName(file);
  if (!io->CanReadFile(file.c_str())) bad("", "is not of the format that its name says");
  io->ReadImageInformation();
  if (io->GetNumberOfComponents() != 1) bad("components", "has several values a voxel, must have one");
  unsigned dimensions = io->GetNumberOfDimensions();
  while (dimensions > 3 && io->GetDimensions(dimensions - 1) == 1) --dimensions;
  if (dimensions != 3) bad("dimensions", "must be three");
  ItkVolume head;
  std::uint64_t count = 1;
  for (unsigned a = 0; a < 3; ++a) {
    const std::uint64_t n = io->GetDimensions(a);
    if (n == 0 || n > 65535) bad("size", std::to_string(n) + ", must be 1 to 65535");
    count *= n;
    head.size[a] = static_cast<std::int32_t>(n);
    head.spacing[a] = io->GetSpacing(a);
    head.origin[a] = io->GetOrigin(a);
    for (unsigned b = 0; b < 3; ++b) head.axis[a][b] = io->GetDirection(a).at(b);
  }
  if (count > max_voxels) bad("size", "more than 4e9 voxels");
  if (format == ItkFormat::minc) {
    for (std::size_t r = 0; r < 2; ++r) {
      head.origin[r] = 0 - head.origin[r];
      for (auto& axis : head.axis) axis[r] = 0 - axis[r];
    }
  }
  own.require_same(head);
  if (format == ItkFormat::minc) head = *own.said;  // ITK holds the directions in single precision
  ::itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned a = 0; a < io->GetNumberOfDimensions(); ++a) {
    region.SetIndex(a, 0);
    region.SetSize(a, io->GetDimensions(a));
  }
  io->SetIORegion(region);
  if (static_cast<std::uint64_t>(io->GetImageSizeInBytes()) != count * io->GetComponentSize())
    bad("size", "does not go with the values' type");
  require_as_many(own, file, count * io->GetComponentSize());
  std::vector<char> bytes(count * io->GetComponentSize(), '\x00');
  io->Read(bytes.data());
  request.report(0.4);
  // What the reader does not fill keeps the byte that was there before.
  std::vector<char> again(bytes.size(), '\x5a');
  const ::itk::ImageIOBase::Pointer second = reader_of(format);  // GIPL's reader goes on where it ended
  second->SetFileName(file);
  second->ReadImageInformation();
  second->SetIORegion(region);
  second->Read(again.data());
  if (bytes != again) bad("data", "the file is cut short or damaged");
  again = {};
  request.report(0.6);
  if (format == ItkFormat::minc) require_values(file, io->GetComponentType(), bytes);
  request.report(0.8);
  with_type(io->GetComponentType(), [&](auto zero) { put_voxels<decltype(zero)>(head, own.unknown, bytes, request); });
}

const ChildWorker worker(read_worker_name, [](ChildRequest& request) {
  MessageReader in = itk_child::opened(read_worker_name, request.request());
  const auto format = in.value<ItkFormat>();
  const std::string file(in.text());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // HDF5 prints what it stumbles over
  try {
    read(format, file, request);
  } catch (const ::itk::ExceptionObject&) {  // its text quotes paths and the file
    bad("", "is damaged, or of a kind of its format that ITK does not read");
  }
});

}  // namespace
}  // namespace trephine::itk
