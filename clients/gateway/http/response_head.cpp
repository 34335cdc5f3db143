// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/response_head.h"

#include <algorithm>
#include <array>
#include <boost/beast/http/status.hpp>
#include <string_view>

namespace dts::gateway {
namespace {

struct Header {
  std::string_view name;
  std::string_view value;
};

/// A page may load from this gateway only, connect to it only, must not be shown in a frame of a foreign page, and cannot use device
/// features: OWASP's list of such headers. 'self' in "connect-src" includes ws: and wss: (CSP level 3, 6.7.2.8).
constexpr std::array kSecurityHeaders{
    Header{"Content-Security-Policy",
           "default-src 'self'; connect-src 'self'; frame-ancestors 'self'; base-uri 'none'; form-action 'self'; object-src 'none'"},
    Header{"X-Content-Type-Options", "nosniff"},
    Header{"Referrer-Policy", "no-referrer"},
    Header{"Cross-Origin-Opener-Policy", "same-origin"},
    Header{"Cross-Origin-Resource-Policy", "same-origin"},
    Header{"Permissions-Policy", "camera=(), geolocation=(), microphone=(), payment=(), usb=()"},
};
constexpr Header kOneYearOfTls{"Strict-Transport-Security", "max-age=31536000"};
constexpr Header kNotKept{"Cache-Control", "no-store"};

bool is_same_name(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return (x | 0x20) == (y | 0x20); });
}

bool is_line(std::string_view text) noexcept {
  return std::none_of(text.begin(), text.end(), [](char c) { return c == '\r' || c == '\n' || c == '\0'; });
}

bool sets(const HttpResponse& response, std::string_view name) {
  return std::any_of(response.headers.begin(), response.headers.end(),
                     [&](const auto& header) { return is_same_name(header.first, name); });
}

/// Returns true for headers that only the transport sets: the length of the answer and the life of the connection.
bool is_ours_to_say(std::string_view name) noexcept {
  return is_same_name(name, "Content-Length") || is_same_name(name, "Transfer-Encoding") || is_same_name(name, "Connection");
}

void add(std::string& head, std::string_view name, std::string_view value) {
  if (!is_line(name) || !is_line(value)) return;
  head.append(name).append(": ").append(value).append("\r\n");
}

}  // namespace

bool may_have_body(unsigned status) noexcept { return status >= 200 && status != 204 && status != 304; }

std::string response_head(const HttpResponse& response, const AnswerFrame& frame) {
  const auto reason = boost::beast::http::obsolete_reason(static_cast<boost::beast::http::status>(response.status));
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + ' ' + std::string(reason.data(), reason.size()) + "\r\n";
  add(head, "Connection", frame.keeps_alive ? "keep-alive" : "close");
  if (may_have_body(response.status)) {
    add(head, "Content-Length", std::to_string(frame.body_bytes));
    if (!response.content_type.empty()) add(head, "Content-Type", response.content_type);
  }
  for (const auto& [name, value] : response.headers) {
    if (!is_ours_to_say(name)) add(head, name, value);
  }
  for (const Header& header : kSecurityHeaders) {
    if (!sets(response, header.name)) add(head, header.name, header.value);
  }
  if (frame.is_secure && !sets(response, kOneYearOfTls.name)) add(head, kOneYearOfTls.name, kOneYearOfTls.value);
  if (frame.path.starts_with("/api/") && !sets(response, kNotKept.name)) add(head, kNotKept.name, kNotKept.value);
  return head + "\r\n";
}

}  // namespace dts::gateway
