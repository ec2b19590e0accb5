// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Series.h"

#include "Explica/Core/WholeFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Report/Drawing.h"
#include "Explica/Report/Figure.h"
#include "Explica/Report/Picture.h"
#include "Explica/Shapes/FitFigure.h"
#include "Explica/Shapes/ShapeFit.h"
#include "Explica/Shapes/ShapeLevel.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace explica::app {
namespace {

constexpr int kSide = 420;               // pixels of the film's pictures
constexpr int kCaption = 34;             // pixels below them
constexpr double kFramesPerSecond = 12;  // of the film
constexpr int kFilmSteps = 24;           // of the film, from one shape to the other
constexpr int kFilmGrid = 44;            // voxels per side for its surfaces
constexpr report::Colour kLine = {0.007F, 0.10F, 0.46F};
using report::kInk;

shapes::HarmonicShape between(const shapes::HarmonicShape& a, const shapes::HarmonicShape& b,
                              double share) {
  return shapes::combine({a, b}, {1 - share, share});
}

std::string shareText(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f : %.2f", 1 - share, share);
  return text;
}

report::Picture curvePicture(const shapes::HarmonicShape& shape) {
  const shapes::AnnulusBox box = shapes::boxOf(shape.annulus);
  const double scale = (kSide / 2.0 - 4) / box.halfSide;
  report::Picture picture(kSide, kSide + kCaption);
  const planar::Curve curve = shapes::levelCurves(shape, 160).front();
  std::vector<report::Segment2> lines;
  const auto place = [&](int v) {
    const planar::Point2 p = curve.point(v) - box.centre.head<2>();
    return Eigen::Vector2d(kSide / 2.0 + scale * p.x(), kSide / 2.0 - scale * p.y());
  };
  for (int e = 0; e < curve.edgeCount(); ++e) lines.push_back({place(e), place(curve.next(e))});
  report::drawSegments(picture, lines, kLine, 3);
  return picture;
}

report::Picture surfacePicture(const shapes::HarmonicShape& shape) {
  const shapes::AnnulusBox box = shapes::boxOf(shape.annulus);
  const TriangleMesh mesh = shapes::levelSurface(shape, kFilmGrid);
  report::SurfacePictureOptions options;
  options.width = options.height = kSide;
  report::Camera camera;
  camera.target = box.centre;
  camera.towards = Vector(-0.5, 0.75, -0.45).normalized();
  const Vector right = camera.towards.cross(Vector(0, 0, 1)).normalized();
  camera.up = right.cross(camera.towards);
  camera.halfHeight = 1.02 * box.halfSide;
  report::Picture picture(kSide, kSide + kCaption);
  report::pastePicture(picture, report::SurfaceScene(mesh).render(camera, {}, {}, options), 0, 0);
  return picture;
}

report::Picture filmPicture(const shapes::HarmonicShape& shape, double share) {
  report::Picture picture =
      shape.annulus.dimension == 2 ? curvePicture(shape) : surfacePicture(shape);
  report::drawText(picture, shareText(share), {kSide / 2.0, kSide + 0.7 * kCaption}, 13, kInk,
                   report::TextAnchor::Middle);
  return picture;
}

}  // namespace

void writeSeries(Context& context, const shapes::HarmonicShape& a, const shapes::HarmonicShape& b,
                 int count, int grid) {
  const shapes::HarmonicAnnulus& annulus = a.annulus;
  std::vector<shapes::SeriesPanel> panels;
  std::vector<report::Picture> pictures;
  double leastMargin = kInfinity;
  for (int k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / (count - 1);
    const shapes::HarmonicShape shape = between(a, b, share);
    leastMargin = std::min(leastMargin, shapes::boundaryMargin(shape));
    char name[40];
    std::snprintf(name, sizeof name, "series/shape-%04d", k);
    if (annulus.dimension == 2) {
      const planar::Curve curve = shapes::levelCurves(shape, grid).front();
      io::writePolygonCsv(context.output(std::string(name) + ".csv"), curve.positions);
      panels.push_back({shareText(share), shapes::outlineOf(curve)});
    } else {
      const TriangleMesh mesh = shapes::levelSurface(shape, grid);
      io::writeGiftiSurface(context.output(std::string(name) + ".surf.gii"), mesh);
      panels.push_back({shareText(share), shapes::sectionOf(mesh, annulus.centre.z())});
      pictures.push_back(filmPicture(shape, share));
    }
  }
  writeTextFile(context.output("series.svg"),
                shapes::drawSeries(annulus, annulus.centre.z(), panels));
  if (annulus.dimension == 3) {
    report::writePng(context.output("series.png"),
                     report::tilePictures(pictures, std::min(count, 3)));
  }
  context.result("series_boundary_margin_min", leastMargin);

  // To and fro.
  std::vector<report::Picture> film;
  for (int k = 0; k <= kFilmSteps; ++k) {
    const double share = static_cast<double>(k) / kFilmSteps;
    film.push_back(filmPicture(between(a, b, share), share));
  }
  for (int k = kFilmSteps - 1; k > 0; --k) film.push_back(film[static_cast<std::size_t>(k)]);
  writeTextFile(context.output("series.gif"), report::encodeGif(film, kFramesPerSecond));
}

}  // namespace explica::app
