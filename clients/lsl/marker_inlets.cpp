// SPDX-License-Identifier: Apache-2.0
#include "lsl/marker_inlets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "core/thread.h"
#include "lsl/hash_text.h"
#include "lsl/outlet.h"

namespace dts::lsl {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPause{5};
constexpr std::chrono::milliseconds kLookPeriod{250};
constexpr double kForgetAfterS = 5.0;
constexpr std::int32_t kBufferLength = 1000;  // samples: the stream has no rate
constexpr std::int32_t kDoNotRecover = 0;     // a sender that comes back has a new uid, and its stream is found again
constexpr std::size_t kMostStreams = 32;
constexpr std::size_t kMostFound = 64;         // of one answer
constexpr std::size_t kMostUnmeasured = 1000;  // of one stream
constexpr std::size_t kMostWaiting = 4000;
constexpr std::size_t kMostSkipped = 1024;
constexpr double kCorrectionLimitS = 0.001;  // LSL measures in a thread of its own; the first call starts it
constexpr std::chrono::seconds kCorrectionPeriod{2};
constexpr std::chrono::milliseconds kFirstCorrectionPeriod{100};
constexpr std::chrono::seconds kCorrectionDelay{5};  // the log then says that markers wait
constexpr std::chrono::seconds kLongestWait{5};      // dtsd rejects markers that are older
constexpr double kSameClockS = 1e-3;                 // clocks of two machines differ by more: each counts from its own start
constexpr double kMarkersPerSecond = 50.0;
constexpr std::size_t kUidBytes = 36;

std::string text_or_empty(const char* text) { return text != nullptr ? text : ""; }

}  // namespace

std::string request_id(const ReceivedMarker& marker) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx%03x",
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(marker.sender_time_s)), marker.repeat & 0xfffU);
  return "l" + marker.stream_uid.substr(0, kUidBytes) + digits.data() + hash_text(marker.text);
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
  inlets->handler_ = std::jthread([owner = inlets.get()](const std::stop_token& stop) { owner->hand_over(stop); });
  inlets->thread_ = std::jthread([owner = inlets.get()](const std::stop_token& stop) { owner->run(stop); });
  return inlets;
}

MarkerInlets::~MarkerInlets() {
  for (std::jthread* const thread : {&thread_, &handler_}) {
    thread->request_stop();
    if (thread->joinable()) thread->join();
  }
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
      const bool is_open = receive(inlet);
      measure_clock(inlet);
      pass(inlet);
      if (!is_open) close(inlet);
      return !is_open;
    });
    std::this_thread::sleep_for(kPause);
  }
}

