// SPDX-License-Identifier: Apache-2.0
#include "ctl/session_tree.h"

#include <string>

#include "cli/validators.h"
#include "ctl/compare_sessions.h"
#include "ctl/record_commands.h"
#include "ctl/session_commands.h"
#include "ctl/sessions/export_command.h"
#include "ctl/sessions/recover_command.h"
#include "ctl/sessions/report_command.h"
#include "ctl/sessions/verify_command.h"
#include "ctl/subject_commands.h"
#include "report/intended_use.h"

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
    return is_pair ? "" : "'" + text + "' does not have the form KEY=VALUE";
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

/// Adds to the help of a command that shows results what they are for, and what not.
void add_intended_use(CommandTree& tree, const CLI::App& command) {
  tree.line.glossaries[&command].push_back({.title = "Intended use", .words = {{"results", std::string(report::kIntendedUse)}}});
}

void add_start(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* start = add(
      tree, session, "start", "Start a session, record it and print its ID",
      "dtsctl session start --rig floor --protocol romberg --subject P017 | with the trials of a protocol\n"
      "dtsctl session start --rig floor --protocol free | runs until dtsctl session stop; no results\n"
      "dtsctl session start --rig floor --protocol free --duration 25 --settle 5 | settle for 5 s, then record 25 s\n"
      "dtsctl session start --rig floor --rig plate --protocol romberg | one session over two rigs, started and stopped together\n"
      "dtsctl session start --rig chair --protocol free --label \"eyes closed\" | with a note\n"
      "dtsctl session start --rig floor --protocol quiet-standing --subject P017 --field weight_kg=71.5 | with the fields of a protocol\n",
      run_session_start);
  start->add_option("--rig", wishes.rigs, "Rig to record. Give it again for further rigs: trials and results are those of the first")
      ->option_text("RIG")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  start->add_option("--protocol", wishes.protocol, "Protocol to follow, see dtsctl protocol list. Required; there is no default")
      ->option_text("NAME");
  start->add_option("--subject", wishes.subject, "Subject ID from the clinic, never a name")->option_text("SUBJECT-ID");
  start->add_option("--field", wishes.fields, "Value of a field that the protocol requires; see dtsctl protocol show NAME")
      ->option_text("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(key_and_value());
  start->add_option("--label", wishes.label, "Note about the session, never a name")->option_text("TEXT")->check(text_of(0, 200));
  start->add_option("--duration", wishes.duration_s, "Stop automatically after S seconds. Default: as the protocol sets, else no limit")
      ->option_text("S")
      ->check(number_between(0.0, 604800.0, "seconds"));
  start
      ->add_option("--settle", wishes.settle_s,
                   "Settling time before the measurement starts, seconds. Default: as the protocol sets, else 0")
      ->option_text("S")
      ->check(number_between(0.0, 3600.0, "seconds"));
}

void add_end(CommandTree& tree, CLI::App& session) {
  const std::string which = "Rig of the session. Required if several sessions are under way";
  CLI::App* stop =
      add(tree, session, "stop", "Stop a session and close its recording",
          "dtsctl session stop | the only running session\ndtsctl session stop --rig floor | the session of this rig, on all its rigs\n",
          run_session_stop);
  add_rig(*stop, tree, which);
  CLI::App* abort = add(tree, session, "abort", "Stop a session and list it as aborted; its recording is kept",
                        "dtsctl session abort --reason \"subject felt dizzy\" | with the reason for the list\n", run_session_abort);
  add_rig(*abort, tree, which);
  abort->add_option("--reason", tree.arguments.session.reason, "Reason, never a name")->option_text("TEXT")->check(text_of(0, 200));
  CLI::App* resume = add(tree, session, "resume", "Continue an interrupted, incomplete or aborted session as a new part",
                         "dtsctl session resume 20261121T144525Z-floor-1 | same subject, protocol and plan\n", run_session_resume);
  add_id(*resume, tree, "ID", "Id of the session");
}

void add_trial(CommandTree& tree, CLI::App& session) {
  CLI::App* trial = add(tree, session, "trial", "Start the next trial, repeat a trial, reject one, or take that back",
                        "dtsctl session trial next | start the next trial, or end a trial without a fixed duration\n"
                        "dtsctl session trial redo | discard the present or last trial and repeat it\n"
                        "dtsctl session trial reject | discard the present or last trial and continue without it\n"
                        "dtsctl session trial undo | take back the last redo or reject, for 5 s\n",
                        run_session_trial);
  trial->add_option("ACTION", tree.arguments.session.action, "next, redo, reject or undo")
      ->required()
      ->option_text(" ")
      ->check(CLI::IsMember({"next", "redo", "reject", "undo"}));
  add_rig(*trial, tree, "Rig of the session. Required if several sessions are under way");
}

void add_catalogue(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* list =
      add(tree, session, "list", "List recorded sessions, newest first",
          "dtsctl session list | the newest 100\ndtsctl session list --subject P017 --limit 10 | the newest 10 of one subject\n",
          run_session_list);
  add_rig(*list, tree, "Show only sessions of this rig");
  list->add_option("--subject", wishes.subject, "Show only sessions with this subject ID")->option_text("SUBJECT-ID");
  list->add_option("--protocol", wishes.protocol, "Show only sessions with this protocol")->option_text("NAME");
  add_limit(*list, tree, "Show at most N sessions. Default: 100");
  list->add_flag("--deleted", wishes.is_deleted, "Show the deleted sessions instead");
  CLI::App* show = add(tree, session, "show", "Show a session: state, recordings, trials and results",
                       "dtsctl session show 20261121T144525Z-floor-1 | one session\n"
                       "dtsctl session show 20261121T144525Z-floor-1 --csv > trials.csv | the values of its trials, for a spreadsheet\n",
                       run_session_show);
  add_id(*show, tree, "ID", "Id of the session");
  show->add_flag("--csv", tree.arguments.is_csv, "Print the values of the trials as CSV: a row for each trial and measure");
  cli::explain(tree.line, *show,
               "FROM .. TO SCAN | first and last scan of the trial in its part; as SEGMENT:SCAN if a gap divides the trial\n"
               "TRUNK, DEG | trunk class, and trunk flexion in degrees\n"
               "VELOCITY | mean velocity of the centre of pressure (MVELO)\n"
               "DISTANCE | rms distance of the centre of pressure from its mean position (RDIST)\n"
               "ELLIPSE | area of the 95 % ellipse (PEA95_F)\n"
               "(columns) | a narrow terminal shows fewer; --json has all values\n"
               "FLAGS | reasons to doubt the values of a trial\n");
  add_intended_use(tree, *show);
  CLI::App* compare =
      add(tree, session, "compare", "Compare the results of several sessions, oldest first",
          "dtsctl session compare --subject P017 | the newest 12 sessions of one subject that have results, on one rig\n"
          "dtsctl session compare 20261121T144525Z-floor-1 20261128T150211Z-floor-1 | two sessions, with the change in units and percent\n",
          run_session_compare);
  add_intended_use(tree, *compare);
  compare->add_option("ID", wishes.ids, "Session IDs")->option_text("...")->check(text_of(1, 200));
  compare->add_option("--subject", wishes.subject, "Compare the sessions with this subject ID")->option_text("SUBJECT-ID");
  compare->add_option("--protocol", wishes.protocol, "Compare only sessions with this protocol")->option_text("NAME");
}

void add_reason(CLI::App& command, CommandTree& tree, bool is_required) {
  command.add_option("--reason", tree.arguments.session.reason, "Why, never a name")
      ->option_text("TEXT")
      ->check(text_of(is_required ? 1 : 0, 200))
      ->required(is_required);
}

void add_corrections(CommandTree& tree, CLI::App& session) {
  EditArguments& wishes = tree.arguments.edit;
  CLI::App* edit =
      add(tree, session, "edit", "Correct a closed session; the recording stays as it is, and both values are kept",
          "dtsctl session edit 20261121T144525Z-floor-1 --subject P018 --reason \"wrong subject ID\" | the subject ID\n"
          "dtsctl session edit 20261121T144525Z-floor-1 --label \"\" --reason \"had a name\" | remove the label\n"
          "dtsctl session edit 20261121T144525Z-floor-1 --trial 3 --outcome rejected --reason \"subject talked\" | the newest attempt\n"
          "dtsctl session edit 20261121T144525Z-floor-1 --notes \"new shoes\" --reason \"added later\" | add notes\n"
          "dtsctl session edit 20261121T144525Z-floor-1 --marker 2 --remove --reason \"had a name\" | remove a marker's text\n",
          run_session_edit);
  add_id(*edit, tree, "ID", "Id of the session");
  edit->add_option("--subject", wishes.subject, "Correct subject ID, never a name; \"\" removes it")->option_text("SUBJECT-ID");
  edit->add_option("--label", wishes.label, "Correct label; \"\" removes it")->option_text("TEXT")->check(text_of(0, 200));
  edit->add_option("--notes", wishes.notes, "Notes, which replace earlier ones; \"\" removes them")
      ->option_text("TEXT")
      ->check(text_of(0, 1000));
  CLI::Option* trial = edit->add_option("--trial", wishes.trial, "Trial whose outcome is corrected")
                           ->option_text("N")
                           ->check(whole_number_between(1, 1'000'000));
  edit->add_option("--attempt", wishes.attempt, "Its attempt. Default: the newest")
      ->option_text("N")
      ->check(whole_number_between(1, 1'000'000))
      ->needs(trial);
  edit->add_option("--part", wishes.part, "Its part, if several parts have this attempt of the trial")
      ->option_text("N")
      ->check(whole_number_between(1, 1'000'000))
      ->needs(trial);
  CLI::Option* outcome = edit->add_option("--outcome", wishes.outcome, "Correct outcome: done, redone, rejected or aborted")
                             ->option_text("NAME")
                             ->check(CLI::IsMember({"done", "redone", "rejected", "aborted"}))
                             ->needs(trial);
  trial->needs(outcome);
  CLI::Option* marker = edit->add_option("--marker", wishes.marker, "Marker whose text is corrected: its number in session show")
                            ->option_text("N")
                            ->check(whole_number_between(1, 1'000'000));
  CLI::Option* text = edit->add_option("--text", wishes.text, "Correct text of the marker")->option_text("TEXT")->check(text_of(1, 200));
  text->needs(marker);
  edit->add_flag("--remove", wishes.is_removal, "Remove the text of the marker; its time stays")->needs(marker)->excludes(text);
  add_reason(*edit, tree, true);
  CLI::App* deleted = add(tree, session, "delete", "Hide a closed session from all lists; it can be restored",
                          "dtsctl session delete 20261121T144525Z-floor-1 --reason \"a test\" | nothing is removed from the disk\n"
                          "dtsctl session list --deleted | the deleted sessions\n",
                          run_session_delete);
  add_id(*deleted, tree, "ID", "Id of the session");
  add_reason(*deleted, tree, true);
  CLI::App* restored = add(tree, session, "restore", "Show a deleted session again",
                           "dtsctl session restore 20261121T144525Z-floor-1 | undo dtsctl session delete\n", run_session_restore);
  add_id(*restored, tree, "ID", "Id of the session");
  add_reason(*restored, tree, false);
}

void add_subjects(CommandTree& tree) {
  CLI::App* subject = cli::add_group(tree.line.app, "subject", "List, show, follow and erase the subjects",
                                     "dtsctl subject list | all subject IDs\ndtsctl subject trend P017 | results over the visits\n"
                                     "dtsctl subject show P017 | what an erasure would remove\n");
  add(tree, *subject, "list", "List the subject IDs and their sessions", "dtsctl subject list | with deleted sessions\n", run_subject_list);
  CLI::App* show = add(tree, *subject, "show", "Show everything that has this subject ID", "dtsctl subject show P017 | before an erasure\n",
                       run_subject_show);
  add_id(*show, tree, "ID", "Subject ID");
  SubjectArguments& wishes = tree.arguments.subject;
  CLI::App* trend = add(tree, *subject, "trend", "Show how results change from visit to visit, also in plain words",
                        "dtsctl subject trend P017 | sway, or trunk angle and class\n"
                        "dtsctl subject trend P017 --measure MVELO_ML | one measure\n"
                        "dtsctl subject trend P017 --json | all measures, for programs\n",
                        run_subject_trend);
  add_id(*trend, tree, "ID", "Subject ID");
  add_intended_use(tree, *trend);
  trend->add_option("--measure", wishes.measure, "Measure, as in dtsctl session show")->option_text("MEASURE");
  trend->add_option("--language", wishes.language, "Language of the sentences: en or de. Default: en")
      ->option_text("LANGUAGE")
      ->check(CLI::IsMember({"en", "de"}));
  CLI::App* plan = add(tree, *subject, "plan", "Show and change the sessions that are planned for a subject",
                       "dtsctl subject plan P017 | what is due\n"
                       "dtsctl subject plan P017 --add romberg --due 2026-12-31 | plan a session\n"
                       "dtsctl subject plan P017 --remove 3 | remove planned session 3\n",
                       run_subject_plan);
  add_id(*plan, tree, "ID", "Subject ID");
  CLI::Option* planned =
      plan->add_option("--add", wishes.added, "Protocol of a session to plan")->option_text("PROTOCOL")->check(text_of(1, 200));
  plan->add_option("--due", wishes.due_date, "Date of this session")->option_text("YYYY-MM-DD")->needs(planned);
  plan->add_option("--remove", wishes.removed, "Number of the planned session to remove")
      ->option_text("N")
      ->check(whole_number_between(1, 1'000'000))
      ->excludes(planned);
  CLI::App* notes = add(tree, *subject, "notes", "Show and change the notes about a subject",
                        "dtsctl subject notes P017 | all notes\n"
                        "dtsctl subject notes P017 --add \"walks with a stick\" | add a note, never a name\n"
                        "dtsctl subject notes P017 --remove 2 | remove note 2 for ever\n",
                        run_subject_notes);
  add_id(*notes, tree, "ID", "Subject ID");
  CLI::Option* added =
      notes->add_option("--add", wishes.added, "Text of a new note, never a name")->option_text("TEXT")->check(text_of(1, 1000));
  notes->add_option("--remove", wishes.removed, "Number of the note to remove")
      ->option_text("N")
      ->check(whole_number_between(1, 1'000'000))
      ->excludes(added);
  CLI::App* erase = add(tree, *subject, "erase", "Erase a subject for ever: recordings, catalogue, corrections and mentions",
                        "dtsctl subject erase P017 | shows everything and asks first\n"
                        "dtsctl subject erase P017 --yes | for programs: does not ask\n",
                        run_subject_erase);
  add_id(*erase, tree, "ID", "Subject ID");
  erase->add_flag("--yes", tree.arguments.edit.is_confirmed, "Do not ask");
}

void add_files(CommandTree& tree, CLI::App& session) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* verify = add(tree, session, "verify", "Read a whole recording and check all checksums",
                         "dtsctl session verify 20261121T144525Z-floor-1 | all files of a session, also against the catalogue\n"
                         "dtsctl session verify floor.xdf | one file; works without a daemon\n",
                         run_session_verify);
  add_id(*verify, tree, "ID|FILE", "Session ID, or recording file: an existing file, or a name with '/' or with the ending .xdf or .part");
  CLI::App* recover =
      add(tree, session, "recover", "Repair a copy of a recording that was not closed",
          "dtsctl session recover floor.xdf.part | writes floor.recovered.xdf; the original stays unchanged\n", run_session_recover);
  add_id(*recover, tree, "FILE", "Recording file");
  recover
      ->add_option("--out", wishes.out,
                   "File to write; an existing file is never overwritten. Default: NAME.recovered.xdf beside the recording")
      ->option_text("FILE");
  CLI::App* exported =
      add(tree, session, "export", "Write a recording as CSV, as a BIDS dataset, as C3D or as a FHIR Bundle",
          "dtsctl session export 20261121T144525Z-floor-1 --format csv --out tables | one table per stream, plus events, "
          "trials and session data\n"
          "dtsctl session export floor.xdf --format bids --out study | one file, added to the BIDS dataset in study\n"
          "dtsctl session export 20261121T144525Z-floor-1 --format fhir | results and report for the record of a hospital\n",
          run_session_export);
  add_intended_use(tree, *exported);
  add_id(*exported, tree, "ID|FILE",
         "Session ID, or recording file: an existing file, or a name with '/' or with the ending .xdf or .part");
  exported
      ->add_option("--format", wishes.format,
                   "Format: csv, bids, c3d (centre of pressure and force as a force plate) or fhir (results, FHIR R4)")
      ->option_text("NAME")
      ->required()
      ->check(CLI::IsMember({"csv", "bids", "c3d", "fhir"}));
  exported->add_option("--out", wishes.out, "Folder to write to. Default: bids for bids, else this folder")->option_text("DIR");
}

