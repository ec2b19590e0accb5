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

struct Size {
  int width, height;
};

/// Of a view: all pictures of a page have as many pixels together, whatever the number of
/// contrasts.
Size sizeOfViews(const GlmResults& r) {
  const double maps = 1 + 3 * static_cast<double>(r.contrasts.size());
  const double share = std::sqrt(std::min(1.0, kMapsAtFullWidth / maps));
  const int width = static_cast<int>(kFullWidth * share);
  return {width, width * 3 / 4};
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

/// Lateral and medial pictures of each hemisphere.
report::ReportViews viewsOf(const std::vector<ShownSide>& sides, const Eigen::VectorXd& values,
                            const report::ColourScale& scale, double threshold, Size pixels) {
  report::ReportViews views;
  views.scale = scale;
  report::SurfacePictureOptions size{.width = pixels.width, .height = pixels.height};
  for (const ShownSide& side : sides) {
    std::vector<Colour> colours;
    for (Eigen::Index v = 0; v < side.hemisphere->count; ++v) {
      const double value = values[side.hemisphere->first + v];
      colours.push_back(std::isnan(value)             ? kNotTested
                        : std::abs(value) < threshold ? kBelow
                                                      : scale(value));
    }
    const report::SurfaceScene scene(side.inflated);
    const bool right = side.hemisphere->structure == "CortexRight";
    const std::string name = right                                        ? "right"
                             : side.hemisphere->structure == "CortexLeft" ? "left"
                                                                          : "";
    for (const bool lateral : {true, false}) {
      const auto from = lateral == right ? report::ViewName::Right : report::ViewName::Left;
      views.views.push_back({name + (name.empty() ? "" : ", ") + (lateral ? "lateral" : "medial"),
                             scene.render(report::cameraFor(side.inflated.positions, from,
                                                            pixels.width, pixels.height),
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

Eigen::VectorXd meanOf(const GlmResults& r) {
  // Other columns are centred or zero at the first levels; the mean over people is X's mean row.
  return (r.design.matrix.colwise().mean() * r.maps.coefficients).transpose();
}

void addViews(const std::vector<ShownSide>& sides, const GlmResults& r,
              report::ReportContent& page) {
  if (sides.empty()) return;
  const Size size = sizeOfViews(r);
  const Eigen::VectorXd mean = meanOf(r);
  auto views = viewsOf(sides, mean, report::scaleFor(mean, "mean", ""), 0, size);
  views.id = "mean";
  views.title = "Mean of all people";
  views.caption = "Fitted at the people's mean covariates. Dark grey: not analysed.";
  page.views.push_back(std::move(views));
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const auto& maps = r.maps.contrasts[k];
    const std::string& name = r.contrasts[k].name;
    const bool t = r.contrasts[k].isT();
    const auto add = [&](const std::string& what, const Eigen::VectorXd& values, double threshold,
                         const std::string& caption) {
      auto shown = viewsOf(sides, values, symmetric(values, what), threshold, size);
      shown.id = fileName(name) + "-" + std::to_string(page.views.size());
      shown.title = name + ": " + what;
      shown.caption = caption;
      page.views.push_back(std::move(shown));
    };
    add(t ? "effect" : "partial R\u00b2", maps.effect, 0, "Not thresholded.");
    add(t ? "t" : "F", maps.statistic, 0, "Not thresholded.");
    add(t ? "t" : "F", maps.statistic, r.inferences[k].threshold,
        "Where |" + std::string(t ? "t" : "F") + "| is at least " +
            numberText(r.inferences[k].threshold, 3) +
            ", the threshold that forms clusters; this alone makes nothing significant.");
  }
}

/// The hemispheres that turn, inflated or as they are, with the maps of all contrasts.
void addMaps(const std::vector<ShownSide>& sides, const GlmResults& r,
             report::ReportContent& page) {
  for (const ShownSide& side : sides) {
    report::Evolution view = report::evolutionOf({side.mesh});
    view.shapes = {{"inflated", side.inflated.positions}, {"as it is", {}}};
    view.title = side.hemisphere->structure;
    view.scene = "Cortex";
    const auto add = [&](const Eigen::VectorXd& values, const report::ColourScale& scale) {
      view.maps.push_back({values.segment(side.hemisphere->first, side.hemisphere->count), scale});
    };
    const Eigen::VectorXd mean = meanOf(r);
    add(mean, report::scaleFor(mean, "mean", ""));
    for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
      const auto& maps = r.maps.contrasts[k];
      const bool t = r.contrasts[k].isT();
      const std::string name = r.contrasts[k].name + ", ", statistic = name + (t ? "t" : "F");
      const double least = r.inferences[k].threshold;  // that forms clusters
      const auto scale = symmetric(maps.statistic, statistic);
      add(maps.effect, symmetric(maps.effect, name + (t ? "effect" : "partial R\u00b2")));
      add(maps.statistic, scale);
      auto beyond = scale;
      beyond.title = statistic + " beyond " + numberText(least, 3);
      add((maps.statistic.array().abs() < least).select(kNaN, maps.statistic), beyond);
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
  report::ReportTable table;
  table.id = "clusters-" + fileName(r.contrasts[k].name);
  table.title = r.contrasts[k].name + ": clusters";
  table.caption =
      "P is family-wise and two-sided for t: of the peak, the extent and the mass by permutation, "
      "then by random field theory. All are in clusters.tsv.";
  table.columns = {"place of the peak", "t or F",         "effect",   "area, mm²",
                   "vertices",          "P peak",         "P extent", "P mass",
                   "P field, peak",     "P field, extent"};
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
  report::ReportTable table;
  table.id = "regions-" + fileName(r.contrasts[k].name);
  table.title = r.contrasts[k].name + ": regions of the smallest P";
  table.caption = "All regions are in regions.tsv.";
  table.columns = {"region", "effect", "standard error", "t or F", "P", "q"};
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
    const auto& found = r.inferences[k];
    const auto below = (found.q.array() < 0.05).count();
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

std::string resultPage(const GlmSettings& settings, const Observations& o, const GlmResults& r,
                       const Eigen::MatrixXd* values) {
  report::ReportContent page;
  page.title = "Group statistics: " + settings.model;
  addFlags(settings, o, r, page);
  addFindings(settings, o, r, page);
  const std::vector<ShownSide> sides = sidesOf(o);
  addMaps(sides, r, page);
  addViews(sides, r, page);
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    page.tables.push_back(o.surface ? clustersOf(o, r, k) : regionsOf(o, r, k));
  }
  std::string html = report::reportPage(page);
  if (values == nullptr) return html;
  // Beside the surface that turns, which says where it is clicked, or the numbers.
  const std::string ending = "</section>";
  const std::size_t beside =
      html.find(o.surface ? "<section id=\"view3d\"" : "<section id='numbers'");
  return html.insert(html.find(ending, beside) + ending.size(),
                     placePlot(o, r, *values, namedPlaces(o, r)));
}

}  // namespace explica::app
