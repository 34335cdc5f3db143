// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/request_check.h"

#include <array>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/verb.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/http/json_answer.h"
#include "gateway/http/request_target.h"

namespace dts::gateway {
namespace {

namespace http = boost::beast::http;

/// Headers that may occur only once: two programs could each use a different one of two values.
constexpr std::array kOnlyOnce{http::field::host,   http::field::content_length,    http::field::transfer_encoding,
                               http::field::origin, http::field::sec_websocket_key, http::field::sec_websocket_version,
                               http::field::cookie};

std::string text_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

HttpResponse no_request(std::string_view what) { return error_answer(400, what, "unsupported HTTP request"); }

std::optional<HttpResponse> refuse_method(http::verb method) {
  if (method == http::verb::get || method == http::verb::head || method == http::verb::post) return std::nullopt;
  if (method == http::verb::unknown) return error_answer(501, "unknown method", "use GET, HEAD or POST");
  auto response = error_answer(405, "this path does not accept this method", "use GET, HEAD or POST");
  response.headers.emplace_back("Allow", "GET, HEAD, POST");
  return response;
}

/// Rejects a body where none is allowed, or with two different lengths: attackers hide a second request this way (RFC 9112, 11.2).
std::optional<HttpResponse> refuse_framing(const RawRequest& raw) {
  for (const http::field name : kOnlyOnce) {
    if (raw.count(name) > 1) return no_request("a header appears twice that may appear once");
  }
  const bool is_chunked = raw.count(http::field::transfer_encoding) > 0;
  if (is_chunked && raw.count(http::field::content_length) > 0) return no_request("two lengths for one body");
  if (is_chunked && !boost::beast::iequals(raw[http::field::transfer_encoding], "chunked")) {
    return error_answer(501, "an unknown transfer encoding", "use a Content-Length");
  }
  const auto length = raw[http::field::content_length];
  if (raw.method() != http::verb::post && (is_chunked || !raw.body().empty() || !(length.empty() || length == "0"))) {
    return no_request("a body is not allowed here");
  }
  return std::nullopt;
}

/// Checks for base64 of 16 bytes (RFC 6455, 4.2.1).
bool is_websocket_key(std::string_view key) noexcept {
  constexpr std::size_t kDigits = 22;
  constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  return key.size() == kDigits + 2 && key.ends_with("==") && key.find_first_not_of(kBase64) == kDigits;
}

std::map<std::string, std::string> headers_of(const RawRequest& raw) {
  std::map<std::string, std::string> headers;
  for (const auto& field : raw) {
    std::string name = text_of(field.name_string());
    for (char& letter : name) {
      if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    }
    auto [entry, is_new] = headers.emplace(std::move(name), text_of(field.value()));
    if (!is_new) entry->second.append(", ").append(text_of(field.value()));
  }
  return headers;
}

}  // namespace

tl::expected<HttpRequest, HttpResponse> check_request(RawRequest raw, const Peer& peer, bool is_secure, const HostCheck& hosts) {
  if (auto refused = refuse_framing(raw)) return tl::make_unexpected(std::move(*refused));
  const auto host = parse_authority(text_of(raw[http::field::host]));
  if (!host) return tl::make_unexpected(no_request("no usable Host header"));
  if (!hosts.is_ours(*host, peer.local_address)) {
    return tl::make_unexpected(error_answer(421, "the address does not contain a name of this gateway",
                                            "if the name is right, add it to host-name in gateway.toml"));
  }
  if (auto refused = refuse_method(raw.method())) return tl::make_unexpected(std::move(*refused));
  auto target = parse_target(text_of(raw.target()));
  if (!target) return tl::make_unexpected(no_request("no usable path"));

  HttpRequest request;
  request.method = text_of(raw.method_string());
  request.path = std::move(target->path);
  request.query = std::move(target->query);
  request.headers = headers_of(raw);
  request.body = std::move(raw.body());
  request.remote_address = peer.remote_address;
  request.local_address = peer.local_address;
  request.is_secure = is_secure;
  request.is_same_origin = is_same_origin(request.header("origin"), *host, is_secure);
  const bool has_origin = request.headers.contains("origin");
  if (request.method == "POST" && has_origin && !request.is_same_origin) {
    return tl::make_unexpected(
        error_answer(403, "rejected: the request comes from a page of another site", "open the dashboard at the address of the gateway"));
  }
  return request;
}

std::optional<HttpResponse> refuse_upgrade(const RawRequest& raw, const HttpRequest& request) {
  if (request.path != "/ws") return error_answer(404, "this path has no WebSocket", "connect to /ws");
  if (!request.is_same_origin)
    return error_answer(403, "rejected: the request comes from a page of another site", "open the dashboard at the address of the gateway");
  if (raw[http::field::sec_websocket_version] != "13") {
    auto response = error_answer(426, "unsupported version of WebSocket", "use version 13");
    response.headers.emplace_back("Sec-WebSocket-Version", "13");
    return response;
  }
  if (!is_websocket_key(text_of(raw[http::field::sec_websocket_key]))) {
    return error_answer(400, "no usable Sec-WebSocket-Key", "send 16 bytes in base64");
  }
  if (!http::token_list(raw[http::field::sec_websocket_protocol]).exists("dts.v1")) {
    return error_answer(400, "unsupported subprotocol", "request dts.v1");
  }
  return std::nullopt;
}

std::optional<HttpResponse> refuse_unreadable(const boost::system::error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    return error_answer(431, "the header is too large", "delete the cookies of this site in the browser");
  }
  if (error == http::error::body_limit) return error_answer(413, "the body is too large", "send less");
  if (error == http::error::bad_version) return error_answer(505, "unsupported version of HTTP", "use HTTP/1.1");
  const bool is_broken_off = error == http::error::end_of_stream || error == http::error::partial_message;
  if (is_broken_off || error.category() != http::make_error_code(http::error::bad_method).category()) return std::nullopt;
  return no_request("not HTTP");
}

}  // namespace dts::gateway
