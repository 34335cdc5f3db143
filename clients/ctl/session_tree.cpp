// SPDX-License-Identifier: Apache-2.0
#include "ctl/session_tree.h"

#include <string>

#include "cli/validators.h"
#include "ctl/compare_sessions.h"
#include "ctl/session_commands.h"
#include "ctl/sessions/export_command.h"
#include "ctl/sessions/recover_command.h"
#include "ctl/sessions/report_command.h"
#include "ctl/sessions/verify_command.h"

namespace dts::ctl {
namespace {

using cli::number_between;
using cli::text_of;
using cli::whole_number_between;

constexpr std::int64_t kLongestList = 1000;  // an answer cannot hold more

/// Checks for KEY=VALUE, the format that `start_session` parses.
CLI::Validator key_and_value() {
  const auto check = [](std::string& text) -> std::string {
    const std::size_t equals = text.find('=');
    const bool is_pair = equals != std::string::npos && equals > 0 && equals + 1 < text.size() && text.size() <= 200;
    return is_pair ? "" : "'" + text + "' is not of the form KEY=VALUE";
  };
  return {check, "", "pair"};
}

void add_rig(CLI::App& command, CommandTree& tree, const std::string& description) {
  command.add_option("--rig", tree.arguments.rig, description)->option_text("RIG");
}

void add_id(CLI::App& command, CommandTree& tree, const std::string& name, const std::string& description) {
  command.add_option(name, tree.arguments.session.id, description)->required()->option_text(" ")->check(text_of(1, 4096));
}

void add_limit(CLI::App& command, CommandTree& tree, const std::string& description) {
  command.add_option("--limit", tree.arguments.session.limit, description)->option_text("N")->check(whole_number_between(1, kLongestList));
}

void add_start(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* start =
      add(tree, session, "start", "Start a session, record it, and print its id",
          "dtsctl session start --rig floor | until stopped\n"
          "dtsctl session start --rig floor --duration 25 --settle 5 | 5 s to settle, then 25 s\n"
          "dtsctl session start --rig chair --subject P017 --label \"eyes closed\" | with a pseudonym and a note\n"
          "dtsctl session start --rig floor --protocol quiet-standing --subject P017 --field weight_kg=71.5 | as a protocol asks\n",
          run_session_start);
  start->add_option("--rig", tree.arguments.rig, "Rig to use")->option_text("RIG")->required();
  start->add_option("--protocol", wishes.protocol, "Protocol to follow (free)")->option_text("NAME");
  start->add_option("--subject", wishes.subject, "Pseudonym given by the clinic, never a name")->option_text("PSEUDONYM");
  start->add_option("--field", wishes.fields, "What the protocol asks about the subject; see protocol show")
      ->option_text("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(key_and_value());
  start->add_option("--label", wishes.label, "Free text, never a name")->option_text("TEXT")->check(text_of(0, 200));
  start->add_option("--duration", wishes.duration_s, "Stop by itself after S seconds")
      ->option_text("S")
      ->check(number_between(0.0, 604800.0, "seconds"));
  start->add_option("--settle", wishes.settle_s, "Time to settle before the session counts (as the protocol says, else 0)")
      ->option_text("S")
      ->check(number_between(0.0, 3600.0, "seconds"));
}

void add_end(CommandTree& tree, CLI::App& session) {
  const std::string which = "Rig of the session; needed when several have one";
  CLI::App* stop =
      add(tree, session, "stop", "Stop a session and close its recording",
          "dtsctl session stop | the only session under way\ndtsctl session stop --rig floor | the one of this rig\n", run_session_stop);
  add_rig(*stop, tree, which);
  CLI::App* abort = add(tree, session, "abort", "Stop a session that did not go as it should; what is recorded stays",
                        "dtsctl session abort --reason \"subject felt dizzy\" | listed as aborted, with the reason\n", run_session_abort);
  add_rig(*abort, tree, which);
  abort->add_option("--reason", tree.arguments.session.reason, "Why; never a name")->option_text("TEXT")->check(text_of(0, 200));
  CLI::App* resume = add(tree, session, "resume", "Go on with an interrupted, incomplete or aborted session as a new part",
                         "dtsctl session resume 20261121T144525Z-floor-1 | same subject, protocol and plan\n", run_session_resume);
  add_id(*resume, tree, "ID", "Id of the session");
}

void add_trial(CommandTree& tree, CLI::App& session) {
  CLI::App* trial = add(tree, session, "trial", "Next trial of the protocol; or void one",
                        "dtsctl session trial next | start the next trial, or end one without a length of its own\n"
                        "dtsctl session trial redo | void the trial under way, or the last one, and do it again\n"
                        "dtsctl session trial reject | void it and go on\n",
                        run_session_trial);
  trial->add_option("ACTION", tree.arguments.session.action, "next, redo or reject")
      ->required()
      ->option_text(" ")
      ->check(CLI::IsMember({"next", "redo", "reject"}));
  add_rig(*trial, tree, "Rig of the session; needed when several have one");
}

void add_catalogue(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* list =
      add(tree, session, "list", "List recorded sessions, newest first",
          "dtsctl session list | the newest hundred\ndtsctl session list --subject P017 --limit 10 | of one subject\n", run_session_list);
  add_rig(*list, tree, "Only of this rig");
  list->add_option("--subject", wishes.subject, "Only of this pseudonym")->option_text("PSEUDONYM");
  list->add_option("--protocol", wishes.protocol, "Only of this protocol")->option_text("NAME");
  add_limit(*list, tree, "At most N sessions (100)");
  CLI::App* show = add(tree, session, "show", "Show a session: its recordings and trials",
                       "dtsctl session show 20261121T144525Z-floor-1 | state, files and trials\n", run_session_show);
  add_id(*show, tree, "ID", "Id of the session");
  cli::explain(tree.line, *show,
               "FROM .. TO SCAN | where the trial lies in its part's recording; with SEGMENT:SCAN when a gap divides the trial\n"
               "TRUNK, DEG | class of trunk movement, and flexion of the trunk\n"
               "MVELO | mean velocity of the centre of pressure\n"
               "RDIST | rms distance of the centre of pressure from its mean position\n"
               "ELLIPSE | area of the 95 % ellipse (PEA95_F)\n"
               "FLAGS | what is doubtful about a trial's values\n");
  CLI::App* compare =
      add(tree, session, "compare", "Figures of several sessions side by side, oldest first",
          "dtsctl session compare --subject P017 | the newest dozen sessions of one subject\n"
          "dtsctl session compare 20261121T144525Z-floor-1 20261128T150211Z-floor-1 | two, with the change in units and percent\n",
          run_session_compare);
  compare->add_option("ID", wishes.ids, "Ids of sessions")->option_text("...")->check(text_of(1, 200));
  compare->add_option("--subject", wishes.subject, "All of this pseudonym")->option_text("PSEUDONYM");
  compare->add_option("--protocol", wishes.protocol, "Of these, only of this protocol")->option_text("NAME");
}

void add_files(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* verify = add(tree, session, "verify", "Read a recording whole and compare all checksums",
                         "dtsctl session verify 20261121T144525Z-floor-1 | all its files, also against the catalogue\n"
                         "dtsctl session verify floor.xdf | a file; needs no daemon\n",
                         run_session_verify);
  add_id(*verify, tree, "ID|FILE", "Session, or a file of one: what exists, has a '/', or ends in .xdf or .part");
  CLI::App* recover = add(tree, session, "recover", "Repair a copy of a recording that was never closed",
                          "dtsctl session recover floor.xdf.part | makes floor.recovered.xdf; the original stays\n", run_session_recover);
  add_id(*recover, tree, "FILE", "The recording");
  recover->add_option("--out", wishes.out, "Name of the copy (NAME.recovered.xdf beside it); never overwritten")->option_text("FILE");
  CLI::App* exported =
      add(tree, session, "export", "Write a recording as CSV or as a BIDS dataset",
          "dtsctl session export 20261121T144525Z-floor-1 --format csv --out tables | a table per stream, events, trials, and what is known of it\n"
          "dtsctl session export floor.xdf --format bids --out study | a file; a dataset of ours is added to\n",
          run_session_export);
  add_id(*exported, tree, "ID|FILE", "Session, or a file of one: what exists, has a '/', or ends in .xdf or .part");
  exported->add_option("--format", wishes.format, "csv or bids")->option_text("NAME")->required()->check(CLI::IsMember({"csv", "bids"}));
  exported->add_option("--out", wishes.out, "Folder to write into (csv: here; bids: bids)")->option_text("DIR");
}

void add_report(CommandTree& tree) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* report = add(tree, tree.line.app, "report", "Write pages about a session of quiet standing: one of it, one of every trial",
                         "dtsctl report 20261121T144525Z-floor-1 | HTML and SVG pages into 20261121T144525Z-floor-1-report\n"
                         "dtsctl report floor.xdf --format html --out pages | of a file; needs no daemon\n",
                         run_report);
  add_id(*report, tree, "ID|FILE", "Session, or a file of one: what exists, has a '/', or ends in .xdf or .part");
  report->add_option("--format", wishes.format, "html, svg or all (all)")->option_text("NAME")->check(CLI::IsMember({"html", "svg", "all"}));
  report->add_option("--out", wishes.out, "Folder to write into (ID-report); pages of ours are replaced")->option_text("DIR");
}

void add_protocols_and_audit(CommandTree& tree) {
  CLI::App* protocol =
      cli::add_group(tree.line.app, "protocol", "What a session can follow", "dtsctl protocol list | the protocols there are\n");
  add(tree, *protocol, "list", "List the protocols", "dtsctl protocol list | name, trials and length of each\n", run_protocol_list);
  CLI::App* show = add(tree, *protocol, "show", "Show one protocol: conditions, and what it asks about the subject",
                       "dtsctl protocol show quiet-standing | before starting a session with it\n", run_protocol_show);
  show->add_option("NAME", tree.arguments.session.protocol, "Name of the protocol")->required()->option_text(" ");
  CLI::App* audit = add(tree, tree.line.app, "audit", "Who did what; verifies that nothing was changed or removed",
                        "dtsctl audit --limit 20 | the newest entries\n", run_audit);
  add_limit(*audit, tree, "At most N entries (100)");
}

}  // namespace

void add_sessions(CommandTree& tree) {
  CLI::App* session = cli::add_group(tree.line.app, "session", "Start and stop sessions, look after their recordings",
                                     "dtsctl session start --rig floor | begin; prints the session's id\n"
                                     "dtsctl session stop | end it\n"
                                     "dtsctl session list | what was recorded\n"
                                     "dtsctl session export 20261121T144525Z-floor-1 --format csv | as tables\n");
  add_start(tree, *session);
  add_end(tree, *session);
  add_trial(tree, *session);
  add_catalogue(tree, *session);
  add_files(tree, *session);
  add_report(tree);
  add_protocols_and_audit(tree);
}

}  // namespace dts::ctl
