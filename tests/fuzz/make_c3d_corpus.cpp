// SPDX-License-Identifier: Apache-2.0
// make_c3d_corpus FOLDER writes the seeds of the C3D fuzzer: small files, synthetic, one for each type of plate and each encoding.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/made_c3d.h"

namespace {

namespace fs = std::filesystem;
using dts::test::MadeC3d;
using dts::test::MadeEncoding;

void add_common(MadeC3d& made, int channels) {
  made.channels = channels;
  made.group("POINT");
  made.words("USED", {}, {0});
  made.reals("RATE", {}, {100});
  made.text("UNITS", "mm");
  made.group("ANALOG");
  made.words("USED", {}, {channels});
  made.reals("GEN_SCALE", {}, {1});
  made.reals("SCALE", {channels}, std::vector<double>(static_cast<std::size_t>(channels), 0.5));
  made.words("OFFSET", {channels}, std::vector<int>(static_cast<std::size_t>(channels), 0));
}

std::string plate_of_type(int type, MadeEncoding encoding, bool is_real) {
  MadeC3d made(encoding, is_real);
  const int channels = type == 3 ? 8 : 6;
  add_common(made, channels);
  std::vector<int> numbers;
  for (int k = 1; k <= channels; ++k) numbers.push_back(k);
  std::vector<double> matrix(type == 4 ? 36 : 0, 0.0);
  for (std::size_t k = 0; k < matrix.size(); k += 7) matrix[k] = 1.0;
  made.plates({{.type = type, .origin = {type == 3 ? 120.0 : 1.0, type == 3 ? 200.0 : 2.0, 48.0}, .channels = numbers, .matrix = matrix}},
              {1, 2});
  for (int frame = 0; frame < 4; ++frame) {
    std::vector<double> sample{10, -20, -1400, 100, 200, 30};
    if (type == 3) sample = {10, 14, -8, -12, 400, 360, 300, 340};
    made.frame(sample);
  }
  return made.bytes();
}

std::string with_events() {
  MadeC3d made;
  add_common(made, 6);
  made.group("EVENT");
  made.words("USED", {}, {2});
  made.texts("CONTEXTS", 5, {"Left", "Right"});
  made.texts("LABELS", 8, {"Foot on", "Foot off"});
  made.reals("TIMES", {2, 2}, {0, 0.01, 0, 0.02});
  made.group("TRIAL");
  made.words("ACTUAL_START_FIELD", {2}, {1, 0});
  made.words("ACTUAL_END_FIELD", {2}, {3, 0});
  made.plates({{.type = 1, .channels = {1, 2, 3, 4, 5, 6}}, {.type = 9, .channels = {1, 2, 3, 4, 5, 6}}});
  made.reals("FPCOPPOLY", {12, 2}, std::vector<double>(24, 1e-6));
  for (int frame = 0; frame < 3; ++frame) made.frame({1, 2, -700, 30, 40, 500});
  return made.bytes();
}

/// Records that begin within the data of the record before: each would have the data of all records behind it.
std::string with_overlaps() {
  MadeC3d made;
  add_common(made, 6);
  made.plates({{.type = 2, .channels = {1, 2, 3, 4, 5, 6}}});
  for (int record = 0; record < 200; ++record) made.raw_record("\xFF\x02", 2, "", 2);
  made.frame({1, 2, -700, 30, 40, 500});
  return made.bytes();
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const fs::path folder = arguments[1];
  fs::create_directories(folder);
  const auto put = [&folder](const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  };
  for (int type = 1; type <= 4; ++type) put("type" + std::to_string(type) + ".c3d", plate_of_type(type, MadeEncoding::Intel, true));
  put("dec.c3d", plate_of_type(2, MadeEncoding::Dec, true));
  put("sgi-int.c3d", plate_of_type(2, MadeEncoding::Sgi, false));
  put("events.c3d", with_events());
  put("overlap.c3d", with_overlaps());
}
