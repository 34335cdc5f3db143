// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace dts::physics::test {

/// Fixtures of the development data; they are not part of the project.
inline std::filesystem::path reference_folder() {
  return std::filesystem::path(DTS_SOURCE_DIR).parent_path() / "shared" / "data" / "reach" / "reference";
}

/// Cells of a CSV file by column; lines that begin with # are comments. Empty when there is no such file.
inline std::vector<std::map<std::string, std::string>> reference_rows(const std::string& name) {
  std::ifstream file(reference_folder() / name);
  std::vector<std::map<std::string, std::string>> rows;
  std::vector<std::string> header;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    if (header.empty()) {
      header = row;
      continue;
    }
    auto& named = rows.emplace_back();
    for (std::size_t i = 0; i < row.size() && i < header.size(); ++i) named[header[i]] = row[i];
  }
  return rows;
}

inline double number(const std::map<std::string, std::string>& row, const std::string& column) { return std::stod(row.at(column)); }

}  // namespace dts::physics::test
