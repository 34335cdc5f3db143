// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/system/error_code.hpp>
#include <optional>

#include "dts/error.h"
#include "gateway/http/http_message.h"
#include "gateway/http/server_state.h"

namespace dts::gateway {

using RawRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// Takes a parsed request to what the routes may see, or says why they may not. All refusals end the connection: what follows on it
/// cannot be trusted to be a request.
[[nodiscard]] tl::expected<HttpRequest, HttpResponse> check_request(RawRequest raw, const Peer& peer, bool is_secure,
                                                                    const HostCheck& hosts);

/// For "/ws": a page of ours that speaks dts.v1. Nothing: fine.
[[nodiscard]] std::optional<HttpResponse> refuse_upgrade(const RawRequest& raw, const HttpRequest& request);

/// The answer to something that is no request; nothing when nobody is there to read one.
[[nodiscard]] std::optional<HttpResponse> refuse_unreadable(const boost::system::error_code& error);

}  // namespace dts::gateway
