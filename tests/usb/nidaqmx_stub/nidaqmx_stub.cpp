// SPDX-License-Identifier: Apache-2.0
// A stand-in for libnidaqmx.so.1: the functions that this program uses, with NI's names and signatures (NI-DAQmx C Reference),
// over a signal that can be computed. One task at a time, like one device has.
#include "usb/nidaqmx_stub/nidaqmx_stub.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

using dts::emulator::NiStubControl;

constexpr std::int32_t kInvalidDevice = -200220;
constexpr std::int32_t kInvalidChannel = -200170;
constexpr std::int32_t kInvalidTask = -200088;
constexpr std::int32_t kNotYetAvailable = -200284;
constexpr std::uint32_t kGroupByScan = 1;
constexpr std::size_t kInputs = 8;
constexpr double kNanosecondsPerSecond = 1e9;

/// The state of the whole library, as NI's has one: it is asked through C functions.
struct State {
  NiStubControl control;
  int task = 0;  ///< Its address is the handle.
  std::size_t channels = 0;
  bool is_running = false;
  std::int64_t start_ns = 0;
  std::uint64_t next = 0;
  std::int32_t last_error = 0;
};

State& state() {
  static State one;
  return one;
}

std::int32_t fail(std::int32_t status) {
  state().last_error = status;
  return status;
}

bool is_known(void* task) { return task == &state().task && state().control.tasks > 0; }

std::int64_t now_ns() { return state().control.now_ns ? state().control.now_ns() : 0; }

double true_rate_hz() {
  const NiStubControl& control = state().control;
  if (control.runs_at_hz > 0.0) return control.runs_at_hz;
  return control.timebase_hz > 0.0 ? control.timebase_hz / std::floor(control.timebase_hz / control.rate_hz) : control.rate_hz;
}

std::int64_t instant_ns(std::uint64_t scan) {
  return state().start_ns + std::llround(std::ceil(static_cast<double>(scan) / true_rate_hz() * kNanosecondsPerSecond));
}

/// Scans taken by now, of which `next` have been read.
std::uint64_t scans_taken() {
  const State& s = state();
  if (!s.is_running || (!s.control.trigger.empty() && !s.control.is_triggered)) return s.next;
  std::uint64_t count = s.next;
  while (instant_ns(count) <= now_ns() && count < s.next + 100'000) ++count;
  return count;
}

/// "Dev1/ai0, Dev1/ai3" names inputs of the one device?
std::int32_t count_channels(const std::string& list, std::size_t& count) {
  count = 0;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(", ", at), list.size());
    const std::string one = list.substr(at, end - at);
    if (one.rfind("Dev1/", 0) != 0) return kInvalidDevice;
    const bool is_input = one.size() == 8 && one.rfind("Dev1/ai", 0) == 0 && one[7] >= '0' && one[7] < static_cast<char>('0' + kInputs);
    if (!is_input) return kInvalidChannel;
    ++count;
    at = end + 2;
  }
  return 0;
}

}  // namespace

