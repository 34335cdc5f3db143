// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::lsl {

// Types and values of liblsl's C API (lsl_c.h), which have not changed since version 1.10.
namespace api {
using Info = void*;      ///< lsl_streaminfo
using Xml = void*;       ///< lsl_xml_ptr
using Outlet = void*;    ///< lsl_outlet
using Inlet = void*;     ///< lsl_inlet
using Resolver = void*;  ///< lsl_continuous_resolver

inline constexpr std::int32_t kFloat32 = 1;
inline constexpr std::int32_t kString = 3;
inline constexpr double kIrregularRate = 0.0;
inline constexpr std::int32_t kNoError = 0;
inline constexpr std::int32_t kLostError = -2;  ///< The stream has ended, and the inlet does not recover it.
}  // namespace api

/// The library of LSL, loaded at run time: nothing of LSL is needed to build or link this program. The functions have LSL's names without
/// "lsl_". None throws. Thread: any; an outlet, inlet or resolver belongs to one thread at a time.
struct Liblsl {
  /// The files that `load` tries, in this order, if none is configured.
  [[nodiscard]] static const std::vector<std::string>& default_files();
  /// Loads `file`, a name as for dlopen; empty: the first of `default_files` that can be loaded. Fails with NotFound if there is none, and
  /// with InvalidArgument if it is another library, or older than 1.10 or newer than 1.x.
  [[nodiscard]] static core::Result<std::unique_ptr<const Liblsl>> load(const std::string& file);

  std::int32_t (*library_version)() = nullptr;  ///< 100 * major + minor
  double (*local_clock)() = nullptr;            ///< CLOCK_MONOTONIC on Linux, s.

  api::Info (*create_streaminfo)(const char* name, const char* type, std::int32_t channels, double rate_hz, std::int32_t format,
                                 const char* source_id) = nullptr;
  void (*destroy_streaminfo)(api::Info info) = nullptr;
  std::int32_t (*get_channel_count)(api::Info info) = nullptr;
  double (*get_nominal_srate)(api::Info info) = nullptr;
  const char* (*get_name)(api::Info info) = nullptr;
  const char* (*get_source_id)(api::Info info) = nullptr;
  const char* (*get_uid)(api::Info info) = nullptr;
  api::Xml (*get_desc)(api::Info info) = nullptr;
  api::Xml (*append_child)(api::Xml node, const char* name) = nullptr;
  api::Xml (*append_child_value)(api::Xml node, const char* name, const char* value) = nullptr;

  api::Outlet (*create_outlet)(api::Info info, std::int32_t chunk_size, std::int32_t buffer_s) = nullptr;
  void (*destroy_outlet)(api::Outlet outlet) = nullptr;
  std::int32_t (*have_consumers)(api::Outlet outlet) = nullptr;
  /// `values`: scan after scan; `count`: of all values; `stamps_s`: one per scan.
  std::int32_t (*push_chunk_ftnp)(api::Outlet outlet, const float* values, unsigned long count, const double* stamps_s,
                                  std::int32_t push_through) = nullptr;
  std::int32_t (*push_sample_strtp)(api::Outlet outlet, const char** texts, double stamp_s, std::int32_t push_through) = nullptr;

  api::Resolver (*create_continuous_resolver_bypred)(const char* predicate, double forget_after_s) = nullptr;
  std::int32_t (*resolver_results)(api::Resolver resolver, api::Info* found, std::uint32_t size) = nullptr;
  void (*destroy_continuous_resolver)(api::Resolver resolver) = nullptr;
  api::Inlet (*create_inlet)(api::Info info, std::int32_t buffer_length, std::int32_t chunk_length, std::int32_t recover) = nullptr;
  void (*destroy_inlet)(api::Inlet inlet) = nullptr;
  /// Returns the sample's time on the sender's clock; 0: no sample. The texts are the caller's: `destroy_string`.
  double (*pull_sample_str)(api::Inlet inlet, char** texts, std::int32_t count, double timeout_s, std::int32_t* error) = nullptr;
  void (*destroy_string)(char* text) = nullptr;
  /// Returns what must be added to a time of the sender's clock, s.
  double (*time_correction)(api::Inlet inlet, double timeout_s, std::int32_t* error) = nullptr;
};

}  // namespace dts::lsl