void MarkerInlets::find_streams() {
  // The resolver knows a stream for this time after its end.
  std::erase_if(ended_, [](const Ended& ended) { return steady_clock::now() - ended.at > std::chrono::duration<double>(kForgetAfterS); });
  for (const api::Resolver resolver : resolvers_) {
    std::array<api::Info, kMostFound> found{};
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
  if (std::ranges::find(ended_, uid, &Ended::uid) != ended_.end()) return;
  const bool is_ours = text_or_empty(lsl_.get_source_id(info)).starts_with(kSourceIdPrefix);
  const bool is_markers = lsl_.get_nominal_srate(info) == api::kIrregularRate && lsl_.get_channel_count(info) == 1;
  if (is_ours || !is_markers) {
    if (!is_ours) log_.warning("the LSL stream " + name + " matches markers_from, but it is skipped: markers have one channel and no rate");
    if (skipped_uids_.size() == kMostSkipped) skipped_uids_.clear();
    skipped_uids_.push_back(uid);
    return;
  }
  if (inlets_.size() >= kMostStreams) {
    if (!std::exchange(is_full_logged_, true)) {
      log_.warning("the LSL stream " + name + " matches markers_from, but it must wait: dts-lsl receives from at most " +
                   std::to_string(kMostStreams) + " marker streams. End one of them, or make markers_from narrower");
    }
    return;
  }
  const api::Inlet inlet = lsl_.create_inlet(info, kBufferLength, 0, kDoNotRecover);
  if (inlet == nullptr) return;  // the stream has ended already, or the next look tries again
  Inlet opened{.inlet = inlet, .uid = uid, .name = name, .limit = core::TokenBucket(kMarkersPerSecond)};
  opened.opened = steady_clock::now();
  inlets_.push_back(std::move(opened));
}

/// Asks LSL for its newest measurement of the sender's clock: clocks of two machines drift.
void MarkerInlets::measure_clock(Inlet& inlet) {
  const auto now = steady_clock::now();
  if (now < inlet.next_correction) return;
  std::int32_t error = api::kNoError;
  const double correction_s = lsl_.time_correction(inlet.inlet, kCorrectionLimitS, &error);
  if (error == api::kNoError && std::isfinite(correction_s)) {
    if (!inlet.correction_s) log_.info("markers of the LSL stream " + inlet.name + " go into sessions");
    inlet.correction_s = std::abs(correction_s) < kSameClockS ? 0.0 : correction_s;
  } else if (!inlet.correction_s && now - inlet.opened > kCorrectionDelay && !std::exchange(inlet.is_delay_logged, true)) {
    log_.warning("the clock of the LSL stream " + inlet.name + " cannot be measured: its markers wait. Check that UDP reaches its machine");
  }
  inlet.next_correction = now + (inlet.correction_s ? std::chrono::milliseconds(kCorrectionPeriod) : kFirstCorrectionPeriod);
}

/// Takes all that LSL has. An inlet whose stream has ended gives nothing any more, so nothing may delay this.
bool MarkerInlets::receive(Inlet& inlet) {
  for (std::size_t count = 0; count < kMostUnmeasured; ++count) {
    char* text = nullptr;
    std::int32_t error = api::kNoError;
    const double sent_s = lsl_.pull_sample_str(inlet.inlet, &text, 1, 0.0, &error);
    if (error == api::kLostError) return false;
    if (sent_s == 0.0 || text == nullptr) return true;
    inlet.repeat = sent_s == inlet.last_sent_s ? inlet.repeat + 1 : 0;
    inlet.last_sent_s = sent_s;
    ReceivedMarker marker{
        .stream_uid = inlet.uid, .stream_name = inlet.name, .text = text, .sender_time_s = sent_s, .repeat = inlet.repeat};
    lsl_.destroy_string(text);
    if (!inlet.limit.take(steady_clock::now())) {
      report("the LSL stream " + inlet.name + " sends more than 50 markers per second: the rest is skipped");
    } else if (inlet.unmeasured.size() >= kMostUnmeasured) {
      report("too many markers of the LSL stream " + inlet.name + " wait: the rest is skipped");
    } else {
      inlet.unmeasured.push_back(std::move(marker));
    }
  }
  return true;
}

/// Gives the markers whose time is known to the other thread.
void MarkerInlets::pass(Inlet& inlet) {
  if (!inlet.correction_s) return;
  for (ReceivedMarker& marker : inlet.unmeasured) {
    const double host_ns = (marker.sender_time_s + *inlet.correction_s) * 1e9;
    if (!std::isfinite(host_ns) || std::abs(host_ns) > 9e18) {
      report("a marker of the LSL stream " + inlet.name + " is skipped: its time is no number");
      continue;
    }
    marker.host_time_ns = std::llround(host_ns);
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMostWaiting) {
      report("a marker of the LSL stream " + inlet.name + " is skipped: too many wait for dtsd");
      continue;
    }
    waiting_.push_back({.marker = std::move(marker), .received = steady_clock::now()});
    changed_.notify_one();
  }
  inlet.unmeasured.clear();
}

void MarkerInlets::close(Inlet& inlet) {
  log_.info("the marker stream " + inlet.name + " has ended");
  if (!inlet.unmeasured.empty()) {
    log_.warning(std::to_string(inlet.unmeasured.size()) + " markers of the LSL stream " + inlet.name +
                 " are skipped: it ended before its clock was measured");
  }
  lsl_.destroy_inlet(inlet.inlet);
  ended_.push_back({.uid = inlet.uid, .at = steady_clock::now()});
  is_full_logged_ = false;
}

void MarkerInlets::report(const std::string& text) {
  if (reports_.take(steady_clock::now())) log_.warning(text);
}

void MarkerInlets::hand_over(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("marks", {}));
  core::TokenBucket reports(0.1, 5.0);
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) return;
    const Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    if (steady_clock::now() - next.received <= kLongestWait) {
      handle_(next.marker, stop);
    } else if (reports.take(steady_clock::now())) {
      log_.warning("a marker of the LSL stream " + next.marker.stream_name + " is skipped: dtsd did not answer for 5 s");
    }
  }
}

}  // namespace dts::lsl
