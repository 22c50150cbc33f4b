// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/hex.h"
#include "base/write_file.h"

namespace trephine {
namespace {

void check(int result) {
  if (result != 1) throw Error(ExitCode::internal, "", "", "SHA-256 failed in OpenSSL");
}

}  // namespace

struct Sha256::Context {
  EVP_MD_CTX* md = EVP_MD_CTX_new();
  ~Context() { EVP_MD_CTX_free(md); }
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  check(context_->md ? 1 : 0);
  check(EVP_DigestInit_ex(context_->md, EVP_sha256(), nullptr));
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

Sha256& Sha256::bytes(const void* data, std::size_t size) {
  if (!context_) throw Error(ExitCode::internal, "", "", "a finished SHA-256 cannot take more bytes");
  if (size > 0) check(EVP_DigestUpdate(context_->md, data, size));
  return *this;
}

Sha256& Sha256::text(std::string_view s) {
  integer(static_cast<std::int64_t>(s.size()));
  return bytes(s.data(), s.size());
}

Sha256& Sha256::number(double v) {
  if (v == 0) v = 0;  // -0 == 0
  std::int64_t bits;
  static_assert(sizeof bits == sizeof v);
  std::memcpy(&bits, &v, sizeof bits);
  return integer(bits);
}

Sha256& Sha256::integer(std::int64_t v) {
  unsigned char little[8];
  for (int i = 0; i < 8; ++i) little[i] = static_cast<unsigned char>(static_cast<std::uint64_t>(v) >> (8 * i));
  return bytes(little, sizeof little);
}

std::string Sha256::hex() {
  if (!context_) throw Error(ExitCode::internal, "", "", "a SHA-256 was finished twice");
  unsigned char digest[32];
  unsigned size = 0;
  check(EVP_DigestFinal_ex(context_->md, digest, &size));
  context_.reset();
  return hex_text(digest, size);
}

std::string sha256_of_bytes(std::string_view bytes) { return Sha256().bytes(bytes.data(), bytes.size()).hex(); }

std::string sha256_of_file(const std::filesystem::path& file) {
  const FileDescriptor fd = open_input(file, UINT64_MAX).fd;
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (const std::size_t n = read_some(fd.get(), buffer.data(), buffer.size(), file)) hash.bytes(buffer.data(), n);
  return hash.hex();
}

}  // namespace trephine
