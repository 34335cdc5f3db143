// SPDX-License-Identifier: Apache-2.0
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/run.h"
#include "cli/table.h"
#include "cli/validators.h"
#include "core/clock.h"
#include "files/whole_file.h"
#include "fleet/database/jobs.h"
#include "fleet/database/schema.h"
#include "fleet/hub/audit_trail.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/erasures.h"
#include "fleet/hub/programs.h"
#include "fleet/hub/users_file.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"
#include "fleet/worker/kinds.h"

namespace dts::fleet::hub {
namespace {

using database::Database;
using database::migrate;
using database::Parameter;
using database::Rows;

constexpr int kMostRows = 100'000;

/// How a column is printed: in a table as people read it, as JSON with the number in the unit of its key.
enum class Kind : std::uint8_t { Text, Count, Bytes, Seconds };

struct ListColumn {
  const char* header;  ///< Of the table; starts with '>' if it is right-aligned. Empty: only in JSON.
  const char* key;     ///< Of the JSON object.
  Kind kind = Kind::Text;
};

struct Arguments {
  std::string config;
  bool is_json = false;
  int limit = 100;
  std::string clinic;
  std::string rig;
  std::string protocol;
  std::string subject;
  Clinic added;
  SessionName erased;
  bool is_confirmed = false;
  std::string out;
  std::string kind;
  std::string since;
  std::string state;
};

std::string user_name() {
  const passwd* const user = ::getpwuid(::getuid());
  return user == nullptr ? std::to_string(::getuid()) : std::string(user->pw_name);
}

std::string local_user() { return "local:" + user_name(); }

std::int64_t utc_now_ns() {
  const core::SystemClock clock;
  return clock.now_ns() + clock.utc_minus_monotonic_ns();
}

std::string cell_text(const ListColumn& column, const Rows& rows, std::size_t row, std::size_t index) {
  if (rows.is_null(row, index)) return "-";
  if (column.kind == Kind::Bytes) return cli::decimal(rows.number(row, index).value_or(0.0) / 1e6, 1) + " MB";
  if (column.kind == Kind::Seconds) return cli::duration(rows.number(row, index).value_or(0.0));
  return rows.text(row, index);
}

void print_list(const std::vector<ListColumn>& columns, const Rows& rows, bool is_json, cli::Console& console) {
  std::vector<std::string> headers;
  for (const ListColumn& column : columns) {
    if (*column.header != '\0') headers.emplace_back(column.header);
  }
  cli::Table table(headers);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    cli::Json json = cli::Json::object();
    std::vector<cli::Cell> cells;
    for (std::size_t index = 0; index < columns.size(); ++index) {
      const ListColumn& column = columns[index];
      if (*column.header != '\0') cells.push_back({.text = cell_text(column, rows, row, index)});
      if (rows.is_null(row, index)) continue;
      if (column.kind == Kind::Text) {
        json[column.key] = rows.text(row, index);
      } else if (column.kind == Kind::Seconds) {
        cli::set_number(json, column.key, rows.number(row, index).value_or(0.0));
      } else {
        json[column.key] = rows.integer(row, index).value_or(0);
      }
    }
    if (is_json) {
      console.out << cli::one_line(json) << '\n';
    } else {
      table.add(std::move(cells));
    }
  }
  if (!is_json) table.print(console);
  if (!is_json && rows.empty()) console.talk << "no entries\n";
}

/// Calls `work` with the settings and the migrated database.
int with_database(const Arguments& arguments, cli::Console& console, const std::function<core::Status(const Settings&, Database&)>& work) {
  const auto settings = settings_of(arguments.config, console);
  if (!settings) return cli::kUsage;
  Database database({.connection = settings->connection,
                     .name = "dts-fleet",
                     .rejection_hint = "run this as the user of dts-hub: runuser -u dts-hub -- dts-fleet ..."});
  auto done = migrate(database);
  if (done) done = work(*settings, database);
  return done ? cli::kOk : cli::fail_with(console, done.error());
}

/// Prints the rows of one statement.
int list(const Arguments& arguments, cli::Console& console, const std::vector<ListColumn>& columns, const std::string& sql,
         std::initializer_list<Parameter> parameters = {}) {
  return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) -> core::Status {
    DTS_TRY_ASSIGN(const Rows rows, database.run(sql, parameters));
    print_list(columns, rows, arguments.is_json, console);
    return {};
  });
}

