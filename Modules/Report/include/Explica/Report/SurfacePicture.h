// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Picture.h"

#include <array>
#include <memory>
#include <vector>

namespace explica::report {

/// From where a surface is seen, in the head's directions.
enum class ViewName { Left, Right, Front, Back, Top, Bottom };
constexpr auto enumWords(ViewName) {
  using enum ViewName;
  return std::to_array<EnumWord<ViewName>>({{Left, "left"},
                                            {Right, "right"},
                                            {Front, "front"},
                                            {Back, "back"},
                                            {Top, "top"},
                                            {Bottom, "bottom"}});
}

/// Where the eye is and what it sees; parallel projection.
struct Camera {
  Point target = Point::Zero();      ///< in the middle of the picture, RAS mm
  Vector towards = Vector(1, 0, 0);  ///< unit, from the eye into the scene
  Vector up = Vector(0, 0, 1);       ///< unit, perpendicular to `towards`
  double halfHeight = 100;           ///< half of what the picture's height shows, mm
};

/// A camera that shows all of some places, with a small margin.
/// @param towards  direction of sight, any length > 0
/// @param up       what points upwards in the picture; replaced where it is parallel to `towards`
[[nodiscard]] Camera cameraTowards(const Positions& places, const Vector& towards, const Vector& up,
                                   int width, int height);
[[nodiscard]] Camera cameraFor(const Positions& places, ViewName view, int width, int height);

struct SurfacePictureOptions {
  int width = 1200;
  int height = 900;
  int samples = 2;         ///< rays a pixel in each direction: 2 means 4 rays
  double occlusion = 0.9;  ///< how much folds darken, in [0, 1]
};

template <class Visitor>
void describe(SurfacePictureOptions& options, Visitor&& visit) {
  visit(Field{"width", "pixels", "width of a view", 1, 20000}, options.width);
  visit(Field{"height", "pixels", "height of a view", 1, 20000}, options.height);
  visit(Field{"samples", "", "rays a pixel in each direction, against jagged edges", 1, 8},
        options.samples);
  visit(Field{"occlusion", "", "how much folds darken, 0 to 1"}, options.occlusion);
}

/// How the colours of a face's corners fill it.
enum class Filling {
  Smooth,   ///< interpolated
  Discrete  ///< each point has the colour of the nearest corner: for labels
};

/// A surface made ready for pictures: ray-casting hierarchy and how open each vertex lies, computed
/// once for any number of views and colours.  CPU only; the same input gives the same picture with
/// any number of threads.
class SurfaceScene {
 public:
  /// @param moves  of each vertex whether `moveTo` may move it, or none
  /// @throws InvalidInput  no face, or a position that is not finite
  explicit SurfaceScene(const TriangleMesh& mesh, const std::vector<std::uint8_t>& moves = {});
  ~SurfaceScene();
  SurfaceScene(SurfaceScene&&) noexcept;
  SurfaceScene& operator=(SurfaceScene&&) noexcept;

  /// The same faces in other places.  Rays are followed anew only through the faces that move.
  /// @throws InvalidInput  other faces, or a vertex that was to stay has moved
  void moveTo(const TriangleMesh& mesh);

  /// Draws the surface on white, lit from the eye's upper left, dark where folds hide from the sky.
  /// The inner side of faces is shown darker and bluish.
  /// @param colours  one a vertex; empty for a plain light grey
  /// @param keys     one a vertex, or none: a thin dark line runs about a region, which is made of
  ///                 the faces without a corner of key 0; others have the colours of their corners
  ///                 of key 0
  [[nodiscard]] Picture render(const Camera& camera, const std::vector<Colour>& colours,
                               Filling filling = Filling::Smooth,
                               const SurfacePictureOptions& options = {},
                               const std::vector<std::int32_t>& keys = {}) const;

  /// Share of the sky that each vertex sees within a tenth of the surface's size, V values in [0,
  /// 1].
  [[nodiscard]] const std::vector<float>& openness() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace explica::report
