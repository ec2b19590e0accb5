// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ResultPage.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Report/Page.h"
#include "Explica/Report/SurfacePicture.h"
#include "PlacePlot.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::app {
namespace {

using report::Colour;

constexpr Colour kNotTested = {0.55F, 0.55F, 0.55F};  // linear light: off the mask
constexpr Colour kBelow = {0.78F, 0.78F, 0.78F};      // below the threshold
constexpr int kMapsAtFullWidth = 3;  // of a page; more are drawn smaller, for as many pixels
constexpr int kFullWidth = 420;      // of a view, pixels

/// All pictures of a page have as many pixels together, whatever the number of contrasts.
report::SurfacePictureOptions sizeOfViews(const GlmResults& r) {
  const double maps = 1 + 3 * static_cast<double>(r.contrasts.size());
  const double share = std::sqrt(std::min(1.0, kMapsAtFullWidth / maps));
  const int width = static_cast<int>(kFullWidth * share);
  return {.width = width, .height = width * 3 / 4};
}

TriangleMesh meshOf(const Observations& o, const MapSide& h) {
  const Faces& all = o.surface->mesh.faces;
  std::vector<std::int32_t> mine;
  for (Eigen::Index f = 0; f < all.rows(); ++f) {
    if (all(f, 0) >= h.first && all(f, 0) < h.first + h.count) {
      mine.push_back(static_cast<std::int32_t>(f));
    }
  }
  return {o.surface->mesh.positions.middleRows(h.first, h.count),
          (all(mine, Eigen::all).array() - static_cast<std::int32_t>(h.first)).matrix()};
}

struct ShownSide {
  const MapSide* hemisphere;
  TriangleMesh mesh, inflated;
};

std::vector<ShownSide> sidesOf(const Observations& o) {
  std::vector<ShownSide> sides;
  if (!o.surface) return sides;
  for (const MapSide& h : o.hemispheres) {
    checkpoint();
    TriangleMesh mesh = meshOf(o, h), inflated = maps::inflated(mesh);
    sides.push_back({&h, std::move(mesh), std::move(inflated)});
  }
  return sides;
}

/// A map of the model as the page shows it: in pictures, and on the hemispheres that turn.
struct ShownMap {
  std::string contrast;  ///< empty of the mean of all people
  std::string title, caption;
  Eigen::VectorXd values;
  report::ColourScale scale;
  double threshold = 0;  ///< smaller values are not shown
};

/// Lateral and medial pictures of each hemisphere.
report::ReportViews viewsOf(const std::vector<ShownSide>& sides, const ShownMap& map,
                            const report::SurfacePictureOptions& size) {
  report::ReportViews views;
  views.title = map.title;
  views.caption = map.caption;
  views.scale = map.scale;
  for (const ShownSide& side : sides) {
    std::vector<Colour> colours;
    for (Eigen::Index v = 0; v < side.hemisphere->count; ++v) {
      const double value = map.values[side.hemisphere->first + v];
      colours.push_back(std::isnan(value)                 ? kNotTested
                        : std::abs(value) < map.threshold ? kBelow
                                                          : map.scale(value));
    }
    const report::SurfaceScene scene(side.inflated);
    const bool right = side.hemisphere->structure == "CortexRight";
    const bool left = side.hemisphere->structure == "CortexLeft";
    const std::string name = right ? "right, " : left ? "left, " : "";
    for (const bool lateral : {true, false}) {
      const auto from = lateral == right ? report::ViewName::Right : report::ViewName::Left;
      views.views.push_back(
          {name + (lateral ? "lateral" : "medial"),
           scene.render(report::cameraFor(side.inflated.positions, from, size.width, size.height),
                        colours, report::Filling::Smooth, size)});
    }
  }
  return views;
}

report::ColourScale symmetric(const Eigen::VectorXd& values, const std::string& title) {
  std::vector<double> sizes;
  for (const double v : values) {
    if (std::isfinite(v)) sizes.push_back(std::abs(v));
  }
  std::sort(sizes.begin(), sizes.end());
  const double most = sizes.empty() ? 1 : std::max(sizes[sizes.size() * 99 / 100], 1e-12);
  return {report::ColourMap::Diverging, -most, most, title, ""};
}

/// The mean of all people, and of each contrast effect and statistic, the latter thresholded, too.
std::vector<ShownMap> mapsOf(const GlmResults& r) {
  // Other columns are centred or zero at the first levels; the mean over people is X's mean row.
  const Eigen::VectorXd mean = (r.design.matrix.colwise().mean() * r.maps.coefficients).transpose();
  std::vector<ShownMap> all = {{"", "Mean of all people",
                                "Fitted at the people's mean covariates. Dark grey: not analysed.",
                                mean, report::scaleFor(mean, "mean", "")}};
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const auto& maps = r.maps.contrasts[k];
    const std::string& name = r.contrasts[k].name;
    const bool t = r.contrasts[k].isT();
    const std::string effect = t ? "effect" : "partial R\u00b2", statistic = t ? "t" : "F";
    const double least = r.inferences[k].threshold;
    all.push_back({name, name + ": " + effect, "Not thresholded.", maps.effect,
                   symmetric(maps.effect, effect)});
    all.push_back({name, name + ": " + statistic, "Not thresholded.", maps.statistic,
                   symmetric(maps.statistic, statistic)});
    all.push_back(all.back());
    all.back().threshold = least;
    all.back().caption = "Where |" + statistic + "| is at least " + numberText(least, 3) +
                         ", the threshold that forms clusters; this alone makes nothing "
                         "significant.";
  }
  return all;
}

