// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Results.h"

#include "Explica/IO/VertexDataFile.h"

#include "Explica/Core/Text.h"

#include <cctype>
#include <cmath>

namespace explica::app {
namespace {

using statistics::ContrastMaps;
using statistics::Inference;

constexpr double kConfidence = 0.95;

void writeMap(Context& context, const Observations& o, const std::string& name,
              const std::string& kind, const Eigen::VectorXd& values) {
  for (const MapSide& side : o.hemispheres) {
    io::GiftiMapsWriter writer(context.output(side.prefix + name + "_" + kind + ".shape.gii"),
                               side.structure, 1);
    const Eigen::VectorXf part = values.segment(side.first, side.count).cast<float>();
    writer.add(kind, "", {part.data(), static_cast<std::size_t>(part.size())});
    writer.finish();
  }
}

std::string row(const std::vector<std::string>& cells) {
  return joined(cells, "\t") + "\n";
}

double at(const Eigen::VectorXd& values, Eigen::Index v) {
  return v < values.size() ? values[v] : std::nan("");
}

}  // namespace

std::string numberText(double value, int digits) {
  if (!std::isfinite(value)) return "n/a";
  return printed("%.*g", digits, value);
}

std::string fileName(const std::string& contrast) {
  std::string name;
  for (const char c : contrast) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
    if (plain)
      name += c;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (name.ends_with('-')) name.pop_back();
  return name.empty() ? "contrast" : name;
}

const MapSide& hemisphereOf(const Observations& o, Eigen::Index place) {
  std::size_t h = 0;
  while (place >= o.hemispheres[h].first + o.hemispheres[h].count) ++h;
  return o.hemispheres[h];
}

std::string regionOf(const Observations& o, Eigen::Index place) {
  if (!o.placeNames.empty()) return o.placeNames[place];
  const MapSide& side = hemisphereOf(o, place);
  return side.regions.empty() ? "" : side.regions[place - side.first];
}

void writeMaps(Context& context, const Observations& o, const GlmResults& r) {
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const ContrastMaps& maps = r.maps.contrasts[k];
    const Inference& found = r.inferences[k];
    const bool t = r.contrasts[k].isT();
    std::vector<std::pair<const char*, Eigen::VectorXd>> all = {
        {"effect", maps.effect},  {t ? "t" : "f", maps.statistic}, {"p", maps.p},
        {"q", found.q},           {"p_field", found.field},        {"p_fwe", found.familyWise},
        {"tfce", found.enhanced}, {"tfce_p_fwe", found.enhancedP}};
    if (t) {
      all.emplace_back("ci95", statistics::confidenceHalfWidth(maps, kConfidence));
      all.emplace_back("d", statistics::standardisedEffect(maps, r.maps.variance));
      all.emplace_back("partial_r", statistics::partialCorrelation(maps));
    }
    for (const auto& [kind, values] : all) {
      if (values.size() > 0) writeMap(context, o, fileName(r.contrasts[k].name), kind, values);
    }
  }
}

std::string clusterTable(const Observations& o, const GlmResults& r) {
  std::string text =
      row({"contrast", "hemisphere", "sign", "vertices", "area_mm2", "mass", "peak_vertex", "x",
           "y", "z", "region", "statistic", "effect", "p_fwe_peak", "p_fwe_extent", "p_fwe_mass",
           "p_field_peak", "p_field_extent"});
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    for (const auto& c : r.inferences[k].clusters) {
      const Eigen::Index peak = c.cluster.peak;
      const MapSide& side = hemisphereOf(o, peak);
      const Eigen::Vector3d place = o.surface->mesh.positions.row(peak);
      text += row({r.contrasts[k].name, side.structure, c.negative ? "-" : "+",
                   std::to_string(c.cluster.vertices.size()), numberText(c.cluster.extent),
                   numberText(c.cluster.mass), std::to_string(peak - side.first),
                   numberText(place[0], 5), numberText(place[1], 5), numberText(place[2], 5),
                   regionOf(o, peak).empty() ? "n/a" : regionOf(o, peak), numberText(c.statistic),
                   numberText(r.maps.contrasts[k].effect[peak]), numberText(c.peak),
                   numberText(c.extent), numberText(c.mass), numberText(c.fieldPeak),
                   numberText(c.fieldExtent)});
    }
  }
  return text;
}

std::string designTable(const Observations& o, const GlmResults& r) {
  std::vector<std::string> head = {"participant_id"};
  head.insert(head.end(), r.design.columns.begin(), r.design.columns.end());
  if (!r.design.groups.empty()) head.emplace_back("random_intercept");
  std::string text = row(head);
  for (std::size_t i = 0; i < o.people.size(); ++i) {
    std::vector<std::string> cells = {o.people[i]};
    for (const double value : r.design.matrix.row(i)) {
      cells.push_back(numberText(value, 9));
    }
    if (!r.design.groups.empty()) {
      cells.push_back(r.design.groupNames[r.design.groups[i]]);
    }
    text += row(cells);
  }
  return text;
}

std::string regionTable(const Observations& o, const GlmResults& r) {
  std::string text = row({"region", "contrast", "people", "effect", "low95", "high95", "statistic",
                          "df", "p", "q", "p_fwe", "d", "partial_r"});
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const ContrastMaps& maps = r.maps.contrasts[k];
    const Eigen::VectorXd width = statistics::confidenceHalfWidth(maps, kConfidence),
                          d = statistics::standardisedEffect(maps, r.maps.variance),
                          correlation = statistics::partialCorrelation(maps);
    const bool t = r.contrasts[k].isT();
    for (Eigen::Index v = 0; v < o.places; ++v) {
      text += row({o.placeNames[v], r.contrasts[k].name, std::to_string(r.maps.people[v]),
                   numberText(maps.effect[v]), numberText(maps.effect[v] - width[v]),
                   numberText(maps.effect[v] + width[v]), numberText(maps.statistic[v]),
                   numberText(maps.df[v]), numberText(maps.p[v]), numberText(r.inferences[k].q[v]),
                   numberText(at(r.inferences[k].familyWise, v)), t ? numberText(d[v]) : "n/a",
                   t ? numberText(correlation[v]) : "n/a"});
    }
  }
  return text;
}

std::string nameOfPlace(const Observations& o, Eigen::Index v) {
  const std::string region = regionOf(o, v);
  if (!o.placeNames.empty()) return region;
  const MapSide& side = hemisphereOf(o, v);
  return side.structure + " " + std::to_string(v - side.first) +
         (region.empty() ? "" : " (" + region + ")");
}

GlmSummary summaryOf(const GlmSettings& s, const Observations& o, const GlmResults& results) {
  GlmSummary summary;
  summary.people = static_cast<std::int64_t>(o.people.size());
  (o.placeNames.empty() ? summary.vertices : summary.regions) = o.places;
  summary.degreesOfFreedom =
      static_cast<double>(results.design.matrix.rows() - results.design.matrix.cols());
  if (results.smoothness) summary.fwhm = results.smoothness->fwhm;
  if (o.surface) {
    summary.clusters = 0;
    for (const auto& inference : results.inferences) {
      *summary.clusters += static_cast<std::int64_t>(inference.clusters.size());
    }
  }
  if (s.permutations > 0) {
    summary.shuffles = static_cast<std::int64_t>(results.inferences.front().shuffles);
    summary.exchange = std::string(nameOf(results.inferences.front().exchange));
  }
  return summary;
}

}  // namespace explica::app
