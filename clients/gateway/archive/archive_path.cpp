// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/archive_path.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <vector>

namespace dts::gateway {
namespace {

constexpr std::string_view kBegin = "/api/sessions/";
constexpr std::size_t kLongestPageName = 128;

bool is_name(std::string_view text) noexcept {
  return !text.empty() && text.size() <= kLongestPageName && text.front() != '.' && std::ranges::all_of(text, [](char letter) {
    const bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9');
    return is_letter || letter == '.' || letter == '_' || letter == '-';
  });
}

std::vector<std::string_view> steps_of(std::string_view path) {
  std::vector<std::string_view> steps;
  while (true) {
    const std::size_t end = path.find('/');
    steps.push_back(path.substr(0, end));
    if (end == std::string_view::npos) return steps;
    path.remove_prefix(end + 1);
  }
}

std::uint32_t number_of(std::string_view text) noexcept {
  std::uint32_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  return failed == std::errc() && end == text.data() + text.size() ? number : 0;
}

}  // namespace

std::optional<ArchivePath> read_archive_path(std::string_view path) {
  if (!path.starts_with(kBegin)) return std::nullopt;
  const auto steps = steps_of(path.substr(kBegin.size()));
  if (steps.size() < 2 || !std::ranges::all_of(steps, is_name)) return std::nullopt;
  ArchivePath asked{.session_id = std::string(steps[0])};
  if (steps[1] == "report" || steps[1] == "report-de") {
    if (steps[1] == "report-de") asked.language = report::Language::German;
    if (steps.size() == 2) return asked;
    asked.kind = ArchivePath::Kind::Page;
    asked.page = steps[2];
    return steps.size() == 3 ? std::optional(asked) : std::nullopt;
  }
  if (steps[1] != "export" || steps.size() < 3) return std::nullopt;
  if (steps[2] == "xdf" && steps.size() == 4) {
    asked.kind = ArchivePath::Kind::Recording;
    asked.part = number_of(steps[3]);
    return asked.part > 0 ? std::optional(asked) : std::nullopt;
  }
  if (steps.size() != 3) return std::nullopt;
  constexpr std::array kFormats{std::pair{"csv", ArchivePath::Kind::Csv}, std::pair{"bids", ArchivePath::Kind::Bids},
                                std::pair{"c3d", ArchivePath::Kind::C3d}, std::pair{"fhir", ArchivePath::Kind::Fhir}};
  const auto format = std::ranges::find(kFormats, steps[2], [](const auto& one) { return std::string_view(one.first); });
  if (format == kFormats.end()) return std::nullopt;
  asked.kind = format->second;
  return asked;
}

}  // namespace dts::gateway
