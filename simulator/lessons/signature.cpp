// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/signature.h"

#include "base/refusal.h"
#include "base/signature.h"
#include "base/write_file.h"
#include "haptics/recording.h"
#include "json/declared_json.h"

namespace trephine::lessons {
namespace {

struct SignatureFile {
  int trephine_signature = 1;
  std::string recording_sha256, signature;
  template <class V>
  static void describe(V& v) {
    using P = SignatureFile;
    v.integer(&P::trephine_signature, "trephine_signature", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::recording_sha256, "recording_sha256", "SHA-256 of the recording's bytes.").is_required();
    v.text(&P::signature, "signature", "Ed25519 of what is signed.").is_required();
  }
};

// What is signed names its purpose, so that a signature for something else is never one of a recording.
std::string signed_words(const std::string& recording_sha256) {
  return "a recording that its signer saw being made: " + recording_sha256;
}

}  // namespace

std::filesystem::path signature_file(const std::filesystem::path& recording) {
  std::filesystem::path file = recording;
  return file += ".sig";
}

void sign_recording(const std::filesystem::path& recording, const std::filesystem::path& private_key) {
  sign_recording(haptics::read_recording(recording), recording, private_key);
}

void sign_recording(const haptics::Recording& read, const std::filesystem::path& recording,
                    const std::filesystem::path& private_key) {
  haptics::require_seal(read, recording);
  SignatureFile s;
  s.recording_sha256 = read.sha256;
  s.signature = signature_of_bytes(signed_words(s.recording_sha256), private_key);
  write_file(signature_file(recording), json::declared_json(AnyParams::make<SignatureFile>(s)) + "\n", Links::replaced);
}

const char* name_of(Signature signature) {
  switch (signature) {
    case Signature::not_asked:
      return "";
    case Signature::fits:
      return "signed";
    case Signature::absent:
    case Signature::of_other_bytes:
    case Signature::by_another_key:
    case Signature::of_another_rubric:
      break;
  }
  return "not signed";
}

Signature signature_of(const std::string& recording_sha256, const std::filesystem::path& recording,
                       const std::filesystem::path& public_key) {
  if (public_key.empty()) return Signature::not_asked;
  const std::filesystem::path file = signature_file(recording);
  if (!std::filesystem::exists(file)) return Signature::absent;
  SignatureFile s;
  with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 16);
    json::read_declared_json({bytes.data(), bytes.size()}, parameters_of<SignatureFile>(), &s);
  });
  if (s.recording_sha256 != recording_sha256) return Signature::of_other_bytes;
  return is_signed(signed_words(s.recording_sha256), s.signature, public_key) ? Signature::fits
                                                                              : Signature::by_another_key;
}

Signature signature_for(Signature signature, const std::string& announced_sha256,
                        const lesson::CompiledRubric& rubric) {
  return signature == Signature::fits && announced_sha256 != rubric.sha256 ? Signature::of_another_rubric : signature;
}

void require_no_misfit(Signature signature, const std::filesystem::path& recording) {
  const bool other_bytes = signature == Signature::of_other_bytes;
  if (!other_bytes && signature != Signature::by_another_key) return;
  throw refusal(other_bytes ? "recording_sha256" : "signature",
                other_bytes ? "is not of the recording beside it, which was changed or replaced"
                            : "is not by the owner of the public key",
                {"ask the teacher who saw the attempt to `sign` it"})
      .in_file(signature_file(recording).string());
}

}  // namespace trephine::lessons
