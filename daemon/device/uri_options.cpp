// SPDX-License-Identifier: Apache-2.0
#include "device/uri_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/join.h"
#include "core/suggest.h"

namespace dts::device {
namespace {

using core::ErrorCode;

constexpr std::size_t kMostNumbers = 256;

std::optional<double> parse_number(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped_at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Accepts any text that is not empty.
bool is_free_text(const UriOption& option) { return option.kind == OptionKind::File || option.kind == OptionKind::Text; }

bool is_choice(std::string_view choices, std::string_view word) {
  if (word.empty() || word.find('|') != std::string_view::npos) return false;
  return ("|" + std::string(choices) + "|").find("|" + std::string(word) + "|") != std::string::npos;
}

std::vector<std::string_view> split_choices(std::string_view choices) {
  std::vector<std::string_view> words;
  while (!choices.empty()) {
    const std::size_t bar = std::min(choices.find('|'), choices.size());
    words.push_back(choices.substr(0, bar));
    choices.remove_prefix(std::min(bar + 1, choices.size()));
  }
  return words;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> known) {
  const std::string meant = core::suggest(word, known);
  return meant.empty() ? "" : "did you mean \"" + meant + "\"?";
}

/// Returns the error text for one option.
struct Mistake {
  std::string what;
  std::string hint;
};

/// Returns all mistakes as one error, so that the user corrects the URI only once.
tl::unexpected<core::Error> refuse(const DeviceUri& uri, std::span<const Mistake> mistakes) {
  std::string what = "device \"" + uri.text + "\": ";
  std::string hint;
  for (const Mistake& mistake : mistakes) {
    what += (&mistake == &mistakes.front() ? "" : "; ") + mistake.what;
    hint += (hint.empty() || mistake.hint.empty() ? "" : "; ") + mistake.hint;
  }
  return core::fail(ErrorCode::InvalidArgument, what, std::move(hint));
}

std::vector<Mistake> unknown_names(const DeviceUri& uri, std::span<const UriOption> known) {
  std::vector<Mistake> mistakes;
  std::vector<std::string_view> names;
  for (const UriOption& option : known) names.push_back(option.name);
  for (const auto& [name, value] : uri.options) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    mistakes.push_back({"unknown option \"" + name + "\"", did_you_mean(name, names)});
  }
  if (!mistakes.empty()) mistakes.back().hint += (mistakes.back().hint.empty() ? "Known: " : " Known: ") + core::join(names);
  return mistakes;
}

std::string not_allowed(const UriOption& option, const std::string& value) {
  return std::string(option.name) + " = \"" + value + "\" is not allowed; allowed: " + allowed(option);
}

}  // namespace

core::Result<UriOptions> UriOptions::read(const DeviceUri& uri, std::span<const UriOption> known) {
  std::vector<Mistake> mistakes = unknown_names(uri, known);
  UriOptions options;
  for (const UriOption& option : known) {
    const auto given = uri.options.find(std::string(option.name));
    const bool is_given = given != uri.options.end();
    if (is_given) options.given_.emplace(option.name);
    const std::string value = is_given ? given->second : std::string(option.default_text);
    if (!is_given && option.kind == OptionKind::Numbers) continue;
    if (!is_given && is_free_text(option)) {
      options.texts_.emplace(option.name, value);
      continue;
    }
    if (options.set(option, value)) continue;
    std::string hint;
    if (option.kind == OptionKind::Word) hint = did_you_mean(value, split_choices(option.choices));
    if (option.kind == OptionKind::Numbers) hint = "write numbers separated by commas, at most " + std::to_string(kMostNumbers);
    mistakes.push_back({not_allowed(option, value), std::move(hint)});
  }
  if (!mistakes.empty()) return refuse(uri, mistakes);
  return options;
}

bool UriOptions::set(const UriOption& option, const std::string& value) {
  if (is_free_text(option) || option.kind == OptionKind::Word) {
    if (is_free_text(option) ? value.empty() : !is_choice(option.choices, value)) return false;
    texts_.emplace(option.name, value);
    return true;
  }
  if (option.kind == OptionKind::Numbers) return set_list(option, value);
  if (option.maximum == kNever && value == "never") {
    numbers_.emplace(option.name, kNever);
    return true;
  }
  const std::optional<double> number = parse_number(value);
  const bool is_fine = number && *number >= option.minimum && *number <= option.maximum &&
                       (option.kind == OptionKind::Number || *number == std::floor(*number));
  if (is_fine) numbers_.emplace(option.name, *number);
  return is_fine;
}

bool UriOptions::set_list(const UriOption& option, const std::string& value) {
  std::vector<double> list;
  std::istringstream items(value + ",");
  for (std::string item; std::getline(items, item, ',');) {
    const std::optional<double> number = parse_number(item);
    const bool is_fine = number && *number >= option.minimum && *number <= option.maximum && list.size() < kMostNumbers;
    if (!is_fine) return false;
    list.push_back(*number);
  }
  lists_.emplace(option.name, std::move(list));
  return true;
}

std::string allowed(const UriOption& option) {
  if (option.kind == OptionKind::File) return "FILE";
  if (option.kind == OptionKind::Text) return "TEXT";
  if (option.kind == OptionKind::Word) return std::string(option.choices);
  std::ostringstream text;
  text.precision(12);
  text << option.minimum << "..";
  if (option.maximum == kNever) {
    text << " or never";
  } else {
    text << option.maximum;
  }
  if (option.kind == OptionKind::Integer) text << " (whole number)";
  if (option.kind == OptionKind::Numbers) text << ",...";
  return text.str();
}

std::string describe_options(std::span<const UriOption> options) {
  std::ostringstream text;
  for (const UriOption& option : options) {
    text << "  " << option.name << '=' << allowed(option);
    if (!option.default_text.empty()) text << "  [" << option.default_text << ']';
    text << "\n      " << option.sentence << '\n';
  }
  return text.str();
}

}  // namespace dts::device
