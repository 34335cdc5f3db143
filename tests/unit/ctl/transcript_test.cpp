// SPDX-License-Identifier: Apache-2.0
// Whole conversations with a played daemon, against the committed texts in transcripts/: see transcripts/README.md.
#include <google/protobuf/text_format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include "cli/json.h"
#include "ctl/calibrate/rig_facts.h"
#include "dts/wire/options.h"
#include "support/committed_text.h"
#include "unit/cli/command_checks.h"
#include "unit/ctl/run_fixture.h"
#include "unit/ctl/sessions/made_recording.h"
#include "unit/report/made_standing.h"

namespace dts::ctl {
namespace {

namespace fs = std::filesystem;

std::string one_line(const google::protobuf::Message& message) {
  google::protobuf::TextFormat::Printer printer;
  printer.SetSingleLineMode(true);
  std::string text;
  printer.PrintToString(message, &text);
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

/// Overwrites a byte in the middle, as a bad disk does.
void damage(const fs::path& file) {
  fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
  stream.put('\x55');
}

void make_standing(const std::string& file) {
  report::MadeStanding made{.length_s = 25.0};
  report::add_trial(made, 1, 2.0, 20.0, "eyes-open", {{"eyes", "open"}});
  report::write_standing(file, made);
}

/// All names below a folder, or the text of a file.
std::string shown(const fs::path& path) {
  if (!fs::is_directory(path)) return test::content_of(path);
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(path)) names.push_back(entry.path().string() + "\n");
  std::ranges::sort(names);
  return std::accumulate(names.begin(), names.end(), std::string());
}

/// What begins and ends so becomes `to`.
std::string replaced_between(std::string text, const std::string& begin, const std::string& end, const std::string& to) {
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + to.size())) {
    const std::size_t last = text.find(end, at + begin.size());
    if (last == std::string::npos) break;
    text.replace(at, last + end.size() - at, to);
  }
  return text;
}

/// A checksum of a recording depends on the program's version.
std::string without_checksums(std::string text) {
  constexpr std::size_t kDigits = 64;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789abcdef", at), text.size());
    if (end - at == kDigits) text.replace(at, kDigits, "SHA");
    at = end - at == kDigits ? at : end;
  }
  return text;
}

class TranscriptTest : public RunTest, public ::testing::WithParamInterface<std::string> {
 protected:
  TranscriptTest() {
    console_.is_out_terminal = console_.is_talk_terminal = console_.has_colours = true;
    console_.columns = 220;
  }
  /// The transcript with what the commands in it print now.
  std::string play(const std::string& transcript) {
    std::string played;
    std::vector<std::string> set_up;
    for (const std::string& line : test::lines_of(transcript)) {
      if (line.starts_with("> ") || line.starts_with("| ") || line.starts_with("! ") || line.starts_with("= ")) continue;
      played += line + "\n";
      if (line.starts_with("$")) {
        for (const std::string& step : set_up) prepare(step);
        set_up.clear();
        played += run_command(line.substr(1));
      } else if (line.starts_with("  ") && !set_up.empty()) {
        set_up.back() += "\n" + line.substr(2);
      } else if (!line.empty() && !line.starts_with("#")) {
        set_up.push_back(line);
      }
    }
    EXPECT_TRUE(set_up.empty()) << "no command follows: " << set_up.back();
    return played;
  }

