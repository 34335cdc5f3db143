// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace dts::fleet::s3 {

/// Computes a SHA-256 step by step.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  /// Returns 32 bytes, and starts again. Returns an empty text if OpenSSL failed.
  [[nodiscard]] std::string finish();
  void restart();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* state) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> state_;
  bool is_sound_ = false;
};

[[nodiscard]] std::string hexadecimal(std::string_view bytes);

}  // namespace dts::fleet::s3
