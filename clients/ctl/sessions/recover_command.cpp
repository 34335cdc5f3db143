// SPDX-License-Identifier: Apache-2.0
#include "ctl/sessions/recover_command.h"

#include <string>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "ctl/recording_view.h"
#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"

namespace dts::ctl {
namespace {

cli::Json to_json(const record::Recovery& recovery) {
  cli::Json json{{"file", recovery.file},
                 {"sha256", recovery.sha256},
                 {"kept_bytes", recovery.kept_bytes},
                 {"dropped_bytes", recovery.dropped_bytes},
                 {"chunks", recovery.chunks},
                 {"reason", recovery.reason}};
  cli::set_number(json, "duration_s", recovery.duration_s);
  cli::set_number(json, "lost_s_at_most", recovery.lost_s_at_most);
  return json;
}

void print_recovery(cli::Console& console, const record::Recovery& recovery) {
  console.out << cli::printable(recovery.file) << ": " << cli::duration(recovery.duration_s) << " kept, " << bytes_text(recovery.kept_bytes)
              << " in " << recovery.chunks << " chunks\n"
              << cli::styled(console, cli::Style::Bad,
                             "at most " + cli::decimal(recovery.lost_s_at_most, 2) + " s lost: " + cli::printable(recovery.reason) + ", " +
                                 bytes_text(recovery.dropped_bytes) + " dropped")
              << '\n';
  cli::print_hint(console, "check it: dtsctl session verify " + cli::printable(recovery.file));
}

}  // namespace

int run_session_recover(const Arguments& arguments, cli::Console& console) {
  const std::string& file = arguments.session.id;
  if (auto usable = check_recording(file); !usable) return cli::fail_with(console, usable.error());
  const std::string copy = arguments.session.out.empty() ? record::recovered_name(file) : arguments.session.out;
  WorkBar work(console, "recovering");
  const auto recovery = record::recover(file, copy, work.progress());
  if (!recovery) {
    const int status = cli::fail_with(console, recovery.error());
    return work.is_interrupted() ? cli::kInterrupted : status;
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(*recovery));
  } else {
    print_recovery(console, *recovery);
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace dts::ctl
