// SPDX-License-Identifier: Apache-2.0
#include "c3d/c3d_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

namespace dts::c3d {
namespace {

using core::ErrorCode;

constexpr std::size_t kMostFramesOfHeader = 65535;
constexpr std::size_t kMostSamplesPerFrame = 100;
constexpr std::size_t kParameterBlock = 2;
constexpr std::size_t kLongestText = 64;

void put_word(std::string& bytes, std::size_t value) {
  bytes += static_cast<char>(value & 0xFFU);
  bytes += static_cast<char>(value >> 8U & 0xFFU);
}

void put_real(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  put_word(bytes, bits & 0xFFFFU);
  put_word(bytes, bits >> 16U);
}

std::string fit(const std::string& text, std::size_t length) {
  std::string fitted = text.substr(0, length);
  fitted.resize(length, ' ');
  return fitted;
}

/// Writes groups and parameters, one after the other.
class SectionWriter {
 public:
  void group(const std::string& name) {
    --group_;
    record(name, group_, std::string(1, '\0'));
  }
  void words(const std::string& name, const std::vector<std::size_t>& dimensions, const std::vector<std::size_t>& values) {
    std::string data;
    for (const std::size_t value : values) put_word(data, value);
    parameter(name, 2, dimensions, data);
  }
  void reals(const std::string& name, const std::vector<std::size_t>& dimensions, const std::vector<double>& values) {
    std::string data;
    for (const double value : values) put_real(data, value);
    parameter(name, 4, dimensions, data);
  }
  void texts(const std::string& name, const std::vector<std::string>& values) {
    std::size_t longest = 1;
    for (const std::string& value : values) longest = std::max(longest, std::min(value.size(), kLongestText));
    std::string data;
    for (const std::string& value : values) data += fit(value, longest);
    parameter(name, -1, {longest, values.size()}, data);
  }
  void text(const std::string& name, const std::string& value) {
    const std::string fitted = value.substr(0, kLongestText);
    parameter(name, -1, {fitted.size()}, fitted);
  }
  /// Returns the section with its head, filled up to whole blocks.
  std::string finished() {
    std::string section{'\1', kKeyOfSection, '\0', static_cast<char>(Encoding::Intel)};
    section += records_;
    section += std::string(2, '\0');  // a name of length 0 ends the section
    const std::size_t blocks = (section.size() + kBlockBytes - 1) / kBlockBytes;
    section.resize(blocks * kBlockBytes, '\0');
    section[2] = static_cast<char>(blocks);
    return section;
  }

 private:
  static constexpr char kKeyOfSection = 0x50;

  void record(const std::string& name, int id, const std::string& content) {
    records_ += static_cast<char>(name.size());
    records_ += static_cast<char>(id);
    records_ += name;
    put_word(records_, content.size() + 2);  // from here to the next record
    records_ += content;
  }
  void parameter(const std::string& name, int type, const std::vector<std::size_t>& dimensions, const std::string& data) {
    std::string content(1, static_cast<char>(type));
    content += static_cast<char>(dimensions.size());
    for (const std::size_t dimension : dimensions) content += static_cast<char>(dimension);
    content += data;
    content += '\0';  // no description
    record(name, -group_, content);
  }

