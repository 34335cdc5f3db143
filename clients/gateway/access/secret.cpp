// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/secret.h"

#include <sodium.h>

namespace dts::gateway {

void wipe(std::string& text) noexcept {
  text.resize(text.capacity());  // an earlier text may have been longer; never reallocates
  sodium_memzero(text.data(), text.size());
  text.clear();
}

}  // namespace dts::gateway
