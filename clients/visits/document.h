// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "dts/v1/sessions.pb.h"
#include "visits/sentences.h"

namespace dts::visits {

/// Returns trends and plain words of a subject as one JSON document, as `dtsctl subject trend --json` prints it and the gateway serves it:
///
///     {"subject":"P017","language":"en",
///      "series":[{"rig","protocol","condition","measure","unit","retest":{"percent","source"},
///                 "points":[{"session","utc_ns","value","sd","trials","is_comparable"}]}],
///      "words":{"changes":["..."],"sessions":[{"session","sentences":["..."]}]}}
///
/// Undefined members are absent. Sessions are newest first. `measure`: only series of this measure; empty: all.
[[nodiscard]] nlohmann::ordered_json document_of(const v1::SubjectRecord& subject, const v1::ListProtocolsResponse& protocols,
                                                 const Sentences& sentences, const std::string& measure = {});

}  // namespace dts::visits
