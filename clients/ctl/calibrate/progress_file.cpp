// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/progress_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "cli/try.h"

namespace dts::ctl {
namespace {

using cli::Json;
using client::ErrorCode;
using client::Result;

constexpr const char* kFresh = "start again with --fresh";
constexpr const char* kOther = "use --resume without other options: it uses those of the file; or start again with --fresh";
constexpr std::size_t kShownBytes = 60;

tl::unexpected<client::Error> failed(const std::filesystem::path& path, int error) {
  return client::fail(ErrorCode::Failed, path.string() + ": " + std::strerror(error), "check free space and write permission");
}

tl::unexpected<client::Error> damaged_head(const std::filesystem::path& path) {
  return client::fail(ErrorCode::DataDamaged, path.string() + ":1: damaged: the line with the properties of the calibration is missing",
                      kFresh);
}

tl::unexpected<client::Error> nothing_to_resume(const std::filesystem::path& path) {
  return client::fail(ErrorCode::WrongState, "there is nothing to resume: " + path.string() + " does not exist", "leave out --resume");
}

/// Returns "estimator is \"thesis\", now \"poly3\"": the first difference between two calibrations.
std::string difference(const Json& then, const Json& now) {
  for (const auto& [key, value] : now.items()) {
    const Json old = then.is_object() ? then.value(key, Json()) : Json();
    if (old == value) continue;
    const auto shown = [](const Json& json) { return json.dump().size() > kShownBytes ? std::string("another list") : json.dump(); };
    return key + " was " + shown(old) + ", now it is " + shown(value);
  }
  return "it has keys that this version does not know";
}

std::optional<std::vector<double>> numbers(const Json& line, const char* key, std::size_t count) {
  const auto found = line.find(key);
  if (found == line.end() || !found->is_array() || found->size() != count) return std::nullopt;
  std::vector<double> values;
  for (const Json& value : *found) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
    values.push_back(value.get<double>());
  }
  return values;
}

}  // namespace

Result<std::filesystem::path> state_folder(const client::Environment& environment) {
  const char* state = environment("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::filesystem::path(state) / "dts";
  const char* home = environment("HOME");
  if (home != nullptr && *home == '/') return std::filesystem::path(home) / ".local" / "state" / "dts";
  return client::fail(ErrorCode::Failed, "cannot save the progress: neither XDG_STATE_HOME nor HOME is set");
}

void ProgressFile::Closer::operator()(const int* descriptor) const noexcept {
  ::close(*descriptor);
  delete descriptor;
}

Result<ProgressFile> ProgressFile::open(const std::filesystem::path& file, int flags) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  ProgressFile progress;
  progress.path_ = file;
  const int descriptor = ::open(file.c_str(), flags | O_RDWR | O_APPEND | O_CLOEXEC, 0600);
  if (descriptor < 0) return failed(file, errno);
  progress.descriptor_ = Descriptor(new int(descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return client::fail(ErrorCode::WrongState, file.string() + " is in use: another calibration of this rig is running",
                        "end the other calibration first");
  }
  return progress;
}

Result<ProgressFile> ProgressFile::create(const std::filesystem::path& file, const Json& calibration) {
  DTS_TRY_ASSIGN(auto progress, open(file, O_CREAT));
  if (::ftruncate(*progress.descriptor_, 0) != 0) return failed(file, errno);
  progress.points_.resize(calibration.at("points").size());
  DTS_TRY(progress.append(cli::one_line({{"calibration", calibration}})));
  return progress;
}

Result<Json> ProgressFile::calibration_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  if (!stream) return nothing_to_resume(file);
  std::getline(stream, text);
  const Json line = Json::parse(text, nullptr, false);
  Json calibration = line.is_object() ? line.value("calibration", Json()) : Json();
  if (!calibration.is_object()) return damaged_head(file);
  return calibration;
}

Result<ProgressFile> ProgressFile::resume(const std::filesystem::path& file, const Json& calibration, std::size_t point_count,
                                          std::size_t channel_count) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return nothing_to_resume(file);
  DTS_TRY_ASSIGN(auto progress, open(file, 0));
  progress.points_.resize(point_count);
  DTS_TRY(progress.read(calibration, channel_count));
  return progress;
}

Result<void> ProgressFile::read(const Json& calibration, std::size_t channel_count) {
  std::ifstream file(path_, std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  const std::string text = content.str();
  std::size_t begin = 0;
  for (std::size_t number = 1; begin < text.size(); ++number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;  // cut off by a crash
    const Json line =
        Json::parse(text.begin() + static_cast<std::ptrdiff_t>(begin), text.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
    if (number == 1) {
      const Json then = line.is_object() ? line.value("calibration", Json()) : Json();
      if (!then.is_object()) return damaged_head(path_);
      if (then != calibration) {
        return client::fail(ErrorCode::WrongState, path_.string() + " belongs to another calibration: " + difference(then, calibration),
                            kOther);
      }
    } else {
      DTS_TRY(add_line(line, number, channel_count));
    }
    begin = end + 1;
  }
  if (begin == 0) return damaged_head(path_);
  if (begin < text.size() && ::ftruncate(*descriptor_, static_cast<off_t>(begin)) != 0) return failed(path_, errno);
  return {};
}

Result<void> ProgressFile::add_line(const Json& line, std::size_t number, std::size_t channel_count) {
  const auto damaged = [&] {
    return client::fail(ErrorCode::DataDamaged, path_.string() + ":" + std::to_string(number) + ": not a point", kFresh);
  };
  if (!line.is_object()) return damaged();
  const auto index = line.find("index");
  const auto scans = line.find("scans");
  const auto is_count = [&](const auto& found) { return found != line.end() && found->is_number_unsigned(); };
  if (is_count(index) && index->get<std::size_t>() < points_.size() && line.contains("redo")) {
    if (line["redo"] != true) return damaged();
    points_[index->get<std::size_t>()].reset();
    return {};
  }
  auto mean = numbers(line, "mean", channel_count);
  auto noise = numbers(line, "noise", channel_count);
  if (!is_count(index) || !is_count(scans) || !mean || !noise || index->get<std::size_t>() >= points_.size()) return damaged();
  points_[index->get<std::size_t>()] = SteadyReading{std::move(*mean), std::move(*noise), scans->get<std::size_t>()};
  return {};
}

std::size_t ProgressFile::next() const noexcept {
  return static_cast<std::size_t>(std::ranges::find(points_, false, &std::optional<SteadyReading>::has_value) - points_.begin());
}

Result<void> ProgressFile::append(const std::string& line) {
  const std::string text = line + "\n";
  const ssize_t written = ::write(*descriptor_, text.data(), text.size());
  if (written < 0 || ::fsync(*descriptor_) != 0) return failed(path_, errno);
  if (static_cast<std::size_t>(written) < text.size()) return failed(path_, ENOSPC);
  return {};
}

Result<void> ProgressFile::record(std::size_t index, const SteadyReading& reading) {
  auto written = append(cli::one_line({{"index", index}, {"mean", reading.mean}, {"noise", reading.noise}, {"scans", reading.scans}}));
  if (written) points_.at(index) = reading;
  return written;
}

Result<void> ProgressFile::forget(std::size_t index) {
  auto written = append(cli::one_line({{"index", index}, {"redo", true}}));
  if (written) points_.at(index).reset();
  return written;
}

void ProgressFile::finish() noexcept {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace dts::ctl
