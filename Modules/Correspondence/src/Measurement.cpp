// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Measurement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace explica::correspondence {

double foldingOf(const harmonic::Annulus& annulus) {
  std::vector<double> links(annulus.size[2], 0), voxels(annulus.size[2], 0);
  const std::size_t sliceSize = annulus.strides()[2];
  parallelFor(annulus.size[2], 1, [&](std::size_t k) {
    for (std::size_t p = k * sliceSize; p < (k + 1) * sliceSize; ++p) {
      const std::int32_t n = annulus.numberAt[p];
      voxels[k] += n == harmonic::kInner;
      for (int d = 0; n >= 0 && d < 4; ++d) links[k] += annulus.links[n][d] == harmonic::kInner;
    }
  });
  const Vector& h = annulus.grid.spacing;
  double sum = 0, area = 0;
  for (std::size_t k = 0; k < voxels.size(); ++k) {
    if (voxels[k] == 0) continue;
    // Voxel faces along the axes are 4 / pi times as long as a line of any direction.
    const double perimeter = kPi / 4 * links[k] * std::sqrt(h[0] * h[1]);
    const double here = voxels[k] * h[0] * h[1];
    sum += here * perimeter * perimeter / (4 * kPi * here);
    area += here;
  }
  return area > 0 ? sum / area : 0;
}

namespace {

/// Counts voxels without thickness and says once how many there are, why and where.
void noteGaps(Measurement& m, const Monitor& monitor) {
  const harmonic::Annulus& annulus = m.annulus;
  std::int32_t first = -1;
  std::size_t leaving = 0;
  for (std::size_t n = 0; n < annulus.count(); ++n) {
    if (!std::isnan(m.correspondence.thickness(n))) continue;
    if (!m.nearEdge.empty() && m.nearEdge[n]) {
      ++leaving;
    } else if (m.lost++ == 0) {
      first = static_cast<std::int32_t>(n);
    }
  }
  // Slices on their own always leave out what lies beyond the inner region's ends.
  const std::size_t dropped = annulus.planar ? 0 : annulus.droppedVoxels;
  std::string reasons;
  const auto add = [&](std::size_t voxels, const char* why, const std::string& place) {
    if (voxels > 0) {
      reasons += (reasons.empty() ? ": " : "; ") + std::to_string(voxels) + why + place;
    }
  };
  const auto firstAt = [](const std::array<int, 3>& voxel) {
    return " (the first at voxel " + harmonic::voxelText(voxel) + ")";
  };
  add(dropped, " in pieces that touch only one of the two boundaries",
      firstAt(annulus.firstDropped));
  add(m.lost, " whose trajectory ends before a boundary",
      first < 0 ? "" : firstAt(annulus.voxel(first)));
  add(leaving, " whose trajectory leaves the image", "");
  const std::size_t all = m.lost + leaving + dropped;
  if (!harmonic::isWorthAWarning(all, annulus.count())) return;
  monitor.warn(std::to_string(all) + " voxels of tissue could not be measured" + reasons);
}

}  // namespace

std::vector<int> validOf(const Measurement& m) {
  std::vector<int> valid(m.annulus.count());
  for (std::size_t n = 0; n < valid.size(); ++n) {
    valid[n] = !std::isnan(m.correspondence.thickness(n)) && (m.nearEdge.empty() || !m.nearEdge[n]);
  }
  return valid;
}

Measurement measure(harmonic::Annulus annulus, const MeasurementOptions& options,
                    const Monitor& monitor, const OnPart& onPart) {
  // Before the work, not after it.
  if (options.layers.layers < 1) throw InvalidInput("there must be at least one layer");
  Measurement m;
  const auto begin = [&](const char* part) {
    if (onPart) onPart(part, m);
  };
  const double folding = foldingOf(annulus);
  m.sulciRecovered = options.sulciMode(folding) == SulciMode::Recover;
  static_cast<Ribbon&>(m) = solveRibbon(
      std::move(annulus), m.sulciRecovered ? std::optional(options.sulcus) : std::nullopt,
      options.interpolant, monitor.part(0, 0.7), begin);
  begin("correspondence");
  m.correspondence =
      findCorrespondences(m.annulus, m.interpolant, options.correspondence, monitor.part(0.7, 1));
  if (!options.isWall(folding)) {
    const bool flat = m.annulus.planar || m.annulus.grid.dimension() == 2;
    m.nearEdge = nearImageEdge(m.annulus, {true, true, !flat}, m.correspondence);
  }
  m.cutVoxels =
      static_cast<std::size_t>(std::count(m.nearEdge.begin(), m.nearEdge.end(), std::uint8_t{1}));
  noteGaps(m, monitor);
  begin("layers");
  m.depth = depthOf(m.correspondence);
  m.layers = layersOf(options.layers.layerKind == LayerKind::Depth
                          ? m.depth
                          : volumeDepthOf(m.annulus, m.interpolant, m.correspondence),
                      options.layers.layers);
  if (options.grid) {
    begin("grid");
    m.grid = anatomicalGrid(m.annulus, m.interpolant, *options.grid);
  }
  return m;
}

