// SPDX-License-Identifier: Apache-2.0
#include "lab/force/force_file.h"

#include <filesystem>
#include <fstream>
#include <utility>

#include "files/whole_file.h"
#include "lab/base/position_columns.h"
#include "lab/force/c3d_plates.h"
#include "lab/force/raw_channels.h"
#include "lab/force/text_exports.h"

namespace dts::lab::force {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30U;
constexpr std::size_t kMostC3dBytes = kMostBytes;

/// Returns why the file cannot be read at all.
core::Status check_regular(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return unreadable(file, "no such file", "give an existing file");
  if (!std::filesystem::is_regular_file(file, error)) return unreadable(file, "is not a regular file", "give a file");
  const auto bytes = std::filesystem::file_size(file, error);
  if (error) return unreadable(file, "cannot be read: " + error.message(), "check the permissions");
  if (bytes == 0) return unreadable(file, "is empty", "export the file again");
  if (bytes > kMostBytes) return unreadable(file, "is larger than 1 GiB", "export a part of it");
  return {};
}

core::Result<std::string> first_bytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(2, '\0');
  if (!stream) return unreadable(file, "cannot be read", "check the permissions");
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

bool is_table_of_positions(const Beginning& beginning) {
  if (beginning.lines.empty()) return false;
  std::vector<std::string_view> names;
  for (const TextCell& cell : cells_of(beginning.lines.front(), ',')) names.push_back(cell.text);
  return has_position_columns(names);
}

}  // namespace

tl::unexpected<core::Error> unreadable(const std::string& file, const std::string& what, const std::string& hint) {
  return core::fail(core::ErrorCode::Failed, file + ": " + what + (hint.empty() ? "" : "; " + hint));
}

ForceSample sample_of(const physics::Wrench& wrench, const std::optional<physics::PointPolynomial>& polynomial) {
  const physics::ForcePoint point = polynomial ? corrected(wrench, *polynomial) : force_point(wrench);
  return {.force_n = wrench.force_n,
          .moment_nm = wrench.moment_nm,
          .cop_mm = {point.x_mm, point.y_mm, 0.0},
          .free_moment_nm = point.free_moment_nm};
}

bool is_force_file(const std::string& file) {
  if (!check_regular(file)) return false;
  const auto bytes = first_bytes(file);
  if (!bytes) return false;
  if (c3d::is_c3d(*bytes)) return true;
  const auto beginning = read_beginning(file);
  return beginning && !is_table_of_positions(*beginning) && text_format(*beginning).has_value();
}

core::Result<ForceFile> read_force_file(const std::string& file, const ReadOptions& options) {
  DTS_TRY(check_regular(file));
  if (!options.plate_file.empty()) return read_raw_channels(file, options.plate_file);
  DTS_TRY_ASSIGN(const auto beginning_bytes, first_bytes(file));
  if (c3d::is_c3d(beginning_bytes)) {
    auto bytes = files::read_whole_file(file, kMostC3dBytes);
    if (!bytes) return unreadable(file, bytes.error().what);
    return read_c3d_plates(file, std::move(*bytes), options);
  }
  DTS_TRY_ASSIGN(const auto beginning, read_beginning(file));
  if (const auto format = text_format(beginning)) return read_text_export(file, beginning, *format);
  return unreadable(file, "byte 2: not a C3D file, and no line has the names of a force plate's columns (Fx, Fy, Fz)",
                    "give a C3D file, a text export or raw channels with --plate-file");
}

}  // namespace dts::lab::force
