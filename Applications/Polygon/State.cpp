// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "State.h"

#include "Explica/Core/Errors.h"

#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Document.h"

#include <vector>

namespace explica::app {
namespace {

using Json = nlohmann::ordered_json;
using planar::PolygonCheckpoint;
using planar::PolygonIteration;
using planar::PolygonState;

constexpr const char* kKind = "explica polygon state 1";
/// A state holds all positions of every frame.
constexpr provenance::DocumentLimits kStateLimits = {std::size_t{1} << 30, 16, 100'000'000};

/// JSON has no infinity: null stands for it.
Json numberOf(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double toNumber(const Json& json) {
  return json.is_null() ? kInfinity : json.get<double>();
}

Json jsonOf(const Positions2& positions) {
  Json list = Json::array();
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    list.push_back(positions(v, 0));
    list.push_back(positions(v, 1));
  }
  return list;
}

Positions2 toPositions(const Json& list) {
  Positions2 positions(static_cast<Eigen::Index>(list.size() / 2), 2);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const auto at = static_cast<std::size_t>(2 * v);
    positions.row(v) << list.at(at).get<double>(), list.at(at + 1).get<double>();
  }
  return positions;
}

Json jsonOf(const planar::Region& region) {
  return {region.firstEdge, region.edgeCount};
}

planar::Region toRegion(const Json& json) {
  return {json.at(0).get<int>(), json.at(1).get<int>()};
}

Json jsonOf(const PolygonState& state) {
  return {{"region", jsonOf(state.region)}, {"positions", jsonOf(state.positions)}};
}

/// A region that leaves its polygon is no state.
PolygonState toState(const Json& json) {
  PolygonState state{toPositions(json.at("positions")), toRegion(json.at("region"))};
  const Eigen::Index n = state.positions.rows();
  if (n < 2 || state.region.edgeCount < 1 || state.region.edgeCount > n ||
      state.region.firstEdge < 0 || state.region.firstEdge >= n) {
    throw std::out_of_range("region");
  }
  return state;
}

/// The members of an iteration, one list for writing and reading.
template <class Row, class Visit>
void visitNumbers(Row& row, const Visit& visit) {
  for (auto* member : {&row.visibility, &row.variance, &row.length, &row.lengthError,
                       &row.leastDistance, &row.knotEnergy, &row.step, &row.seconds}) {
    visit(*member);
  }
}

}  // namespace

std::string textOf(const PolygonCheckpoint& state) {
  Json json = {{"kind", kKind},
               {"method", nameOf(state.method)},
               {"input", jsonOf(state.input)},
               {"input_region", jsonOf(state.inputRegion)}};
  Positions2 view(static_cast<Eigen::Index>(state.view.points.size()), 2);
  for (std::size_t p = 0; p < state.view.points.size(); ++p) {
    view.row(static_cast<Eigen::Index>(p)) = state.view.points[p].transpose();
  }
  json["viewpoints"] = jsonOf(view);
  json["weights"] = state.view.weights;
  json["posed"] = jsonOf(state.posed);
  json["damping"] = state.methodState.damping;
  const Eigen::VectorXd& tension = state.methodState.tension;
  json["tension"] = std::vector<double>(tension.data(), tension.data() + tension.size());
  json["vertices_merged"] = state.verticesMerged;
  json["first_crossing"] = state.firstCrossing;
  Json& history = json["history"] = Json::array();
  for (const PolygonIteration& row : state.history) {
    Json numbers = {row.iteration};
    visitNumbers(row, [&](const double& value) { numbers.push_back(numberOf(value)); });
    history.push_back(std::move(numbers));
  }
  Json& path = json["path"] = Json::array();
  for (const PolygonState& at : state.path) path.push_back(jsonOf(at));
  return provenance::textOf(json) + "\n";
}

PolygonCheckpoint readState(const std::filesystem::path& path) {
  if (!isThere(path)) {
    throw IOError(path.string() + " cannot be read; nothing was left to resume from");
  }
  try {
    const Json json = provenance::readJson(path, kStateLimits);
    if (json.at("kind") != kKind) throw std::out_of_range("kind");
    PolygonCheckpoint state;
    state.method = valueOf<planar::PolygonMethod>(json.at("method").get<std::string>());
    state.input = toPositions(json.at("input"));
    state.inputRegion = toRegion(json.at("input_region"));
    const Positions2 view = toPositions(json.at("viewpoints"));
    for (Eigen::Index p = 0; p < view.rows(); ++p) {
      state.view.points.emplace_back(view.row(p).transpose());
    }
    state.view.weights = json.at("weights").get<std::vector<double>>();
    state.posed = toState(json.at("posed"));
    state.methodState.damping = json.at("damping");
    const auto tension = json.at("tension").get<std::vector<double>>();
    state.methodState.tension = Eigen::Map<const Eigen::VectorXd>(
        tension.data(), static_cast<Eigen::Index>(tension.size()));
    state.verticesMerged = json.at("vertices_merged");
    state.firstCrossing = json.at("first_crossing");
    for (const Json& numbers : json.at("history")) {
      PolygonIteration row;
      row.iteration = numbers.at(0);
      std::size_t at = 0;
      visitNumbers(row, [&](double& value) { value = toNumber(numbers.at(++at)); });
      state.history.push_back(row);
    }
    for (const Json& at : json.at("path")) state.path.push_back(toState(at));
    return state;
  } catch (const std::exception& error) {
    throw IOError(path.string() + ": not a complete state of an unfolding (" + error.what() + ")");
  }
}

}  // namespace explica::app