extern "C" {

std::int32_t DAQmxCreateTask(const char* name, void** task);
std::int32_t DAQmxCreateAIVoltageChan(void* task, const char* channels, const char* names, std::int32_t terminal, double minimum,
                                      double maximum, std::int32_t units, const char* scale);
std::int32_t DAQmxCfgSampClkTiming(void* task, const char* source, double rate_hz, std::int32_t edge, std::int32_t mode,
                                   std::uint64_t scans);
std::int32_t DAQmxCfgDigEdgeStartTrig(void* task, const char* source, std::int32_t edge);
std::int32_t DAQmxCfgInputBuffer(void* task, std::uint32_t scans);
std::int32_t DAQmxGetSampClkRate(void* task, double* rate_hz);
std::int32_t DAQmxStartTask(void* task);
std::int32_t DAQmxReadAnalogF64(void* task, std::int32_t scans, double timeout_s, std::uint32_t fill_mode, double* values,
                                std::uint32_t size, std::int32_t* scans_read, std::uint32_t* reserved);
std::int32_t DAQmxStopTask(void* task);
std::int32_t DAQmxClearTask(void* task);
std::int32_t DAQmxGetExtendedErrorInfo(char* text, std::uint32_t size);
std::int32_t DAQmxGetDevProductType(const char* device, char* text, std::uint32_t size);
std::int32_t DAQmxGetDevSerialNum(const char* device, std::uint32_t* number);

dts::emulator::NiStubControl* nidaqmx_stub_control() { return &state().control; }

std::int32_t DAQmxCreateTask(const char*, void** task) {
  ++state().control.tasks;
  state().control.trigger.clear();
  *task = &state().task;
  return 0;
}

std::int32_t DAQmxCreateAIVoltageChan(void* task, const char* channels, const char*, std::int32_t terminal, double minimum, double maximum,
                                      std::int32_t units, const char* scale) {
  if (!is_known(task) || units != 10348 || scale != nullptr) return fail(kInvalidTask);
  State& s = state();
  s.control.channels = channels;
  s.control.terminal = terminal;
  s.control.minimum = minimum;
  s.control.maximum = maximum;
  const std::int32_t status = s.control.is_present ? count_channels(channels, s.channels) : kInvalidDevice;
  return status < 0 ? fail(status) : 0;
}

std::int32_t DAQmxCfgSampClkTiming(void* task, const char*, double rate_hz, std::int32_t edge, std::int32_t mode, std::uint64_t) {
  if (!is_known(task) || edge != 10280 || mode != 10123) return fail(kInvalidTask);
  state().control.rate_hz = rate_hz;
  return 0;
}

std::int32_t DAQmxCfgDigEdgeStartTrig(void* task, const char* source, std::int32_t edge) {
  if (!is_known(task) || edge != 10280) return fail(kInvalidTask);
  state().control.trigger = source;
  return 0;
}

std::int32_t DAQmxCfgInputBuffer(void* task, std::uint32_t scans) {
  if (!is_known(task)) return fail(kInvalidTask);
  state().control.buffer_scans = scans;
  return 0;
}

std::int32_t DAQmxGetSampClkRate(void* task, double* rate_hz) {
  if (!is_known(task)) return fail(kInvalidTask);
  *rate_hz = true_rate_hz();
  return 0;
}

std::int32_t DAQmxStartTask(void* task) {
  State& s = state();
  if (!is_known(task)) return fail(kInvalidTask);
  if (s.control.start_status < 0) return fail(s.control.start_status);
  s.is_running = true;
  s.control.running = 1;
  s.start_ns = now_ns();
  s.next = 0;
  return 0;
}

std::int32_t DAQmxReadAnalogF64(void* task, std::int32_t scans, double timeout_s, std::uint32_t fill_mode, double* values,
                                std::uint32_t size, std::int32_t* scans_read, std::uint32_t*) {
  State& s = state();
  *scans_read = 0;
  if (!is_known(task) || !s.is_running || fill_mode != kGroupByScan || scans < 0) return fail(kInvalidTask);
  if (static_cast<std::uint64_t>(scans) * s.channels > size) return fail(kInvalidTask);
  if (s.control.reads++ >= s.control.fail_at_read) return fail(s.control.fail_status);
  if (s.control.gives_too_many) {
    *scans_read = scans + 1;
    return 0;
  }
  const std::uint64_t wanted = s.next + static_cast<std::uint64_t>(scans);
  const std::int64_t deadline_ns = now_ns() + std::llround(timeout_s * kNanosecondsPerSecond);
  if (scans_taken() < wanted && s.control.wait_until_ns) {
    const bool is_coming = s.control.trigger.empty() || s.control.is_triggered;
    s.control.wait_until_ns(is_coming ? std::min(deadline_ns, instant_ns(wanted - 1)) : deadline_ns);
  }
  const std::uint64_t end = std::min(scans_taken(), wanted);
  for (; s.next < end; ++s.next) {
    for (std::size_t channel = 0; channel < s.channels; ++channel) {
      *values++ = s.next == s.control.nan_at_scan ? std::nan("") : dts::emulator::ni_stub_volts(channel, s.next);
    }
    ++*scans_read;
  }
  return end < wanted ? fail(kNotYetAvailable) : 0;
}

std::int32_t DAQmxStopTask(void* task) {
  if (!is_known(task)) return fail(kInvalidTask);
  state().is_running = false;
  state().control.running = 0;
  return 0;
}

std::int32_t DAQmxClearTask(void* task) {
  if (!is_known(task)) return fail(kInvalidTask);
  state().is_running = false;
  state().control.running = 0;
  --state().control.tasks;
  return 0;
}

std::int32_t DAQmxGetExtendedErrorInfo(char* text, std::uint32_t size) {
  const char* const words =
      state().last_error == kInvalidDevice ? "Device identifier is invalid.\nDevice Specified: Dev7" : "Stub says no.";
  std::snprintf(text, size, "%s", words);
  return 0;
}

std::int32_t DAQmxGetDevProductType(const char* device, char* text, std::uint32_t size) {
  if (std::strcmp(device, "Dev1") != 0) return fail(kInvalidDevice);
  std::snprintf(text, size, "%s", "USB-6008");
  return 0;
}

std::int32_t DAQmxGetDevSerialNum(const char* device, std::uint32_t* number) {
  if (std::strcmp(device, "Dev1") != 0) return fail(kInvalidDevice);
  *number = state().control.serial_number;
  return 0;
}

}  // extern "C"
