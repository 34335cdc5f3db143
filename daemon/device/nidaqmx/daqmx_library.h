// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/result.h"

namespace dts::device::nidaqmx {

inline constexpr const char* kDefaultLibrary = "libnidaqmx.so.1";

// Values of NI's C API (NI-DAQmx C Reference) and of its published list of error codes (nidaqmx-python, error_codes.py).
namespace api {
inline constexpr std::int32_t kVolts = 10348;
inline constexpr std::int32_t kRising = 10280;
inline constexpr std::int32_t kContinuous = 10123;
inline constexpr std::int32_t kTerminalDefault = -1;
inline constexpr std::int32_t kTerminalRse = 10083;
inline constexpr std::int32_t kTerminalNrse = 10078;
inline constexpr std::int32_t kTerminalDifferential = 10106;
inline constexpr std::uint32_t kGroupByScan = 1;

inline constexpr std::int32_t kSamplesNotYetAvailable = -200284;  ///< A read has timed out.
inline constexpr std::int32_t kSamplesNoLongerAvailable = -200279;
inline constexpr std::int32_t kInputFifoOverflow = -200361;
inline constexpr std::int32_t kInputBufferOverwrite = -200222;
inline constexpr std::int32_t kDeviceRemoved = -200045;
inline constexpr std::int32_t kDeviceCannotBeAccessed = -201003;
inline constexpr std::int32_t kInvalidDeviceId = -200220;
}  // namespace api

/// Returns true if the buffer of the device or of the driver was full.
[[nodiscard]] bool is_overrun(std::int32_t status) noexcept;
/// Returns true if the device is no longer there.
[[nodiscard]] bool is_gone(std::int32_t status) noexcept;

/// NI-DAQmx, loaded at run time: nothing of NI is needed to build or link this program. Status < 0: error, > 0: warning.
class DaqmxLibrary {
 public:
  using Task = void*;
  using Bool32 = std::uint32_t;

  /// Loads the library `file`, a name as for dlopen. Fails with Unsupported if it is not installed or a function is missing.
  [[nodiscard]] static core::Result<std::unique_ptr<const DaqmxLibrary>> load(const std::string& file);

  /// Returns the error `status` of the last call in this thread, with NI's text after `what`.
  [[nodiscard]] core::Error error(std::int32_t status, const std::string& what) const;

  /// Returns the product's name, "USB-6008"; empty: the library does not say.
  [[nodiscard]] std::string model_of(const std::string& device) const;
  /// Returns the serial number as NI prints it, in hexadecimal digits; empty: the device has none, or the library does not say.
  [[nodiscard]] std::string serial_of(const std::string& device) const;

  // NI's functions, with their names without "DAQmx". Thread: any, one per task.
  std::int32_t (*create_task)(const char* name, Task* task) = nullptr;
  std::int32_t (*create_ai_voltage_chan)(Task task, const char* channels, const char* names, std::int32_t terminal, double minimum,
                                         double maximum, std::int32_t units, const char* scale) = nullptr;
  std::int32_t (*cfg_samp_clk_timing)(Task task, const char* source, double rate_hz, std::int32_t edge, std::int32_t mode,
                                      std::uint64_t scans) = nullptr;
  std::int32_t (*cfg_dig_edge_start_trig)(Task task, const char* source, std::int32_t edge) = nullptr;
  std::int32_t (*cfg_input_buffer)(Task task, std::uint32_t scans) = nullptr;
  std::int32_t (*get_samp_clk_rate)(Task task, double* rate_hz) = nullptr;
  std::int32_t (*start_task)(Task task) = nullptr;
  std::int32_t (*read_analog_f64)(Task task, std::int32_t scans, double timeout_s, Bool32 fill_mode, double* values, std::uint32_t size,
                                  std::int32_t* scans_read, Bool32* reserved) = nullptr;
  std::int32_t (*stop_task)(Task task) = nullptr;
  std::int32_t (*clear_task)(Task task) = nullptr;
  std::int32_t (*get_extended_error_info)(char* text, std::uint32_t size) = nullptr;
  // Optional: nullptr if the library has none.
  std::int32_t (*get_dev_product_type)(const char* device, char* text, std::uint32_t size) = nullptr;
  std::int32_t (*get_dev_serial_num)(const char* device, std::uint32_t* number) = nullptr;

 private:
  DaqmxLibrary() = default;
};

}  // namespace dts::device::nidaqmx
