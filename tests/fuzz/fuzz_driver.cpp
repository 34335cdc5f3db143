// SPDX-License-Identifier: Apache-2.0
// Runs the fuzz targets without libFuzzer: fuzz_driver TARGET FOLDER COUNT KEPT runs every file of the folder, and COUNT changed versions
// of each, the same ones every time. Then every file of the folder KEPT, if there is one: what scripts/fuzz --keep has found.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "fuzz/fuzz_support.h"

namespace dts::fuzz {
namespace {

std::map<std::string, TryBytes>& targets() {
  static std::map<std::string, TryBytes> all;
  return all;
}

/// One change of the kinds that find mistakes in parsers of lengths and counts.
void change(std::string& bytes, std::mt19937& random) {
  constexpr std::array<unsigned char, 8> kSpecial = {0x00, 0x01, 0x04, 0x08, 0x7F, 0x80, 0xFE, 0xFF};
  if (bytes.empty()) bytes = "X";
  const std::size_t at = random() % bytes.size();
  const std::size_t length = std::min<std::size_t>(1 + random() % 16, bytes.size() - at);
  switch (random() % 6) {
    case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1U << (random() % 8))); break;
    case 1: bytes[at] = static_cast<char>(kSpecial[random() % kSpecial.size()]); break;
    case 2: bytes.replace(at, length, std::string(length, static_cast<char>(kSpecial[random() % kSpecial.size()]))); break;
    case 3: bytes.erase(at, length); break;
    case 4: bytes.insert(random() % bytes.size(), bytes.substr(at, length)); break;
    default: bytes.resize(at); break;
  }
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);  // the same order everywhere: the changes are drawn in it
  return files;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

int run_target(TryBytes try_bytes, const std::filesystem::path& folder, long versions, const std::filesystem::path& kept_folder) {
  const auto run = [try_bytes](const std::string& bytes) { try_bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()); };
  const auto files = files_of(folder);
  std::mt19937 random(7);
  for (const auto& file : files) {
    const std::string bytes = content_of(file);
    run(bytes);
    for (long version = 0; version < versions; ++version) {
      std::string changed = bytes;
      const auto changes = 1 + random() % 3;
      for (std::size_t number = 0; number < changes; ++number) change(changed, random);
      run(changed);
    }
  }
  const auto kept = std::filesystem::is_directory(kept_folder) ? files_of(kept_folder) : std::vector<std::filesystem::path>{};
  for (const auto& file : kept) run(content_of(file));
  std::printf("%zu files, %ld changed versions of each, %zu kept files\n", files.size(), versions, kept.size());
  return files.empty() ? 1 : 0;
}

}  // namespace

void add_target(const char* name, TryBytes try_bytes) { targets()[name] = try_bytes; }

}  // namespace dts::fuzz

int main(int count, char** arguments) {
  using dts::fuzz::targets;
  if (count != 5 || !targets().contains(arguments[1])) return 2;
  return dts::fuzz::run_target(targets().at(arguments[1]), arguments[2], std::strtol(arguments[3], nullptr, 10), arguments[4]);
}
