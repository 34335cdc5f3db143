// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/utc_text.h"
#include "record/export/bids_documents.h"
#include "record/export/bids_names.h"
#include "record/export/event_rows.h"
#include "record/export/export.h"
#include "record/export/output_files.h"
#include "record/export/recording_document.h"
#include "record/export/row_text.h"
#include "record/export/walk.h"

namespace dts::record {
namespace {

constexpr std::size_t kLargestList = 16U << 20U;
constexpr std::string_view kParticipants = "participant_id\tpseudonym\n";
constexpr std::string_view kScans = "filename\tacq_time\n";

/// One regular stream and its file.
struct Motion {
  OutputFile* file = nullptr;  ///< Null: the stream is not exported.
  std::size_t stream = 0;
  MotionFacts facts{};
  std::optional<TimeAxis> times{};
};

class BidsSink : public ExportSink {
 public:
  BidsSink(const Recording& recording, const Corrections& corrections, double origin_s, OutputFiles& files)
      : recording_(recording),
        corrections_(corrections),
        subject_(corrected(recording.session().value_or(SessionFacts{}), corrections).subject),
        names_(recording, subject_),
        origin_s_(origin_s),
        files_(files),
        motions_(recording.streams().size()),
        markers_(recording, corrections) {}

  [[nodiscard]] core::Status create_files();
  [[nodiscard]] core::Status write(const RecordedScans& scans) override;
  [[nodiscard]] core::Status write(const RecordedChange& /*change*/) override { return {}; }
  [[nodiscard]] core::Status write(const TimedEvent& event) override;
  /// Writes the documents that need the whole recording, and the lists of the dataset.
  [[nodiscard]] core::Status write_documents();
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_.load(); }

 private:
  [[nodiscard]] core::Status create_events();
  [[nodiscard]] core::Status add_participant();
  [[nodiscard]] core::Status add_scans();

  const Recording& recording_;
  const Corrections& corrections_;
  std::string subject_;  ///< After corrections.
  BidsNames names_;
  double origin_s_;
  OutputFiles& files_;
  std::vector<Motion> motions_;
  std::optional<EventRows> events_{};
  MarkerTexts markers_;
  std::atomic<std::uint64_t> rows_ = 0;
};

core::Status BidsSink::create_files() {
  std::set<std::string> taken;
  for (std::size_t stream = 0; stream < motions_.size(); ++stream) {
    const StreamInfo& info = recording_.streams()[stream];
    if (!info.rate || info.value_type == ValueType::Text || recording_.sample_count(stream) == 0) continue;
    Motion& motion = motions_[stream];
    const std::string wanted = names_.tracking_system(info);
    motion.facts.tracking_system = wanted;
    for (int number = 2; !taken.insert(motion.facts.tracking_system).second; ++number) {
      motion.facts.tracking_system = wanted + std::to_string(number);
    }
    DTS_TRY_ASSIGN(motion.file, files_.create(names_.path(motion.facts.tracking_system, "motion.tsv")));
    motion.stream = stream;
    motion.times.emplace(origin_s_, *info.rate);
  }
  return create_events();
}

/// Creates the file of events. Events belong to the whole recording, but BIDS requires one tracking system: uses the centre of pressure, or
/// else the first stream.
core::Status BidsSink::create_events() {
  const Motion* owner = nullptr;
  for (const Motion& motion : motions_) {
    if (motion.file == nullptr) continue;
    const bool is_cop = short_name(recording_.streams()[motion.stream].name) == "cop";
    if (owner == nullptr || is_cop) owner = &motion;
  }
  if (owner == nullptr) {
    return core::fail(core::ErrorCode::InvalidArgument, "the recording has no scans: BIDS needs scans", "export it as CSV");
  }
  DTS_TRY_ASSIGN(auto events, files_.create(names_.path(owner->facts.tracking_system, "events.tsv")));
  events_.emplace(*events);
  events->append("onset\tduration\ttrial_type\tvalue\tcondition\tsegment\tscan\tdetails\n");
  return files_.put(names_.path(owner->facts.tracking_system, "events.json"), events_description());
}

core::Status BidsSink::write(const RecordedScans& scans) {
  Motion& motion = motions_[scans.stream];
  if (motion.file == nullptr || scans.count == 0) return {};
  const StreamInfo& info = recording_.streams()[scans.stream];
  const std::size_t channels = info.channels.size();
  motion.times->begin(scans);
  const double* value = scans.values.data();
  for (std::size_t scan = 0; scan < scans.count; ++scan) {
    char* at = put_microseconds(motion.file->reserve((channels + 1) * (kLongestNumber + 1) + 1), motion.times->time_ns(scan));
    for (std::size_t channel = 0; channel < channels; ++channel) {
      *at++ = '\t';
      at = put_value(at, *value++, info.value_type, "n/a");
    }
    *at++ = '\n';
    motion.file->advance(at);
  }
  motion.facts.scans += scans.count;
  motion.facts.duration_ns = motion.times->time_ns(scans.count - 1) + info.rate->time_ns({1});
  rows_ += scans.count;
  return motion.file->status();
}

core::Status BidsSink::write(const TimedEvent& timed) {
  const EventCells cells = cells_of(markers_.corrected(timed));
  const bool is_moment = timed.event.has_marker() || timed.event.has_trigger();
  const std::int64_t time_ns = to_ns(timed.time_s - origin_s_);
  std::array<char, kLongestNumber> onset{};
  std::string row(onset.data(), put_microseconds(onset.data(), time_ns));
  row += is_moment ? "\t0" : "\tn/a";
  for (const std::string& cell : {cells.kind, cells.text, cells.condition, std::to_string(timed.event.segment()),
                                  std::to_string(timed.event.scan()), cells.details}) {
    row += "\t" + tsv_cell(cell);
  }
  events_->add(time_ns, row + "\n");
  ++rows_;
  return events_->status();
}

/// Returns a list of an existing dataset, or only its header if the list does not exist.
core::Result<std::string> read_list(const std::string& file, std::string_view header) {
  std::error_code none;
  if (!std::filesystem::exists(file, none)) return std::string(header);
  const auto bytes = std::filesystem::file_size(file, none);
  std::ifstream stream(file, std::ios::binary);
  if (none || !stream || bytes > kLargestList) return core::fail(core::ErrorCode::Failed, "cannot read '" + file + "'");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!text.starts_with(header)) {
    return core::fail(core::ErrorCode::WrongState, "'" + file + "' has other columns than dtsd writes: another program changed it",
                      "export into a new folder");
  }
  return text.ends_with('\n') ? text : text + "\n";
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; });
  return text;
}

