// SPDX-License-Identifier: Apache-2.0
#include "ctl/commands.h"

#include <algorithm>
#include <chrono>

#include "cli/suggestion.h"
#include "cli/try.h"
#include "ctl/ask.h"
#include "ctl/status_view.h"

namespace dts::ctl {

using client::ControlClient;
using client::Result;

Result<v1::RigStatus> find_rig(const v1::StatusSnapshot& status, const std::string& name) {
  std::vector<std::string> known;
  for (const v1::RigStatus& rig : status.rigs()) {
    if (rig.rig().name() == name) return rig;
    known.push_back(rig.rig().name());
  }
  const std::string hint = known.empty() ? "add a [[rig]] to the daemon's configuration" : cli::known_words_hint(name, known);
  return client::fail(client::ErrorCode::NotFound, "no rig '" + name + "'", hint);
}

Result<Target> target(const Arguments& arguments) {
  Target found;
  client::EndpointWishes wishes{.control = arguments.endpoint, .data = arguments.data};
  const char* const environment = client::process_environment("DTSD_KEY");
  const std::string file = !arguments.key_file.empty() || environment == nullptr ? arguments.key_file : environment;
  if (!file.empty()) {
    DTS_TRY_ASSIGN(auto key, client::read_key(file));
    if (wishes.control.empty() && wishes.data.empty()) {
      if (key.control.empty()) {
        return client::fail(client::ErrorCode::InvalidArgument,
                            file + " contains no address: the daemon accepted no other machines when the key was made",
                            "give --endpoint tcp://HOST:PORT, or add [network] to the daemon's configuration and make a new key");
      }
      wishes = {.control = key.control, .data = key.data};
    }
    found.key = std::move(key);
  }
  DTS_TRY_ASSIGN(found.endpoints, client::find_endpoints(wishes));
  return found;
}

Result<ControlClient> connect(const Arguments& arguments) {
  DTS_TRY_ASSIGN(const auto where, target(arguments));
  client::ControlOptions options{.endpoint = where.endpoints.control, .key = where.key};
  if (arguments.timeout_s) options.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(*arguments.timeout_s * 1000.0));
  return ControlClient::open(options);
}

namespace {

bool has_session(const v1::StatusSnapshot& status, const std::string& name) {
  return std::ranges::any_of(status.rigs(), [&](const v1::RigStatus& rig) {
    const v1::SessionState state = rig.session().state();
    const bool is_over = state == v1::SESSION_STATE_UNSPECIFIED || state == v1::SESSION_STATE_IDLE || state == v1::SESSION_STATE_FAILED;
    return rig.rig().name() == name && !is_over;
  });
}

/// Warns that a marker without a session reaches only the clients that are connected now. If there are several rigs, one with a session is
/// enough.
void warn_unrecorded(const v1::StatusSnapshot& status, const v1::MarkResponse& mark, cli::Console& console) {
  const auto& marks = mark.marks();
  if (marks.empty() || std::ranges::any_of(marks, [&](const v1::MarkResponse::At& at) { return has_session(status, at.rig()); })) return;
  const std::string where = marks.size() == 1 ? " on rig '" + marks[0].rig() + "'" : "";
  cli::print_error(console, "no session is running" + where + ": this marker is not recorded",
                   "dtsctl session start --rig " + (marks.size() == 1 ? marks[0].rig() : "RIG") + " --protocol NAME");
}

}  // namespace

int run_status(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.status(); },
      [&](const v1::StatusSnapshot& status) { print_status(console, status); });
}

int run_rig_list(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.list_rigs(); },
      [&](const v1::ListRigsResponse& rigs) {
        print_rigs(console, rigs);
        if (rigs.rigs_size() > 0) cli::print_hint(console, "details: dtsctl rig show " + rigs.rigs(0).name());
      });
}

int run_rig_show(const Arguments& arguments, cli::Console& console) {
  const auto ask = [&](ControlClient& dts) {
    return dts.status().and_then([&](const v1::StatusSnapshot& status) { return find_rig(status, arguments.rig); });
  };
  return ask_and_print(arguments, console, ask, [&](const v1::RigStatus& rig) { print_rig(console, rig); });
}

int run_device_list(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.devices(); },
      [&](const v1::GetDevicesResponse& devices) { print_devices(console, devices); });
}

int run_device_test(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.test_device(arguments.rig); },
      [&](const v1::TestDeviceResponse& test) { print_device_test(console, test); });
}

int run_mark(const Arguments& arguments, cli::Console& console) {
  v1::StatusSnapshot after;
  return ask_and_print(
      arguments, console,
      [&](ControlClient& dts) {
        auto mark = dts.mark(arguments.text, arguments.rig);
        if (!mark) return mark;
        if (const auto status = dts.status()) {  // after the marker, which must not be delayed
          warn_unrecorded(*status, *mark, console);
          after = *status;
        }
        return mark;
      },
      [&](const v1::MarkResponse& mark) {
        for (const v1::MarkResponse::At& at : mark.marks()) {
          const bool is_unrecorded = after.rigs_size() > 0 && !has_session(after, at.rig());
          console.out << "rig '" << cli::printable(at.rig()) << "' marked: segment " << at.segment() << ", scan " << at.scan()
                      << (is_unrecorded ? ", not recorded: no session" : "") << '\n';
        }
      });
}

int run_tare(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.tare(arguments.rig); },
      [&](const v1::TareResponse& tare) { console.out << tare_line(arguments.rig, tare) << '\n'; });
}

}  // namespace dts::ctl
