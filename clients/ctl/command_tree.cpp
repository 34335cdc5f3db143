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
  app.add_option("--endpoint", tree.arguments.endpoint,
                 "Control address of the daemon: ipc:///path/control.sock or tcp://host:port. Default: found automatically")
      ->option_text("URI");
  app.add_option("--data", tree.arguments.data, "Data address of the daemon. Default: the data socket beside the control socket")
      ->option_text("URI");
  app.add_option("--key", tree.arguments.key_file,
                 "Key file of this machine for a daemon on another machine (dtsctl key new); it contains the addresses")
      ->option_text("FILE");
  app.add_option("--timeout", tree.arguments.timeout_s,
                 "Give up after S seconds without an answer or without data. Default: 3 for a command, never for a stream")
      ->option_text("S")
      ->check(number_between(0.03, 86400.0, "seconds"));
  app.add_flag("--json", tree.arguments.is_json, "Print one JSON document");
}

void add_rigs_and_devices(CommandTree& tree) {
  CLI::App* rig = cli::add_group(tree.line.app, "rig", "Show the rigs of this daemon", "dtsctl rig list | all rigs\n");
  add(tree, *rig, "list", "List the rigs", "dtsctl rig list | name, kind, device and streams of each rig\n", run_rig_list);
  CLI::App* show = add(tree, *rig, "show", "Show one rig: plate, sensors, streams, stages and state",
                       "dtsctl rig show floor | everything about one rig\n", run_rig_show);
  show->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");

  CLI::App* device =
      cli::add_group(tree.line.app, "device", "List and test the measuring hardware", "dtsctl device test floor | check every sensor\n");
  add(tree, *device, "list", "List the devices and the kinds of device that a rig can use",
      "dtsctl device list | model, serial and state of each device\n", run_device_list);
  CLI::App* test = add(tree, *device, "test", "Show mean, noise and range of each channel of a rig's device over the last second",
                       "dtsctl device test floor | mean, noise and gap of each sensor\n", run_device_test);
  test->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");
}

void add_actions(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* mark = add(tree, tree.line.app, "mark", "Put a marker (a note) at the newest scan",
                       "dtsctl mark \"eyes closed\" | in every rig\ndtsctl mark step --rig floor | in one rig\n", run_mark);
  mark->add_option("TEXT", arguments.text, "Text of the marker, up to 200 bytes; put several words in quotes")
      ->required()
      ->option_text(" ")
      ->check(text_of(1, 200));
  add_rig(*mark, arguments.rig, "Mark only this rig");
  CLI::App* tare = add(tree, tree.line.app, "tare", "Tare a rig: what it reads now becomes zero. The plate or chair must be empty",
                       "dtsctl tare --rig floor | when no one is on the plate\n", run_tare);
  add_rig(*tare, arguments.rig, "Rig to tare")->required();
}

void add_keys(CommandTree& tree) {
  KeyArguments& wishes = tree.arguments.key;
  CLI::App* group = cli::add_group(tree.line.app, "key", "Manage the keys of other machines", "dtsctl key list | names and roles\n");
  CLI::App* made = add(tree, *group, "new", "Make a key for another machine and print the name of its file",
                       "dtsctl key new ward-3 --role viewer | writes ward-3.key; copy it to that machine\n"
                       "dtsctl --key ward-3.key watch floor/cop | use it on that machine\n",
                       run_key_new);
  made->add_option("NAME", wishes.name, "Name of the machine or person: 1 to 32 characters of a-z 0-9 . _ -")
      ->required()
      ->option_text(" ")
      ->check(text_of(1, 32));
  made->add_option("--role", wishes.role, "viewer: look; operator: run sessions; engineer: change devices and keys")
      ->required()
      ->option_text("ROLE")
      ->check(CLI::IsMember({"viewer", "operator", "engineer"}));
  made->add_option("--out", wishes.out, "File to write. Default: NAME.key in this folder")->option_text("FILE");
  made->add_option("--host", wishes.host,
                   "Name or address of the daemon's machine on the network. Default: the address that this command uses, or the host name")
      ->option_text("HOST");
  add(tree, *group, "list", "List the keys that the daemon accepts", "dtsctl key list | name, role and date of each\n", run_key_list);
  CLI::App* revoked = add(tree, *group, "revoke", "Revoke a key and close its connections",
                          "dtsctl key revoke ward-3 | when a machine was lost\n", run_key_revoke);
  revoked->add_option("NAME", wishes.name, "Name of the key")->required()->option_text(" ")->check(text_of(1, 32));
}

