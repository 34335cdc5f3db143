// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/host_check.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <charconv>
#include <utility>

namespace dts::gateway {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& letter : lower) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return lower;
}

bool is_host_character(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_'; }

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port == 0) return std::nullopt;
  return port;
}

/// Returns the address in a host text, if it is one: "::1" for "[::1]".
std::optional<boost::asio::ip::address> address_of(std::string_view host) {
  const bool has_brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (has_brackets) host = host.substr(1, host.size() - 2);
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(std::string(host), error);
  if (error || address.is_v6() != has_brackets) return std::nullopt;
  return address;
}

}  // namespace

std::optional<Authority> parse_authority(std::string_view text) {
  Authority authority;
  const std::size_t host_end = text.starts_with('[') ? text.find(']') : text.find(':');
  if (text.starts_with('[') && host_end == std::string_view::npos) return std::nullopt;
  const std::size_t length = text.starts_with('[') ? host_end + 1 : std::min(host_end, text.size());
  authority.host = lower_case(text.substr(0, length));
  if (authority.host.empty()) return std::nullopt;
  if (authority.host.front() == '[') {
    if (!address_of(authority.host)) return std::nullopt;
  } else if (!std::all_of(authority.host.begin(), authority.host.end(), is_host_character)) {
    return std::nullopt;
  }
  if (length == text.size()) return authority;
  if (text[length] != ':') return std::nullopt;
  authority.port = parse_port(text.substr(length + 1));
  return authority.port ? std::optional(authority) : std::nullopt;
}

HostCheck::HostCheck(std::vector<std::string> host_names, bool is_loopback) : names_(std::move(host_names)) {
  for (std::string& name : names_) name = lower_case(name);
  if (is_loopback) names_.emplace_back("localhost");
}

bool HostCheck::is_ours(const Authority& host, std::string_view local_address) const {
  if (std::find(names_.begin(), names_.end(), host.host) != names_.end()) return true;
  boost::system::error_code error;
  const auto local = boost::asio::ip::make_address(std::string(local_address), error);
  return !error && address_of(host.host) == local;
}

bool is_same_origin(std::string_view origin, const Authority& host, bool is_secure) {
  const std::string_view scheme = is_secure ? "https://" : "http://";
  if (!origin.starts_with(scheme)) return false;
  const auto from = parse_authority(origin.substr(scheme.size()));
  const std::uint16_t usual_port = is_secure ? 443 : 80;
  return from && from->host == host.host && from->port.value_or(usual_port) == host.port.value_or(usual_port);
}

}  // namespace dts::gateway