void addViews(const std::vector<ShownSide>& sides, const std::vector<ShownMap>& maps,
              const report::SurfacePictureOptions& size, report::ReportContent& page) {
  if (sides.empty()) return;
  for (const ShownMap& map : maps) {
    report::ReportViews views = viewsOf(sides, map, size);
    views.id = map.contrast.empty()
                   ? "mean"
                   : fileName(map.contrast) + "-" + std::to_string(page.views.size());
    page.views.push_back(std::move(views));
  }
}

/// The hemispheres that turn, inflated or as they are, with the maps of all contrasts.
void addMaps(const std::vector<ShownSide>& sides, const std::vector<ShownMap>& maps,
             report::ReportContent& page) {
  for (const ShownSide& side : sides) {
    report::Evolution view = report::evolutionOf({side.mesh});
    view.shapes = {{"inflated", side.inflated.positions}, {"as it is", {}}};
    view.title = side.hemisphere->structure;
    view.scene = "Cortex";
    for (const ShownMap& map : maps) {
      report::ColourScale scale = map.scale;
      if (!map.contrast.empty()) scale.title = map.contrast + ", " + scale.title;
      if (map.threshold > 0) scale.title += " beyond " + numberText(map.threshold, 3);
      const Eigen::VectorXd shown =
          (map.values.array().abs() < map.threshold).select(kNaN, map.values);
      view.maps.push_back({shown.segment(side.hemisphere->first, side.hemisphere->count), scale});
    }
    page.evolutions.push_back(std::move(view));
  }
}

/// Places to name: peaks of the largest clusters, or the regions of the smallest P.
std::vector<Eigen::Index> placesToName(const Observations& o, const GlmResults& r, std::size_t k) {
  std::vector<Eigen::Index> places;
  if (o.surface) {
    for (const auto& c : r.inferences[k].clusters) places.push_back(c.cluster.peak);
  } else {
    for (Eigen::Index v = 0; v < o.places; ++v) {
      if (!std::isnan(r.maps.contrasts[k].p[v])) places.push_back(v);
    }
    std::stable_sort(places.begin(), places.end(), [&](Eigen::Index a, Eigen::Index b) {
      return r.maps.contrasts[k].p[a] < r.maps.contrasts[k].p[b];
    });
  }
  places.resize(std::min<std::size_t>(places.size(), 6));
  return places;
}

std::vector<NamedPlace> namedPlaces(const Observations& o, const GlmResults& r) {
  std::vector<NamedPlace> named;
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    for (const Eigen::Index v : placesToName(o, r, k)) named.push_back({k, v});
  }
  return named;
}

report::ReportTable clustersOf(const Observations& o, const GlmResults& r, std::size_t k) {
  report::ReportTable table{
      "clusters-" + fileName(r.contrasts[k].name),
      r.contrasts[k].name + ": clusters",
      "P is family-wise and two-sided for t: of the peak, the extent and the mass by permutation, "
      "then by random field theory. All are in clusters.tsv.",
      {"place of the peak", "t or F", "effect", "area, mm²", "vertices", "P peak", "P extent",
       "P mass", "P field, peak", "P field, extent"},
      {}};
  for (const auto& c : r.inferences[k].clusters) {
    if (table.rows.size() == 40) break;
    table.rows.push_back(
        {nameOfPlace(o, c.cluster.peak), numberText(c.statistic, 3),
         numberText(r.maps.contrasts[k].effect[c.cluster.peak], 3), numberText(c.cluster.extent, 4),
         std::to_string(c.cluster.vertices.size()), numberText(c.peak, 3), numberText(c.extent, 3),
         numberText(c.mass, 3), numberText(c.fieldPeak, 3), numberText(c.fieldExtent, 3)});
  }
  return table;
}

