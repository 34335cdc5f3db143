// SPDX-License-Identifier: Apache-2.0
#include "ctl/commands.h"

#include <chrono>

#include "ctl/exit_status.h"
#include "ctl/json.h"
#include "ctl/status_view.h"
#include "ctl/suggestion.h"

namespace dts::ctl {
namespace {

using client::ControlClient;
using client::Result;

/// Connects, asks, and prints the answer as JSON or through `view`.
template <class Ask, class View>
int ask_and_print(const CommandTree& tree, Console& console, Ask&& ask, View&& view) {
  auto dts = connect(tree.arguments);
  if (!dts) return fail_with(console, dts.error());
  const auto answer = ask(*dts);
  if (!answer) return fail_with(console, answer.error());
  if (tree.arguments.is_json) {
    console.out << document(to_json(*answer));
  } else {
    view(*answer);
  }
  console.out.flush();
  return kOk;
}

Result<v1::RigStatus> find_rig(const v1::StatusSnapshot& status, const std::string& name) {
  std::vector<std::string> known;
  for (const v1::RigStatus& rig : status.rigs()) {
    if (rig.rig().name() == name) return rig;
    known.push_back(rig.rig().name());
  }
  std::string list;
  for (const std::string& rig : known) list += (list.empty() ? "" : ", ") + rig;
  const std::string meant = nearest(name, known);
  const std::string hint = meant.empty() ? "there are: " + list : "did you mean " + meant + "?";
  return client::fail(client::ErrorCode::NotFound, "no rig '" + name + "'", known.empty() ? "no rig is configured" : hint);
}

}  // namespace

Result<client::Endpoints> endpoints(const Arguments& arguments) {
  return client::find_endpoints({.control = arguments.endpoint, .data = arguments.data});
}

Result<ControlClient> connect(const Arguments& arguments) {
  const auto where = endpoints(arguments);
  if (!where) return tl::make_unexpected(where.error());
  client::ControlOptions options{.endpoint = where->control};
  if (arguments.timeout_s) {
    options.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(*arguments.timeout_s * 1000.0));
    options.tare_timeout = options.timeout;
  }
  return ControlClient::open(options);
}

int fail_with(Console& console, const client::Error& error) {
  print_error(console, error);
  return exit_status(error.code);
}

int run_status(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [](ControlClient& dts) { return dts.status(); },
      [&](const v1::StatusSnapshot& status) { print_status(console, status); });
}

int run_rig_list(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [](ControlClient& dts) { return dts.list_rigs(); },
      [&](const v1::ListRigsResponse& rigs) {
        print_rigs(console, rigs);
        if (rigs.rigs_size() > 0) print_hint(console, "details: dtsctl rig show " + rigs.rigs(0).name());
      });
}

int run_rig_show(const CommandTree& tree, Console& console) {
  const auto ask = [&](ControlClient& dts) {
    return dts.status().and_then([&](const v1::StatusSnapshot& status) { return find_rig(status, tree.arguments.rig); });
  };
  return ask_and_print(tree, console, ask, [&](const v1::RigStatus& rig) { print_rig(console, rig); });
}

int run_device_list(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [](ControlClient& dts) { return dts.devices(); },
      [&](const v1::GetDevicesResponse& devices) { print_devices(console, devices); });
}

int run_device_test(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [&](ControlClient& dts) { return dts.test_device(tree.arguments.rig); },
      [&](const v1::TestDeviceResponse& test) { print_device_test(console, test); });
}

int run_session_start(const CommandTree& tree, Console& console) {
  const Arguments& arguments = tree.arguments;
  v1::StartSessionRequest request;
  request.set_rig(arguments.rig);
  request.set_protocol(arguments.protocol);
  request.set_subject(arguments.subject);
  request.set_label(arguments.label);
  request.set_duration_s(arguments.duration_s);
  request.set_settle_s(arguments.settle_s);
  return ask_and_print(
      tree, console, [&](ControlClient& dts) { return dts.start_session(request); },
      [&](const v1::SessionInfo& session) {
        console.out << printable(session.session_id()) << '\n';
        print_hint(console, "stop it: dtsctl session stop --rig " + session.rig() + "   see it: dtsctl watch " + session.rig() + "/");
      });
}

int run_session_stop(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [&](ControlClient& dts) { return dts.stop_session(tree.arguments.rig); },
      [&](const v1::SessionInfo& session) { console.out << session_line(session) << '\n'; });
}

int run_mark(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [&](ControlClient& dts) { return dts.mark(tree.arguments.text, tree.arguments.rig); },
      [&](const v1::MarkResponse& mark) {
        for (const v1::MarkResponse::At& at : mark.marks()) {
          console.out << printable(at.rig()) << ": segment " << at.segment() << ", scan " << at.scan() << '\n';
        }
      });
}

int run_tare(const CommandTree& tree, Console& console) {
  return ask_and_print(
      tree, console, [&](ControlClient& dts) { return dts.tare(tree.arguments.rig); },
      [&](const v1::TareResponse& tare) { console.out << tare_line(tree.arguments.rig, tare) << '\n'; });
}

}  // namespace dts::ctl
