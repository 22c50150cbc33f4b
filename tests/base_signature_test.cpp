// SPDX-License-Identifier: GPL-3.0-or-later
// Ed25519 against the first example of RFC 8032, section 7.1, and what is no signature or no key.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/signature.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

const std::string signature_of_nothing =
    "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe2465"
    "5141438e7a100b";
constexpr const char* private_pem =
    "-----BEGIN PRIVATE KEY-----\nMC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n-----END PRIVATE "
    "KEY-----\n";
constexpr const char* public_pem =
    "-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n-----END PUBLIC "
    "KEY-----\n";

TEST(Signature, IsThatOfTheStandardAndOfTheseBytesAlone) {
  const TemporaryFolder folder;
  const auto secret = folder.path() / "key", open = folder.path() / "key.pub";
  write_file(secret, private_pem);
  fs::permissions(secret, fs::perms::owner_read | fs::perms::owner_write);
  write_file(open, public_pem);
  EXPECT_EQ(signature_of_bytes("", secret), signature_of_nothing);
  EXPECT_TRUE(is_signed("", signature_of_nothing, open));
  EXPECT_FALSE(is_signed("a", signature_of_nothing, open));
  const std::string of_a = signature_of_bytes("a", secret);
  EXPECT_TRUE(is_signed("a", of_a, open));
  for (std::size_t n = 0; n < of_a.size(); ++n) {
    std::string other = of_a;
    other[n] = other[n] == '0' ? '1' : '0';
    EXPECT_FALSE(is_signed("a", other, open)) << n;
  }
  for (const std::string& none :
       {std::string(), of_a.substr(1), of_a + "0", std::string(128, 'x'), std::string(128, '0')})
    EXPECT_FALSE(is_signed("a", none, open)) << none;
}

TEST(Signature, AFileThatHoldsNoSuchKeyIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "key";
  for (const char* text : {"", "-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n", public_pem}) {
    write_file(file, text);
    fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_THROW(signature_of_bytes("a", file), Error) << text;
  }
  write_file(file, private_pem);  // the public key is asked for
  EXPECT_THROW(is_signed("a", signature_of_nothing, file), Error);
}

TEST(Signature, APrivateKeyThatOthersMayReadIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "key";
  write_file(file, private_pem);
  for (const int mode : {0640, 0604, 0620, 0602, 0644, 0666}) {
    fs::permissions(file, fs::perms(mode));
    try {
      signature_of_bytes("a", file);
      ADD_FAILURE() << std::oct << mode;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.file(), file.string());
      EXPECT_NE(std::string(e.what()).find("chmod 600 '" + file.string() + "'"), std::string::npos) << e.what();
    }
  }
  for (const int mode : {0600, 0400}) {
    fs::permissions(file, fs::perms(mode));
    EXPECT_NO_THROW(signature_of_bytes("a", file)) << std::oct << mode;
  }
}

}  // namespace
}  // namespace trephine
