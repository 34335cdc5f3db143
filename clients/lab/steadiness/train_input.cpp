// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/train_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

#include "lab/base/command.h"
#include "lab/steadiness/rig_noise.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;

constexpr std::size_t kMostRows = 100'000;
constexpr std::size_t kMostWords = 20;  // different words of one fact
constexpr const char* kNoFacts = "none";
/// What is known about a person without a plate, so a label must be distinguished better than by these.
constexpr std::array kUsualFacts{"age", "height_cm", "sex"};

/// One `--where`: the column must have one of the values.
struct Where {
  std::string column;
  std::set<std::string> values;
};

core::Result<std::vector<Where>> read_where(const std::vector<std::string>& texts) {
  std::vector<Where> all;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size()) {
      return core::fail(core::ErrorCode::InvalidArgument, "--where '" + text + "' is not COLUMN=VALUE",
                        "write for example --where condition=ec_firm");
    }
    const std::string column = text.substr(0, sign);
    auto found = std::ranges::find(all, column, &Where::column);
    if (found == all.end()) found = all.insert(all.end(), Where{.column = column, .values = {}});
    for (std::size_t begin = sign + 1; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      if (end > begin) found->values.insert(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return all;
}

std::vector<std::string> columns_to_read(const std::vector<Where>& where, const std::vector<std::string>& against) {
  std::vector<std::string> columns = against;
  if (against.empty()) columns.assign(kUsualFacts.begin(), kUsualFacts.end());
  std::erase(columns, kNoFacts);
  for (const Where& one : where) columns.push_back(one.column);
  return columns;
}

bool is_in_every_row(Measure measure, const std::vector<SteadinessRow>& rows) {
  return std::ranges::all_of(rows, [&](const SteadinessRow& row) { return row.measures.has(measure); });
}

/// Returns the requested measures; without a request, the core measures that every row has.
core::Result<std::vector<Measure>> measures_of(const std::vector<std::string>& symbols, const std::vector<SteadinessRow>& rows) {
  std::vector<Measure> measures;
  for (const std::string& symbol : symbols) {
    const auto measure = posturography::measure_named(symbol);
    if (!measure)
      return core::fail(core::ErrorCode::InvalidArgument, "unknown measure '" + symbol + "'",
                        "write symbols such as MVELO,PEA95_F; dtslab sway --help lists them");
    const auto missing = std::ranges::find_if(rows, [&](const SteadinessRow& row) { return !row.measures.has(*measure); });
    if (missing != rows.end()) {
      return core::fail(core::ErrorCode::InvalidArgument, symbol + " is missing in line " + std::to_string(missing->line),
                        "choose another measure, or remove the row");
    }
    if (std::ranges::find(measures, *measure) == measures.end()) measures.push_back(*measure);
  }
  if (!symbols.empty()) return measures;
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto measure = static_cast<Measure>(k);
    if (posturography::info(measure).is_core && is_in_every_row(measure, rows)) measures.push_back(measure);
  }
  if (!measures.empty()) return measures;
  return core::fail(core::ErrorCode::InvalidArgument, "no core measure is present in every row",
                    "choose measures with --measures, or use longer trials");
}

core::Status check_where(const std::vector<Where>& where, const std::vector<SteadinessRow>& rows, const std::string& table) {
  for (const Where& one : where) {
    if (!rows.empty() && !rows.front().facts.contains(one.column))
      return core::fail(core::ErrorCode::InvalidArgument, table + " has no column '" + one.column + "'",
                        "choose another column with --where");
  }
  return {};
}

/// Keeps the usable rows. Counts the others by label and reports them.
void keep_usable(TrainInput& input, const std::vector<Where>& where, const std::string& label, cli::Console& console) {
  auto& rows = input.rows;
  std::erase_if(rows, [&](const SteadinessRow& row) {
    return !std::ranges::all_of(where, [&](const Where& one) { return one.values.contains(row.facts.at(one.column)); });
  });
  const std::size_t nameless = std::erase_if(rows, [](const SteadinessRow& row) { return row.label.empty(); });
  const std::size_t invalid = std::erase_if(rows, [&](const SteadinessRow& row) {
    if (!row.is_valid) ++input.moved[row.label];
    return !row.is_valid;
  });
  const std::size_t empty = std::erase_if(rows, [](const SteadinessRow& row) { return row.measures.count() == 0; });
  if (invalid > 0) warn(console, std::to_string(invalid) + " rows left out: the subject stepped off or moved the feet");
  if (nameless > 0) warn(console, std::to_string(nameless) + " rows left out: empty cell in column '" + label + "'");
  if (empty > 0) warn(console, std::to_string(empty) + " rows left out: they have no measures");
}

