// SPDX-License-Identifier: Apache-2.0
#include "lsl/lsl_peer.h"

#include <dlfcn.h>

#include <array>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <stdexcept>

namespace dts::test {
namespace {

constexpr double kPatienceS = 100.0;
constexpr int kChunkScans = 4096;
constexpr int kBufferS = 360;
constexpr int kDoRecover = 1;

/// What a consumer needs of liblsl besides what dts-lsl uses.
struct Consumer {
  std::int32_t (*resolve_byprop)(void** found, std::uint32_t size, const char* property, const char* value, std::int32_t minimum,
                                 double timeout_s) = nullptr;
  void* (*get_fullinfo)(void* inlet, double timeout_s, std::int32_t* error) = nullptr;
  char* (*get_xml)(void* info) = nullptr;
  void (*open_stream)(void* inlet, double timeout_s, std::int32_t* error) = nullptr;
  unsigned long (*pull_chunk_f)(void* inlet, float* values, double* stamps_s, unsigned long size, unsigned long stamps, double timeout_s,
                                std::int32_t* error) = nullptr;
};

template <class Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) throw std::runtime_error(std::string("liblsl has no ") + name);
}

const Consumer& consumer() {
  static const Consumer found = [] {
    void* const library = dlopen(liblsl_file().c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    Consumer functions;
    find(library, "lsl_resolve_byprop", functions.resolve_byprop);
    find(library, "lsl_get_fullinfo", functions.get_fullinfo);
    find(library, "lsl_get_xml", functions.get_xml);
    find(library, "lsl_open_stream", functions.open_stream);
    find(library, "lsl_pull_chunk_f", functions.pull_chunk_f);
    return functions;
  }();
  return found;
}

}  // namespace

std::string liblsl_file() {
  const std::string file = DTS_TEST_LIBLSL;
  return !file.empty() && std::filesystem::exists(file) ? file : "";
}

const lsl::Liblsl& liblsl() {
  static const std::unique_ptr<const lsl::Liblsl> library = lsl::Liblsl::load(liblsl_file()).value();
  return *library;
}

Inlet::Inlet(const std::string& name) {
  void* info = nullptr;
  if (consumer().resolve_byprop(&info, 1, "name", name.c_str(), 1, kPatienceS) != 1) throw std::runtime_error("no LSL stream " + name);
  inlet_ = liblsl().create_inlet(info, kBufferS, 0, kDoRecover);
  liblsl().destroy_streaminfo(info);
  std::int32_t error = 0;
  void* const full = consumer().get_fullinfo(inlet_, kPatienceS, &error);
  if (full == nullptr) throw std::runtime_error("no description of the LSL stream " + name);
  channels_ = static_cast<std::size_t>(liblsl().get_channel_count(full));
  char* const xml = consumer().get_xml(full);
  xml_ = xml;
  std::erase_if(xml_, [](char letter) { return letter == '\n' || letter == '\t'; });
  liblsl().destroy_string(xml);
  liblsl().destroy_streaminfo(full);
  consumer().open_stream(inlet_, kPatienceS, &error);
  if (error != 0) throw std::runtime_error("the LSL stream " + name + " does not open");
}

Inlet::~Inlet() { liblsl().destroy_inlet(inlet_); }

std::size_t Inlet::pull(Samples& samples, double timeout_s) {
  std::vector<float> values(kChunkScans * channels_);
  std::vector<double> stamps_s(kChunkScans);
  std::int32_t error = 0;
  if (timeout_s > 0.0) {  // one sample first: with a timeout, liblsl waits for a full chunk
    const unsigned long first = consumer().pull_chunk_f(inlet_, values.data(), stamps_s.data(), channels_, 1, timeout_s, &error);
    if (first == 0) return 0;
    samples.values.insert(samples.values.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    samples.stamps_s.push_back(stamps_s[0]);
  }
  const unsigned long count = consumer().pull_chunk_f(inlet_, values.data(), stamps_s.data(), values.size(), stamps_s.size(), 0.0, &error);
  samples.values.insert(samples.values.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  const std::size_t scans = count / channels_;
  samples.stamps_s.insert(samples.stamps_s.end(), stamps_s.begin(), stamps_s.begin() + static_cast<std::ptrdiff_t>(scans));
  return scans + (timeout_s > 0.0 ? 1 : 0);
}

std::optional<Inlet::Text> Inlet::pull_text(double timeout_s) {
  char* text = nullptr;
  std::int32_t error = 0;
  const double stamp_s = liblsl().pull_sample_str(inlet_, &text, 1, timeout_s, &error);
  if (stamp_s == 0.0 || text == nullptr) return std::nullopt;
  Text received{.stamp_s = stamp_s, .text = text};
  liblsl().destroy_string(text);
  return received;
}

PeerOutlet::PeerOutlet(const std::string& name, int channels, double rate_hz, const std::string& source_id) {
  const bool is_text = channels == 0;
  void* const info = liblsl().create_streaminfo(name.c_str(), is_text ? "Markers" : "Test", is_text ? 1 : channels, rate_hz,
                                                is_text ? lsl::api::kString : lsl::api::kFloat32, source_id.c_str());
  outlet_ = liblsl().create_outlet(info, 0, kBufferS);
  liblsl().destroy_streaminfo(info);
}

PeerOutlet::~PeerOutlet() { liblsl().destroy_outlet(outlet_); }

void PeerOutlet::push(const std::string& text, double stamp_s) {
  const char* texts[] = {text.c_str()};
  liblsl().push_sample_strtp(outlet_, texts, stamp_s, 1);
}

void PeerOutlet::push(const std::vector<float>& values, double stamp_s) {
  liblsl().push_chunk_ftnp(outlet_, values.data(), values.size(), &stamp_s, 1);
}

bool PeerOutlet::has_consumers() const { return liblsl().have_consumers(outlet_) != 0; }

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

}  // namespace dts::test
