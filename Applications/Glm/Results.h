// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Statistics/Inference.h"
#include "Observations.h"

#include <string>
#include <vector>

namespace explica::app {

/// All that was found of the contrasts of one model.
struct GlmResults {
  statistics::Design design;
  std::vector<statistics::Contrast> contrasts;
  statistics::ModelMaps maps;
  std::vector<statistics::Inference> inferences;  ///< as many as contrasts
  std::optional<statistics::Smoothness> smoothness;
  Eigen::MatrixXd values;  ///< N x V, what was fitted; empty if it does not fit into memory
};

/// A model in numbers.
struct GlmSummary {
  std::int64_t people = 0;
  std::optional<std::int64_t> vertices, regions, clusters, shuffles;
  double degreesOfFreedom = kNaN;
  std::optional<double> fwhm;  ///< mm, of the residuals
  std::optional<std::string> exchange;
};

inline void describe(Results& t, const GlmSummary& r) {
  t.count("people", "People", "In the model.", r.people).inHead();
  t.count("vertices", "Vertices", "Places with a model of their own.", r.vertices);
  t.count("regions", "Regions", "Places with a model of their own.", r.regions);
  t.number("df", "Degrees of freedom of the residuals", "", "Where all people have a value.",
           r.degreesOfFreedom)
      .inHead();
  t.number("fwhm", "Smoothness of the residuals", "mm", "Full width at half maximum.", r.fwhm);
  t.count("clusters", "Clusters", "Of all contrasts, beyond --threshold.", r.clusters).inHead();
  t.count("shuffles", "Permutations done", "", r.shuffles);
  t.text("exchange", "Exchanged", "", r.exchange);
}

[[nodiscard]] GlmSummary summaryOf(const GlmSettings& settings, const Observations& observations,
                                   const GlmResults& results);

/// A contrast's name as files have it: letters, digits, '.', '_' and '-'.
[[nodiscard]] std::string fileName(const std::string& contrast);

/// Writes each contrast's maps, hemisphere by hemisphere.
void writeMaps(Context& context, const Observations& observations, const GlmResults& results);

/// A row a cluster.
[[nodiscard]] std::string clusterTable(const Observations& observations, const GlmResults& results);
/// A row a person: the design as it was used.
[[nodiscard]] std::string designTable(const Observations& observations, const GlmResults& results);
/// A row a region and contrast.
[[nodiscard]] std::string regionTable(const Observations& observations, const GlmResults& results);

/// The region of a vertex, "" where there is no atlas, and the hemisphere that it is on.
[[nodiscard]] std::string regionOf(const Observations& observations, Eigen::Index place);
/// A region's name, or a vertex's hemisphere, number and region.
[[nodiscard]] std::string nameOfPlace(const Observations& observations, Eigen::Index place);
[[nodiscard]] const MapSide& hemisphereOf(const Observations& observations, Eigen::Index place);

/// "0.0123", "n/a" of what is not known.
[[nodiscard]] std::string numberText(double value, int digits = 6);

}  // namespace explica::app