std::string utc(const char* column) { return "to_char(" + std::string(column) + ", 'YYYY-MM-DD\"T\"HH24:MI:SS\"Z\"')"; }

std::string age(const char* column) { return "extract(epoch FROM now() - " + std::string(column) + ")::float8"; }

int clinic_list(const Arguments& arguments, cli::Console& console) {
  return list(arguments, console,
              {{"CLINIC", "clinic"},
               {"STATE", "state"},
               {">LAST BEAT", "beat_age_s", Kind::Seconds},
               {">UNDELIVERED", "backlog_files", Kind::Count},
               {">SIZE", "backlog_bytes", Kind::Bytes},
               {">OLDEST", "backlog_age_s", Kind::Seconds},
               {">HELD", "held_files", Kind::Count},
               {">CLOCK", "clock_offset_s", Kind::Seconds},
               {"DTSD", "daemon"},
               {"FORWARDER", "forwarder"},
               {"ADDED (UTC)", "added_utc"},
               {"", "revoked_utc"},
               {"", "key"},
               {"TITLE", "title"}},
              "SELECT id, state, " + age("at") + ", backlog_files, backlog_bytes, " + age("backlog_oldest") +
                  ", held_files, clock_offset_s, CASE WHEN has_daemon THEN daemon_version WHEN at IS NOT NULL THEN 'no answer' END, "
                  "forwarder_version, " +
                  utc("added") + ", " + utc("revoked") + ", nkey, title FROM clinic LEFT JOIN beat ON beat.clinic = id ORDER BY id");
}

int rig_list(const Arguments& arguments, cli::Console& console) {
  return list(
      arguments, console,
      {{"CLINIC", "clinic"},
       {"RIG", "rig"},
       {"KIND", "kind"},
       {"DEVICE", "device"},
       {">RATE (Hz)", "measured_rate_hz"},
       {">LOST SCANS", "lost_scans_total", Kind::Count},
       {">GAPS", "gaps_total", Kind::Count},
       {"SESSION", "session_state"},
       {"CALIBRATION", "calibration"},
       {">SINCE", "calibration_age_s", Kind::Seconds},
       {">LAST BEAT", "beat_age_s", Kind::Seconds},
       {"", "sensors", Kind::Count},
       {"", "session"}},
      "SELECT rig.clinic, rig.id, kind, device, round(measured_rate_hz::numeric, 1)::text, lost_scans_total, gaps_total, session_state, "
      "CASE WHEN calibration = '' THEN 'plate model' ELSE calibration END, " +
          age("calibration_since") + ", " + age("rig.at") +
          ", sensors, session FROM rig JOIN clinic ON clinic.id = rig.clinic WHERE state = 'active' ORDER BY rig.clinic, rig.id");
}

int session_list(const Arguments& arguments, cli::Console& console) {
  return list(
      arguments, console,
      {{"CLINIC", "clinic"},
       {"SESSION", "session"},
       {"RIG", "rig"},
       {"PROTOCOL", "protocol"},
       {"SUBJECT", "subject"},
       {"STATE", "state"},
       {"STARTED (UTC)", "started_utc"},
       {">PARTS", "parts", Kind::Count},
       {">STORED", "stored_parts", Kind::Count},
       {"", "revision", Kind::Count}},
      "SELECT s.clinic, s.id, s.rig, s.protocol, s.subject, s.state, " + utc("s.started") +
          ", (SELECT count(*) FROM part p WHERE p.clinic = s.clinic AND p.session = s.id), (SELECT count(store_key) FROM part p WHERE "
          "p.clinic = s.clinic AND p.session = s.id), s.revision FROM session s WHERE NOT s.is_deleted AND ($1 = '' OR s.clinic = $1) AND "
          "($2 = '' OR s.rig = $2) AND ($3 = '' OR s.protocol = $3) AND ($4 = '' OR s.subject = $4) ORDER BY s.started DESC LIMIT $5",
      {arguments.clinic, arguments.rig, arguments.protocol, arguments.subject, arguments.limit});
}

