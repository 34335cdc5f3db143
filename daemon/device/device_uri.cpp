// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "device/device_uri.h"

namespace dts::device {
namespace {

using core::ErrorCode;

constexpr std::size_t kMaxLength = 4096;
constexpr std::string_view kForm = "write a device as scheme:name?key=value&key=value, for example sim:floor?seed=7";

bool is_word(std::string_view text) noexcept {
  const auto is_word_character = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), is_word_character);
}

bool has_control_character(std::string_view text) noexcept {
  return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

tl::unexpected<core::Error> refuse(std::string_view uri, const std::string& why) {
  return core::fail(ErrorCode::InvalidArgument, "device \"" + std::string(uri) + "\": " + why, std::string(kForm));
}

core::Status add_option(DeviceUri& uri, std::string_view pair) {
  const std::size_t equals = pair.find('=');
  const std::string_view key = pair.substr(0, equals);
  if (equals == std::string_view::npos || !is_word(key)) {
    return refuse(uri.text, "\"" + std::string(pair) + "\" is not an option of the form key=value");
  }
  const bool is_new = uri.options.emplace(key, pair.substr(equals + 1)).second;
  if (!is_new) return refuse(uri.text, "option \"" + std::string(key) + "\" is given twice");
  return {};
}

}  // namespace

core::Result<DeviceUri> DeviceUri::parse(std::string_view text) {
  if (text.size() > kMaxLength) return refuse(text.substr(0, 60), "longer than " + std::to_string(kMaxLength) + " characters");
  if (has_control_character(text)) {
    return core::fail(ErrorCode::InvalidArgument, "device URI: contains a control character", std::string(kForm));
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return refuse(text, "has no scheme");
  DeviceUri uri;
  uri.text = text;
  uri.scheme = text.substr(0, colon);
  if (!is_word(uri.scheme)) return refuse(text, "the scheme \"" + uri.scheme + "\" must have letters, digits, _ and - only");
  const std::string_view rest = text.substr(colon + 1);
  const std::size_t question = rest.find('?');
  uri.name = rest.substr(0, question);
  if (question == std::string_view::npos) return uri;

  std::string_view options = rest.substr(question + 1);
  while (true) {
    const std::size_t end = options.find('&');
    DTS_TRY(add_option(uri, options.substr(0, end)));
    if (end == std::string_view::npos) return uri;
    options.remove_prefix(end + 1);
  }
}

}  // namespace dts::device
