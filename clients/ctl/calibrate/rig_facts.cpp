// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/rig_facts.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>

#include "cli/try.h"
#include "core/clock.h"
#include "ctl/commands.h"

namespace dts::ctl {

using client::ErrorCode;
using client::Result;

Result<double> RigFacts::rate_hz(const std::string& stream) const {
  const auto has_name = [&](const v1::StreamFormat& format) { return format.name() == stream; };
  const auto found = std::ranges::find_if(rig.streams(), has_name);
  const bool is_published = std::ranges::find(rig.published(), stream) != rig.published().end();
  if (found == rig.streams().end() || !is_published) {
    return client::fail(ErrorCode::NotFound, "rig '" + rig.name() + "' does not publish its stream '" + stream + "'",
                        "add it to streams in [publish] of the rig file and restart dtsd");
  }
  return static_cast<double>(found->rate().numerator()) / static_cast<double>(found->rate().denominator());
}

Result<void> RigFacts::check_idle() const {
  if (session_id.empty()) return {};
  return client::fail(ErrorCode::WrongState, "rig '" + rig.name() + "' has a running session: " + session_id,
                      "dtsctl session stop --rig " + rig.name());
}

Result<RigFacts> ask_rig_facts(client::ControlClient& dts, const std::string& rig) {
  DTS_TRY_ASSIGN(const auto status, dts.status());
  DTS_TRY_ASSIGN(const auto found, find_rig(status, rig));
  if (found.device() != v1::DEVICE_STATE_STREAMING) {
    const std::string why = found.device_message().empty() ? "its device does not stream" : found.device_message();
    return client::fail(ErrorCode::DeviceGone, "rig '" + rig + "': " + why, "dtsctl device list");
  }
  DTS_TRY_ASSIGN(const auto devices, dts.devices());
  RigFacts facts{.rig = found.rig(), .daq_model = {}, .daq_serial = {}, .session_id = {}};
  const v1::SessionState session = found.session().state();
  const bool is_over = session == v1::SESSION_STATE_UNSPECIFIED || session == v1::SESSION_STATE_IDLE || session == v1::SESSION_STATE_FAILED;
  if (!is_over) facts.session_id = found.session().session_id();
  for (const v1::DeviceInfo& device : devices.devices()) {
    if (device.rig() != rig) continue;
    facts.daq_model = device.model();
    facts.daq_serial = device.serial();
  }
  return facts;
}

std::string utc_now() {
  const core::SystemClock clock;
  const auto seconds = static_cast<std::time_t>((clock.now_ns() + clock.utc_minus_monotonic_ns()) / 1'000'000'000);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

tl::unexpected<client::Error> as_client_error(const core::Error& error) {
  return client::fail(static_cast<ErrorCode>(error.code), error.what, error.hint);
}

Result<std::string> free_file(const std::string& wanted) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::path(wanted).parent_path();
  const std::filesystem::path folder = parent.empty() ? "." : parent;
  if (!std::filesystem::is_directory(folder, error)) {
    return client::fail(ErrorCode::InvalidArgument, "cannot write " + wanted + ": there is no folder " + folder.string(),
                        "create the folder, or give another file with --out");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    return client::fail(ErrorCode::InvalidArgument, "cannot write " + wanted + ": no permission to write to the folder " + folder.string(),
                        "give another file with --out");
  }
  if (std::filesystem::is_directory(wanted, error)) {
    return client::fail(ErrorCode::InvalidArgument, wanted + " is a folder", "give a file in it with --out");
  }
  if (!std::filesystem::exists(wanted, error)) return wanted;
  return client::fail(ErrorCode::InvalidArgument, wanted + " already exists: a calibration is never overwritten",
                      "give another file with --out, or move the old one away");
}

}  // namespace dts::ctl
