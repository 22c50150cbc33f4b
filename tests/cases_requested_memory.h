// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

/// What this test program has asked `operator new` for since it began, in bytes.
std::uint64_t requested_bytes();
