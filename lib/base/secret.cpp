// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/secret.h"

#include <sys/random.h>

#include <array>

#include "base/error.h"
#include "base/hex.h"

namespace trephine {

std::string random_secret() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(ExitCode::internal, "", "token", "the system gives no random bytes");
  return hex_text(bytes.data(), bytes.size());
}

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ = static_cast<unsigned char>(differ | (a[i] ^ b[i]));
  return differ == 0;
}

}  // namespace trephine
