// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Digests of what two processors must agree on: the C library's functions, and the unfolding of
// polygons, one line each.  Testing/check-arm64.sh compares them.

#include "Explica/Core/PortableMath.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonMeasures.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

using namespace explica;

/// FNV-1a over the bits of numbers.
class Digest {
 public:
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    for (int shift = 0; shift < 64; shift += 8) {
      value_ = (value_ ^ (bits >> shift & 0xff)) * 0x100000001b3;
    }
  }
  void print(const char* name) const {
    std::printf("%s %016llx\n", name, static_cast<unsigned long long>(value_));
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

void printFunction(const char* name, double (*function)(double)) {
  Digest digest;
  for (int i = 1; i < 200000; ++i) digest.add(function(0.4999e-5 * i));
  digest.print(name);
}

void printUnfolding(const char* name, const planar::PolygonPhantom& phantom,
                    planar::PolygonMethod method) {
  planar::PolygonUnfoldingOptions options;
  options.method = method;
  const auto region = planar::regionBetween(phantom.curve, phantom.first, phantom.last);
  const auto result = planar::unfoldPolygon(phantom.curve, region, phantom.viewpoint, options);
  Digest digest;
  for (const double x : result.curve.positions.reshaped()) digest.add(x);
  digest.print(name);
  std::printf("%s-visibility %.9f\n%s-iterations %d\n", name, result.history.back().visibility,
              name, result.history.back().iteration);
}

}  // namespace

int main() {
  printFunction("sin", std::sin);
  printFunction("cos", std::cos);
  printFunction("tan", std::tan);
  printFunction("asin", std::asin);
  printFunction("acos", std::acos);
  printFunction("atan", std::atan);
  printFunction("exp", std::exp);
  printFunction("log", std::log);
  printFunction("log1p", std::log1p);
  printFunction("cbrt", std::cbrt);
  printFunction("sqrt", std::sqrt);
  printFunction("portable-log", portable::log);
  printFunction("portable-exp", portable::exp);
  printFunction("portable-sin", portable::sin);
  printFunction("portable-acos", portable::acos);
  const auto phantom = planar::makePolygon34();
  const auto region = planar::regionBetween(phantom.curve, phantom.first, phantom.last);
  Digest visibility, knot;
  const auto seen = planar::polygonVisibility(phantom.curve, region, phantom.viewpoint);
  for (const double x : seen.gradient.reshaped()) visibility.add(x);
  visibility.print("visibility-gradient");
  const std::vector<bool> moving(phantom.curve.positions.rows(), true);
  const auto energy =
      planar::makePolygonKnotEnergy(planar::PolygonKnot::AllPairs, phantom.curve, moving);
  const auto forces = energy->evaluate(phantom.curve.positions).gradient;
  for (const double x : forces.reshaped()) knot.add(x);
  knot.print("knot-gradient");
  std::printf("knot-gradient-norm %.15g\n", forces.norm());
  Digest hidden;
  hidden.add(planar::selfOcclusion(phantom.curve));
  hidden.print("self-occlusion");
  printUnfolding("polygon19", planar::makePolygon19(), planar::PolygonMethod::Implicit);
  printUnfolding("polygon34", phantom, planar::PolygonMethod::Implicit);
  printUnfolding("polygon34-thesis", phantom, planar::PolygonMethod::Thesis);
}
