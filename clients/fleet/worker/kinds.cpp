// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/utf8.h"
#include "session/figure.h"

namespace dts::fleet::worker {
namespace {

using nlohmann::json;

constexpr int kDeepest = 16;  ///< Levels of a document; ours have 5.
constexpr std::size_t kMostFigures = 10'000;
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kLongestUnit = 20;
constexpr std::size_t kLongestDetails = 4096;
constexpr std::size_t kLongestMessage = 500;

/// Results of a kind as an array of objects with name, value, unit and details, as in dtslab's "summary".
using Summary = json (*)(json& document);

json summary(json& document) { return std::move(document["summary"]); }

json replay_summary(json& document) {
  const json is_identical = document.value("is_identical", json());
  if (is_identical.is_null()) return json::array();  // nothing in the recording to compare with
  if (!is_identical.is_boolean()) return {};
  json figure{{"name", "replay/is_identical"}, {"value", is_identical.get<bool>() ? 1 : 0}, {"unit", "1"}};
  const json streams = document.value("streams", json::array());
  const auto differs = [](const json& stream) { return stream.is_object() && stream.contains("first_difference"); };
  if (const auto found = std::ranges::find_if(streams, differs); found != streams.end()) {
    figure["details"] = {{"stream", found->value("stream", json())}, {"first_difference", found->at("first_difference")}};
  }
  return json::array({figure});
}

struct Kind {
  std::string_view name;
  std::string_view words;  ///< Of dtslab; FILE is the recording.
  Summary summary;
};
constexpr std::array kKinds{
    Kind{"sway", "sway FILE --json", summary},
    Kind{"reach", "reach results FILE --json", summary},
    Kind{"replay", "replay FILE --json", replay_summary},
};

const Kind* kind_named(std::string_view name) {
  const auto* const found = std::ranges::find(kKinds, name, &Kind::name);
  return found == kKinds.end() ? nullptr : found;
}

/// A text of the database: PostgreSQL takes no zero byte.
bool is_text(const json& value, std::size_t longest) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return !text.empty() && text.size() <= longest && core::printable(text) == text;
}

/// Returns an empty text if the details are too long, or hold a zero byte.
std::string details_of(const json& figure) {
  const json details = figure.value("details", json());
  if (!details.is_object()) return {};
  std::string text = details.dump();
  return text.size() > kLongestDetails || text.find("\\u0000") != std::string::npos ? std::string() : text;
}

std::optional<Figure> figure_of(const json& figure, const std::string& suffix) {
  if (!figure.is_object()) return std::nullopt;
  const json name = figure.value("name", json());
  const json value = figure.value("value", json());
  const json unit = figure.value("unit", json());
  if (!is_text(name, kLongestName) || !is_text(unit, kLongestUnit) || !value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  if (!std::isfinite(number)) return std::nullopt;
  return Figure{.name = name.get<std::string>() + suffix, .value = number, .unit = unit.get<std::string>(), .details = details_of(figure)};
}

/// Returns whether no value lies deeper than `kDeepest`: some functions of the parser call themselves at each level. Its own callback would
/// report the depth, too, but then needs time with the square of an array's length.
bool is_shallow(std::string_view text) {
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (is_quoted && letter == '\\') ++at;  // skips what is escaped
    if (letter == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (letter == '[' || letter == '{') ++depth;
    if (letter == ']' || letter == '}') --depth;
    if (depth > kDeepest) return false;
  }
  return true;
}

core::ErrorCode code_named(const std::string& word) {
  for (int number = static_cast<int>(core::ErrorCode::Failed); number <= static_cast<int>(core::ErrorCode::Internal); ++number) {
    const auto code = static_cast<core::ErrorCode>(number);
    if (core::name(code) == word) return code;
  }
  return core::ErrorCode::Failed;
}

std::string short_text(const json& error, const char* key) {
  const json text = error.value(key, json());
  return text.is_string() ? core::printable(text.get_ref<const std::string&>().substr(0, kLongestMessage)) : std::string();
}

}  // namespace

std::vector<std::string_view> kind_names() {
  std::vector<std::string_view> names;
  for (const Kind& kind : kKinds) names.push_back(kind.name);
  return names;
}

std::optional<std::vector<std::string>> words_of(std::string_view kind, const std::string& file) {
  const Kind* const known = kind_named(kind);
  if (known == nullptr) return std::nullopt;
  std::vector<std::string> words;
  std::string_view rest = known->words;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    words.push_back(word == "FILE" ? file : std::string(word));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
  }
  return words;
}

core::Result<Figures> figures_of(std::string_view kind, const std::string& output, std::uint32_t part) {
  const Kind* const known = kind_named(kind);
  if (known == nullptr) return core::fail(core::ErrorCode::Unsupported, "unknown kind of job '" + std::string(kind) + "'");
  json document = is_shallow(output) ? json::parse(output, nullptr, false) : json();
  if (!document.is_object()) return core::fail(core::ErrorCode::DataDamaged, "dtslab printed no JSON document");
  if (const json error = document.value("error", json()); error.is_object()) {
    return Figures{.rejection = core::Error{.code = code_named(short_text(error, "code")),
                                            .what = short_text(error, "message"),
                                            .hint = short_text(error, "hint")}};
  }
  const json list = known->summary(document);
  if (!list.is_array()) return core::fail(core::ErrorCode::DataDamaged, "dtslab printed a document without results");
  Figures figures;
  std::set<std::string> names;
  for (const json& item : list) {
    auto figure = names.size() < kMostFigures ? figure_of(item, session::part_suffix(part)) : std::nullopt;
    if (figure && names.insert(figure->name).second) {
      figures.all.push_back(*std::move(figure));
    } else {
      ++figures.skipped;
    }
  }
  return figures;
}

}  // namespace dts::fleet::worker
