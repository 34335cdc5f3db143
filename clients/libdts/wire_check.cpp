// SPDX-License-Identifier: Apache-2.0
#include "wire_check.h"

#include <limits>
#include <string>

namespace dts::client {
namespace {

constexpr int kMaxRigs = 64;
constexpr int kMaxStreams = 64;
constexpr int kMaxChannels = 256;
constexpr std::uint32_t kMaxScans = 65536;
constexpr int kMaxTexts = 1000;
constexpr std::size_t kLongestName = 64;
constexpr std::int64_t kMaxRateTerm = 1'000'000'000'000;

tl::unexpected<Error> damaged(const std::string& what) {
  return fail(ErrorCode::DataDamaged, "the daemon's answer makes no sense: " + what, "are dtsd and this program of the same version?");
}

Result<void> check_count(int count, int limit, const char* of_what) {
  if (count <= limit) return {};
  return damaged(std::to_string(count) + " " + of_what + ", at most " + std::to_string(limit) + " are possible");
}

bool is_name(const std::string& text) { return !text.empty() && text.size() <= kLongestName && text.find('/') == std::string::npos; }

Result<void> check_stream(const v1::StreamFormat& stream) {
  if (!is_name(stream.name())) return damaged("a stream without a proper name");
  if (!is_well_formed(stream.rate())) return damaged("stream '" + stream.name() + "' has an impossible rate");
  if (stream.channels_size() == 0) return damaged("stream '" + stream.name() + "' has no channels");
  return check_count(stream.channels_size(), kMaxChannels, "channels");
}

}  // namespace

bool is_well_formed(const v1::Rate& rate) noexcept {
  return rate.numerator() > 0 && rate.numerator() <= kMaxRateTerm && rate.denominator() > 0 && rate.denominator() <= kMaxRateTerm;
}

bool is_well_formed(const v1::StreamBlock& block) noexcept {
  if (block.instance_id() == 0 || !is_well_formed(block.rate())) return false;
  const std::uint64_t scans = block.scan_count();
  const std::uint64_t channels = block.channel_count();
  if (scans == 0 || scans > kMaxScans || channels == 0 || channels > static_cast<std::uint64_t>(kMaxChannels)) return false;
  if (static_cast<std::uint64_t>(block.values_size()) != scans * channels || block.quality().size() != channels) return false;
  return block.first_scan() <= std::numeric_limits<std::uint64_t>::max() - scans;
}

Result<void> check(const v1::RigInfo& rig) {
  if (!is_name(rig.name())) return damaged("a rig without a proper name");
  if (auto few = check_count(rig.sensors_size(), kMaxChannels, "sensors"); !few) return few;
  if (auto few = check_count(rig.streams_size(), kMaxStreams, "streams"); !few) return few;
  for (const v1::StreamFormat& stream : rig.streams()) {
    if (auto valid = check_stream(stream); !valid) return valid;
  }
  return {};
}

Result<void> check(const v1::StatusSnapshot& status) {
  if (status.instance_id() == 0) return damaged("no instance id");
  if (auto few = check_count(status.rigs_size(), kMaxRigs, "rigs"); !few) return few;
  if (auto few = check_count(status.notices_size(), kMaxTexts, "notices"); !few) return few;
  for (const v1::RigStatus& rig : status.rigs()) {
    if (auto valid = check(rig.rig()); !valid) return valid;
  }
  return {};
}

Result<void> check(const v1::ListRigsResponse& rigs) {
  if (auto few = check_count(rigs.rigs_size(), kMaxRigs, "rigs"); !few) return few;
  for (const v1::RigInfo& rig : rigs.rigs()) {
    if (auto valid = check(rig); !valid) return valid;
  }
  return {};
}

Result<void> check(const v1::GetDevicesResponse& devices) {
  if (auto few = check_count(devices.devices_size(), kMaxTexts, "devices"); !few) return few;
  return check_count(devices.kinds_size(), kMaxTexts, "kinds of device");
}

Result<void> check(const v1::TestDeviceResponse& test) {
  if (auto few = check_count(test.checks_size(), kMaxTexts, "checks"); !few) return few;
  return check_count(test.channels_size(), kMaxChannels, "channels");
}

Result<void> check(const v1::SessionInfo& session) {
  if (session.session_id().empty()) return damaged("a session without an id");
  return {};
}

Result<void> check(const v1::MarkResponse& mark) { return check_count(mark.marks_size(), kMaxRigs, "marks"); }

Result<void> check(const v1::TareResponse& tare) { return check_count(tare.baseline_mm_size(), kMaxChannels, "sensors"); }

}  // namespace dts::client