  std::string records_;
  int group_ = 0;
};

/// How the samples are divided into frames: a header counts at most 65535 frames.
struct Frames {
  std::size_t count = 0;
  std::size_t samples_per_frame = 1;
};

Frames frames_of(std::size_t samples) {
  for (std::size_t each = 1; samples > kMostFramesOfHeader && each <= kMostSamplesPerFrame; ++each) {
    if (samples % each == 0 && samples / each <= kMostFramesOfHeader) return {.count = samples / each, .samples_per_frame = each};
  }
  return {.count = samples};
}

std::string header_of(const Outline& outline, const Frames& frames, std::size_t data_block) {
  const std::size_t channels = outline.plates.size() * kChannelsOfPlate;
  std::string header{static_cast<char>(kParameterBlock), 0x50};
  put_word(header, 0);                                    // points
  put_word(header, channels * frames.samples_per_frame);  // analogue values of a frame
  put_word(header, 1);                                    // first frame
  put_word(header, std::min(frames.count, kMostFramesOfHeader));
  put_word(header, 0);     // longest gap that was interpolated
  put_real(header, -1.0);  // real numbers
  put_word(header, data_block);
  put_word(header, frames.samples_per_frame);
  put_real(header, outline.rate_hz / static_cast<double>(frames.samples_per_frame));
  header.resize(kBlockBytes, '\0');
  constexpr std::size_t kEventKeyAt = 298;  // word 150: events have labels of four letters; here none, they are parameters
  std::string key;
  put_word(key, 12345);
  return header.replace(kEventKeyAt, key.size(), key);
}

void put_points(SectionWriter& section, const Outline& outline, const Frames& frames, std::size_t data_block) {
  section.group("POINT");
  section.words("USED", {}, {0});
  section.reals("SCALE", {}, {-1.0});
  section.reals("RATE", {}, {outline.rate_hz / static_cast<double>(frames.samples_per_frame)});
  section.words("DATA_START", {}, {data_block});
  section.words("FRAMES", {}, {std::min(frames.count, kMostFramesOfHeader)});
  if (frames.count > kMostFramesOfHeader) section.reals("LONG_FRAMES", {}, {static_cast<double>(frames.count)});
  section.text("UNITS", "mm");
  section.group("TRIAL");
  section.words("ACTUAL_START_FIELD", {2}, {1, 0});
  section.words("ACTUAL_END_FIELD", {2}, {frames.count & 0xFFFFU, frames.count >> 16U});
}

void put_channels(SectionWriter& section, const Outline& outline) {
  constexpr std::array<std::pair<const char*, const char*>, kChannelsOfPlate> kChannels{
      {{"Fx", "N"}, {"Fy", "N"}, {"Fz", "N"}, {"Px", "mm"}, {"Py", "mm"}, {"Mz", "Nmm"}}};
  std::vector<std::string> labels;
  std::vector<std::string> units;
  for (std::size_t plate = 1; plate <= outline.plates.size(); ++plate) {
    for (const auto& [label, unit] : kChannels) {
      labels.push_back(label + std::to_string(plate));
      units.emplace_back(unit);
    }
  }
  section.group("ANALOG");
  section.words("USED", {}, {labels.size()});
  section.texts("LABELS", labels);
  section.texts("DESCRIPTIONS", labels);
  section.texts("UNITS", units);
  section.reals("GEN_SCALE", {}, {1.0});
  section.reals("SCALE", {labels.size()}, std::vector<double>(labels.size(), 1.0));
  section.words("OFFSET", {labels.size()}, std::vector<std::size_t>(labels.size(), 0));
  section.reals("RATE", {}, {outline.rate_hz});
}

void put_plates(SectionWriter& section, const Outline& outline) {
  const std::size_t count = outline.plates.size();
  std::vector<double> corners;
  std::vector<std::size_t> channels;
  for (const Corners& plate : outline.plates) {
    for (const auto& corner : plate) corners.insert(corners.end(), corner.begin(), corner.end());
    for (std::size_t k = 0; k < kChannelsOfPlate; ++k) channels.push_back(channels.size() + 1);
  }
  section.group("FORCE_PLATFORM");
  section.words("USED", {}, {count});
  section.words("TYPE", {count}, std::vector<std::size_t>(count, 1));
  section.words("ZERO", {2}, {1, 0});
  section.reals("CORNERS", {3, 4, count}, corners);
  section.reals("ORIGIN", {3, count}, std::vector<double>(3 * count, 0.0));
  section.words("CHANNEL", {kChannelsOfPlate, count}, channels);
}

void put_events(SectionWriter& section, const Outline& outline) {
  section.group("EVENT");
  section.words("USED", {}, {outline.events.size()});
  if (outline.events.empty()) return;
  std::vector<std::string> contexts;
  std::vector<std::string> labels;
  std::vector<double> times;
  for (const Event& event : outline.events) {
    contexts.push_back(event.context);
    labels.push_back(event.label);
    const double minutes = std::floor(event.time_s / kSecondsPerMinute);
    times.push_back(minutes);
    times.push_back(event.time_s - kSecondsPerMinute * minutes);
  }
  section.texts("CONTEXTS", contexts);
  section.texts("LABELS", labels);
  section.reals("TIMES", {2, outline.events.size()}, times);
}

std::string section_of(const Outline& outline, const Frames& frames, std::size_t data_block) {
  SectionWriter section;
  put_points(section, outline, frames, data_block);
  put_channels(section, outline);
  put_plates(section, outline);
  put_events(section, outline);
  section.group("MANUFACTURER");
  section.text("SOFTWARE", outline.software);
  return section.finished();
}

}  // namespace

core::Result<std::string> file_beginning(const Outline& outline) {
  const auto wrong = [](const std::string& what) { return core::fail(ErrorCode::InvalidArgument, "a C3D file " + what); };
  if (outline.samples == 0) return wrong("needs at least one sample");
  if (outline.samples > 0xFFFFFFFFU) return wrong("has at most 4294967295 samples");
  if (outline.plates.empty() || outline.plates.size() > kMostPlates) return wrong("has 1 to " + std::to_string(kMostPlates) + " plates");
  if (outline.events.size() > kMostEvents) return wrong("has at most " + std::to_string(kMostEvents) + " events");
  const Frames frames = frames_of(outline.samples);
  using Real = std::numeric_limits<float>;
  if (!(outline.rate_hz / static_cast<double>(frames.samples_per_frame) >= Real::min() && outline.rate_hz <= Real::max())) {
    return wrong("needs a rate above 0 that a 32-bit number can hold");
  }
  const std::size_t blocks = section_of(outline, frames, 0).size() / kBlockBytes;  // the place of the data does not change the size
  const std::size_t data_block = kParameterBlock + blocks;
  return header_of(outline, frames, data_block) + section_of(outline, frames, data_block);
}

void append_sample(std::string& bytes, std::span<const double> values) {
  for (const double value : values) put_real(bytes, value);
}

}  // namespace dts::c3d
