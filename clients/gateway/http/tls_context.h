// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "dts/error.h"

namespace dts::gateway {

/// Returns a TLS context: TLS 1.2 or newer with forward secrecy, no compression, no renegotiation. Fails with InvalidArgument, naming the
/// file.
[[nodiscard]] client::Result<std::unique_ptr<boost::asio::ssl::context>> open_tls(const std::string& certificate_file,
                                                                                  const std::string& key_file);

}  // namespace dts::gateway
