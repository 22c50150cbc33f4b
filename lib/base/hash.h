// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace trephine {

/// SHA-256 (FIPS 180-4) of everything that was added, computed by OpenSSL. Values are hashed with their length or as
/// fixed-width little-endian bytes, so that no two different sequences of pieces give the same bytes.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  Sha256& bytes(const void* data, std::size_t size);  ///< raw, without a length
  Sha256& text(std::string_view s);                   ///< with its length before it
  Sha256& number(double v);                           ///< the 8 bytes of its bit pattern; -0 counts as 0
  Sha256& integer(std::int64_t v);
  std::string hex();  ///< 64 lower-case digits; nothing may be added afterwards

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

std::string sha256_of_bytes(std::string_view bytes);
/// Throws as read_file does.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace trephine
