// SPDX-License-Identifier: Apache-2.0
#include "c3d/c3d_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/number_text.h"

namespace dts::c3d {
namespace {

using core::ErrorCode;

constexpr char kKey = 0x50;  // the second byte of every C3D file
constexpr std::size_t kWordsOfPoint = 4;
constexpr std::uint16_t kSaturated = 65535;
constexpr std::uint16_t kEventKey = 12345;
constexpr std::size_t kMostHeaderEvents = 18;
/// A whole number below this one that is stored with a sign means one without a sign: nobody shifts a signed channel by half its range.
constexpr double kLowestOffset = -16384.0;

/// Where the parameters are, and how they store numbers.
struct ParameterSection {
  std::string_view bytes;
  Encoding encoding = Encoding::Intel;
};

core::Result<ParameterSection> find_section(std::string_view file, std::vector<std::string>& warnings) {
  const std::size_t start = kBlockBytes * (static_cast<std::size_t>(static_cast<unsigned char>(file[0])) - 1);
  constexpr std::size_t kHead = 4;
  if (start + kHead > file.size()) {
    return core::fail(ErrorCode::Failed, "byte 1: the parameters would begin behind the end of the file", "copy the file again");
  }
  const auto blocks = static_cast<std::size_t>(static_cast<unsigned char>(file[start + 2]));
  ParameterSection section{.bytes = file.substr(start, blocks == 0 ? file.size() : blocks * kBlockBytes)};
  section.bytes = section.bytes.substr(0, 255 * kBlockBytes);
  const auto processor = static_cast<unsigned char>(file[start + 3]);
  if (processor >= 1 && processor <= 3) {
    warnings.push_back("the number of the processor is " + std::to_string(processor) + " instead of " + std::to_string(processor + 83));
    section.encoding = static_cast<Encoding>(processor + 83);
  } else if (processor >= 84 && processor <= 86) {
    section.encoding = static_cast<Encoding>(processor);
  } else {
    return core::fail(ErrorCode::Failed,
                      "byte " + std::to_string(start + 4) + ": the processor " + std::to_string(processor) + " is not known (84, 85, 86)",
                      "export the file again");
  }
  return section;
}

std::string text_of(double number) { return core::number_text(number); }

bool is_number_of(std::optional<double> found, double expected) {
  return !found || std::abs(*found - expected) <= 1e-4 * std::abs(expected);
}

}  // namespace

/// The first block, in words of two bytes. The first word has number 1, as in the description of the format.
struct C3dFile::Header {
  std::string_view block;
  Encoding encoding;

  [[nodiscard]] std::size_t word(std::size_t number) const noexcept { return unsigned_word(encoding, block.data() + 2 * (number - 1)); }
  [[nodiscard]] double real_at(std::size_t number) const noexcept { return real(encoding, block.data() + 2 * (number - 1)); }

