// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms in HDF5: read by ITK, written as ITK reads them.
#include <itkHDF5TransformIO.h>
#include <itkTransformFactoryBase.h>

#include <string>
#include <vector>

#include "base/child.h"
#include "hdf5_file.h"
#include "itk/itk_child.h"
#include "itk/transform_message.h"

namespace trephine::itk {
namespace {

using namespace hdf5;

void read(const std::string& file, ChildRequest& request) {
  ::itk::TransformFactoryBase::RegisterDefaultTransforms();
  const auto io = ::itk::HDF5TransformIOTemplate<double>::New();
  if (!io->CanReadFile(file.c_str())) bad("", "is no HDF5 file of an ITK transform");
  {
    const Id opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!opened.valid()) bad("", "is damaged");
    require_self_contained(opened);
  }
  io->SetFileName(file);
  io->Read();
  MessageWriter out;
  for (const auto& transform : io->GetReadTransformList()) {
    const std::string kind = transform->GetTransformTypeAsString();
    const bool composite = kind.rfind("Composite", 0) == 0;  // its parameters are those of its parts
    const auto array = [&](const auto& from) {
      std::vector<double> numbers;
      for (unsigned i = 0; !composite && i < from.Size() && i < 64; ++i) numbers.push_back(from[i]);
      out.array(numbers);
    };
    out.text(kind);
    array(transform->GetParameters());
    array(transform->GetFixedParameters());
  }
  request.write(out.bytes());
}

void put_text_data(hid_t file, const char* name, const char* text) {
  const hsize_t one = 1;
  const Id space(made(H5Screate_simple(1, &one, nullptr)), H5Sclose), type(made(H5Tcopy(H5T_C_S1)), H5Tclose),
      plain(dateless(H5P_DATASET_CREATE), H5Pclose);
  made(H5Tset_size(type, H5T_VARIABLE));
  const Id data(made(H5Dcreate2(file, name, type, space, H5P_DEFAULT, plain, H5P_DEFAULT)), H5Dclose);
  made(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text));
}

void put_data(hid_t file, const char* name, const std::vector<double>& numbers) {
  const hsize_t count = numbers.size();
  const Id space(made(H5Screate_simple(1, &count, nullptr)), H5Sclose), plain(dateless(H5P_DATASET_CREATE), H5Pclose);
  const Id data(made(H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, plain, H5P_DEFAULT)), H5Dclose);
  made(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
}

void write(const std::string& name, const std::vector<double>& numbers) {
  const Id file(made(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), H5Fclose);
  put_text_data(file, "/ITKVersion", "5.2.1");
  put_text_data(file, "/HDFVersion", "1.10.8");
  put_text_data(file, "/OSName", "unsaid");
  put_text_data(file, "/OSVersion", "unsaid");
  for (const char* group : {"/TransformGroup", "/TransformGroup/0"}) H5Gclose(made_group(file, group));
  put_text_data(file, "/TransformGroup/0/TransformType", "AffineTransform_double_3_3");
  put_data(file, "/TransformGroup/0/TransformFixedParameters", {0, 0, 0});
  put_data(file, "/TransformGroup/0/TransformParameters", numbers);
  made(H5Fflush(file, H5F_SCOPE_GLOBAL));
}

const ChildWorker worker(transform_worker_name, [](ChildRequest& request) {
  MessageReader in = itk_child::opened(transform_worker_name, request.request());
  const auto task = in.value<TransformTask>();
  const std::string file(in.text());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (task == TransformTask::write) return write(file, in.array<double>());
  try {
    read(file, request);
  } catch (const ::itk::ExceptionObject&) {
    bad("", "is damaged, or of a kind that ITK does not read");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Error&) {
    throw;
  } catch (...) {  // H5::Exception is no std::exception
    bad("", "is damaged: HDF5 cannot read it");
  }
});

}  // namespace
}  // namespace trephine::itk