int receipt_list(const Arguments& arguments, cli::Console& console) {
  return list(arguments, console,
              {{"CLINIC", "clinic"},
               {"SESSION", "session"},
               {">PART", "part", Kind::Count},
               {">SIZE", "bytes", Kind::Bytes},
               {"STORED (UTC)", "stored_utc"},
               {"HUB", "hub"},
               {"SHA-256", "sha256"},
               {"CLINIC'S SHA-256", "recorded_sha256"},
               {"", "store_key"}},
              "SELECT r.clinic, r.session, r.part, r.bytes, " + utc("r.stored_utc") +
                  ", r.hub, encode(r.sha256, 'hex'), encode(p.recorded_sha256, 'hex'), r.store_key FROM receipt r LEFT JOIN part p "
                  "ON p.clinic = r.clinic AND p.sha256 = r.sha256 WHERE $1 = '' OR r.clinic = $1 ORDER BY r.stored_utc DESC LIMIT $2",
              {arguments.clinic, arguments.limit});
}

int audit_list(const Arguments& arguments, cli::Console& console) {
  return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) -> core::Status {
    DTS_TRY_ASSIGN(const Rows rows,
                   database.run("SELECT * FROM (SELECT number, " + utc("'epoch'::timestamptz + utc_ns / 1000 * interval '1 us'") +
                                    ", who, what, target, result, hash FROM audit ORDER BY number DESC LIMIT $1) newest ORDER BY number",
                                {arguments.limit}));
    print_list({{">NUMBER", "number", Kind::Count},
                {"TIME (UTC)", "utc"},
                {"WHO", "who"},
                {"WHAT", "what"},
                {"TARGET", "target"},
                {"RESULT", "result"},
                {"", "hash"}},
               rows, arguments.is_json, console);
    DTS_TRY_ASSIGN(const std::uint64_t verified, verify_audit(database));
    if (!arguments.is_json) console.out << verified << (verified == 1 ? " entry verified\n" : " entries verified\n");
    return {};
  });
}

int add_jobs_command(const Arguments& arguments, cli::Console& console) {
  return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) -> core::Status {
    DTS_TRY_ASSIGN(const std::uint64_t added, database::add_jobs(database, {.kind = arguments.kind,
                                                                            .version = DTS_VERSION,
                                                                            .clinic = arguments.clinic,
                                                                            .protocol = arguments.protocol,
                                                                            .since = arguments.since}));
    console.out << count_text(added, "job") << " added\n";
    return {};
  });
}

int job_list(const Arguments& arguments, cli::Console& console) {
  return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) -> core::Status {
    DTS_TRY_ASSIGN(const auto jobs, database::list_jobs(database, {.kind = arguments.kind,
                                                                   .clinic = arguments.clinic,
                                                                   .state = arguments.state,
                                                                   .limit = static_cast<std::uint32_t>(arguments.limit)}));
    cli::Table table({">JOB", "KIND", "DTSLAB", "CLINIC", "SESSION", ">PART", "STATE", ">TRIES", "WORKER", "MESSAGE"});
    for (const database::Job& job : jobs) {
      if (arguments.is_json) {
        cli::Json json = {{"id", job.id},           {"kind", job.kind}, {"version", job.version}, {"clinic", job.clinic},
                          {"session", job.session}, {"part", job.part}, {"state", job.state},     {"tries", job.tries}};
        if (!job.worker.empty()) json["worker"] = job.worker;
        if (!job.message.empty()) json["message"] = job.message;
        console.out << cli::one_line(json) << '\n';
        continue;
      }
      table.add({{.text = std::to_string(job.id)},
                 {.text = job.kind},
                 {.text = job.version},
                 {.text = job.clinic},
                 {.text = job.session},
                 {.text = std::to_string(job.part)},
                 {.text = job.state},
                 {.text = std::to_string(job.tries)},
                 {.text = job.worker},
                 {.text = job.message}});
    }
    if (arguments.is_json) return {};
    table.print(console);
    if (jobs.empty()) console.talk << "no entries\n";
    return {};
  });
}

int retry_jobs_command(const Arguments& arguments, cli::Console& console) {
  return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) -> core::Status {
    DTS_TRY_ASSIGN(const std::uint64_t retried, database::retry_jobs(database, {.kind = arguments.kind, .clinic = arguments.clinic}));
    console.out << count_text(retried, "job") << (retried == 1 ? " waits again\n" : " wait again\n");
    return {};
  });
}

