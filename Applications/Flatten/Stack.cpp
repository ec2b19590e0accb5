// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Stack.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Flattening/FlatGrid.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeSeries.h"

#include <algorithm>
#include <memory>
#include <set>

namespace explica::app {
namespace {

Grid gridOf(const std::string& volume) {
  return io::readGrid(volume, {.frame = 0});
}

const Cortex* pointerTo(const std::optional<Cortex>& cortex) {
  return cortex ? &*cortex : nullptr;
}

std::optional<Cortex> cortexFor(Context& context, const FlattenSettings& s,
                                const Subject& subject) {
  CortexFiles files = s.sheet;
  if (!files.folder && !files.white && !files.pial) return {};
  files.reading = s.reading;
  const std::string& structure = subject.reference.metadata.structure;
  if (files.folder && !files.hemisphere && structure == "CortexLeft") files.hemisphere = "L";
  if (files.folder && !files.hemisphere && structure == "CortexRight") files.hemisphere = "R";
  Cortex cortex = readCortex(context, files);
  requireSameVertices(cortex.white, subject.reference.mesh, "surfaces");
  return cortex;
}

/// How much of the patch lies in a volume.
double shareWithin(const Grid& grid, const Positions& places) {
  Eigen::Index within = 0;
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    const Vector at = grid.toIndex(places.row(p).transpose());
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) inside &= at[axis] >= 0 && at[axis] <= grid.size[axis] - 1;
    within += inside;
  }
  return static_cast<double>(within) /
         static_cast<double>(std::max<Eigen::Index>(places.rows(), 1));
}

void checkPlace(Context& context, const FlattenSettings& s, const std::string& volume,
                const Positions& patch, const std::optional<Cortex>& cortex) {
  const Grid grid = gridOf(volume);
  const auto transform = transformTo(context, grid, s.place, pointerTo(cortex));
  const double share = shareWithin(grid, transform ? (*transform)(patch) : patch);
  if (share == 0) {
    throw InvalidInput("'" + volume +
                       "': no vertex of the patch lies in it; do both lie in the same space? "
                       "(--to-volume, --surface-space and --fs-volume say how)");
  }
  if (share >= 0.5) return;
  context.warn(
      printed("only %.1f %% of the patch lie in '%s'", 100 * share, stemOf(volume).c_str()));
}

/// Places of the tissue in a volume's world; NaN stays NaN.
Volume<Eigen::Vector3f> placesIn(const io::PointTransform& transform,
                                 const Volume<Eigen::Vector3f>& points) {
  std::vector<std::size_t> known;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (points[n].allFinite()) known.push_back(n);
  }
  Positions places(static_cast<Eigen::Index>(known.size()), 3);
  for (std::size_t n = 0; n < known.size(); ++n) {
    places.row(static_cast<Eigen::Index>(n)) = points[known[n]].cast<double>().transpose();
  }
  const Positions moved = transform(places);
  Volume<Eigen::Vector3f> result = points;
  for (std::size_t n = 0; n < known.size(); ++n) {
    result[known[n]] = moved.row(static_cast<Eigen::Index>(n)).transpose().cast<float>();
  }
  return result;
}

/// Every frame of a volume on the grid's points.
std::vector<VolumeOnDemand<float>> framesOnGrid(const std::string& path,
                                                const Volume<Eigen::Vector3f>& points,
                                                bool nearest) {
  std::vector<VolumeOnDemand<float>> frames;
  io::VolumeSeries series(path);
  Volume<float> one(series.grid());
  for (one.data = series.next(1); !one.data.empty(); one.data = series.next(1)) {
    auto values = std::make_shared<Volume<float>>(flattening::resampled(one, points, nearest));
    VolumeOnDemand<float> frame;
    frame.grid = values->grid;
    frame.end = values->size();
    frame.fill = [values](std::size_t first, std::size_t many, float* to) {
      std::copy_n(values->data.begin() + static_cast<std::ptrdiff_t>(first), many, to);
    };
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace

std::optional<Cortex> checkBeside(Context& context, const FlattenSettings& s,
                                  const Subject& subject) {
  const Eigen::Index vertices = subject.reference.mesh.vertexCount();
  for (const std::string& file : s.maps) static_cast<void>(io::readVertexMaps(file, vertices));
  static_cast<void>(io::readRegions({s.regions.begin(), s.regions.end()}, vertices));
  std::optional<Cortex> cortex = cortexFor(context, s, subject);
  if (s.volumes.empty()) {
    if (s.place.file) throw UsageError("--to-volume is for --volumes: leave it out, or add that");
    return cortex;
  }
  std::set<std::int32_t> corners;
  for (const std::int32_t f : subject.faces) {
    for (int k = 0; k < 3; ++k) corners.insert(subject.reference.mesh.faces(f, k));
  }
  const std::vector<std::int32_t> used(corners.begin(), corners.end());
  const Positions patch =
      cortex ? (0.5 * (cortex->white.positions + cortex->pial.positions))(used, Eigen::all).eval()
             : subject.reference.mesh.positions(used, Eigen::all).eval();
  for (const std::string& file : s.volumes) checkPlace(context, s, file, patch, cortex);
  return cortex;
}

void writeGrid(Context& context, const FlattenSettings& s, const std::optional<Cortex>& cortex,
               const flattening::Disc& disc, const TriangleMesh& flat) {
  flattening::FlatSheet sheet{flat.faces, flat.positions, disc.mesh.positions, disc.mesh.positions};
  if (cortex) {
    sheet.inner = cortex->white.positions(disc.vertexOrigin, Eigen::all);
    sheet.outer = cortex->pial.positions(disc.vertexOrigin, Eigen::all);
  }
  flattening::FlatGridOptions options{.cell = s.grid, .depths = s.depths.value_or(cortex ? 5 : 1)};
  const auto points = flattening::flatGrid(sheet, options);
  io::writeVolume(context.output("grid.nii.gz"), points);
  for (const std::string& path : s.volumes) {
    const auto transform = transformTo(context, gridOf(path), s.place, pointerTo(cortex));
    const auto frames =
        framesOnGrid(path, transform ? placesIn(*transform, points) : points, s.nearest);
    const auto out = context.output("flat_" + stemOf(path) + ".nii.gz");
    if (frames.size() == 1) {
      io::writeVolume(out, frames.front());
    } else {
      io::writeFrames(out, frames);
    }
  }
  if (!cortex || s.volumes.empty()) return;
  const Grid grid = gridOf(s.volumes.front());
  if (const auto transform = transformTo(context, grid, s.place, pointerTo(cortex))) {
    sheet.inner = (*transform)(sheet.inner);
    sheet.outer = (*transform)(sheet.outer);
  }
  io::writeVolume(context.output("to_flat.nii.gz"), flattening::flatCoordinates(sheet, grid));
}

}  // namespace explica::app
