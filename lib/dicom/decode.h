// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "dicom/header.h"

namespace trephine::dicom {

struct FrameRef {
  const FileHeader* header = nullptr;
  int frame = 0;
};

/// Called with the stored words of a frame (rows x columns x bits_allocated / 8 bytes, little endian), in the requested
/// order.
using FrameSink = std::function<void(std::size_t index, const std::uint8_t* stored)>;

/// Reads the stored words of frames. Uncompressed frames are read at the place that the checked header gives.
/// Compressed frames are decoded by GDCM in one bounded child, which gets the fragments' places and the expected shape,
/// but never a file to parse. Throws Error 65 naming the file and the transfer syntax where the compressed data does
/// not match the header, 70 naming the file where the child dies, 74 where a file shrank meanwhile.
void read_frames(const std::vector<FrameRef>& frames, const FrameSink& sink, const Progress& progress = {});

/// read_frames for compressed frames.
void decode_in_child(const std::vector<FrameRef>& frames, const FrameSink& sink, const Progress& progress);

/// Throws Error 65: two slices at one position have different pixels.
[[noreturn]] void different_duplicates(const FileHeader& header);

/// The compressed bytes of a frame. Throws as read_frames.
std::string stream_of_frame(const FrameRef& frame);

/// Throws what read_frames would throw for a compressed frame that check_codestream refuses, without decoding it.
void check_frame_stream(const FrameRef& frame);

/// Adds everything that a slice's import depends on to a hash: its tags and its pixel bytes as stored.
std::string hash_of_frame(const FrameRef& frame);

}  // namespace trephine::dicom
