// SPDX-License-Identifier: Apache-2.0
#include "device/nidaqmx/daqmx_library.h"

#include <dlfcn.h>

#include <array>
#include <cstdio>
#include <vector>

#include "core/utf8.h"

namespace dts::device::nidaqmx {
namespace {

using core::ErrorCode;

constexpr std::size_t kErrorTextBytes = 2048;
constexpr std::size_t kModelBytes = 64;

std::string loader_says() {
  const char* const text = dlerror();
  return text != nullptr ? text : "no reason given";
}

/// Sets `function` to the function `name` of `library`; if there is none, to nullptr, and stores the first such name in `missing`.
template <class Function>
void resolve(void* library, const char* name, Function& function, std::string& missing) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr && missing.empty()) missing = name;
}

}  // namespace

bool is_overrun(std::int32_t status) noexcept {
  return status == api::kSamplesNoLongerAvailable || status == api::kInputFifoOverflow || status == api::kInputBufferOverwrite;
}

bool is_gone(std::int32_t status) noexcept {
  return status == api::kDeviceRemoved || status == api::kDeviceCannotBeAccessed || status == api::kInvalidDeviceId;
}

core::Result<std::unique_ptr<const DaqmxLibrary>> DaqmxLibrary::load(const std::string& file) {
  // Never unloaded: the library starts threads, which would lose their code.
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) {
    return core::fail(ErrorCode::Unsupported, "NI-DAQmx is not installed on this computer: " + loader_says(),
                      "install NI's Linux Device Drivers for this distribution, if NI lists the device for it; otherwise use another DAQ: "
                      "see the README of daemon/device/nidaqmx");
  }
  auto loaded = std::unique_ptr<DaqmxLibrary>(new DaqmxLibrary);
  std::string missing;
  resolve(library, "DAQmxCreateTask", loaded->create_task, missing);
  resolve(library, "DAQmxCreateAIVoltageChan", loaded->create_ai_voltage_chan, missing);
  resolve(library, "DAQmxCfgSampClkTiming", loaded->cfg_samp_clk_timing, missing);
  resolve(library, "DAQmxCfgDigEdgeStartTrig", loaded->cfg_dig_edge_start_trig, missing);
  resolve(library, "DAQmxCfgInputBuffer", loaded->cfg_input_buffer, missing);
  resolve(library, "DAQmxGetSampClkRate", loaded->get_samp_clk_rate, missing);
  resolve(library, "DAQmxStartTask", loaded->start_task, missing);
  resolve(library, "DAQmxReadAnalogF64", loaded->read_analog_f64, missing);
  resolve(library, "DAQmxStopTask", loaded->stop_task, missing);
  resolve(library, "DAQmxClearTask", loaded->clear_task, missing);
  resolve(library, "DAQmxGetExtendedErrorInfo", loaded->get_extended_error_info, missing);
  std::string optional;  // without these, model and serial number stay unknown
  resolve(library, "DAQmxGetDevProductType", loaded->get_dev_product_type, optional);
  resolve(library, "DAQmxGetDevSerialNum", loaded->get_dev_serial_num, optional);
  if (missing.empty()) return loaded;
  return core::fail(ErrorCode::Unsupported, file + " has no function " + missing + ": it is not NI-DAQmx, or an unsuitable release",
                    "install a current release of NI-DAQmx");
}

std::string DaqmxLibrary::model_of(const std::string& device) const {
  if (get_dev_product_type == nullptr) return {};
  std::array<char, kModelBytes> text{};
  if (get_dev_product_type(device.c_str(), text.data(), text.size()) < 0) return {};
  text.back() = '\0';
  return core::printable(text.data());
}

std::string DaqmxLibrary::serial_of(const std::string& device) const {
  std::uint32_t number = 0;
  if (get_dev_serial_num == nullptr || get_dev_serial_num(device.c_str(), &number) < 0 || number == 0) return {};
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08X", number);
  return text.data();
}

core::Error DaqmxLibrary::error(std::int32_t status, const std::string& what) const {
  std::vector<char> text(kErrorTextBytes);
  get_extended_error_info(text.data(), static_cast<std::uint32_t>(text.size()));
  text.back() = '\0';
  for (char& letter : text) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  core::Error error;
  error.code = status == api::kInvalidDeviceId ? ErrorCode::NotFound : is_gone(status) ? ErrorCode::DeviceGone : ErrorCode::Failed;
  error.what = what + ": NI-DAQmx error " + std::to_string(status) + ": " + text.data();
  if (status == api::kInvalidDeviceId) error.hint = "write the name that NI's tools show, for example ni:Dev1";
  return error;
}

}  // namespace dts::device::nidaqmx