core::Status check_new_clinic(const Clinic& clinic, const Settings& settings) {
  if (!wire::is_clinic_name(clinic.id)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + clinic.id + "' is not a name of a clinic",
                      "use 1 to 32 of the characters a-z, 0-9 and -");
  }
  if (!wire::is_public_nkey(clinic.nkey)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + clinic.nkey + "' is not a public key",
                      "run this at the clinic, and use what it prints: dts-forward key");
  }
  const auto hub = wire::read_nkey(settings.key_file);
  if (!hub && hub.error().code != core::ErrorCode::NotFound) return tl::make_unexpected(hub.error());
  return check_keys(hub ? hub->public_key : "", settings.dashboards, {clinic});
}

core::Status write_enrolment(const std::string& clinic, const Settings& settings, const std::string& file) {
  if (std::filesystem::exists(file)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + file + "' exists already", "name another file in --out");
  }
  DTS_TRY_ASSIGN(const std::string ca_pem, read_ca(settings));
  auto written = files::write_whole_file(file, enrolment_text(clinic, settings.public_servers, ca_pem));
  if (!written && written.error().code == core::ErrorCode::NotAllowed) {
    written.error().hint = "name a file in --out whose folder the user " + user_name() + " can write";
  }
  return written;
}

/// Returns why the database rejects a new clinic: its name or its key has a row already.
core::Status rejected_clinic(const Clinic& clinic, Catalogue& catalogue) {
  const std::string failed = "clinic '" + clinic.id + "' was not added: ";
  DTS_TRY_ASSIGN(const auto clinics, catalogue.clinics());
  for (const Clinic& known : clinics) {
    const std::string state = known.is_revoked ? " (revoked)" : "";
    if (known.id == clinic.id) {
      return core::fail(core::ErrorCode::WrongState, failed + "there is a clinic of this name" + state,
                        known.nkey == clinic.nkey && !known.is_revoked
                            ? "it has this key: to write its file again, run dts-fleet clinic enrolment " + clinic.id + " --out FILE"
                            : "choose another name: dts-fleet clinic list");
    }
    if (known.nkey == clinic.nkey) {
      return core::fail(core::ErrorCode::WrongState, failed + "the key belongs to clinic '" + known.id + "'" + state,
                        "at the clinic: move the key file away, then run dts-forward key");
    }
  }
  return core::fail(core::ErrorCode::WrongState, failed + "the database rejects it", "try again");
}

core::Status add_clinic(const Arguments& arguments, const Settings& settings, Database& database) {
  const Clinic& clinic = arguments.added;
  DTS_TRY(check_new_clinic(clinic, settings));
  DTS_TRY(write_enrolment(clinic.id, settings, arguments.out));
  Catalogue catalogue(database);
  auto added = catalogue.add_clinic(clinic, local_user(), utc_now_ns());
  if (added) return {};
  static_cast<void>(std::remove(arguments.out.c_str()));
  return added.error().code == core::ErrorCode::WrongState ? rejected_clinic(clinic, catalogue) : added;
}

/// Writes the file of an active clinic again.
core::Status write_enrolment_again(const Arguments& arguments, const Settings& settings, Database& database) {
  const std::string& name = arguments.added.id;
  DTS_TRY_ASSIGN(const auto clinics, Catalogue(database).clinics());
  const auto found = std::ranges::find(clinics, name, &Clinic::id);
  if (found == clinics.end()) return core::fail(core::ErrorCode::NotFound, "there is no clinic '" + name + "'", "dts-fleet clinic list");
  if (found->is_revoked) {
    return core::fail(core::ErrorCode::WrongState, "clinic '" + name + "' is revoked", "add it again under another name, with a new key");
  }
  return write_enrolment(name, settings, arguments.out);
}

/// Writes the users file and lets nats-server read it. A nats-server that is not running reads it when it starts.
int write_users_command(const Arguments& arguments, cli::Console& console) {
  return with_database(arguments, console, [&](const Settings& settings, Database& database) -> core::Status {
    if (settings.users_file.empty()) {
      return core::fail(core::ErrorCode::InvalidArgument, "the configuration names no users file", "set [nats] users_file");
    }
    DTS_TRY_ASSIGN(const auto key, wire::read_or_create_nkey(settings.key_file));
    DTS_TRY_ASSIGN(const auto clinics, Catalogue(database).clinics());
    DTS_TRY(check_keys(key.public_key, settings.dashboards, clinics));
    DTS_TRY_ASSIGN(const bool is_written, write_users(settings, key.public_key, clinics));
    console.out << settings.users_file << (is_written ? ": written\n" : ": unchanged\n");
    if (settings.pid_file.empty()) return {};
    const auto reloaded = reload_nats(settings.pid_file);
    if (!reloaded && reloaded.error().code != core::ErrorCode::NotFound) return reloaded;
    console.out << (reloaded ? "nats-server reads it again\n" : "nats-server does not run; it reads the file when it starts\n");
    return {};
  });
}

