// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Json.h"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include <functional>
#include <map>
#include <memory>
#include <mutex>

namespace explica::provenance {
namespace {

/// A schema ready for use: to read it takes far longer than to hold a small value against it.
const valijson::Schema& schemaOf(std::string_view text) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<valijson::Schema>, std::less<>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto known = all.find(text);
  if (known != all.end()) return *known->second;
  auto schema = std::make_unique<valijson::Schema>();
  const auto json = nlohmann::json::parse(text);
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(json), *schema);
  return *all.emplace(text, std::move(schema)).first->second;
}

}  // namespace

std::vector<std::string> schemaFaults(const Json& value, std::string_view schemaText) {
  const auto plain = nlohmann::json::parse(textOf(value));
  valijson::Validator validator;
  valijson::ValidationResults results;
  std::vector<std::string> faults;
  if (validator.validate(schemaOf(schemaText), valijson::adapters::NlohmannJsonAdapter(plain),
                         &results)) {
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
