// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "SurfaceFrame.h"

#include "Bytes.h"
#include "StoredVolume.h"

#include "Explica/IO/VolumeFile.h"

#include "Explica/Core/Text.h"

#include <Eigen/LU>

#include <cmath>

namespace explica::io {

std::string structureFromName(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const auto has = [&name](const char* word) { return name.find(word) != std::string::npos; };
  if (name.starts_with("lh.") || has("hemi-L") || has("_left.") || has("_left_") || has(".L.") ||
      has("_lh.")) {
    return "CortexLeft";
  }
  if (name.starts_with("rh.") || has("hemi-R") || has("_right.") || has("_right_") || has(".R.") ||
      has("_rh.")) {
    return "CortexRight";
  }
  return "Other";
}

void setTypesFromName(const std::filesystem::path& path, SurfaceMetadata& metadata) {
  const std::string name = lowerCase(path.filename().string());
  struct Row {
    const char *word, *type, *secondary;
  };
  static constexpr Row kRows[] = {{"veryinflated", "VeryInflated", ""},
                                  {"very_inflated", "VeryInflated", ""},
                                  {"inflated", "Inflated", ""},
                                  {"infl_", "Inflated", ""},
                                  {"sphere", "Spherical", ""},
                                  {"flat", "Flat", ""},
                                  {"midthickness", "", "MidThickness"},
                                  {"graymid", "", "MidThickness"},
                                  {"white", "", "GrayWhite"},
                                  {"smoothwm", "", "GrayWhite"},
                                  {"pial", "", "Pial"}};
  for (const Row& row : kRows) {
    if (name.find(row.word) == std::string::npos) continue;
    if (*row.type != 0) metadata.geometricType = row.type;
    metadata.secondary = row.secondary;
    return;
  }
}

Eigen::Matrix4d scannerFromTkr(const Grid& volume) {
  // FreeSurfer's Torig: the conformed axes x = -i, y = +k, z = -j about the middle voxel n/2.
  const Vector& h = volume.spacing;
  Eigen::Matrix4d torig = Eigen::Matrix4d::Zero();
  torig.row(0) << -h[0], 0, 0, 0.5 * h[0] * volume.size[0];
  torig.row(1) << 0, 0, h[2], -0.5 * h[2] * volume.size[2];
  torig.row(2) << 0, -h[1], 0, 0.5 * h[1] * volume.size[1];
  torig(3, 3) = 1;
  return volume.affine() * torig.inverse();
}

std::string frameMixUp(const Point& point, const Positions& positions,
                       const Eigen::Matrix4d& scannerFromTkr, double far) {
  const auto distance = [&positions](const Point& x) {
    return std::sqrt((positions.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff());
  };
  const double asGiven = distance(point);
  if (!(asGiven > far) || scannerFromTkr.isIdentity(1e-6)) return {};
  const auto moved = [&point](const Eigen::Matrix4d& matrix) -> Point {
    return matrix.topLeftCorner<3, 3>() * point + matrix.topRightCorner<3, 1>();
  };
  const Point scanner = moved(scannerFromTkr), tkr = moved(scannerFromTkr.inverse());
  const bool wasTkr = distance(scanner) <= distance(tkr);
  const Point& meant = wasTkr ? scanner : tkr;
  if (!(distance(meant) <= far)) return {};
  return printed(
      "(%.2f, %.2f, %.2f) lies %.1f mm from the surface, but %.1f mm if it is %s: the surface is "
      "in the other frame, in which the point is %.2f,%.2f,%.2f",
      point[0], point[1], point[2], asGiven, distance(meant),
      wasTkr ? "FreeSurfer's surface RAS (tkregister)" : "scanner RAS", meant[0], meant[1],
      meant[2]);
}

Grid gridOfVolumeText(const std::filesystem::path& path, const VolumeText& text) {
  constexpr double kLargest = 1e6;  // voxels along an axis; beyond it the text is damaged
  std::array<int, 3> size{};
  for (int i = 0; i < 3; ++i) {
    if (!(text.size[i] >= 1 && text.size[i] <= kLargest) || !(text.spacing[i] > 0)) {
      refuse(path,
             "the volume geometry that it holds has a size or voxel size that is not positive");
    }
    size[i] = static_cast<int>(text.size[i]);
  }
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  affine.topLeftCorner<3, 3>() = text.axes * text.spacing.asDiagonal();
  affine.topRightCorner<3, 1>() =
      text.centre - affine.topLeftCorner<3, 3>() * (0.5 * text.size).eval();
  return gridOf(path, size, affine);
}

void moveToScanner(LoadedSurface& surface, const FrameInFile& frame,
                   const SurfaceReadOptions& options) {
  SurfaceOrigin& origin = surface.origin;
  std::optional<Grid> volume;
  if (options.fsVolume) {
    volume = readGrid(*options.fsVolume);
  } else if (frame.tkrVolume) {
    volume = frame.tkrVolume;
  }
  bool tkr = false;
  switch (options.space) {
    case SurfaceSpace::Scanner:
      origin.space = "scanner, as chosen";
      return;
    case SurfaceSpace::Tkr:
      if (!volume) {
        refuse(origin.path,
               "its coordinates are to be FreeSurfer's surface RAS, but it holds no volume "
               "geometry to place them; name the volume with --fs-volume orig.mgz");
      }
      tkr = true;
      break;
    case SurfaceSpace::Stated:
      if (!frame.stated.empty()) {
        origin.space = frame.stated;
        return;
      }
      tkr = volume.has_value();
      break;
  }
  if (!tkr) {
    origin.space = kFrameNotStated;
    origin.notes.emplace_back(kFrameNotStatedNote);
    return;
  }
  origin.space = "tkr, moved to scanner";
  origin.applied = scannerFromTkr(*volume);
  // Where both frames coincide, coordinates stay to the last bit.
  if (origin.applied.isIdentity(1e-12)) {
    origin.applied.setIdentity();
    return;
  }
  const Eigen::Matrix3d linear = origin.applied.topLeftCorner<3, 3>();
  const Eigen::RowVector3d shift = origin.applied.topRightCorner<3, 1>().transpose();
  surface.mesh.positions = ((surface.mesh.positions * linear.transpose()).rowwise() + shift).eval();
}

}  // namespace explica::io
