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
  return {
      {"kind", a.dimension == 2 ? kCircular : kSpherical},
      {"centre", {a.centre.x(), a.centre.y(), a.centre.z()}},
      {"inner_radius", a.innerRadius},
      {"outer_radius", a.outerRadius},
      {"order", a.order},
      {"level", 0.5},
      {"basis", a.dimension == 2
                    ? "1, cos t, sin t, cos 2t, sin 2t, ..."
                    : "real spherical harmonics, mean square 1, index l*l + l + m; m < 0: sine"},
      {"inner", listOf(shape.inner)},
      {"outer", listOf(shape.outer)}};
}

shapes::HarmonicShape readCoefficients(const std::filesystem::path& path) {
  try {
    const auto json = provenance::readJson(path);
    shapes::HarmonicShape shape;
    shapes::HarmonicAnnulus& a = shape.annulus;
    a.order = json.at("order");
    const std::string kind = json.at("kind");
    if (kind != kCircular && kind != kSpherical) {
      throw IOError(path.string() + ": kind '" + kind + "' found, " + kCircular + " or " +
                    kSpherical + " needed; fit the target again");
    }
    a.dimension = kind == kCircular ? 2 : 3;
    const auto centre = json.at("centre").get<std::vector<double>>();
    a.centre = {centre.at(0), centre.at(1), centre.at(2)};
    a.innerRadius = json.at("inner_radius");
    a.outerRadius = json.at("outer_radius");
    shapes::requireUsable(a);
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
