// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lsl/liblsl.h"

namespace dts::test {

/// The file of the real liblsl; empty: there is none, and tests with it are skipped.
[[nodiscard]] std::string liblsl_file();
/// The library in this process. It must be there.
[[nodiscard]] const lsl::Liblsl& liblsl();

/// A genuine inlet of liblsl: what any recorder has. Ends with this object.
class Inlet {
 public:
  /// Waits until the stream of this name is found and open; throws after a patient time.
  explicit Inlet(const std::string& name);
  ~Inlet();
  Inlet(const Inlet&) = delete;
  Inlet& operator=(const Inlet&) = delete;

  struct Samples {
    std::vector<double> stamps_s;
    std::vector<float> values;  ///< Scan after scan.
  };
  /// Appends all samples that wait, or waits for the first for `timeout_s`. Returns how many it has appended.
  std::size_t pull(Samples& samples, double timeout_s);

  struct Text {
    double stamp_s = 0.0;
    std::string text;
  };
  /// Returns the next text, or nothing after `timeout_s`.
  [[nodiscard]] std::optional<Text> pull_text(double timeout_s);

  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }
  /// The whole description of the stream as XML.
  [[nodiscard]] const std::string& xml() const noexcept { return xml_; }

 private:
  void* inlet_ = nullptr;
  std::size_t channels_ = 0;
  std::string xml_;
};

/// An outlet of another program, of texts or of float32 values.
class PeerOutlet {
 public:
  /// `channels` 0: texts at irregular times.
  PeerOutlet(const std::string& name, int channels, double rate_hz, const std::string& source_id);
  ~PeerOutlet();
  PeerOutlet(const PeerOutlet&) = delete;
  PeerOutlet& operator=(const PeerOutlet&) = delete;

  void push(const std::string& text, double stamp_s);
  void push(const std::vector<float>& values, double stamp_s);
  [[nodiscard]] bool has_consumers() const;

 private:
  void* outlet_;
};

/// CLOCK_MONOTONIC, ns.
[[nodiscard]] std::int64_t monotonic_ns();

}  // namespace dts::test
