// SPDX-License-Identifier: Apache-2.0
#include "ctl/command_tree.h"

#include <string>
#include <utility>

#include "cli/validators.h"
#include "ctl/calibrate/commands.h"
#include "ctl/commands.h"
#include "ctl/doctor.h"
#include "ctl/key_commands.h"
#include "ctl/manual.h"
#include "ctl/session_tree.h"
#include "ctl/top.h"
#include "ctl/watch.h"
#include "dts/error.h"

namespace dts::ctl {

CLI::App* add(CommandTree& tree, CLI::App& parent, const std::string& name, const std::string& description, const std::string& examples,
              Command handler) {
  return cli::add_command(tree.line, parent, name, description, examples,
                          [&tree, handler](cli::Console& console) { return handler(tree.arguments, console); });
}

namespace {

using cli::count_from_one;
using cli::number_between;
using cli::text_of;

CLI::Option* add_rig(CLI::App& command, std::string& rig, const std::string& description) {
  return command.add_option("--rig", rig, description)->option_text("RIG");
}

void add_globals(CommandTree& tree) {
  CLI::App& app = tree.line.app;
  app.add_option("--endpoint", tree.arguments.endpoint, "Control address of the daemon, ipc:///path/control.sock or tcp://host:port")
      ->option_text("URI");
  app.add_option("--data", tree.arguments.data, "Data address; found beside the control socket when not given")->option_text("URI");
  app.add_option("--key", tree.arguments.key_file, "Key of this machine for a daemon on another one (dtsctl key new); it knows the addresses")
      ->option_text("FILE");
  app.add_option("--timeout", tree.arguments.timeout_s,
                 "Give up after S seconds: a command without answer (3), a stream without data (never)")
      ->option_text("S")
      ->check(number_between(0.03, 86400.0, "seconds"));
  app.add_flag("--json", tree.arguments.is_json, "Print one JSON document");
}

void add_rigs_and_devices(CommandTree& tree) {
  CLI::App* rig = cli::add_group(tree.line.app, "rig", "What is set up", "dtsctl rig list | the rigs of this daemon\n");
  add(tree, *rig, "list", "List the rigs", "dtsctl rig list | name, kind, device and streams of each rig\n", run_rig_list);
  CLI::App* show = add(tree, *rig, "show", "Show one rig: plate, sensors, streams, stages, state",
                       "dtsctl rig show floor | everything about one rig\n", run_rig_show);
  show->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");

  CLI::App* device =
      cli::add_group(tree.line.app, "device", "The measuring hardware", "dtsctl device test floor | are all sensors well?\n");
  add(tree, *device, "list", "List devices and the kinds that can be configured",
      "dtsctl device list | model, serial and state of each device\n", run_device_list);
  CLI::App* test = add(tree, *device, "test", "Measure each channel of a rig's device over the last second",
                       "dtsctl device test floor | mean, noise and gap of each sensor\n", run_device_test);
  test->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");
}

void add_actions(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* mark = add(tree, tree.line.app, "mark", "Put a marker on the newest scan",
                       "dtsctl mark \"eyes closed\" | in the data of every rig\ndtsctl mark step --rig floor | of one rig\n", run_mark);
  mark->add_option("TEXT", arguments.text, "Text of the marker; put several words in quotes")
      ->required()
      ->option_text(" ")
      ->check(text_of(1, 200));
  add_rig(*mark, arguments.rig, "Mark only this rig");
  CLI::App* tare = add(tree, tree.line.app, "tare", "Take the present deflections as zero; nobody on the plate",
                       "dtsctl tare --rig floor | with the plate empty\n", run_tare);
  add_rig(*tare, arguments.rig, "Rig to tare")->required();
}

void add_keys(CommandTree& tree) {
  KeyArguments& wishes = tree.arguments.key;
  CLI::App* group = cli::add_group(tree.line.app, "key", "Who may connect from other machines", "dtsctl key list | who may, and what\n");
  CLI::App* made = add(tree, *group, "new", "Make a key for another machine, and print the name of its file",
                       "dtsctl key new ward-3 --role viewer | writes ward-3.key, to be carried there\n"
                       "dtsctl --key ward-3.key watch floor/cop | over there\n",
                       run_key_new);
  made->add_option("NAME", wishes.name, "Whom it is for: 1..32 of a-z 0-9 . _ -")->required()->option_text(" ")->check(text_of(1, 32));
  made->add_option("--role", wishes.role, "viewer looks, operator runs sessions, engineer changes devices and keys")
      ->required()
      ->option_text("ROLE")
      ->check(CLI::IsMember({"viewer", "operator", "engineer"}));
  made->add_option("--out", wishes.out, "File to write (NAME.key)")->option_text("FILE");
  made->add_option("--host", wishes.host, "Name or address of the daemon's machine as others reach it (as it was reached now, or its host name)")->option_text("HOST");
  add(tree, *group, "list", "List the keys that the daemon knows", "dtsctl key list | name, role and date of each\n", run_key_list);
  CLI::App* revoked = add(tree, *group, "revoke", "End the rights and the connections of a key", "dtsctl key revoke ward-3 | a machine was lost\n",
                          run_key_revoke);
  revoked->add_option("NAME", wishes.name, "Name of the key")->required()->option_text(" ")->check(text_of(1, 32));
}

void add_watch(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* watch = add(tree, tree.line.app, "watch", "Show live samples and events",
                        "dtsctl watch | everything, as a live table\n"
                        "dtsctl watch floor/cop | the centre of pressure of the floor platform\n"
                        "dtsctl watch floor/cop --count 200 --jsonl > cop.jsonl | 200 scans for a program\n"
                        "dtsctl watch floor/cop --count 200 --csv > cop.csv | the same for a spreadsheet\n"
                        "dtsctl watch floor/gap floor/marker | only when something happens\n"
                        "dtsctl watch dtsd/status --count 1 --jsonl | the daemon's own state\n",
                        run_watch);
  watch->add_option("TOPIC-PREFIX", arguments.topics, "Topics that begin so: RIG/STREAM, RIG/EVENT, RIG/ (everything but dtsd/status)")
      ->option_text("...");
  watch->add_option("--count", arguments.count, "End after N scans; an event counts as one")->option_text("N")->check(count_from_one());
  CLI::Option* jsonl = watch->add_flag("--jsonl", arguments.is_jsonl, "One JSON object per line");
  watch->add_flag("--csv", arguments.is_csv, "One stream as CSV: a line of names, then a line per scan")->excludes(jsonl);
  watch->add_flag("--latest", arguments.is_latest, "After a pause show only the newest block of each stream");
  cli::explain(tree.line, *watch,
               "ml, ap | centre of pressure, mm: positive to the subject's right, and forward\n"
               "load | force on the plate, N\n"
               "MVELO | sway: mean velocity of the centre of pressure, mm/s\n"
               "RDIST | sway: rms distance from the mean position, mm\n"
               "PEA95_F | sway: area of the 95 % ellipse, mm2\n"
               "RANGE_AP | sway: range forward and backward, mm\n"
               "[words] | what is doubtful about the values\n");
}

void add_top(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* top = add(tree, tree.line.app, "top", "Show the daemon's health once a second: rates, losses by cause, queues, latency, recordings",
                      "dtsctl top | redrawn in place until Ctrl-C\n"
                      "dtsctl top --jsonl --count 60 > health.jsonl | a minute for a program\n",
                      run_top);
  top->add_option("--count", arguments.count, "End after N statuses")->option_text("N")->check(count_from_one());
  top->add_flag("--jsonl", arguments.is_jsonl, "One JSON object per line, as into a pipe");
  cli::explain(tree.line, *top,
               "RATE (Hz) | scans per second over the last seconds\n"
               "LOST | scans that were lost before they could be processed, since the daemon's start\n"
               "GAPS | in how many places\n"
               "DROPPED | blocks that were not sent to clients because they were not ready in time; recordings have them\n"
               "QUEUES (%) | how full the queues before processing, sending and recording were at most within half a minute\n"
               "US/SCAN | microseconds that processing takes for a scan\n"
               "P50, P95 (ms) | 50 % and 95 % of the blocks of the last ten seconds were sent so soon after their newest scan\n"
               "SESSION | the session under way, or the last one\n");
}

}  // namespace

std::unique_ptr<CommandTree> make_command_tree() {
  auto owner = std::make_unique<CommandTree>();
  CommandTree& tree = *owner;
  tree.line.manual = make_manual();
  add_globals(tree);
  add(tree, tree.line.app, "status", "State of daemon, rigs, devices, sessions, rates and losses",
      "dtsctl status | for people\ndtsctl status --json | for programs\n", run_status);
  add_rigs_and_devices(tree);
  add_sessions(tree);
  add_actions(tree);
  add_watch(tree);
  add_top(tree);
  add_calibrate(tree);
  add_keys(tree);
  add(tree, tree.line.app, "doctor", "Check daemon, rigs and this machine; say how to mend what is wrong",
      "dtsctl doctor | one line per check\n", run_doctor);
  cli::add_common(tree.line);
  return owner;
}

}  // namespace dts::ctl
