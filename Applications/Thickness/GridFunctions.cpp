// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GridFunctions.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/VolumeSeries.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Sampling/Sampler.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace explica::app {
namespace {

using correspondence::AnatomicalGrid;

/// Points of a trajectory, one a depth.
Eigen::Index rowsOf(const AnatomicalGrid& grid) {
  return grid.points.rows() / static_cast<Eigen::Index>(grid.trajectories);
}

/// Trajectories that carry cells: those that reach both boundaries.
std::vector<bool> wholeTrajectories(const AnatomicalGrid& grid) {
  std::vector<bool> whole(grid.trajectories, false);
  const Eigen::Index rows = rowsOf(grid);
  for (Eigen::Index c = 0; c < grid.cells.size(); ++c) {
    whole[static_cast<std::size_t>(grid.cells.data()[c] / rows)] = true;
  }
  return whole;
}

/// A file's name without its folder and endings.
std::string stemOf(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.substr(0, name.find('.'));
}

Eigen::VectorXd sampledAt(const sampling::Sampler& sampler, const std::vector<float>& frame) {
  const std::vector<float> values = sampler.sample(frame);
  return Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Eigen::Index>(values.size()))
      .cast<double>();
}

std::string number(double value) {
  if (!std::isfinite(value)) return "n/a";
  char text[48];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

/// The trajectory whose points come nearest to a place.
Eigen::Index nearestTrajectory(const AnatomicalGrid& grid, const Eigen::Vector3d& place) {
  const std::vector<bool> whole = wholeTrajectories(grid);
  const Eigen::Index rows = rowsOf(grid);
  Eigen::Index nearest = -1;
  double least = kInfinity;
  for (Eigen::Index p = 0; p < grid.points.rows(); ++p) {
    if (!whole[static_cast<std::size_t>(p / rows)]) continue;
    const double distance = (grid.points.row(p).transpose() - place).norm();
    if (distance < least) least = distance, nearest = p;
  }
  if (nearest < 0 || least > grid.thickness[nearest]) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "along: (%g, %g, %g) is %.1f mm from the nearest trajectory; give a point in the "
                  "tissue, RAS mm",
                  place[0], place[1], place[2], least);
    throw InvalidInput(text);
  }
  return nearest / rows;
}

/// Values of every frame of the volumes at the grid's points, NaN where a volume is not known.
std::vector<io::VertexMap> functionsOnGrid(Context& context, const GridFunctions& functions,
                                           const io::VolumeReadOptions& reading,
                                           const AnatomicalGrid& grid) {
  std::vector<io::VertexMap> maps;
  for (const std::string& path : functions.volumes) {
    io::VolumeReadOptions options = reading;
    options.frame.reset();
    io::VolumeSeries series(path, options);
    context.note("functions " + path, nlohmann::ordered_json{{"frames", series.frames()}});
    const sampling::Sampler sampler(series.grid(), grid.points);
    for (int f = 0; f < series.frames(); ++f) {
      std::string name = stemOf(path);
      if (series.frames() > 1) name += "_frame-" + std::to_string(f);
      maps.push_back({name, "", sampledAt(sampler, series.next(1))});
      if (maps.back().values.array().isNaN().all()) {
        throw InvalidInput("'" + path + "' is known nowhere in the tissue: check its placement");
      }
    }
  }
  return maps;
}

/// Mean, deviation and count of each function at each depth, over whole trajectories.
std::string depthTable(const std::vector<io::VertexMap>& functions, const AnatomicalGrid& grid) {
  const std::vector<bool> whole = wholeTrajectories(grid);
  const Eigen::Index rows = rowsOf(grid);
  std::string text = "function\tdepth\tmean\tsd\tn\n";
  for (const io::VertexMap& function : functions) {
    for (Eigen::Index row = 0; row < rows; ++row) {
      double sum = 0, squares = 0, count = 0;
      for (Eigen::Index t = 0; t < static_cast<Eigen::Index>(grid.trajectories); ++t) {
        const double value = function.values[t * rows + row];
        if (!whole[static_cast<std::size_t>(t)] || std::isnan(value)) continue;
        sum += value, squares += value * value, count += 1;
      }
      const double mean = sum / count;
      const double spread = std::sqrt(std::max(0.0, squares / count - mean * mean));
      text += function.name + '\t' + number(grid.depth[row]) + '\t' + number(mean) + '\t' +
              number(spread) + '\t' + std::to_string(static_cast<long>(count)) + '\n';
    }
  }
  return text;
}

/// The functions along the trajectories nearest to points, from the inner to the outer boundary.
std::string trajectoryTable(const std::vector<io::VertexMap>& functions, const AnatomicalGrid& grid,
                            const std::vector<Eigen::Vector3d>& along) {
  std::string text = "trajectory\tdepth\tx\ty\tz\tthickness";
  for (const io::VertexMap& function : functions) text += '\t' + function.name;
  text += '\n';
  const Eigen::Index rows = rowsOf(grid);
  for (std::size_t n = 0; n < along.size(); ++n) {
    const Eigen::Index t = nearestTrajectory(grid, along[n]);
    for (Eigen::Index p = t * rows; p < (t + 1) * rows; ++p) {
      text += std::to_string(n + 1) + '\t' + number(grid.depth[p]);
      for (int c = 0; c < 3; ++c) text += '\t' + number(grid.points(p, c));
      text += '\t' + number(grid.thickness[p]);
      for (const io::VertexMap& function : functions) text += '\t' + number(function.values[p]);
      text += '\n';
    }
  }
  return text;
}

}  // namespace

void writeGrid(Context& context, const GridFunctions& wanted, const io::VolumeReadOptions& reading,
               const AnatomicalGrid& grid) {
  auto step = context.step("grid");
  const auto functions = functionsOnGrid(context, wanted, reading, grid);
  std::vector<io::VertexMap> maps = {{"depth", "", grid.depth},
                                     {"thickness", "mm", grid.thickness}};
  maps.insert(maps.end(), functions.begin(), functions.end());
  const auto kind = grid.cells.cols() == 8 ? io::CellKind::Hexahedron : io::CellKind::Quad;
  io::writeVtu(context.output("grid.vtu"), grid.points, {{kind, grid.cells}}, maps);
  if (!functions.empty()) {
    writeTextFile(context.output("grid_functions.tsv"), depthTable(functions, grid));
    context.result("grid_functions", functions.size());
  }
  if (!wanted.along.empty()) {
    writeTextFile(context.output("grid_trajectories.tsv"),
                  trajectoryTable(functions, grid, wanted.along));
  }
}

}  // namespace explica::app
