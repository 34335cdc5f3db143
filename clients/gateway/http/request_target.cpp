// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/request_target.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/utf8.h"

namespace dts::gateway {
namespace {

int hex_value(char digit) noexcept {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  return -1;
}

bool has_control_character(std::string_view text) noexcept {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

bool is_harmless_path(std::string_view path) noexcept {
  if (path.empty() || path.front() != '/' || !core::is_utf8(path) || has_control_character(path)) return false;
  if (path.find('\\') != std::string_view::npos) return false;
  for (std::size_t at = 0; at != std::string_view::npos;) {
    const std::size_t end = path.find('/', at + 1);
    const auto segment = path.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
    if (segment == "." || segment == "..") return false;
    at = end;
  }
  return true;
}

std::optional<std::map<std::string, std::string>> parse_query(std::string_view text) {
  std::map<std::string, std::string> query;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    if (pair.empty()) continue;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    auto key = percent_decoded(pair.substr(0, equals), true);
    auto value = percent_decoded(pair.substr(std::min(pair.size(), equals + 1)), true);
    if (!key || !value || !core::is_utf8(*key) || !core::is_utf8(*value)) return std::nullopt;
    if (has_control_character(*key) || has_control_character(*value)) return std::nullopt;
    if (!query.emplace(std::move(*key), std::move(*value)).second) return std::nullopt;
  }
  return query;
}

}  // namespace

std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_space) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '%') {
      decoded.push_back(plus_is_space && text[at] == '+' ? ' ' : text[at]);
      continue;
    }
    if (text.size() - at < 3) return std::nullopt;
    const int high = hex_value(text[at + 1]);
    const int low = hex_value(text[at + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    decoded.push_back(static_cast<char>(high * 16 + low));
    at += 2;
  }
  return decoded;
}

std::optional<RequestTarget> parse_target(std::string_view target) {
  if (target.empty() || target.front() != '/' || target.find('#') != std::string_view::npos) return std::nullopt;
  const std::size_t mark = target.find('?');
  auto path = percent_decoded(target.substr(0, mark));
  if (!path || !is_harmless_path(*path)) return std::nullopt;
  auto query = parse_query(mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1));
  if (!query) return std::nullopt;
  return RequestTarget{.path = std::move(*path), .query = std::move(*query)};
}

}  // namespace dts::gateway