void add_report(CommandTree& tree) {
  SessionArguments& wishes = tree.arguments.session;
  CLI::App* pages = add(tree, tree.line.app, "report", "Write a report of a session: one page per session and one per trial",
                        "dtsctl report 20261121T144525Z-floor-1 | HTML and SVG pages into 20261121T144525Z-floor-1-report\n"
                        "dtsctl report 20261121T144525Z-chair-1 --format pdf | one document, report.pdf, to print or to archive\n"
                        "dtsctl report floor.xdf --format html --out pages | from a file; works without a daemon\n",
                        run_report);
  add_intended_use(tree, *pages);
  add_id(*pages, tree, "ID|FILE", "Session ID, or recording file: an existing file, or a name with '/' or with the ending .xdf or .part");
  pages
      ->add_option("--format", wishes.format, "Format: html, svg, pdf (needs the package librsvg2-bin) or all (html and svg). Default: all")
      ->option_text("NAME")
      ->check(CLI::IsMember({"html", "svg", "pdf", "all"}));
  pages->add_option("--language", wishes.language, "Language of the pages: en or de. Default: en")
      ->option_text("NAME")
      ->check(CLI::IsMember({"en", "de"}));
  pages->add_option("--out", wishes.out, "Folder to write to; report pages in it are replaced. Default: ID-report")->option_text("DIR");
}

