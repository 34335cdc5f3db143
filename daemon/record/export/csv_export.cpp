// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <atomic>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "record/export/event_rows.h"
#include "record/export/export.h"
#include "record/export/output_files.h"
#include "record/export/recording_document.h"
#include "record/export/row_text.h"
#include "record/export/walk.h"

namespace dts::record {
namespace {

/// The file of one stream of numbers.
struct Column {
  OutputFile* file = nullptr;  ///< Null: not exported (a stream of texts or without samples).
  ValueType type = ValueType::Double64;
  std::size_t channels = 0;
  std::optional<TimeAxis> times{};  ///< Absent: every sample has its own time stamp.
};

/// Returns the longest row in bytes: t_s, segment, scan and one value per channel.
constexpr std::size_t longest_row(std::size_t channels) { return (channels + 3) * (kLongestNumber + 1) + 1; }

char* put_values(char* at, const double* values, const Column& column) noexcept {
  for (std::size_t channel = 0; channel < column.channels; ++channel) {
    *at++ = ',';
    at = put_value(at, values[channel], column.type, "");
  }
  *at++ = '\n';
  return at;
}

char* put_place(char* at, std::int64_t time_ns, std::uint64_t segment, std::uint64_t scan) noexcept {
  at = put_seconds(at, time_ns);
  *at++ = ',';
  at = put_count(at, segment);
  *at++ = ',';
  return put_count(at, scan);
}

class CsvSink : public ExportSink {
 public:
  CsvSink(const Recording& recording, const Corrections& corrections, double origin_s, OutputFiles& files)
      : recording_(recording),
        corrections_(corrections),
        origin_s_(origin_s),
        files_(files),
        columns_(recording.streams().size()),
        trials_(recording),
        markers_(recording, corrections) {}

  [[nodiscard]] core::Status create_files();
  [[nodiscard]] core::Status write(const RecordedScans& scans) override;
  [[nodiscard]] core::Status write(const RecordedChange& change) override;
  [[nodiscard]] core::Status write(const TimedEvent& event) override;
  /// Writes the documents that need the whole recording.
  [[nodiscard]] core::Status write_documents();
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_.load(); }

 private:
  [[nodiscard]] core::Status create_file(std::size_t stream);
  [[nodiscard]] std::string unused_name(const std::string& stream);

  const Recording& recording_;
  const Corrections& corrections_;
  double origin_s_;
  OutputFiles& files_;
  std::vector<Column> columns_;
  std::optional<EventRows> events_{};
  TrialTable trials_;
  MarkerTexts markers_;
  std::set<std::string> names_{"events", "trials"};
  std::atomic<std::uint64_t> rows_ = 0;  ///< Of all streams. Several threads count.
};

core::Status CsvSink::create_files() {
  for (std::size_t stream = 0; stream < columns_.size(); ++stream) {
    if (recording_.streams()[stream].value_type == ValueType::Text || recording_.sample_count(stream) == 0) continue;
    DTS_TRY(create_file(stream));
  }
  DTS_TRY_ASSIGN(auto events, files_.create(file_stem(recording_) + "_events.csv"));
  events_.emplace(*events);
  events->append("t_s,segment,scan,event,text,details\n");
  return {};
}

core::Status CsvSink::create_file(std::size_t stream) {
  const StreamInfo& info = recording_.streams()[stream];
  DTS_TRY_ASSIGN(auto file, files_.create(file_stem(recording_) + "_" + unused_name(info.name) + ".csv"));
  Column& column = columns_[stream];
  column.file = file;
  column.type = info.value_type;
  column.channels = info.channels.size();
  if (info.rate) column.times.emplace(origin_s_, *info.rate);
  std::string header = "t_s,segment,scan";
  for (const ChannelInfo& channel : info.channels) header += "," + csv_cell(name_with_unit(channel));
  column.file->append(header + "\n");
  return {};
}

/// Returns a name that no other stream has: files of other programs may have several streams of the same name.
std::string CsvSink::unused_name(const std::string& stream) {
  const std::string wanted = fit_for_file_name(short_name(stream));
  std::string name = wanted;
  for (int number = 2; !names_.insert(name).second; ++number) name = wanted + "-" + std::to_string(number);
  return name;
}

core::Status CsvSink::write(const RecordedScans& scans) {
  trials_.add(scans);
  Column& column = columns_[scans.stream];
  if (!column.times) return {};  // an irregular stream, or not exported
  column.times->begin(scans);
  for (std::size_t scan = 0; scan < scans.count; ++scan) {
    char* at = column.file->reserve(longest_row(column.channels));
    at = put_place(at, column.times->time_ns(scan), scans.segment, scans.first_scan.value + scan);
    column.file->advance(put_values(at, scans.values.data() + scan * column.channels, column));
  }
  rows_ += scans.count;
  return column.file->status();
}

core::Status CsvSink::write(const RecordedChange& change) {
  Column& column = columns_[change.stream];
  if (column.file == nullptr) return {};
  char* at = column.file->reserve(longest_row(column.channels));
  at = put_place(at, to_ns(change.time_s - origin_s_), change.segment, change.scan.value);
  column.file->advance(put_values(at, change.values.data(), column));
  ++rows_;
  return column.file->status();
}

core::Status CsvSink::write(const TimedEvent& timed) {
  trials_.add(timed);
  const EventCells cells = cells_of(markers_.corrected(timed));
  const std::int64_t time_ns = to_ns(timed.time_s - origin_s_);
  std::array<char, longest_row(0)> place{};
  std::string row(place.data(), put_place(place.data(), time_ns, timed.event.segment(), timed.event.scan()));
  row += "," + csv_cell(cells.kind) + "," + csv_cell(cells.text) + "," + csv_cell(cells.details) + "\n";
  events_->add(time_ns, std::move(row));
  ++rows_;
  return events_->status();
}

core::Status CsvSink::write_documents() {
  events_->finish();
  DTS_TRY(events_->status());
  const std::string stem = file_stem(recording_);
  const std::string trials = trials_.text(corrections_);
  if (auto put = files_.put(stem + "_recording.json", recording_document(recording_, corrections_, true)); !put || trials.empty())
    return put;
  return files_.put(stem + "_trials.csv", trials);
}

}  // namespace

core::Result<Exported> export_csv(Recording& recording, const std::string& folder, const Progress& progress,
                                  const Corrections& corrections) {
  DTS_TRY_ASSIGN(const auto origin_s, find_origin(recording));
  OutputFiles files(folder);
  CsvSink sink(recording, corrections, origin_s, files);
  DTS_TRY(sink.create_files());
  DTS_TRY(walk(recording, sink, progress));
  DTS_TRY(sink.write_documents());
  return files.commit().map([&](OutputFiles::Written&& written) {
    return Exported{.files = std::move(written.files), .rows = sink.rows(), .bytes = written.bytes};
  });
}

}  // namespace dts::record
