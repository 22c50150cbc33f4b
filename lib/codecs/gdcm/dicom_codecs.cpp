// SPDX-License-Identifier: GPL-3.0-or-later
// What dicom_codecs.so gives the programs (codecs/codecs.h). The only file that includes GDCM.
#include <gdcmDataElement.h>
#include <gdcmFile.h>
#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include <sstream>

#include "base/shared_library.h"
#include "codecs/codecs.h"

#define GIVEN extern "C" __attribute__((visibility("default")))

namespace trephine::codecs {
namespace {

void prepare(gdcm::Image& image, const CodedFrame& frame, const gdcm::TransferSyntax& syntax) {
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(frame.columns));
  image.SetDimension(1, static_cast<unsigned>(frame.rows));
  image.SetPixelFormat(gdcm::PixelFormat(1, static_cast<unsigned short>(frame.bits_allocated),
                                         static_cast<unsigned short>(frame.bits_stored),
                                         static_cast<unsigned short>(frame.bits_stored - 1), frame.is_signed));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(syntax);
}

bool refused(std::string* fault, std::string what) {
  *fault = std::move(what);
  return false;
}

void put(gdcm::DataSet& set, const std::vector<FileElement>& elements) {
  for (const FileElement& e : elements) {
    gdcm::DataElement element(gdcm::Tag(e.group, e.element), 0, gdcm::VR::GetVRType(e.vr.c_str()));
    if (e.vr == "SQ") {
      gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
      sequence->SetLengthToUndefined();
      for (const std::vector<FileElement>& own : e.items) {
        gdcm::Item item;
        item.SetVLToUndefined();
        put(item.GetNestedDataSet(), own);
        sequence->AddItem(item);
      }
      element.SetValue(*sequence);
      element.SetVLToUndefined();
    } else {
      element.SetByteValue(e.value.data(), static_cast<std::uint32_t>(e.value.size()));
    }
    set.Replace(element);
  }
}

bool written(gdcm::Writer& writer, const gdcm::TransferSyntax& syntax, std::string* file, std::string* fault) {
  writer.GetFile().GetHeader().SetDataSetTransferSyntax(syntax);
  std::ostringstream stream(std::ios::binary);
  writer.SetStream(stream);
  if (!writer.Write()) return refused(fault, "the file could not be encoded");
  *file = stream.str();
  return true;
}

}  // namespace

GIVEN int trephine_dicom_version() { return own_library_version; }

GIVEN bool trephine_dicom_decode(const CodedFrame* frame, std::string_view stream, std::vector<char>* pixels,
                                 std::string* fault) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::Image image;
  prepare(image, *frame, gdcm::TransferSyntax::GetTSType(frame->syntax_uid.c_str()));
  gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
  gdcm::Fragment fragment;
  fragment.SetByteValue(stream.data(), static_cast<std::uint32_t>(stream.size()));
  fragments->AddFragment(fragment);
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  element.SetVR(gdcm::VR::OW);
  element.SetValue(*fragments);
  image.SetDataElement(element);

  const std::size_t wanted =
      std::size_t(frame->columns) * std::size_t(frame->rows) * std::size_t(frame->bits_allocated / 8);
  if (image.GetBufferLength() != wanted) return refused(fault, "the decoder expects another size");
  pixels->resize(wanted);
  if (!image.GetBuffer(pixels->data())) return refused(fault, "cannot be decoded");
  // The codec sets the word size that its stream states. Another word size would be another image.
  if (image.GetPixelFormat().GetBitsAllocated() != frame->bits_allocated)
    return refused(fault, "decodes to " + std::to_string(image.GetPixelFormat().GetBitsAllocated()) +
                              " bits, BitsAllocated is " + std::to_string(frame->bits_allocated));
  return true;
}

GIVEN bool trephine_dicom_write(const std::vector<FileElement>* elements, const CodedFrame* frame,
                                const std::vector<char>* pixels, std::string* file, std::string* fault) {
  gdcm::Writer writer;
  gdcm::DataSet& set = writer.GetFile().GetDataSet();
  put(set, *elements);
  gdcm::DataElement raw(gdcm::Tag(0x7fe0, 0x0010), 0, gdcm::VR::OW);
  raw.SetByteValue(pixels->data(), static_cast<std::uint32_t>(pixels->size()));
  const gdcm::TransferSyntax plain = gdcm::TransferSyntax::ExplicitVRLittleEndian;
  const gdcm::TransferSyntax syntax = gdcm::TransferSyntax::GetTSType(frame->syntax_uid.c_str());
  if (syntax == plain) {
    set.Replace(raw);
  } else {
    gdcm::SmartPointer<gdcm::Image> image = new gdcm::Image;
    prepare(*image, *frame, plain);
    image->SetDataElement(raw);
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax);
    change.SetInput(*image);
    if (!change.Change()) return refused(fault, "the encoder failed");
    set.Replace(change.GetOutput().GetDataElement());
  }
  return written(writer, syntax, file, fault);
}

GIVEN bool trephine_dicom_write_object(const std::vector<FileElement>* elements, const std::string* syntax_uid,
                                       std::string* file, std::string* fault) {
  gdcm::Writer writer;
  put(writer.GetFile().GetDataSet(), *elements);
  return written(writer, gdcm::TransferSyntax::GetTSType(syntax_uid->c_str()), file, fault);
}

}  // namespace trephine::codecs