void add_protocols_and_audit(CommandTree& tree) {
  CLI::App* protocol =
      cli::add_group(tree.line.app, "protocol", "Show the protocols for sessions", "dtsctl protocol list | all protocols\n");
  add(tree, *protocol, "list", "List the protocols", "dtsctl protocol list | name, trials and duration of each\n", run_protocol_list);
  CLI::App* show = add(tree, *protocol, "show", "Show one protocol: conditions and required fields about the subject",
                       "dtsctl protocol show quiet-standing | before starting a session with it\n", run_protocol_show);
  show->add_option("NAME", tree.arguments.session.protocol, "Name of the protocol")->required()->option_text(" ");
  CLI::App* audit = add(tree, tree.line.app, "audit", "Show who did what, and check that no entry was changed or removed",
                        "dtsctl audit --limit 20 | the newest entries\n", run_audit);
  add_limit(*audit, tree, "Show at most N entries. Default: 100");
}

}  // namespace

void add_sessions(CommandTree& tree) {
  CLI::App* session = cli::add_group(tree.line.app, "session", "Start and stop sessions, and manage their recordings",
                                     "dtsctl session start --rig floor --protocol romberg | start; prints the session ID\n"
                                     "dtsctl session stop | stop the session\n"
                                     "dtsctl session list | list the recorded sessions\n"
                                     "dtsctl session export 20261121T144525Z-floor-1 --format csv | write tables\n");
  add_start(tree, *session);
  add_end(tree, *session);
  add_trial(tree, *session);
  add_catalogue(tree, *session);
  add_corrections(tree, *session);
  add_files(tree, *session);
  add_report(tree);
  add_subjects(tree);
  add_protocols_and_audit(tree);
}

}  // namespace dts::ctl