report::ReportTable regionsOf(const Observations& o, const GlmResults& r, std::size_t k) {
  report::ReportTable table{"regions-" + fileName(r.contrasts[k].name),
                            r.contrasts[k].name + ": regions of the smallest P",
                            "All regions are in regions.tsv.",
                            {"region", "effect", "standard error", "t or F", "P", "q"},
                            {}};
  for (const Eigen::Index v : placesToName(o, r, k)) {
    const auto& m = r.maps.contrasts[k];
    table.rows.push_back({regionOf(o, v), numberText(m.effect[v], 4), numberText(m.error[v], 3),
                          numberText(m.statistic[v], 4), numberText(m.p[v], 3),
                          numberText(r.inferences[k].q[v], 3)});
  }
  return table;
}

void addFindings(const GlmSettings& s, const Observations& o, const GlmResults& r,
                 report::ReportContent& page) {
  page.findings.columns = {""};
  const auto add = [&](const std::string& what, const std::string& unit, const std::string& value,
                       const std::string& meaning) {
    page.findings.rows.push_back({what, unit, {value}, meaning});
  };
  add("People", "", std::to_string(o.people.size()), "With a value in every column of the model.");
  add(o.placeNames.empty() ? "Vertices" : "Regions", "", std::to_string(o.places), "");
  add("Model", "", s.model, "");
  if (r.smoothness) {
    add("Smoothness", "mm", numberText(r.smoothness->fwhm, 3),
        "FWHM of the residuals along the surface, estimated from them.");
  }
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const auto below = (r.inferences[k].q.array() < 0.05).count();
    add(r.contrasts[k].name + ": places of q < 0.05", "", std::to_string(below),
        "False discovery rate over all places of this contrast.");
  }
}

void addFlags(const GlmSettings& s, const Observations& o, const GlmResults& r,
              report::ReportContent& page) {
  const auto say = [&](const std::string& what, const std::string& why) {
    page.flags.push_back({report::FlagLevel::Notice, what, why, {}});
  };
  if (r.contrasts.size() > 1) {
    say("P is corrected within a contrast", "Places are corrected for, the " +
                                                std::to_string(r.contrasts.size()) +
                                                " contrasts are not.");
  }
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    if (!r.inferences[k].interrupted) continue;
    say(r.contrasts[k].name + ": permutations were interrupted",
        std::to_string(r.inferences[k].shuffles) + " of " + std::to_string(s.permutations) +
            " were made; family-wise P by permutation is coarse, or absent.");
  }
  if (s.permutations == 0) {
    say("No permutations were made",
        "Family-wise P is by random field theory, or absent; --permutations 10000 gives it without "
        "its assumptions.");
  }
  if (!o.leftOut.empty()) {
    say(std::to_string(o.leftOut.size()) + " people were left out", joined(o.leftOut));
  }
}

}  // namespace

std::string resultPage(const GlmSettings& settings, const Observations& o, const GlmResults& r) {
  report::ReportContent page;
  page.title = "Group statistics: " + settings.model;
  addFlags(settings, o, r, page);
  addFindings(settings, o, r, page);
  const std::vector<ShownSide> sides = sidesOf(o);
  const std::vector<ShownMap> maps = mapsOf(r);
  addMaps(sides, maps, page);
  addViews(sides, maps, sizeOfViews(r), page);
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    page.tables.push_back(o.surface ? clustersOf(o, r, k) : regionsOf(o, r, k));
  }
  std::string html = report::reportPage(page);
  if (r.values.size() == 0) return html;
  // Beside the surface that turns, which says where it is clicked, or the numbers.
  const std::string ending = "</section>";
  const std::size_t beside =
      html.find(o.surface ? "<section id=\"view3d\"" : "<section id='numbers'");
  return html.insert(html.find(ending, beside) + ending.size(), placePlot(o, r, namedPlaces(o, r)));
}

}  // namespace explica::app