void print_content(const SessionName& name, const SessionContent& content, cli::Console& console) {
  console.out << "session " << name.id << " of " << name.clinic;
  if (content.is_known) console.out << ", protocol " << cli::printable(content.protocol) << ", started " << content.started << " (UTC)";
  console.out << ": " << count_text(static_cast<std::uint64_t>(content.recordings), "recording") << " ("
              << cli::decimal(static_cast<double>(content.bytes) / 1e6, 1) << " MB), " << content.rows << " parts, trials and results\n";
}

/// Returns true if a person on a terminal has typed the session's ID again.
core::Status confirm(const SessionName& name, cli::Console& console) {
  if (::isatty(STDIN_FILENO) == 0 || !console.is_talk_terminal) {
    return core::fail(core::ErrorCode::InvalidArgument, "nothing was erased, because nobody can be asked here", "add --yes");
  }
  console.talk << "All of this is erased for ever at the centre. Type the session's ID to continue: " << std::flush;
  std::string typed;
  if (std::getline(std::cin, typed) && typed == name.id) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "this is not the session's ID: nothing was erased");
}

int erase_session_command(const Arguments& arguments, cli::Console& console) {
  const SessionName& name = arguments.erased;
  return with_database(arguments, console, [&](const Settings& settings, Database& database) -> core::Status {
    Catalogue catalogue(database);
    DTS_TRY_ASSIGN(const SessionContent content, catalogue.content_of(name));
    const bool has_content = content.is_known || content.recordings > 0 || content.rows > 0;
    if (content.is_erased && !has_content) {
      return core::fail(core::ErrorCode::WrongState, "session " + name.id + " of " + name.clinic + " is erased already");
    }
    if (!has_content) {
      return core::fail(core::ErrorCode::NotFound, "the centre has no session " + name.id + " of " + name.clinic, "dts-fleet sessions");
    }
    print_content(name, content, console);
    if (!arguments.is_confirmed) DTS_TRY(confirm(name, console));
    DTS_TRY_ASSIGN(const auto store, open_store(settings));
    Erasures erasures(catalogue, *store, ErasureJournal(settings.directory));
    DTS_TRY_ASSIGN(const std::uint32_t files, erasures.erase(name, local_user(), utc_now_ns()));
    console.out << "erased, with " << count_text(files, "recording") << '\n';
    cli::print_hint(console, "backups of the centre and the clinic itself still have it");
    return {};
  });
}

/// A command line with the values of its options.
struct FleetLine : cli::CommandLine {
  using cli::CommandLine::CommandLine;
  Arguments arguments{};
};

void add_json(CLI::App& command, Arguments& arguments) { command.add_flag("--json", arguments.is_json, "Print JSON, one object a line"); }

void add_limit(CLI::App& command, Arguments& arguments) {
  command.add_option("--limit", arguments.limit, "Number of entries, the newest. Default: 100")
      ->option_text("N")
      ->check(cli::whole_number_between(1, kMostRows));
}

