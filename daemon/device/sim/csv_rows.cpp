// SPDX-License-Identifier: Apache-2.0
#include "device/sim/csv_rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

namespace dts::device::sim {
namespace {

using core::ErrorCode;

/// Reads a line into `row`: exactly as many finite numbers as `row` has, separated by commas. Returns false for any other line.
bool parse_row(std::string_view line, std::span<double> row) {
  for (std::size_t column = 0; column < row.size(); ++column) {
    const bool is_last = column + 1 == row.size();
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != is_last) return false;
    const std::string_view cell = line.substr(0, comma);
    const auto [stopped_at, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row[column]);
    if (error != std::errc{} || stopped_at != cell.data() + cell.size() || !std::isfinite(row[column])) return false;
    if (!is_last) line.remove_prefix(comma + 1);
  }
  return true;
}

core::Status check_file(const std::string& path, const CsvForm& form) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return core::fail(ErrorCode::NotFound, std::string(form.subject) + " " + path + ": no such file",
                      "write the path relative to the daemon's folder, or from /");
  }
  const std::uintmax_t most_bytes = kMaxCsvLineLength * (form.max_rows + 1);
  if (std::filesystem::file_size(path, error) > most_bytes || error) return refuse_row(form, path, "too large");
  return {};
}

void remove_carriage_return(std::string& line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
}

}  // namespace

tl::unexpected<core::Error> refuse_row(const CsvForm& form, const std::string& place, const std::string& why) {
  return core::fail(ErrorCode::InvalidArgument, place + ": " + why, std::string(form.hint));
}

core::Status read_csv(const std::string& path, const CsvForm& form,
                      const std::function<core::Status(std::span<const double> row, const std::string& place)>& add_row) {
  DTS_TRY(check_file(path, form));
  std::ifstream file(path, std::ios::binary);
  if (!file) return core::fail(ErrorCode::Failed, std::string(form.subject) + " " + path + ": cannot be read");
  std::string line;
  std::getline(file, line);
  remove_carriage_return(line);
  if (line != form.header) return refuse_row(form, path + ":1", "the header is \"" + line.substr(0, kMaxCsvLineLength) + "\"");

  std::vector<double> row(1 + static_cast<std::size_t>(std::ranges::count(form.header, ',')));
  std::size_t rows = 0;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    remove_carriage_return(line);
    const std::string place = path + ":" + std::to_string(number);
    if (line.size() > kMaxCsvLineLength) {
      return refuse_row(form, place, "longer than " + std::to_string(kMaxCsvLineLength) + " characters");
    }
    if (!parse_row(line, row)) return refuse_row(form, place, "\"" + line + "\" is not " + std::to_string(row.size()) + " numbers");
    if (++rows > form.max_rows) return refuse_row(form, place, "more than " + std::to_string(form.max_rows) + " rows");
    DTS_TRY(add_row(row, place));
  }
  if (rows < form.min_rows) return refuse_row(form, path, "too few rows, at least " + std::to_string(form.min_rows) + " needed");
  return {};
}

}  // namespace dts::device::sim
