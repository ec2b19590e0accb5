// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Coefficients.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Document.h"

#include <string>
#include <vector>

namespace explica::app {
namespace {

constexpr const char* kCircular = "circular annulus";
constexpr const char* kSpherical = "spherical annulus";
constexpr const char* kGiven = "given annulus";

nlohmann::ordered_json rowsOf(const Positions2& positions) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    rows.push_back({positions(v, 0), positions(v, 1)});
  }
  return rows;
}

planar::Curve polygonOf(const nlohmann::ordered_json& rows) {
  planar::Curve curve;
  curve.positions.resize(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    const auto at = static_cast<Eigen::Index>(v);
    curve.positions.row(at) << rows[v].at(0).get<double>(), rows[v].at(1).get<double>();
  }
  return curve;
}

std::vector<double> listOf(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

Eigen::VectorXd vectorOf(const nlohmann::ordered_json& values) {
  const auto list = values.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

}  // namespace

nlohmann::ordered_json jsonOf(const shapes::HarmonicShape& shape) {
  const shapes::HarmonicAnnulus& a = shape.annulus;
  nlohmann::ordered_json json = {
      {"kind", a.map ? kGiven : (a.dimension == 2 ? kCircular : kSpherical)}};
  if (a.map) {
    json["inner_polygon"] = rowsOf(a.map->inner().positions);
    json["outer_polygon"] = rowsOf(a.map->outer().positions);
  }
  json.update(
      {{"centre", {a.centre.x(), a.centre.y(), a.centre.z()}},
       {"inner_radius", a.innerRadius},
       {"outer_radius", a.outerRadius},
       {"order", a.order},
       {"level", 0.5},
       {"basis", a.dimension == 2
                     ? "1, cos t, sin t, cos 2t, sin 2t, ..."
                     : "real spherical harmonics, mean square 1, index l*l + l + m; m < 0: sine"},
       {"inner", listOf(shape.inner)},
       {"outer", listOf(shape.outer)}});
  return json;
}

shapes::HarmonicShape readCoefficients(const std::filesystem::path& path) {
  try {
    const auto json = provenance::readJson(path);
    shapes::HarmonicShape shape;
    shapes::HarmonicAnnulus& a = shape.annulus;
    a.order = json.at("order");
    if (json.at("kind") == kGiven) {
      a = shapes::givenAnnulus(polygonOf(json.at("inner_polygon")),
                               polygonOf(json.at("outer_polygon")), a.order);
    } else {
      a.dimension = json.at("kind") == kCircular ? 2 : 3;
      const auto centre = json.at("centre").get<std::vector<double>>();
      a.centre = {centre.at(0), centre.at(1), centre.at(2)};
      a.innerRadius = json.at("inner_radius");
      a.outerRadius = json.at("outer_radius");
      shapes::requireUsable(a);
    }
    shape.inner = vectorOf(json.at("inner"));
    shape.outer = vectorOf(json.at("outer"));
    if (shape.inner.size() != a.perBoundary() || shape.outer.size() != a.perBoundary()) {
      throw IOError(path.string() + ": the order asks for " + std::to_string(a.perBoundary()) +
                    " coefficients a boundary, " + std::to_string(shape.inner.size()) + " and " +
                    std::to_string(shape.outer.size()) + " found");
    }
    if (!(shapes::boundaryMargin(shape) > 0)) {
      throw IOError(path.string() + ": boundary values are not on their sides of 1/2");
    }
    return shape;
  } catch (const nlohmann::json::exception& error) {
    throw IOError(path.string() + ": not a file of shape coefficients: " + error.what());
  } catch (const std::out_of_range&) {
    throw IOError(path.string() + ": centre needs three numbers");
  }
}

}  // namespace explica::app
