// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "c3d/encoding.h"
#include "c3d/parameters.h"
#include "core/result.h"

namespace dts::c3d {

inline constexpr std::size_t kBlockBytes = 512;
inline constexpr double kSecondsPerMinute = 60.0;  ///< Events have minutes and seconds.

struct Event {
  std::string context;  ///< "Left", "General"; may be empty.
  std::string label;
  double time_s = 0.0;  ///< From the first stored frame.
};

/// Returns whether this may be the beginning of a C3D file: two bytes say so.
[[nodiscard]] bool is_c3d(std::string_view beginning) noexcept;

/// The analogue channels, parameters and events of one C3D file (c3d.org, "The C3D File Format"). Where header and parameters contradict
/// each other, the header is right, and `warnings` has a line. Holds the bytes of the file; its other memory is bounded by the section of
/// the parameters and the number of channels. Immutable; const methods may run on any thread.
class C3dFile {
 public:
  /// Fails with Failed if the bytes are no C3D file, or have no frame or no rate; the message says where and why.
  [[nodiscard]] static core::Result<C3dFile> read(std::string bytes);

  [[nodiscard]] double point_rate_hz() const noexcept { return point_rate_hz_; }
  [[nodiscard]] std::size_t samples_per_frame() const noexcept { return samples_per_frame_; }
  [[nodiscard]] double analogue_rate_hz() const noexcept { return point_rate_hz_ * static_cast<double>(samples_per_frame_); }
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }  ///< Those that the file really holds.
  [[nodiscard]] std::size_t samples() const noexcept { return frames_ * samples_per_frame_; }
  [[nodiscard]] std::size_t channels() const noexcept { return channels_.size(); }
  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const std::vector<Event>& events() const noexcept { return events_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }

  /// Returns (raw - OFFSET) x SCALE x GEN_SCALE. `sample` < samples(), `channel` < channels(). May be NaN in files of real numbers.
  [[nodiscard]] double analogue(std::size_t sample, std::size_t channel) const noexcept;

 private:
  struct Channel {
    double offset = 0.0;
    double scale = 1.0;
  };
  struct Header;

  C3dFile() = default;
  void check_counts(const Header& header);
  [[nodiscard]] std::size_t stated_frames(const Header& header);
  [[nodiscard]] std::size_t data_start(const Header& header);
  void scale_channels(std::size_t count);
  void read_events(const Header& header);

  std::string bytes_;
  Encoding encoding_ = Encoding::Intel;
  Parameters parameters_;
  std::vector<std::string> warnings_;
  std::vector<Event> events_;
  std::vector<Channel> channels_;
  double point_rate_hz_ = 0.0;
  std::size_t samples_per_frame_ = 1;
  std::size_t frames_ = 0;
  std::size_t data_start_ = 0;   ///< Byte of the first frame.
  std::size_t frame_words_ = 0;  ///< Numbers of one frame.
  std::size_t point_words_ = 0;  ///< Those before the analogue samples.
  std::size_t word_bytes_ = 2;   ///< 4: real numbers.
  bool is_unsigned_ = false;     ///< Whole numbers without a sign.
};

}  // namespace dts::c3d