void describe(Results& t, const Measurement& m) {
  const Correspondence& found = m.correspondence;
  const ThicknessSummary thickness = summaryOf(found);
  const auto grid = [&](auto value) {
    return m.grid ? std::optional<std::int64_t>(value(*m.grid)) : std::nullopt;
  };
  t.count("voxels", "Voxels of tissue", "", m.annulus.count()).inHead();
  t.count("components", "Pieces of tissue", "Connected through voxel faces.", m.annulus.components);
  t.count("direct_contacts", "Contacts of inner and outer region",
          "Voxel faces with no tissue between the two.", m.annulus.directContacts);
  t.count("tissue_ends", "Ends of the tissue",
          "Places wider than it is thick where both touch: a hemisphere's cortex ends once, around "
          "the medial wall.",
          m.annulus.ends);
  t.count("holes", "Holes in the tissue", "Smaller places where both touch.", m.annulus.holes);
  t.count("voxels_left_out", "Voxels of tissue left out", "Pieces that miss one of the boundaries.",
          m.annulus.droppedVoxels);
  t.text("sulci", "Buried sulci", "Whether the outer boundary was put where banks touch.",
         std::string(m.sulciRecovered ? "recover" : "ignore"));
  t.count("sulcal_voxels_recovered", "Voxels beside recovered sulci",
          "Tissue where banks touch, taken for what lies between them.", m.sulcalVoxels.size())
      .inHead();
  t.number("residual", "Relative residual", "", "Of the linear system of the harmonic function.",
           m.interpolant.relativeResidual);
  t.count("iterations", "Iterations", "Of the solver of that system.", m.interpolant.iterations);
  t.share("traced_fraction", "Trajectories followed",
          "The others come from the transport equation.",
          static_cast<double>(found.traced) / (2.0 * static_cast<double>(m.annulus.count())));
  t.count("voxels_without_thickness", "Voxels without thickness",
          "No trajectory through them reaches both boundaries.", m.lost)
      .inHead();
  t.count("voxels_cut_by_image", "Voxels near the image's edge",
          "Their thickness holds if the edge cuts the tissue at a right angle (0 in valid.nii.gz).",
          m.cutVoxels);
  t.number("thickness_mean", "Mean thickness", "mm",
           "Over the area of the middle surface, of columns of voxels. The mean over voxels is "
           "greater: a thick column holds more voxels.",
           thickness.mean)
      .inHead()
      .compared();
  t.number("thickness_mean_columns", "Mean thickness over columns", "mm", "The same number.",
           thickness.mean);
  t.number("thickness_mean_voxels", "Mean thickness over voxels", "mm", "Thick columns count more.",
           thickness.meanOfVoxels);
  t.number("thickness_median", "Median thickness", "mm", "Over voxels.", thickness.median);
  t.number("thickness_p05", "Thickness, 5th percentile", "mm", "Over voxels.", thickness.p05)
      .inHead();
  t.number("thickness_p95", "Thickness, 95th percentile", "mm", "Over voxels.", thickness.p95)
      .inHead();
  t.count("grid_trajectories", "Trajectories of the grid", "",
          grid([](const auto& g) { return g.trajectories; }));
  t.count("grid_cells", "Cells of the grid", "",
          grid([](const auto& g) { return g.cells.rows(); }));
  t.count("grid_trajectories_lost", "Trajectories of the grid that end nowhere", "",
          grid([](const auto& g) { return g.lost; }));
  t.count("grid_cells_degenerate", "Cells of the grid without volume", "",
          grid([](const auto& g) { return g.degenerate; }));
  const Vector& h = m.annulus.grid.spacing;
  const double tissue =
      static_cast<double>(m.annulus.count()) * (m.annulus.planar ? h[0] * h[1] : h.prod());
  t.number("grid_coverage", "Volume of the grid over that of the tissue", "",
           "Cells where thickness could not be measured are missing.",
           m.grid ? std::optional(m.grid->volume / tissue) : std::nullopt);
}

}  // namespace explica::correspondence
