// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ResultPage.h"

#include "Explica/Core/Html.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Report/Page.h"
#include "Explica/Report/SurfacePicture.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace explica::app {
namespace {

using report::Colour;

constexpr Colour kNotTested = {0.55F, 0.55F, 0.55F};  // linear light: off the mask
constexpr Colour kBelow = {0.78F, 0.78F, 0.78F};      // below the threshold
constexpr int kMapsAtFullWidth = 4;    // of a page; more are drawn smaller, for as many pixels
constexpr int kFullWidth = 420;        // of a view, pixels
constexpr std::size_t kPoints = 6000;  // people in all plots of a contrast
constexpr std::size_t kPlots = 6;      // peaks of a contrast that are plotted

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

struct Side {
  const Hemisphere* hemisphere;
  TriangleMesh mesh;
};

std::vector<Side> sidesOf(const Observations& o) {
  std::vector<Side> sides;
  for (const Hemisphere& h : o.hemispheres) {
    Side side{&h, {o.surface->mesh.positions.middleRows(h.first, h.count), {}}};
    const Faces& all = o.surface->mesh.faces;
    std::vector<std::int32_t> mine;
    for (Eigen::Index f = 0; f < all.rows(); ++f) {
      if (all(f, 0) >= h.first && all(f, 0) < h.first + h.count) {
        mine.push_back(static_cast<std::int32_t>(f));
      }
    }
    side.mesh.faces = (all(mine, Eigen::all).array() - static_cast<std::int32_t>(h.first)).matrix();
    sides.push_back(std::move(side));
  }
  return sides;
}

/// Lateral and medial pictures of each hemisphere.
report::ReportViews viewsOf(const std::vector<Side>& sides, const Eigen::VectorXd& values,
                            const report::ColourScale& scale, double threshold, Size pixels) {
  report::ReportViews views;
  views.scale = scale;
  report::SurfacePictureOptions size;
  size.width = pixels.width;
  size.height = pixels.height;
  for (const Side& side : sides) {
    std::vector<Colour> colours;
    for (Eigen::Index v = 0; v < side.hemisphere->count; ++v) {
      const double value = values[side.hemisphere->first + v];
      colours.push_back(std::isnan(value)             ? kNotTested
                        : std::abs(value) < threshold ? kBelow
                                                      : scale(value));
    }
    const report::SurfaceScene scene(side.mesh);
    const bool right = side.hemisphere->structure == "CortexRight";
    const std::string name = right                                        ? "right"
                             : side.hemisphere->structure == "CortexLeft" ? "left"
                                                                          : "";
    for (const bool lateral : {true, false}) {
      const auto from = lateral == right ? report::ViewName::Right : report::ViewName::Left;
      views.views.push_back(
          {name + (name.empty() ? "" : ", ") + (lateral ? "lateral" : "medial"),
           scene.render(report::cameraFor(side.mesh, from, pixels.width, pixels.height), colours,
                        report::Filling::Smooth, size)});
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

void addViews(const Observations& o, const GlmResults& r, report::ReportContent& page) {
  if (!o.surface) return;
  const auto sides = sidesOf(o);
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

/// A surface that turns, with the maps of all contrasts.
void addTurnable(const Observations& o, const GlmResults& r, report::ReportContent& page) {
  if (!o.surface) return;
  for (const Side& side : sidesOf(o)) {
    report::Evolution view = report::evolutionOf({side.mesh});
    view.title = side.hemisphere->structure;
    const auto part = [&](const Eigen::VectorXd& values) {
      return Eigen::VectorXd(values.segment(side.hemisphere->first, side.hemisphere->count));
    };
    const Eigen::VectorXd mean = meanOf(r);
    view.maps.push_back({part(mean), report::scaleFor(mean, "mean", "")});
    for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
      const auto& maps = r.maps.contrasts[k];
      view.maps.push_back({part(maps.statistic),
                           symmetric(maps.statistic, r.contrasts[k].name +
                                                         (r.contrasts[k].isT() ? ", t" : ", F"))});
    }
    page.evolutions.push_back(std::move(view));
  }
}

/// What stands on a plot's horizontal axis: the first column of the contrast's terms.
struct Axis {
  std::string name;
  std::vector<double> x;
  std::vector<std::string> levels;  ///< of a categorical column
};

Axis axisOf(const Observations& o, const GlmResults& r, const statistics::Contrast& contrast) {
  const statistics::Factor* factor = nullptr;
  for (std::size_t c = 0; c < r.design.columns.size(); ++c) {
    if (contrast.weights.row(static_cast<Eigen::Index>(c)).isZero()) continue;
    for (const std::string& name : r.design.terms[static_cast<std::size_t>(r.design.termOf[c])]) {
      for (const auto& f : r.design.factors) {
        if (f.name == name && (factor == nullptr || f.levels.empty())) factor = &f;
      }
    }
  }
  Axis axis;
  if (factor == nullptr) {
    axis.name = "people";
    for (std::size_t i = 0; i < o.people.size(); ++i) axis.x.push_back(static_cast<double>(i));
    return axis;
  }
  axis.name = factor->name;
  axis.levels = factor->levels;
  for (const auto& row : o.about.rows) {
    const std::string& cell = row[o.about.at(factor->name)];
    if (factor->levels.empty()) {
      axis.x.push_back(statistics::numberIn(cell).value_or(std::nan("")));
    } else {
      const auto level = std::find(factor->levels.begin(), factor->levels.end(), cell);
      axis.x.push_back(static_cast<double>(level - factor->levels.begin()));
    }
  }
  return axis;
}

/// Each person at one place, as an SVG element; a point says who it is.
std::string scatterSvg(const Observations& o, const Axis& axis, const Eigen::VectorXd& y,
                       const std::string& title) {
  constexpr double kPlotWidth = 420, kPlotHeight = 260, kLeft = 56, kBottom = 42, kTop = 26;
  double x0 = *std::min_element(axis.x.begin(), axis.x.end()),
         x1 = *std::max_element(axis.x.begin(), axis.x.end());
  double y0 = std::nan(""), y1 = std::nan("");
  for (const double v : y) {
    y0 = std::fmin(y0, v);
    y1 = std::fmax(y1, v);
  }
  const double margin = axis.levels.empty() ? (x1 - x0) * 0.03 : 0.5;
  x0 -= margin;
  x1 += margin;
  const auto px = [&](double x) {
    return kLeft + (x - x0) / (x1 - x0) * (kPlotWidth - kLeft - 10);
  };
  const auto py = [&](double v) {
    return kPlotHeight - kBottom -
           (v - y0) / std::max(y1 - y0, 1e-12) * (kPlotHeight - kBottom - kTop);
  };
  std::string svg = "<svg viewBox='0 0 420 260' role='img' aria-label='" + escapeHtml(title) +
                    "' xmlns='http://www.w3.org/2000/svg' font-family='sans-serif' font-size='12'>"
                    "<text x='10' y='16' font-weight='600'>" +
                    escapeHtml(title) + "</text>";
  const auto label = [&](double x, double yy, const std::string& text, const char* anchor) {
    svg += "<text x='" + numberText(x, 5) + "' y='" + numberText(yy, 5) + "' text-anchor='" +
           anchor + "'>" + escapeHtml(text) + "</text>";
  };
  label(kLeft - 6, py(y0) + 4, numberText(y0, 3), "end");
  label(kLeft - 6, py(y1) + 4, numberText(y1, 3), "end");
  if (axis.levels.empty()) {
    label(px(x0 + margin), kPlotHeight - kBottom + 16, numberText(x0 + margin, 4), "middle");
    label(px(x1 - margin), kPlotHeight - kBottom + 16, numberText(x1 - margin, 4), "middle");
  }
  for (std::size_t l = 0; l < axis.levels.size(); ++l) {
    label(px(static_cast<double>(l)), kPlotHeight - kBottom + 16, axis.levels[l], "middle");
  }
  label(kPlotWidth / 2 + kLeft / 2, kPlotHeight - 8, axis.name, "middle");
  svg += "<path d='M56 26V218H410' fill='none' stroke='#888'/>";
  for (std::size_t i = 0; i < o.people.size(); ++i) {
    const double value = y[static_cast<Eigen::Index>(i)];
    if (!std::isfinite(value) || !std::isfinite(axis.x[i])) continue;
    // Of a level, people are spread in the order of the table.
    const double aside =
        axis.levels.empty() ? 0 : (static_cast<double>(i * 37 % 61) / 61 - 0.5) * 0.5;
    svg += "<circle cx='" + numberText(px(axis.x[i] + aside), 5) + "' cy='" +
           numberText(py(value), 5) + "' r='2.6' fill='#145ab4' fill-opacity='0.6'><title>" +
           escapeHtml(o.people[i]) + ": " + numberText(value, 4) + "</title></circle>";
  }
  return svg + "</svg>";
}

/// Places to plot: peaks of the largest clusters, or the regions of the smallest P.
std::vector<Eigen::Index> placesToPlot(const Observations& o, const GlmResults& r, std::size_t k) {
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
  const std::size_t most = std::clamp<std::size_t>(kPoints / o.people.size(), 1, kPlots);
  places.resize(std::min(places.size(), most));
  return places;
}

std::string nameOfPlace(const Observations& o, Eigen::Index v) {
  const std::string region = regionOf(o, v);
  if (!o.placeNames.empty()) return region;
  const Hemisphere& side = hemisphereOf(o, v);
  return side.structure + " " + std::to_string(v - side.first) +
         (region.empty() ? "" : " (" + region + ")");
}

void addPlots(const Observations& o, const GlmResults& r, const Eigen::MatrixXd* values,
              report::ReportContent& page) {
  if (values == nullptr) return;
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    const Axis axis = axisOf(o, r, r.contrasts[k]);
    for (const Eigen::Index v : placesToPlot(o, r, k)) {
      page.charts.push_back({fileName(r.contrasts[k].name) + "-at-" + std::to_string(v),
                             scatterSvg(o, axis, values->col(v), nameOfPlace(o, v)),
                             r.contrasts[k].name + ": each person at the peaks"});
    }
  }
}

report::ReportTable clustersOf(const Observations& o, const GlmResults& r, std::size_t k) {
  report::ReportTable table;
  table.id = "clusters-" + fileName(r.contrasts[k].name);
  table.title = r.contrasts[k].name + ": clusters";
  table.caption =
      "P is family-wise and two-sided for t: of the peak, the extent and the mass by "
      "permutation, then by random field theory. All are in clusters.tsv.";
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
  auto places = placesToPlot(o, r, k);
  for (const Eigen::Index v : places) {
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
    std::string names;
    for (const std::string& person : o.leftOut) names += (names.empty() ? "" : ", ") + person;
    say(std::to_string(o.leftOut.size()) + " people were left out", names);
  }
}

}  // namespace

std::string resultPage(const GlmSettings& settings, const Observations& o, const GlmResults& r,
                       const Eigen::MatrixXd* values) {
  report::ReportContent page;
  page.title = "Group statistics: " + settings.model;
  addFlags(settings, o, r, page);
  addFindings(settings, o, r, page);
  addTurnable(o, r, page);
  addViews(o, r, page);
  addPlots(o, r, values, page);
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    page.tables.push_back(o.surface ? clustersOf(o, r, k) : regionsOf(o, r, k));
  }
  return report::reportPage(page);
}

}  // namespace explica::app
