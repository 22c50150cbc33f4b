// SPDX-License-Identifier: GPL-3.0-or-later
// Writes one volume with the writer of its format.
#include <itkGiplImageIO.h>
#include <itkMetaImageIO.h>
#include <itkVTKImageIO.h>

#include "base/child.h"
#include "base/error.h"
#include "itk/itk_child.h"
#include "itk/volume_message.h"
#include "minc.h"

namespace trephine::itk {
namespace {

::itk::ImageIOBase::Pointer writer_of(ItkFormat format) {
  switch (format) {
    case ItkFormat::meta_image:
      return ::itk::MetaImageIO::New().GetPointer();
    case ItkFormat::gipl:
      return ::itk::GiplImageIO::New().GetPointer();
    case ItkFormat::vtk:
      return ::itk::VTKImageIO::New().GetPointer();
    default:
      throw Error(ExitCode::internal, "", write_worker_name, "no writer of that format");
  }
}

::itk::ImageIOBase::IOComponentEnum type_of(ItkSample sample) {
  using Type = ::itk::ImageIOBase::IOComponentEnum;
  return sample == ItkSample::int16 ? Type::SHORT : sample == ItkSample::uint8 ? Type::UCHAR : Type::FLOAT;
}

void write(ItkFormat format, const std::string& file, const ItkVolume& head, ItkSample sample,
           std::string_view voxels) {
  if (format == ItkFormat::minc) return write_minc(file, head, sample, voxels);
  const ::itk::ImageIOBase::Pointer io = writer_of(format);
  io->SetFileName(file);
  io->SetNumberOfDimensions(3);
  ::itk::ImageIORegion region(3);
  for (unsigned a = 0; a < 3; ++a) {
    io->SetDimensions(a, static_cast<unsigned>(head.size[a]));
    io->SetSpacing(a, head.spacing[a]);
    io->SetOrigin(a, head.origin[a]);
    io->SetDirection(a, {head.axis[a][0], head.axis[a][1], head.axis[a][2]});
    region.SetIndex(a, 0);
    region.SetSize(a, static_cast<::itk::SizeValueType>(head.size[a]));
  }
  io->SetIORegion(region);
  io->SetPixelType(::itk::IOPixelEnum::SCALAR);
  io->SetNumberOfComponents(1);
  io->SetComponentType(type_of(sample));
  io->SetFileTypeToBinary();
  if (format == ItkFormat::meta_image) io->UseCompressionOn();
  io->WriteImageInformation();
  io->Write(voxels.data());
}

const ChildWorker worker(write_worker_name, [](ChildRequest& request) {
  MessageReader in = itk_child::opened(write_worker_name, request.request());
  const auto format = in.value<ItkFormat>();
  const auto sample = in.value<ItkSample>();
  const auto head = in.value<ItkVolume>();
  const std::string file(in.text());
  const std::string_view voxels = in.text();
  std::uint64_t bytes = sample == ItkSample::int16 ? 2 : sample == ItkSample::uint8 ? 1 : 4;
  for (const std::int32_t n : head.size) bytes *= static_cast<std::uint64_t>(n);
  if (bytes != voxels.size()) throw Error(ExitCode::internal, "", write_worker_name, "another number of voxels");
  try {
    write(format, file, head, sample, voxels);
  } catch (const ::itk::ExceptionObject&) {
    throw Error(ExitCode::io, "", "", "ITK could not write the file");
  }
});

}  // namespace
}  // namespace trephine::itk
