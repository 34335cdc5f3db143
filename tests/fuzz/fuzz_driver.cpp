// SPDX-License-Identifier: Apache-2.0
// Stands in for libFuzzer where there is none: FUZZ_TARGET FOLDER COUNT runs every file of the folder, and COUNT changed versions of each,
// the same ones every time.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

namespace {

void run(const std::string& bytes) { LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()); }

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

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  const auto files = files_of(arguments[1]);
  const long versions = std::strtol(arguments[2], nullptr, 10);
  std::mt19937 random(7);
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    run(bytes);
    for (long version = 0; version < versions; ++version) {
      std::string changed = bytes;
      const auto changes = 1 + random() % 3;
      for (std::size_t number = 0; number < changes; ++number) change(changed, random);
      run(changed);
    }
  }
  std::printf("%zu files, %ld changed versions of each\n", files.size(), versions);
  return files.empty() ? 1 : 0;
}
