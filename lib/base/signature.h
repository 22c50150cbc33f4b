// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace trephine {

/// Signatures by Ed25519 (RFC 8032), computed by OpenSSL. Keys are PEM files without a passphrase, as
/// `openssl genpkey -algorithm ed25519` and `openssl pkey -pubout` write them.

/// The signature of the bytes, as 128 lower-case hexadecimal digits. The same key and bytes give the same signature.
/// Throws Error 66 where the key's file cannot be read, 65 where it holds no private Ed25519 key, or where anybody but
/// its owner may read or write it.
std::string signature_of_bytes(std::string_view bytes, const std::filesystem::path& private_key);

/// Whether `signature` is of these bytes by the owner of the key; text that is no signature is of nobody.
/// Throws Error 66 where the key's file cannot be read, 65 where it holds no public Ed25519 key.
bool is_signed(std::string_view bytes, std::string_view signature, const std::filesystem::path& public_key);

}  // namespace trephine
