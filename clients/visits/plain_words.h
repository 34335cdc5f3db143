// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dts/v1/sessions.pb.h"
#include "visits/sentences.h"
#include "visits/series.h"

namespace dts::visits {

/// Titles of conditions by protocol and condition, in the language of the sentences where the protocol has it, else in English.
using Titles = std::map<std::pair<std::string, std::string>, std::string>;
[[nodiscard]] Titles titles_of(const v1::ListProtocolsResponse& protocols, const Sentences& sentences);

/// Returns what the results of one session say, as sentences without a judgement: eyes closed against eyes open; trunk angle by target,
/// classes, consistency. Empty for a session without such results.
[[nodiscard]] std::vector<std::string> words_of_session(const v1::SessionRecord& session, const Sentences& sentences,
                                                        const Titles& titles = {});

/// Returns how the newest visit differs from the one before and, if there were more, from the first one, for ellipse, mean velocity and
/// trunk angle. Compares only points that were analysed in the same way. A difference within the known variation between two days is said
/// to be one; if a measure has no known variation, the last sentence says so.
[[nodiscard]] std::vector<std::string> words_of_changes(std::span<const Series> series, const Sentences& sentences,
                                                        const Titles& titles = {});

}  // namespace dts::visits