core::Status BidsSink::add_participant() {
  const std::string row = names_.subject() + "\t" + tsv_cell(subject_) + "\n";
  DTS_TRY_ASSIGN(auto list, read_list(files_.path("participants.tsv"), kParticipants));
  if (list.find("\n" + row) != std::string::npos) return {};
  if (lower_case(list).find("\n" + lower_case(names_.subject()) + "\t") != std::string::npos) {
    return core::fail(core::ErrorCode::WrongState,
                      "another subject ID of this data set becomes " + names_.subject() +
                          " too: BIDS allows only letters and digits, and many disks ignore the difference of upper and lower case",
                      "export into a new folder");
  }
  return files_.replace("participants.tsv", list + row);
}

core::Status BidsSink::add_scans() {
  DTS_TRY_ASSIGN(auto list, read_list(files_.path(names_.scans_table()), kScans));
  std::string begin = "n/a";
  if (const auto& session = recording_.session()) {
    std::int64_t utc_ns = 0;
    if (!__builtin_add_overflow(to_ns(origin_s_), session->utc_minus_monotonic_ns, &utc_ns)) begin = core::utc_text(utc_ns);
  }
  for (const Motion& motion : motions_) {
    if (motion.file != nullptr) list += names_.path_in_session(motion.facts.tracking_system, "motion.tsv") + "\t" + begin + "\n";
  }
  return files_.replace(names_.scans_table(), list);
}

core::Status BidsSink::write_documents() {
  events_->finish();
  DTS_TRY(events_->status());
  for (const Motion& motion : motions_) {
    if (motion.file == nullptr) continue;
    const StreamInfo& info = recording_.streams()[motion.stream];
    const auto put = [&](const std::string& suffix, const std::string& text) {
      return files_.put(names_.path(motion.facts.tracking_system, suffix), text);
    };
    DTS_TRY(put("channels.tsv", channels_table(info)).and_then([&] { return put("channels.json", channels_description()); }).and_then([&] {
      return put("motion.json", motion_description(recording_, info, motion.facts));
    }));
  }
  // Our facts that BIDS does not define: BIDS validators ignore the folder sourcedata.
  return files_
      .put("sourcedata/" + names_.subject() + "/" + file_stem(recording_) + "_recording.json",
           recording_document(recording_, corrections_, false))
      .and_then([&] { return add_participant(); })
      .and_then([&] { return add_scans(); });
}

/// Makes a dataset of an empty or missing folder. Accepts an existing dataset of ours. Fails for any other folder.
core::Status prepare_dataset(const Recording& recording, OutputFiles& files) {
  namespace fs = std::filesystem;
  std::error_code none;
  const std::string description = files.path("dataset_description.json");
  if (fs::exists(description, none)) {
    std::ifstream stream(description, std::ios::binary);
    std::string text(64U << 10U, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (is_our_dataset(text)) return {};
    return core::fail(core::ErrorCode::WrongState, "'" + description + "' belongs to a data set that dtsd did not write",
                      "choose another folder");
  }
  const fs::path folder = fs::path(description).parent_path();
  if (fs::exists(folder, none) && !fs::is_empty(folder, none)) {
    return core::fail(core::ErrorCode::WrongState, "'" + folder.string() + "' contains files that are not a BIDS data set",
                      "choose a new folder, or an empty one");
  }
  return files.put("dataset_description.json", dataset_description(recording.session().value_or(SessionFacts{}).software))
      .and_then([&] { return files.put("README", dataset_readme()); })
      .and_then([&] { return files.put("participants.json", participants_description()); });
}

}  // namespace

core::Result<Exported> export_bids(Recording& recording, const std::string& folder, const Progress& progress,
                                   const Corrections& corrections) {
  DTS_TRY_ASSIGN(const auto origin_s, find_origin(recording));
  OutputFiles files(folder);
  BidsSink sink(recording, corrections, origin_s, files);
  DTS_TRY(prepare_dataset(recording, files)
              .and_then([&] { return sink.create_files(); })
              .and_then([&] { return walk(recording, sink, progress); })
              .and_then([&] { return sink.write_documents(); }));
  return files.commit().map([&](OutputFiles::Written&& written) {
    return Exported{.files = std::move(written.files), .rows = sink.rows(), .bytes = written.bytes};
  });
}

}  // namespace dts::record
