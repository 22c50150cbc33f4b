// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace trephine::lessons {

/// A teacher who saw an attempt signs its recording: RECORDING.sig then lies beside it. The signature is of the
/// recording's bytes, so that whoever changes or replaces the recording breaks it (base/signature.h).

/// Where the signature of a recording lies.
std::filesystem::path signature_file(const std::filesystem::path& recording);

/// Writes the signature by the private key. Throws Error 65 where the file is no recording; as signature_of_bytes and
/// write_file do.
void sign_recording(const std::filesystem::path& recording, const std::filesystem::path& private_key);

/// "signed", or "not signed" where there is no signature beside the recording; empty where `public_key` is, as nobody
/// asks. `recording_sha256` is of the bytes that were read (Recording::sha256), whatever lies at the path by now.
/// Throws Error 80 where the signature is not by that key or not of these bytes; 65 where its file is damaged.
std::string signature_state(const std::string& recording_sha256, const std::filesystem::path& recording,
                            const std::filesystem::path& public_key);

}  // namespace trephine::lessons
