// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/signature.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <sys/stat.h>

#include <memory>
#include <vector>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/hex.h"

namespace trephine {
namespace {

constexpr std::size_t signature_bytes = 64;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

// OpenSSL would ask at the terminal for the passphrase of a key that has one.
int no_passphrase(char*, int, int, void*) { return -1; }

// Who can read a private key signs in its owner's name. Asked of the opened file, which nobody can exchange.
void require_secret(const InputFile& input, const std::filesystem::path& file) {
  struct stat s {};
  if (::fstat(input.fd.get(), &s) == 0 && (s.st_mode & (S_IRWXG | S_IRWXO)) == 0) return;
  throw Error(ExitCode::bad_input, file.string(), "private key",
              "can be read or written by others, who could sign in its owner's name: chmod 600 '" + file.string() +
                  "', or make a new one if others had it");
}

Key read_key(const std::filesystem::path& file, bool is_private) {
  const InputFile input = open_input(file, 1 << 16);
  const std::vector<char> pem = read_input(input, file);
  const std::unique_ptr<BIO, decltype(&BIO_free)> bio(BIO_new_mem_buf(pem.data(), int(pem.size())), BIO_free);
  const auto read = is_private ? PEM_read_bio_PrivateKey : PEM_read_bio_PUBKEY;
  Key key(bio ? read(bio.get(), nullptr, no_passphrase, nullptr) : nullptr, EVP_PKEY_free);
  if (!key || EVP_PKEY_id(key.get()) != EVP_PKEY_ED25519)
    throw Error(ExitCode::bad_input, file.string(), is_private ? "private key" : "public key",
                is_private ? "is none of Ed25519 without a passphrase; openssl genpkey -algorithm ed25519 makes one"
                           : "is none of Ed25519; openssl pkey -in PRIVATE_KEY -pubout writes it");
  if (is_private) require_secret(input, file);  // a public key that is given for one need not be secret
  return key;
}

void check(int result) {
  if (result != 1) throw Error(ExitCode::internal, "", "", "Ed25519 failed in OpenSSL");
}

const unsigned char* raw(std::string_view bytes) { return reinterpret_cast<const unsigned char*>(bytes.data()); }

int digit_of(char c) { return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1; }

}  // namespace

std::string signature_of_bytes(std::string_view bytes, const std::filesystem::path& private_key) {
  const Key key = read_key(private_key, true);
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  unsigned char signature[signature_bytes];
  std::size_t size = sizeof signature;
  check(EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key.get()));
  check(EVP_DigestSign(context.get(), signature, &size, raw(bytes), bytes.size()));
  return hex_text(signature, sizeof signature);
}

bool is_signed(std::string_view bytes, std::string_view signature, const std::filesystem::path& public_key) {
  const Key key = read_key(public_key, false);
  if (signature.size() != 2 * signature_bytes) return false;
  unsigned char binary[signature_bytes];
  for (std::size_t n = 0; n < signature_bytes; ++n) {
    const int high = digit_of(signature[2 * n]), low = digit_of(signature[2 * n + 1]);
    if (high < 0 || low < 0) return false;
    binary[n] = static_cast<unsigned char>(high * 16 + low);
  }
  const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  check(EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()));
  return EVP_DigestVerify(context.get(), binary, sizeof binary, raw(bytes), bytes.size()) == 1;
}

}  // namespace trephine
