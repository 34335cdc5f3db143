// SPDX-License-Identifier: Apache-2.0
#include "lsl/marker_inlets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/thread.h"
#include "lsl/outlet.h"

namespace dts::lsl {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPause{5};
constexpr std::chrono::milliseconds kLookPeriod{250};
constexpr double kForgetAfterS = 5.0;
constexpr std::int32_t kBufferLength = 1000;  // samples: the stream has no rate
constexpr std::int32_t kDoNotRecover = 0;     // a sender that comes back has a new uid, and its stream is found again
constexpr std::size_t kMostStreams = 32;      // also of one answer
constexpr std::size_t kMostSkipped = 1024;
constexpr double kCorrectionLimitS = 2.0;
constexpr double kSameClockS = 1e-3;  // clocks of two machines differ by more: each counts from its own start
constexpr double kMarkersPerSecond = 50.0;
constexpr std::size_t kUidBytes = 36;

std::string text_or_empty(const char* text) { return text != nullptr ? text : ""; }

/// FNV-1a.
std::uint32_t hash_of(const std::string& text) {
  std::uint32_t hash = 2166136261U;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  return hash;
}

}  // namespace

std::string request_id(const ReceivedMarker& marker) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx%08x",
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(marker.sender_time_s)), hash_of(marker.text));
  return "l" + marker.stream_uid.substr(0, kUidBytes) + digits.data();
}

core::Result<std::unique_ptr<MarkerInlets>> MarkerInlets::start(const Liblsl& lsl, const std::vector<std::string>& predicates,
                                                                Handle handle, core::Log log) {
  std::unique_ptr<MarkerInlets> inlets(new MarkerInlets(lsl, std::move(handle), std::move(log)));
  for (const std::string& predicate : predicates) {
    const api::Resolver resolver = lsl.create_continuous_resolver_bypred(predicate.c_str(), kForgetAfterS);
    if (resolver == nullptr) {
      return core::fail(core::ErrorCode::InvalidArgument, "LSL does not accept the predicate of markers_from: " + predicate,
                        "write it like name='MyMarkers' or type='Markers' and hostname='lab2'");
    }
    inlets->resolvers_.push_back(resolver);
  }
  inlets->thread_ = std::jthread([owner = inlets.get()](const std::stop_token& stop) { owner->run(stop); });
  return inlets;
}

MarkerInlets::~MarkerInlets() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  for (const Inlet& inlet : inlets_) lsl_.destroy_inlet(inlet.inlet);
  for (const api::Resolver resolver : resolvers_) lsl_.destroy_continuous_resolver(resolver);
}

void MarkerInlets::run(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("markers", {}));
  steady_clock::time_point next_look;
  while (!stop.stop_requested()) {
    if (const auto now = steady_clock::now(); now >= next_look) {
      next_look = now + kLookPeriod;
      find_streams();
    }
    std::erase_if(inlets_, [this](Inlet& inlet) {
      if (receive(inlet)) return false;
      log_.info("the marker stream " + inlet.name + " has ended");
      lsl_.destroy_inlet(inlet.inlet);
      return true;
    });
    std::this_thread::sleep_for(kPause);
  }
}

void MarkerInlets::find_streams() {
  for (const api::Resolver resolver : resolvers_) {
    std::array<api::Info, kMostStreams> found{};
    const std::int32_t count = lsl_.resolver_results(resolver, found.data(), static_cast<std::uint32_t>(found.size()));
    for (std::int32_t index = 0; index < count && index < static_cast<std::int32_t>(found.size()); ++index) {
      const api::Info info = found[static_cast<std::size_t>(index)];
      open(info);
      lsl_.destroy_streaminfo(info);
    }
  }
}

void MarkerInlets::open(api::Info info) {
  const std::string uid = text_or_empty(lsl_.get_uid(info));
  const std::string name = text_or_empty(lsl_.get_name(info));
  if (std::ranges::find(inlets_, uid, &Inlet::uid) != inlets_.end() || std::ranges::find(skipped_uids_, uid) != skipped_uids_.end()) return;
  const bool is_ours = text_or_empty(lsl_.get_source_id(info)).starts_with(kSourceIdPrefix);
  const bool is_markers = lsl_.get_nominal_srate(info) == api::kIrregularRate && lsl_.get_channel_count(info) == 1;
  if (is_ours || !is_markers || inlets_.size() >= kMostStreams) {
    if (!is_ours) log_.warning("the LSL stream " + name + " matches markers_from, but it is skipped: markers have one channel and no rate");
    if (skipped_uids_.size() == kMostSkipped) skipped_uids_.clear();
    skipped_uids_.push_back(uid);
    return;
  }
  const api::Inlet inlet = lsl_.create_inlet(info, kBufferLength, 0, kDoNotRecover);
  if (inlet == nullptr) return;  // the stream has ended already, or the next look tries again
  std::int32_t error = api::kNoError;
  double correction_s = lsl_.time_correction(inlet, kCorrectionLimitS, &error);
  if (error != api::kNoError) {
    lsl_.destroy_inlet(inlet);
    return;
  }
  if (std::abs(correction_s) < kSameClockS) correction_s = 0.0;
  log_.info("markers of the LSL stream " + name + " go into sessions");
  inlets_.push_back(
      {.inlet = inlet, .uid = uid, .name = name, .correction_s = correction_s, .limit = core::TokenBucket(kMarkersPerSecond)});
}

bool MarkerInlets::receive(Inlet& inlet) {
  for (;;) {
    char* text = nullptr;
    std::int32_t error = api::kNoError;
    const double sent_s = lsl_.pull_sample_str(inlet.inlet, &text, 1, 0.0, &error);
    if (error == api::kLostError) return false;
    if (sent_s == 0.0 || text == nullptr) return true;
    ReceivedMarker marker{.stream_uid = inlet.uid, .stream_name = inlet.name, .text = text, .sender_time_s = sent_s};
    lsl_.destroy_string(text);
    const double host_ns = (sent_s + inlet.correction_s) * 1e9;
    if (!std::isfinite(host_ns) || std::abs(host_ns) > 9e18) continue;  // no time at all
    marker.host_time_ns = std::llround(host_ns);
    if (inlet.limit.take(steady_clock::now())) {
      handle_(marker);
    } else if (reports_.take(steady_clock::now())) {
      log_.warning("the LSL stream " + inlet.name + " sends more than 50 markers per second: the rest is skipped");
    }
  }
}

}  // namespace dts::lsl
