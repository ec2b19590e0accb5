// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Json.h"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace explica::provenance {

std::vector<std::string> schemaFaults(const Json& value, std::string_view schemaText) {
  const auto schemaJson = nlohmann::json::parse(schemaText);
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schemaJson), schema);

  const auto plain = nlohmann::json::parse(textOf(value));
  valijson::Validator validator;
  valijson::ValidationResults results;
  std::vector<std::string> faults;
  if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(plain), &results)) {
    return faults;
  }
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    std::string place;
    for (const auto& part : error.context) place += part;
    faults.push_back(place + ": " + error.description);
  }
  return faults;
}

}  // namespace explica::provenance
