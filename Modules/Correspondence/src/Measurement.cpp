// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Measurement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <cmath>
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

Measurement measure(harmonic::Annulus annulus, const MeasurementOptions& options,
                    const Monitor& monitor, const OnPart& onPart) {
  // Before the work, not after it.
  if (options.layers.layers < 1) throw InvalidInput("there must be at least one layer");
  Measurement m;
  m.annulus = std::move(annulus);
  const auto begin = [&](const char* part) {
    if (onPart) onPart(part, m);
  };
  const double folding = foldingOf(m.annulus);
  m.sulciRecovered = options.sulciMode(folding) == SulciMode::Recover;
  if (m.sulciRecovered) {
    begin("sulci");
    SulcalRecovery recovered = recoverSulci(std::move(m.annulus), options.sulcus, monitor);
    m.annulus = std::move(recovered.annulus);
    m.sulcalVoxels = std::move(recovered.voxels);
  }
  begin("harmonic");
  m.interpolant = harmonic::solveInterpolant(m.annulus, options.interpolant, monitor);
  begin("correspondence");
  m.correspondence = findCorrespondences(m.annulus, m.interpolant, options.correspondence, monitor);
  if (options.imageEdgeMode(folding) == ImageEdge::Open) {
    const bool flat = m.annulus.planar || m.annulus.grid.dimension() == 2;
    m.cutVoxels = leaveOutCut(m.annulus, {true, true, !flat}, m.correspondence);
  }
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

}  // namespace explica::correspondence
