// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string_view>

namespace trephine::meshio {

enum class ForeignProgram : std::uint32_t { assimp, vtk };
inline const char* name_of(ForeignProgram program) { return program == ForeignProgram::vtk ? "VTK" : "assimp"; }

/// Another program's reader for the files of one extension. assimp chooses its own by it; VTK's are vtp, vtk and wrl.
struct ForeignReader {
  ForeignProgram program = ForeignProgram::assimp;
  char extension[8] = "";  ///< without its dot; an array, for the reader is handed to a child as its bytes
  bool reads(std::string_view other) const { return other == extension; }
};

}  // namespace trephine::meshio