std::optional<double> number_of(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_number = !text.empty() && end == text.c_str() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

/// Returns a fact as columns of numbers: as it is if every cell is a number, else one column of 0 and 1 for each word but the first.
core::Result<Rival> rival_of(const std::string& fact, const std::vector<SteadinessRow>& rows) {
  Rival rival{.name = fact, .columns = {{}}};
  std::set<std::string> words;
  for (const SteadinessRow& row : rows) {
    const std::string& cell = row.facts.at(fact);
    if (cell.empty())
      return core::fail(core::ErrorCode::InvalidArgument, "'" + fact + "' is empty in line " + std::to_string(row.line),
                        "choose other columns with --against, or remove the row");
    words.insert(cell);
    if (const auto number = number_of(cell)) rival.columns.front().push_back(*number);
  }
  if (rival.columns.front().size() == rows.size()) return rival;
  if (words.size() > kMostWords)
    return core::fail(core::ErrorCode::InvalidArgument, "'" + fact + "' has more than " + std::to_string(kMostWords) + " different words",
                      "choose other columns with --against");
  rival.columns.clear();
  for (auto word = std::next(words.begin()); word != words.end(); ++word) {
    auto& column = rival.columns.emplace_back();
    for (const SteadinessRow& row : rows) column.push_back(row.facts.at(fact) == *word ? 1.0 : 0.0);
  }
  return rival;
}

core::Result<std::vector<Rival>> rivals_of(const TrainArguments& arguments, const std::vector<SteadinessRow>& rows) {
  std::vector<Rival> rivals;
  const bool is_asked = !arguments.against.empty();
  for (const std::string& fact : columns_to_read({}, arguments.against)) {
    if (fact == arguments.label) continue;
    if (!rows.front().facts.contains(fact)) {
      if (!is_asked) continue;
      return core::fail(core::ErrorCode::InvalidArgument, arguments.table + " has no column '" + fact + "'",
                        "choose other columns with --against");
    }
    DTS_TRY_ASSIGN(auto rival, rival_of(fact, rows));
    if (!rival.columns.empty()) rivals.push_back(std::move(rival));
  }
  return rivals;
}

/// Replaces the measures by those that a rig with this noise would have measured.
core::Status add_noise(const TrainArguments& arguments, TrainInput& input, cli::Console& console) {
  for (SteadinessRow& row : input.rows) {
    const auto profile = posturography::profile_named(row.profile);
    if (!profile || !(row.rate_hz > 0.0))
      return core::fail(core::ErrorCode::InvalidArgument, "line " + std::to_string(row.line) + " has no profile or no rate",
                        "make the table with dtslab sway --table");
    const RigNoise noise(arguments.noise_mm, arguments.noise_hz > 0.0 ? arguments.noise_hz : row.rate_hz, row.rate_hz, *profile);
    row.measures = noise.added_to(row.measures);
  }
  std::string left_out;
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto measure = static_cast<Measure>(k);
    const auto& about = posturography::info(measure);
    if (about.is_core && !RigNoise::is_known_for(measure)) left_out += (left_out.empty() ? "" : ", ") + std::string(about.symbol);
  }
  warn(console, "left out, because the effect of noise on them is not known: " + left_out);
  return {};
}

}  // namespace

core::Result<TrainInput> read_train_input(const TrainArguments& arguments, cli::Console& console, files::Problems& problems) {
  DTS_TRY_ASSIGN(const auto where, read_where(arguments.where));
  TrainInput input;
  input.rows = read_rows(arguments.table, arguments.label, columns_to_read(where, arguments.against), problems);
  if (!problems.empty()) return input;
  DTS_TRY(check_where(where, input.rows, arguments.table));
  keep_usable(input, where, arguments.label, console);
  if (input.rows.empty()) return core::fail(core::ErrorCode::InvalidArgument, arguments.table + " has no usable row", "give another table");
  if (input.rows.size() > kMostRows)
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostRows) + " rows", "use fewer rows");
  if (arguments.noise_mm > 0.0) DTS_TRY(add_noise(arguments, input, console));
  DTS_TRY_ASSIGN(input.samples.measures, measures_of(arguments.measures, input.rows));
  for (const SteadinessRow& row : input.rows) {
    input.samples.values.push_back(row.measures);
    input.samples.labels.push_back(row.label);
    input.samples.subjects.push_back(row.subject);
  }
  DTS_TRY_ASSIGN(input.rivals, rivals_of(arguments, input.rows));
  return input;
}

}  // namespace dts::lab::steadiness
