// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "peers/contact_algorithm.h"

namespace trephine::peers {

/// The algorithm of a shared library (peer_abi.h), which stays loaded to the end of the process. Throws Error 65 where
/// it cannot be loaded, lacks a function, or has another version or a name that is none. `make`, and what it gives,
/// throw Error 74 naming the function that fails or gives what is not finite.
AlgorithmKind load_peer(const std::filesystem::path& library);

}  // namespace trephine::peers