 private:
  void prepare(const std::string& step) {
    const std::size_t end = step.find_first_of(" \n", step.find(' ') + 1);
    const std::string what = step.substr(0, step.find(' '));
    const std::string name = step.substr(what.size() + 1, end - what.size() - 1);
    const std::string text = end == std::string::npos ? "" : placed(step.substr(end + 1));
    if (what == "answer") {
      const std::lock_guard lock(mutex_);
      answers_[name] = testing::from_text<v1::Response>(text);
    } else if (what == "publish") {
      published_.emplace_back(name, text);
    } else if (what == "file") {
      std::ofstream(directory_.path() / name) << text;
    } else if (what == "screen") {
      console_.can_redraw = true;
      console_.columns = static_cast<std::size_t>(std::stoi(name));
    } else if (what == "remove") {
      fs::remove_all(directory_.path() / name);
    } else if (what == "damage") {
      damage(directory_.path() / name);
    } else if (what == "standing") {
      make_standing(directory_.path() / name);
    } else if (what == "recording") {
      const std::map<std::string, Ending> endings{
          {"closed", Ending::Closed}, {"incomplete", Ending::Incomplete}, {"killed", Ending::Killed}};
      make_recording(directory_.path() / name, endings.at(text.substr(0, text.find(' '))), text.find(" 2") != std::string::npos ? 2 : 1,
                     text.ends_with(" gap"));
    } else {
      ADD_FAILURE() << step;
    }
  }
  std::string run_command(const std::string& command) {
    const std::vector<std::string> words = cli::shell_words(placed(command));
    if (!words.empty() && words.front() == "show") return marked("| ", shown(words.at(1)));
    int status = -1;
    if (published_.empty()) {
      status = std::ranges::find(words, "--endpoint") != words.end() ? run_bare(words) : run_with(words);
    } else {
      testing::FakePublisher daemon(data_);
      std::jthread speaker([&] {
        EXPECT_TRUE(daemon.wait_for_subscription(published_.front().second));
        publish(daemon);
      });
      status = run_with(words);
    }
    published_.clear();
    std::string printed = out();
    if (const auto json = cli::Json::parse(printed, nullptr, false); json.is_object() && printed == cli::document(json)) {
      printed = cli::one_line(json) + "\n";
    }
    const std::lock_guard lock(mutex_);
    std::string text = marked("> ", requests_) + marked("| ", printed) + marked("! ", talk());
    requests_.clear();
    return text + "= " + std::to_string(status) + "\n";
  }
  /// The first step says which subscription to wait for.
  void publish(testing::FakePublisher& daemon) const {
    for (std::size_t index = 1; index < published_.size(); ++index) {
      const auto& [topic, text] = published_[index];
      if (topic == "dtsd/status") {
        daemon.send(topic, testing::from_text<v1::StatusSnapshot>(text));
      } else if (text.find("scan_count") != std::string::npos) {
        daemon.send(topic, testing::from_text<v1::StreamBlock>(text));
      } else {
        daemon.send(topic, testing::from_text<v1::Event>(text));
      }
    }
  }
  std::vector<std::string> answer(const v1::Request& request) {
    const std::lock_guard lock(mutex_);
    v1::Request asked = request;
    asked.clear_request_id();
    // A busy machine may answer so late that the client asks again.
    if (std::exchange(last_id_, request.request_id()) != request.request_id()) requests_ += one_line(asked) + "\n";
    const auto* command = wire::command_field(request);
    const std::string name = command == nullptr ? "" : command->name();
    const std::string of_session = name + "/" + request.show_session().session_id();
    const auto known = answers_.find(answers_.contains(of_session) ? of_session : name);
    v1::Response response;
    if (known != answers_.end()) {
      response = known->second;
    } else {
      response.mutable_error()->set_what("the transcript has no answer to this");
    }
    response.set_request_id(request.request_id());
    return {response.SerializeAsString()};
  }
  [[nodiscard]] std::string placed(const std::string& text) const {
    return test::replaced(test::replaced(text, "@", directory_.path().string()), "VERSION", std::string(client::version()));
  }
  /// Each line with a mark before it, and without what differs from run to run.
  [[nodiscard]] std::string marked(const std::string& mark, std::string text) const {
    text = test::replaced(test::replaced(std::move(text), "\x1b", "^"), directory_.path().string(), "@");
    text = test::replaced(std::move(text), std::string(client::version()), "VERSION");
    for (const std::string& today : {begun_, utc_now().substr(0, 10)}) {
      for (const std::string& day : {today, test::replaced(today, "-", "")})
        text = replaced_between(std::move(text), day + "T", "Z", "NOW");
    }
    for (const std::string verb : {" arrive", " arrives"}) text = replaced_between(std::move(text), verb + ", after ", " ms", verb);
    std::string marked;
    for (std::string line : test::lines_of(without_checksums(test::rounded(std::move(text))))) {
      if (line.find("clock source: ") != std::string::npos) line = "CLOCK SOURCE";
      if (line.find("  clock: ") != std::string::npos) line = "CLOCK";
      line = replaced_between(std::move(line), R"({"name":"clock source")", "}", "CLOCK SOURCE");
      line = replaced_between(std::move(line), R"({"name":"clock")", "}", "CLOCK");
      if (line.find("\"pages\"") != std::string::npos) line = replaced_between(std::move(line), "\"bytes\":", "}", "BYTES}");
      if (line.find(" pages, ") != std::string::npos) line = replaced_between(std::move(line), ", ", " kB", ", BYTES");
      marked += mark + line + "\n";
    }
    return marked;
  }

  const std::string begun_ = utc_now().substr(0, 10);  ///< The day.
  std::mutex mutex_;
  std::map<std::string, v1::Response> answers_;
  std::string requests_;
  std::string last_id_;
  std::vector<std::pair<std::string, std::string>> published_;
  testing::FakeController daemon_{control_, [this](const v1::Request& request, int) { return answer(request); }};
};

TEST_P(TranscriptTest, EveryCommand_PrintsWhatItDid) {
  const std::string file = "unit/ctl/transcripts/" + GetParam() + ".txt";

  test::expect_committed(file, play(test::content_of(test::committed_file(file))));
}

INSTANTIATE_TEST_SUITE_P(Transcripts, TranscriptTest,
                         ::testing::Values("catalogue", "compare", "doctor", "edit", "files", "keys_and_protocols", "rigs", "sessions",
                                           "subjects", "top", "usage", "watch"),
                         [](const auto& given) { return given.param; });

}  // namespace
}  // namespace dts::ctl
