// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "dts/stream.h"
#include "lsl/liblsl.h"

namespace dts::lsl {

/// Begins the source_id of every outlet of this program, so that its marker inlets skip them.
inline constexpr const char* kSourceIdPrefix = "dtsd/";

/// What an outlet states of itself.
struct OutletFacts {
  std::string name;  ///< "floor/cop", as the topic and as in recordings.
  std::string source_id;
  std::optional<client::StreamFormat> format;  ///< Absent: the outlet has texts at irregular times.
  std::string device_model;
  std::string device_serial;
  std::string daemon_version;

  friend bool operator==(const OutletFacts&, const OutletFacts&);
};

/// Returns the host time of a scan of the block, ns: that of its first scan and the exact rate, as in recordings.
[[nodiscard]] std::int64_t host_time_ns(const client::Block& block, std::size_t scan);
/// Returns a host time as a time of LSL's clock, which is CLOCK_MONOTONIC in seconds.
[[nodiscard]] inline double lsl_time_s(std::int64_t host_ns) noexcept { return static_cast<double>(host_ns) / 1e9; }

/// One stream in LSL: values as float32, or texts. Ends with this object. Thread: one.
class Outlet {
 public:
  /// `lsl` outlives the outlet. `buffer_s`: what the library keeps for a slow consumer; it then drops the oldest. Fails with Failed if the
  /// library cannot make it: no port or no network interface.
  [[nodiscard]] static core::Result<std::unique_ptr<Outlet>> create(const Liblsl& lsl, OutletFacts facts, std::int32_t buffer_s);
  ~Outlet();
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  /// Sends the scans of a block at once, each with its own time. The block has as many channels as the format.
  void push(const client::Block& block);
  void push(const std::string& text, std::int64_t host_ns);

  [[nodiscard]] const OutletFacts& facts() const noexcept { return facts_; }

 private:
  Outlet(const Liblsl& lsl, OutletFacts facts, api::Outlet outlet) : lsl_(lsl), facts_(std::move(facts)), outlet_(outlet) {}

  const Liblsl& lsl_;
  OutletFacts facts_;
  api::Outlet outlet_;
  std::vector<float> values_;
  std::vector<double> stamps_s_;
};

}  // namespace dts::lsl
