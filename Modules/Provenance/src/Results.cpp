// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Results.h"

#include <cmath>

namespace explica::provenance {
namespace {

/// JSON has no NaN and no infinity: null instead.
Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

struct ToJson {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(double value) const { return numberOrNull(value); }
  Json operator()(const std::vector<double>& values) const {
    Json list = Json::array();
    for (const double value : values) list.push_back(numberOrNull(value));
    return list;
  }
  Json operator()(const std::vector<Results>& parts) const {
    Json list = Json::array();
    for (const Results& part : parts) {
      Json object = Json::object();
      for (const Result& result : part) object[result.key] = valueOf(result.value);
      list.push_back(std::move(object));
    }
    return list;
  }
  template <class T>
  Json operator()(const T& value) const {
    return value;
  }
};

Json limitJson(const Limit& limit) {
  return {{"least", numberOrNull(limit.least)},
          {"most", numberOrNull(limit.most)},
          {"otherwise", nameOf(limit.outside)},
          {"source", limit.source}};
}

}  // namespace

Json valueOf(const Result::Value& value) {
  return std::visit(ToJson{}, value);
}

Json meaningOf(const Result& result) {
  Json json = {{"title", result.title}};
  if (!result.unit.empty()) json["unit"] = result.unit;
  if (!result.meaning.empty()) json["meaning"] = result.meaning;
  if (!result.start.empty()) json["start"] = result.start;
  if (result.isInHead) json["head"] = true;
  if (result.isCompared) json["compared"] = true;
  for (const Limit& limit : result.limits) json["limits"].push_back(limitJson(limit));
  if (const auto judgement = result.judgement()) json["judgement"] = nameOf(*judgement);
  if (!result.limits.empty()) json["sentence"] = result.sentence();
  if (const std::string expected = result.expected(); !expected.empty())
    json["expected"] = expected;
  return json;
}

}  // namespace explica::provenance
