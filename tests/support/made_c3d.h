// SPDX-License-Identifier: Apache-2.0
// C3D files made in code, in every encoding, right or wrong: independent of the writer that is tested.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace dts::test {

enum class MadeEncoding : unsigned char { Intel = 84, Dec = 85, Sgi = 86 };

inline void put_word(std::string& bytes, MadeEncoding encoding, int value) {
  const auto low = static_cast<char>(value & 0xFF);
  const auto high = static_cast<char>((value >> 8) & 0xFF);
  bytes += encoding == MadeEncoding::Sgi ? high : low;
  bytes += encoding == MadeEncoding::Sgi ? low : high;
}

/// DEC: four times the value as IEEE, words exchanged.
inline void put_real(std::string& bytes, MadeEncoding encoding, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(encoding == MadeEncoding::Dec ? 4.0 * value : value));
  const auto high = static_cast<int>(bits >> 16U);
  const auto low = static_cast<int>(bits & 0xFFFFU);
  put_word(bytes, encoding, encoding == MadeEncoding::Intel ? low : high);
  put_word(bytes, encoding, encoding == MadeEncoding::Intel ? high : low);
}

/// A file with one group after another, then frames of the given values.
class MadeC3d {
 public:
  explicit MadeC3d(MadeEncoding encoding = MadeEncoding::Intel, bool is_real = true) : encoding_(encoding), is_real_(is_real) {}

  // Words of the header; change them to make a file that contradicts itself.
  int points = 0;
  int channels = 0;
  int samples_per_frame = 1;
  int first_frame = 1;
  int last_frame = -1;     ///< -1: of the frames that are added.
  int data_block = -1;     ///< -1: behind the parameters.
  double rate_hz = 100.0;  ///< Of frames.

  void group(const std::string& name) {
    --group_;
    raw_record(name, group_, std::string(1, '\0'));
  }
  void words(const std::string& name, const std::vector<int>& dimensions, const std::vector<int>& values) {
    std::string data;
    for (const int value : values) put_word(data, encoding_, value);
    parameter(name, 2, dimensions, data);
  }
  void reals(const std::string& name, const std::vector<int>& dimensions, const std::vector<double>& values) {
    std::string data;
    for (const double value : values) put_real(data, encoding_, value);
    parameter(name, 4, dimensions, data);
  }
  void text(const std::string& name, const std::string& value) { parameter(name, -1, {static_cast<int>(value.size())}, value); }
  void texts(const std::string& name, int length, const std::vector<std::string>& values) {
    std::string data;
    for (std::string value : values) {
      value.resize(static_cast<std::size_t>(length), ' ');
      data += value;
    }
    parameter(name, -1, {length, static_cast<int>(values.size())}, data);
  }
  void parameter(const std::string& name, int type, const std::vector<int>& dimensions, const std::string& data) {
    std::string content(1, static_cast<char>(type));
    content += static_cast<char>(dimensions.size());
    for (const int dimension : dimensions) content += static_cast<char>(dimension);
    raw_record(name, -group_, content + data + std::string(1, '\0'));
  }
  /// `offset`: of the next record; 0x10000: where it is.
  void raw_record(const std::string& name, int id, const std::string& content, int offset = 0x10000) {
    records_ += static_cast<char>(name.size());
    records_ += static_cast<char>(id);
    records_ += name;
    put_word(records_, encoding_, offset == 0x10000 ? static_cast<int>(content.size()) + 2 : offset);
    records_ += content;
  }
  /// One plate in FORCE_PLATFORM, a square of 400 mm with its centre at (200, 200) and z down, with the next channels.
  struct Plate {
    int type = 2;
    std::array<double, 3> origin{};
    std::vector<int> channels;
    std::vector<double> matrix{};
  };
  void plates(const std::vector<Plate>& all, const std::vector<int>& zero = {1, 0}) {
    group("FORCE_PLATFORM");
    const int count = static_cast<int>(all.size());
    std::vector<int> types;
    std::vector<int> numbers;
    std::vector<double> origins;
    std::vector<double> corners;
    std::vector<double> matrices;
    for (const Plate& plate : all) {
      types.push_back(plate.type);
      numbers.insert(numbers.end(), plate.channels.begin(), plate.channels.end());
      origins.insert(origins.end(), plate.origin.begin(), plate.origin.end());
      const std::initializer_list<double> square{400, 0, 0, 0, 0, 0, 0, 400, 0, 400, 400, 0};  // x = lab x, y = -lab y, z down
      corners.insert(corners.end(), square);
      matrices.insert(matrices.end(), plate.matrix.begin(), plate.matrix.end());
    }
    words("USED", {}, {count});
    words("TYPE", {count}, types);
    words("ZERO", {2}, zero);
    reals("CORNERS", {3, 4, count}, corners);
    reals("ORIGIN", {3, count}, origins);
    words("CHANNEL", {static_cast<int>(all.front().channels.size()), count}, numbers);
    if (!matrices.empty()) reals("CAL_MATRIX", {6, 6, count}, matrices);
  }
  /// The numbers of a frame: 4 for each point, then the channels of each sample.
  void frame(const std::vector<double>& numbers) {
    for (const double number : numbers) {
      if (is_real_) {
        put_real(data_, encoding_, number);
      } else {
        put_word(data_, encoding_, static_cast<int>(number));
      }
    }
    ++frames_;
  }

  [[nodiscard]] std::string bytes() const {
    std::string section{'\1', 0x50, '\0', static_cast<char>(encoding_)};
    section += records_ + std::string(2, '\0');
    const std::size_t blocks = (section.size() + 511) / 512;
    section.resize(blocks * 512, '\0');
    section[2] = static_cast<char>(blocks);
    std::string header{'\2', 0x50};
    put_word(header, encoding_, points);
    put_word(header, encoding_, channels * samples_per_frame);
    put_word(header, encoding_, first_frame);
    put_word(header, encoding_, last_frame < 0 ? first_frame + frames_ - 1 : last_frame);
    put_word(header, encoding_, 0);
    put_real(header, encoding_, is_real_ ? -1.0 : 1.0);
    put_word(header, encoding_, data_block < 0 ? static_cast<int>(blocks) + 2 : data_block);
    put_word(header, encoding_, samples_per_frame);
    put_real(header, encoding_, rate_hz);
    header.resize(512, '\0');
    return header + section + data_;
  }

 private:
  MadeEncoding encoding_;
  bool is_real_;
  std::string records_;
  std::string data_;
  int group_ = 0;
  int frames_ = 0;
};

}  // namespace dts::test
