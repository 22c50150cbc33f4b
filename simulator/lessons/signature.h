// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "haptics/recording.h"
#include "lesson/rubric.h"

namespace trephine::lessons {

/// A teacher who saw an attempt signs its recording: RECORDING.sig then lies beside it. The signature is of the
/// recording's bytes, so that whoever changes or replaces the recording breaks it (base/signature.h).

/// Where the signature of a recording lies.
std::filesystem::path signature_file(const std::filesystem::path& recording);

/// Writes the signature by the private key. Throws Error 65 where the file is no recording; as signature_of_bytes and
/// write_file do.
void sign_recording(const std::filesystem::path& recording, const std::filesystem::path& private_key);
/// The same of one that was read from there.
void sign_recording(const haptics::Recording& read, const std::filesystem::path& recording,
                    const std::filesystem::path& private_key);

/// What lies beside a recording, for whoever has a public key; `fits`: a signature by its owner of these very bytes.
/// `of_another_rubric`: it fits, and points by this rubric are not what was signed, for the recording names another one
/// or none.
enum class Signature { not_asked, absent, of_other_bytes, by_another_key, of_another_rubric, fits };
/// "signed"; "not signed" for all else; empty where nobody asked.
const char* name_of(Signature signature);

/// `not_asked` where `public_key` is empty. `recording_sha256` is of the bytes that were read (Recording::sha256),
/// whatever lies at the path by now. Throws Error 65 where the file of the signature is damaged.
Signature signature_of(const std::string& recording_sha256, const std::filesystem::path& recording,
                       const std::filesystem::path& public_key);

/// What it says of points by that rubric, where the recording's header names this one.
Signature signature_for(Signature signature, const std::string& announced_sha256, const lesson::CompiledRubric& rubric);

/// Throws Error 80, naming the signature's file, where there is one that does not fit.
void require_no_misfit(Signature signature, const std::filesystem::path& recording);

}  // namespace trephine::lessons