  [[nodiscard]] std::size_t points() const noexcept { return word(2); }
  [[nodiscard]] std::size_t analogue_words() const noexcept { return word(3); }  ///< Of one frame.
  [[nodiscard]] std::size_t first_frame() const noexcept { return word(4); }
  [[nodiscard]] std::size_t last_frame() const noexcept { return word(5); }
  [[nodiscard]] double scale() const noexcept { return real_at(7); }
  [[nodiscard]] std::size_t data_block() const noexcept { return word(9); }
  [[nodiscard]] std::size_t samples_per_frame() const noexcept { return word(10); }
  [[nodiscard]] double rate_hz() const noexcept { return real_at(11); }
};

bool is_c3d(std::string_view beginning) noexcept { return beginning.size() >= 2 && beginning[0] != 0 && beginning[1] == kKey; }

core::Result<C3dFile> C3dFile::read(std::string bytes) {
  if (!is_c3d(bytes)) return core::fail(ErrorCode::Failed, "byte 2 is not that of a C3D file", "give a C3D file");
  if (bytes.size() < kBlockBytes) return core::fail(ErrorCode::Failed, "the file ends within its header", "copy the file again");
  C3dFile file;
  file.bytes_ = std::move(bytes);
  DTS_TRY_ASSIGN(const auto section, find_section(file.bytes_, file.warnings_));
  file.encoding_ = section.encoding;
  file.parameters_ = Parameters::read(section.bytes, section.encoding, file.warnings_);
  const Header header{.block = std::string_view(file.bytes_).substr(0, kBlockBytes), .encoding = section.encoding};

  file.word_bytes_ = header.scale() < 0.0 ? 4 : 2;
  file.point_words_ = header.points() * kWordsOfPoint;
  file.frame_words_ = file.point_words_ + header.analogue_words();
  file.samples_per_frame_ = std::max<std::size_t>(header.samples_per_frame(), 1);
  file.point_rate_hz_ = header.rate_hz();
  if (!(file.point_rate_hz_ > 0.0) || !std::isfinite(file.point_rate_hz_)) {
    file.point_rate_hz_ = file.parameters_.number("POINT", "RATE").value_or(0.0);
    file.warnings_.emplace_back("the header has no rate: that of POINT:RATE is used");
  }
  if (!(file.point_rate_hz_ > 0.0) || !std::isfinite(file.point_rate_hz_)) {
    return core::fail(ErrorCode::Failed, "words 11 and 12 of the header: the rate of the frames is not above 0", "export the file again");
  }
  if (file.frame_words_ == 0) {
    return core::fail(ErrorCode::Failed, "words 2 and 3 of the header: the file has no points and no channels", "export the file again");
  }
  file.check_counts(header);
  file.data_start_ = file.data_start(header);
  const std::size_t stated = file.stated_frames(header);
  const std::size_t frame_bytes = file.frame_words_ * file.word_bytes_;
  const std::size_t held = file.data_start_ < file.bytes_.size() ? (file.bytes_.size() - file.data_start_) / frame_bytes : 0;
  file.frames_ = std::min(stated, held);
  if (held < stated) {
    file.warnings_.push_back("the file ends after frame " + std::to_string(held) + " of " + std::to_string(stated));
  } else if ((held - stated) * frame_bytes >= kBlockBytes) {  // less may fill up the last block
    file.warnings_.push_back("the file holds " + std::to_string(held) + " frames, but only " + std::to_string(stated) +
                             " are stated: the others are not read");
  }
  if (file.frames_ == 0) {
    return core::fail(ErrorCode::Failed, "byte " + std::to_string(file.data_start_ + 1) + ": the file has no frame",
                      "export the file again");
  }
  file.scale_channels(header.analogue_words() / file.samples_per_frame_);
  file.read_events(header);
  return file;
}

void C3dFile::check_counts(const Header& header) {
  const auto differ = [this](const std::string& name, std::optional<double> found, double expected) {
    if (is_number_of(found, expected)) return;
    warnings_.push_back(name + " is " + text_of(*found) + ", but the header says " + text_of(expected) + ": the header is used");
  };
  if (header.samples_per_frame() == 0 && header.analogue_words() > 0) {
    warnings_.emplace_back("the header has 0 analogue samples in a frame: 1 is used");
  }
  if (header.analogue_words() % samples_per_frame_ != 0) {
    warnings_.push_back("the header has " + std::to_string(header.analogue_words()) + " analogue values in a frame of " +
                        std::to_string(samples_per_frame_) + " samples: the rest is not used");
  }
  differ("POINT:USED", parameters_.count("POINT", "USED"), static_cast<double>(header.points()));
  differ("POINT:RATE", parameters_.number("POINT", "RATE"), point_rate_hz_);
  if (header.analogue_words() == 0) return;
  differ("ANALOG:USED", parameters_.count("ANALOG", "USED"), static_cast<double>(header.analogue_words() / samples_per_frame_));
  differ("ANALOG:RATE", parameters_.number("ANALOG", "RATE"), analogue_rate_hz());
}

std::size_t C3dFile::data_start(const Header& header) {
  const auto parameter = parameters_.count("POINT", "DATA_START");
  const bool is_known = parameter && *parameter >= 2.0 && *parameter <= kSaturated;
  std::size_t block = header.data_block();
  if (block < 2) {
    warnings_.push_back("the header has block " + std::to_string(block) + " as that of the data: POINT:DATA_START is used");
    block = is_known ? static_cast<std::size_t>(*parameter) : 2;
  } else if (is_known && *parameter != static_cast<double>(block)) {
    warnings_.push_back("POINT:DATA_START is " + text_of(*parameter) + ", but the header says " + std::to_string(block) +
                        ": the header is used");
  }
  return (block - 1) * kBlockBytes;
}

/// A header holds at most 65535 frames; longer files state their number in parameters. A number below that of the header is wrong there.
std::size_t C3dFile::stated_frames(const Header& header) {
  constexpr double kMostFrames = 4294967295.0;
  const bool is_in_header = header.last_frame() >= header.first_frame() && header.last_frame() != kSaturated;
  const double least = header.last_frame() == kSaturated ? static_cast<double>(kSaturated - header.first_frame() + 1) : 1.0;
  std::optional<double> stated;
  const auto state = [&](std::optional<double> frames) {
    if (!stated && frames && *frames >= least && *frames <= kMostFrames) stated = frames;
  };
  const auto first = parameters_.count("TRIAL", "ACTUAL_START_FIELD");
  const auto last = parameters_.count("TRIAL", "ACTUAL_END_FIELD");
  if (first && last) {
    constexpr double kWord = 65536.0;
    const double from = *first + kWord * parameters_.count("TRIAL", "ACTUAL_START_FIELD", 1).value_or(0.0);
    const double to = *last + kWord * parameters_.count("TRIAL", "ACTUAL_END_FIELD", 1).value_or(0.0);
    if (from >= 1.0) state(to - from + 1.0);
  }
  state(parameters_.count("POINT", "LONG_FRAMES"));
  if (const auto frames = parameters_.count("POINT", "FRAMES"); frames != kSaturated) state(frames);

  if (is_in_header) {
    const std::size_t frames = header.last_frame() - header.first_frame() + 1;
    if (stated && *stated != static_cast<double>(frames)) {
      warnings_.push_back("the parameters say that there are " + text_of(*stated) + " frames, but the header says " +
                          std::to_string(frames) + ": the header is used");
    }
    return frames;
  }
  if (stated) return static_cast<std::size_t>(*stated);
  warnings_.emplace_back("the number of frames is not known: all that the file holds are used");
  return std::numeric_limits<std::size_t>::max();
}

void C3dFile::scale_channels(std::size_t count) {
  channels_.resize(count);
  const double general = parameters_.number("ANALOG", "GEN_SCALE").value_or(1.0);
  for (Channel& channel : channels_) channel.scale = general;
  // SCALE and OFFSET hold 255 channels; SCALE2 and OFFSET2 continue them.
  std::size_t scaled = 0;
  std::size_t shifted = 0;
  bool is_shifted_far = false;
  for (int part = 1; part <= 257 && (scaled < count || shifted < count); ++part) {
    const std::string suffix = part == 1 ? "" : std::to_string(part);
    const Parameter* const scale = parameters_.find("ANALOG", "SCALE" + suffix);
    const Parameter* const offset = parameters_.find("ANALOG", "OFFSET" + suffix);
    if (scale == nullptr && offset == nullptr) break;
    for (std::size_t k = 0; scale != nullptr && k < scale->numbers.size() && scaled < count; ++k) {
      channels_[scaled++].scale *= scale->numbers[k];
    }
    for (std::size_t k = 0; offset != nullptr && k < offset->numbers.size() && shifted < count; ++k) {
      channels_[shifted++].offset = offset->numbers[k];
      is_shifted_far = is_shifted_far || offset->numbers[k] <= kLowestOffset;
    }
  }
  if (scaled < count) {
    warnings_.push_back("ANALOG:SCALE has " + std::to_string(scaled) + " of " + std::to_string(count) + " channels: the others have 1");
  }
  std::string format = parameters_.text("ANALOG", "FORMAT");
  std::ranges::transform(format, format.begin(), [](char letter) { return letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter; });
  is_unsigned_ = word_bytes_ == 2 && (format == "UNSIGNED" || (format.empty() && is_shifted_far));
  if (!is_unsigned_) return;
  constexpr double kWord = 65536.0;
  for (Channel& channel : channels_) {
    if (channel.offset < 0.0) channel.offset += kWord;
  }
}

void C3dFile::read_events(const Header& header) {
  const double first_s = header.first_frame() > 1 ? static_cast<double>(header.first_frame() - 1) / point_rate_hz_ : 0.0;
  const auto text_at = [this](const char* name, std::size_t index) {
    const Parameter* const found = parameters_.find("EVENT", name);
    return found != nullptr && index < found->texts.size() ? found->texts[index] : std::string();
  };
  const Parameter* const times = parameters_.find("EVENT", "TIMES");
  const double used = parameters_.count("EVENT", "USED").value_or(0.0);  // may be NaN
  for (std::size_t k = 0; times != nullptr && static_cast<double>(k) < used && 2 * k + 1 < times->numbers.size(); ++k) {
    const double time_s = kSecondsPerMinute * times->numbers[2 * k] + times->numbers[2 * k + 1] - first_s;
    if (std::isfinite(time_s)) events_.push_back({.context = text_at("CONTEXTS", k), .label = text_at("LABELS", k), .time_s = time_s});
  }
  if (!events_.empty() || header.word(150) != kEventKey) return;
  const std::size_t count = std::min(header.word(151), kMostHeaderEvents);
  for (std::size_t k = 0; k < count; ++k) {
    const double time_s = header.real_at(153 + 2 * k) - first_s;
    std::string label(header.block.substr(2 * (199 + 2 * k - 1), 4));
    label = label.substr(0, label.find_last_not_of(std::string_view(" \0", 2)) + 1);
    if (std::isfinite(time_s)) events_.push_back({.context = {}, .label = std::move(label), .time_s = time_s});
  }
}

double C3dFile::analogue(std::size_t sample, std::size_t channel) const noexcept {
  const std::size_t frame = sample / samples_per_frame_;
  const std::size_t within = sample % samples_per_frame_;
  const std::size_t word = frame * frame_words_ + point_words_ + within * channels_.size() + channel;
  const char* const at = bytes_.data() + data_start_ + word * word_bytes_;
  const Channel& about = channels_[channel];
  if (word_bytes_ == 4) return (real(encoding_, at) - about.offset) * about.scale;
  const double raw = is_unsigned_ ? unsigned_word(encoding_, at) : signed_word(encoding_, at);
  return (raw - about.offset) * about.scale;
}

}  // namespace dts::c3d