void add_clinic_commands(FleetLine& line) {
  Arguments& arguments = line.arguments;
  CLI::App* clinic = cli::add_group(line.app, "clinic", "Add, revoke and list clinics, and write their files",
                                    "dts-fleet clinic list | with what each has not delivered\n");
  CLI::App* add = cli::add_command(
      line, *clinic, "add", "Let a clinic deliver, and write the file with which it connects",
      "dts-fleet clinic add kent --title \"Kent clinic\" --key UABC --out kent.enrolment.toml | then carry the file to the clinic\n",
      [&arguments](cli::Console& console) {
        const int status = with_database(
            arguments, console, [&](const Settings& settings, Database& database) { return add_clinic(arguments, settings, database); });
        if (status == cli::kOk) cli::print_hint(console, "carry " + arguments.out + " to the clinic: it belongs beside forward.toml");
        return status;
      });
  add->add_option("name", arguments.added.id, "Name of the clinic: a-z, 0-9 and -")->required()->option_text("NAME");
  add->add_option("--title", arguments.added.title, "Name for people")->required()->option_text("TEXT")->check(cli::text_of(1, 200));
  add->add_option("--key", arguments.added.nkey, "Public key, as dts-forward key prints it at the clinic")->required()->option_text("KEY");
  CLI::App* enrolment = cli::add_command(line, *clinic, "enrolment", "Write the file with which a clinic connects again: it was lost",
                                         "dts-fleet clinic enrolment kent --out kent.enrolment.toml | the clinic keeps its key\n",
                                         [&arguments](cli::Console& console) {
                                           return with_database(arguments, console, [&](const Settings& settings, Database& database) {
                                             return write_enrolment_again(arguments, settings, database);
                                           });
                                         });
  enrolment->add_option("name", arguments.added.id, "Name of the clinic")->required()->option_text("NAME");
  for (CLI::App* command : {add, enrolment}) {
    command->add_option("--out", arguments.out, "File to write for the clinic")->required()->option_text("FILE");
  }
  CLI::App* revoke =
      cli::add_command(line, *clinic, "revoke", "Stop accepting anything from a clinic; what it has delivered stays",
                       "dts-fleet clinic revoke kent | its connections end within 2 s\n", [&arguments](cli::Console& console) {
                         return with_database(arguments, console, [&](const Settings& /*settings*/, Database& database) {
                           return Catalogue(database).revoke_clinic(arguments.added.id, local_user(), utc_now_ns());
                         });
                       });
  revoke->add_option("name", arguments.added.id, "Name of the clinic")->required()->option_text("NAME");
  CLI::App* listed = cli::add_command(line, *clinic, "list", "List the clinics, and what each has not delivered",
                                      "dts-fleet clinic list --json | for scripts\n",
                                      [&arguments](cli::Console& console) { return clinic_list(arguments, console); });
  add_json(*listed, arguments);
}

void add_lists(FleetLine& line) {
  Arguments& arguments = line.arguments;
  CLI::App* rigs =
      cli::add_command(line, line.app, "rigs", "List the rigs of all clinics", "dts-fleet rigs | as their clinics reported last\n",
                       [&arguments](cli::Console& console) { return rig_list(arguments, console); });
  add_json(*rigs, arguments);
  CLI::App* sessions = cli::add_command(line, line.app, "sessions", "List sessions of all clinics, newest first",
                                        "dts-fleet sessions --protocol romberg --limit 20 | of one protocol\n"
                                        "dts-fleet sessions --clinic kent --subject P017 --json | of one subject, for scripts\n",
                                        [&arguments](cli::Console& console) { return session_list(arguments, console); });
  sessions->add_option("--clinic", arguments.clinic, "Only of this clinic")->option_text("NAME");
  sessions->add_option("--rig", arguments.rig, "Only of rigs with this name")->option_text("RIG");
  sessions->add_option("--protocol", arguments.protocol, "Only with this protocol")->option_text("NAME");
  sessions->add_option("--subject", arguments.subject, "Only of this subject ID")->option_text("ID");
  CLI::App* receipts = cli::add_command(line, line.app, "receipts", "List the recordings that the centre keeps, newest first",
                                        "dts-fleet receipts --clinic kent | of one clinic; the clinic's SHA-256 is that of its own file\n",
                                        [&arguments](cli::Console& console) { return receipt_list(arguments, console); });
  receipts->add_option("--clinic", arguments.clinic, "Only of this clinic")->option_text("NAME");
  CLI::App* audit = cli::add_command(line, line.app, "audit", "Print the newest entries of the audit trail, and verify all of it",
                                     "dts-fleet audit --limit 20 | who added, revoked and erased\n",
                                     [&arguments](cli::Console& console) { return audit_list(arguments, console); });
  for (CLI::App* command : {sessions, receipts, audit}) {
    add_limit(*command, arguments);
    add_json(*command, arguments);
  }
}

void add_session_commands(FleetLine& line) {
  Arguments& arguments = line.arguments;
  CLI::App* session = cli::add_group(line.app, "session", "Erase a session at the centre",
                                     "dts-fleet session erase kent 20261121T144525Z-floor-1 | asks before it erases\n");
  CLI::App* erase = cli::add_command(line, *session, "erase", "Erase a session for ever: its rows and its recordings at the centre",
                                     "dts-fleet session erase kent 20261121T144525Z-floor-1 | prints what there is, and asks\n"
                                     "dts-fleet session erase kent 20261121T144525Z-floor-1 --yes | for programs: does not ask\n",
                                     [&arguments](cli::Console& console) { return erase_session_command(arguments, console); });
  erase->add_option("clinic", arguments.erased.clinic, "Name of the clinic")->required()->option_text("CLINIC");
  erase->add_option("session", arguments.erased.id, "ID of the session")->required()->option_text("SESSION");
  erase->add_flag("--yes", arguments.is_confirmed, "Do not ask");
}