void add_watch(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* watch = add(tree, tree.line.app, "watch", "Show live samples and events",
                        "dtsctl watch | everything, in a live table; q ends\n"
                        "dtsctl watch floor/cop | the centre of pressure of the floor platform\n"
                        "dtsctl watch floor/cop --count 200 --jsonl > cop.jsonl | 200 scans for a program\n"
                        "dtsctl watch floor/cop --count 200 --csv > cop.csv | the same for a spreadsheet\n"
                        "dtsctl watch floor/gap floor/marker | events only\n"
                        "dtsctl watch dtsd/status --count 1 --jsonl | the state of the daemon\n",
                        run_watch);
  watch
      ->add_option("TOPIC-PREFIX", arguments.topics,
                   "Show topics that begin with this: RIG/STREAM, RIG/EVENT or RIG/. Default: everything except dtsd/status")
      ->option_text("...");
  watch
      ->add_option("--count", arguments.count,
                   "End after N scans and events together; with --csv after N rows of its stream. Default: no end")
      ->option_text("N")
      ->check(count_from_one());
  CLI::Option* jsonl = watch->add_flag("--jsonl", arguments.is_jsonl, "Print one JSON object per line");
  watch->add_flag("--csv", arguments.is_csv, "Print one stream as CSV: a line with the names, then a line per scan")->excludes(jsonl);
  watch->add_flag("--latest", arguments.is_latest, "Skip old blocks after a pause: show only the newest block of each stream");
  cli::explain(tree.line, *watch,
               "ml, ap | centre of pressure, mm: positive to the subject's right (ml) and forward (ap)\n"
               "load | force on the plate, N\n"
               "velocity (MVELO) | sway: mean velocity of the centre of pressure, mm/s\n"
               "distance (RDIST) | sway: rms distance from the mean position, mm\n"
               "ellipse (PEA95_F) | sway: area of the 95 % ellipse, mm2\n"
               "range AP (RANGE_AP) | sway: range forward and backward, mm\n"
               "last 30 s | sway outside a trial: the values cover this time, since the person stands still\n"
               "[words] | reasons to doubt the values\n");
}

void add_top(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* top =
      add(tree, tree.line.app, "top", "Show the health of the daemon once per second: rates, losses by cause, queues, latency, recordings",
          "dtsctl top | updated in place; q ends\n"
          "dtsctl top --jsonl --count 60 > health.jsonl | one minute, for a program\n",
          run_top);
  top->add_option("--count", arguments.count, "End after N statuses; the daemon sends one per second. Default: no end")
      ->option_text("N")
      ->check(count_from_one());
  top->add_flag("--jsonl", arguments.is_jsonl, "Print one JSON object per line. Default when the output is not a terminal");
  cli::explain(
      tree.line, *top,
      "RATE (Hz) | scans per second, averaged over the last seconds\n"
      "LOST | scans lost before the pipeline, since the daemon started\n"
      "GAPS | number of gaps with lost scans, since the daemon started\n"
      "DROPPED | blocks not sent to clients because a queue was full; recordings contain them\n"
      "QUEUES (%) | highest fill of the queues before processing, sending and recording in the last 30 s\n"
      "US/SCAN | processing time per scan, microseconds\n"
      "P50, P95 (ms) | delay from the newest scan to sending: 50 % and 95 % of the blocks of the last 10 s were sent within this time\n"
      "SESSION | the session under way\n"
      "(columns) | a narrow terminal shows fewer; --jsonl has all values\n");
}

}  // namespace

std::unique_ptr<CommandTree> make_command_tree() {
  auto owner = std::make_unique<CommandTree>();
  CommandTree& tree = *owner;
  tree.line.manual = make_manual();
  add_globals(tree);
  add(tree, tree.line.app, "status", "Show the state of daemon, rigs, devices, sessions, rates and losses",
      "dtsctl status | a table\ndtsctl status --json | for a program\n", run_status);
  add_rigs_and_devices(tree);
  add_sessions(tree);
  add_actions(tree);
  add_watch(tree);
  add_top(tree);
  add_calibrate(tree);
  add_keys(tree);
  add(tree, tree.line.app, "doctor", "Check daemon, rigs and this machine; show how to fix each problem",
      "dtsctl doctor | one line per check\n", run_doctor);
  cli::add_common(tree.line);
  return owner;
}

}  // namespace dts::ctl
