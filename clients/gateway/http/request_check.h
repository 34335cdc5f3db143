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

/// Converts a parsed request to one for the routes, or returns the reason why it is rejected. Every rejection ends the connection: the
/// bytes after a bad request cannot be trusted to be a request.
[[nodiscard]] tl::expected<HttpRequest, HttpResponse> check_request(RawRequest raw, const Peer& peer, bool is_secure,
                                                                    const HostCheck& hosts);

/// Checks a request for "/ws": it must come from a page of ours and use dts.v1. Returns nothing if it may be upgraded.
[[nodiscard]] std::optional<HttpResponse> refuse_upgrade(const RawRequest& raw, const HttpRequest& request);

/// Returns the answer to data that is not a valid request; nothing if the peer cannot read an answer any more.
[[nodiscard]] std::optional<HttpResponse> refuse_unreadable(const boost::system::error_code& error);

}  // namespace dts::gateway
