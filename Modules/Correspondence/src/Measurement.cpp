// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Measurement.h"

#include <utility>

namespace explica::correspondence {

Measurement measure(harmonic::Annulus annulus, const MeasurementOptions& options,
                    const Monitor& monitor, const OnPart& onPart) {
  Measurement m;
  m.annulus = std::move(annulus);
  const auto begin = [&](const char* part) {
    if (onPart) onPart(part, m);
  };
  if (options.sulciMode() == SulciMode::Recover) {
    begin("sulci");
    SulcalRecovery recovered = recoverSulci(std::move(m.annulus), options.sulcus, monitor);
    m.annulus = std::move(recovered.annulus);
    m.sulcalVoxels = std::move(recovered.voxels);
  }
  begin("harmonic");
  m.interpolant = harmonic::solveInterpolant(m.annulus, options.interpolant, monitor);
  begin("correspondence");
  m.correspondence = findCorrespondences(m.annulus, m.interpolant, options.correspondence, monitor);
  if (options.imageEdgeMode() == ImageEdge::Open) {
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
