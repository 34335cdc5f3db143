// SPDX-License-Identifier: Apache-2.0
#include "fhir/resource_id.h"

#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/string_generator.hpp>
#include <boost/uuid/uuid_io.hpp>

#include "fhir/codes.h"

namespace dts::fhir {

std::string resource_id(const record::SessionFacts& facts, std::string_view what) {
  static const boost::uuids::uuid name_space =
      boost::uuids::string_generator()(std::string(kCodeSystem.substr(kCodeSystem.rfind(':') + 1)));
  const std::string name = facts.session_id + "\n" + std::to_string(facts.part) + "\n" + std::to_string(facts.started_utc_ns) + "\n" +
                           facts.boot_id + "\n" + std::string(what);
  return boost::uuids::to_string(boost::uuids::name_generator_sha1(name_space)(name));
}

}  // namespace dts::fhir
