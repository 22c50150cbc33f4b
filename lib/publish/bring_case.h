// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine::publish {

/// Publishes in a library, which other hosts may share, a case that a run on this host has built in a folder of its
/// own: FROM/CASE becomes LIBRARY/CASE. Every byte is compared with the checksums of case.json first. The library holds
/// the old case or the new one, as after `trephine run` itself: what case.json names is written under its content's
/// name, then pictures and run.json, then case.json; a case that is new appears by one rename. What else lies in the
/// case's folder there, such as a lesson's approval, stays. Throws Error 65 where the built case is damaged, 75 where
/// another run builds the case or the lease was lost meanwhile, 73 and 74.
void bring_case(const std::filesystem::path& from_library, const std::filesystem::path& library,
                const std::string& case_token);

/// Brings what a refused run left for looking (publish/refused.h), if there is any. A failure is not told: the reason
/// of the refusal matters more.
void bring_refused(const std::filesystem::path& from_library, const std::filesystem::path& library,
                   const std::string& case_token);

}  // namespace trephine::publish