void add_job_commands(FleetLine& line) {
  Arguments& arguments = line.arguments;
  std::vector<std::string> kinds;
  for (const std::string_view kind : worker::kind_names()) kinds.emplace_back(kind);
  CLI::App* jobs = cli::add_group(line.app, "jobs", "Let workers analyse recordings of the centre again",
                                  "dts-fleet jobs add --kind sway --protocol romberg | all sessions of one protocol\n");
  CLI::App* add = cli::add_command(line, *jobs, "add", "Add a job for each stored recording that does not have it yet",
                                   "dts-fleet jobs add --kind sway --clinic kent --since 2026-11-01 | sessions of one clinic since a day\n",
                                   [&arguments](cli::Console& console) { return add_jobs_command(arguments, console); });
  CLI::App* listed =
      cli::add_command(line, *jobs, "list", "List the jobs, newest first", "dts-fleet jobs list --state failed | with the reasons\n",
                       [&arguments](cli::Console& console) { return job_list(arguments, console); });
  CLI::App* retry = cli::add_command(line, *jobs, "retry", "Let failed jobs wait again", "dts-fleet jobs retry --kind sway | of one kind\n",
                                     [&arguments](cli::Console& console) { return retry_jobs_command(arguments, console); });
  for (CLI::App* command : {add, listed, retry}) {
    CLI::Option* kind =
        command->add_option("--kind", arguments.kind, "Kind of the analysis")->option_text("KIND")->check(CLI::IsMember(kinds));
    if (command == add) kind->required();
    command->add_option("--clinic", arguments.clinic, "Only of this clinic")->option_text("NAME");
  }
  add->add_option("--protocol", arguments.protocol, "Only sessions with this protocol")->option_text("NAME");
  add->add_option("--since", arguments.since, "Only sessions that started on this day (UTC) or later")->option_text("DATE");
  listed->add_option("--state", arguments.state, "Only in this state")
      ->option_text("STATE")
      ->check(CLI::IsMember({"waiting", "running", "done", "failed"}));
  add_limit(*listed, arguments);
  add_json(*listed, arguments);
}

}  // namespace

std::shared_ptr<cli::CommandLine> make_fleet_tree() {
  auto line = std::make_shared<FleetLine>(cli::Program{
      .name = "dts-fleet",
      .version = DTS_VERSION,
      .description = "Looks after the centre of a fleet of clinics",
      .examples = "dts-fleet clinic add kent --title \"Kent clinic\" --key UABC --out kent.enrolment.toml | let a clinic deliver\n"
                  "dts-fleet clinic list | what each clinic has not delivered\n"
                  "dts-fleet rigs | which rigs work\n"
                  "dts-fleet sessions --clinic kent | newest first\n"});
  add_config_option(*line, line->arguments.config);
  Arguments& arguments = line->arguments;
  cli::add_command(*line, line->app, "users", "Write the users of nats-server, before its first start",
                   "dts-fleet --config hub.toml users | dts-hub does the same while it runs\n",
                   [&arguments](cli::Console& console) { return write_users_command(arguments, console); });
  add_clinic_commands(*line);
  add_lists(*line);
  add_session_commands(*line);
  add_job_commands(*line);
  cli::add_common(*line);
  line->manual = {
      .summary = "administration of a fleet of clinics",
      .description = "Adds and revokes clinics, and lists what the centre knows of them. It connects to the database of\n.BR dts-hub (8).",
      .environment = {},
      .exit_statuses = {0, 1, 2, 3, 4, 5, 6, 7, 130},
      .further_sections = {},
      .files = {{"/etc/dts-hub/hub.toml", "Configuration."}},
      .see_also = {{"dts-hub", 8}}};
  return line;
}

int run_fleet_program(const std::vector<std::string>& words, cli::Console& console) {
  const auto line = make_fleet_tree();
  return cli::run(*line, words, console);
}

}  // namespace dts::fleet::hub
