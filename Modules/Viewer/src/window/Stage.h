// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Eyes.h"

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Viewer/Window.h"

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

class vtkActor;
class vtkAnnotatedCubeActor;
class vtkCellPicker;
class vtkLookupTable;
class vtkOrientationMarkerWidget;
class vtkPoints;
class vtkPolyData;
class vtkPolyDataMapper;
class vtkPolyDataNormals;
class vtkRenderWindow;
class vtkRenderWindowInteractor;
class vtkRenderer;
class vtkScalarBarActor;
class vtkTextActor;
class vtkUnsignedCharArray;

namespace explica::viewer {

/// A point of the surface under the pointer.
struct Picked {
  std::int32_t vertex = -1;
  Point place = Point::Zero();  ///< RAS mm
};

/// The three-dimensional picture: surface, colours, the region's rim, colour bar, cube of
/// directions.  Knows no window but the one that it is put into.
class Stage {
 public:
  explicit Stage(const TriangleMesh& surface);
  ~Stage();

  /// Puts the picture into a window; the cube of directions needs its interactor.
  void enter(vtkRenderWindow& window, vtkRenderWindowInteractor& interactor);
  void render();

  void place(const Positions& positions);
  void paint(const std::vector<Rgb>& colours);
  /// Colours by face: for regions and labels, between whose colours nothing lies.
  void paintFaces(const std::vector<Rgb>& colours);
  /// Shows the bar; none where there is no scale.
  void showScale(const std::optional<Scale>& scale, const std::string& title);
  /// Draws the edges of the region's faces that no other face of it has.
  void showRim(const std::vector<std::int32_t>& regionFaces);
  /// A line along the surface, or none: V indices one after the other.
  void showPath(const std::vector<std::int32_t>& vertices);

  /// Marks from where the region is looked at.
  void showEyes(const View& view, const visibility::Viewpoints& points, const Point& from);
  void setEyesShown(bool shown);

  /// The surface fills the picture, seen from this side.
  void look(const Vector& direction);
  /// The viewpoints are in the picture, too.
  void lookAtAll();
  /// From the surface to the eye.
  [[nodiscard]] Vector direction() const;
  /// @param x,y  pixels of the window from the lower left
  [[nodiscard]] std::optional<Picked> pick(int x, int y);

 private:
  void buildSurface();
  void buildLines();
  void follow(vtkPolyData& lines, const std::vector<std::int32_t>& vertices);
  void coarsenWhileTurning(vtkRenderWindowInteractor& interactor);
  void show(vtkPolyData& mesh);

  const TriangleMesh& surface_;
  Positions positions_;
  std::vector<std::int32_t> rim_;   ///< ends of its edges, two by two
  std::vector<std::int32_t> path_;  ///< ends of its pieces, two by two
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkPolyData> mesh_;
  vtkNew<vtkUnsignedCharArray> colours_;
  vtkNew<vtkUnsignedCharArray> faceColours_;
  vtkNew<vtkPolyDataNormals> normals_;
  vtkNew<vtkPolyDataMapper> mapper_;
  vtkNew<vtkPolyDataMapper> coarseMapper_;
  vtkNew<vtkActor> actor_;
  vtkNew<vtkPolyData> rimLines_;
  vtkNew<vtkPolyData> pathLines_;
  vtkNew<vtkScalarBarActor> bar_;
  vtkNew<vtkTextActor> barTitle_;
  vtkNew<vtkLookupTable> barColours_;
  vtkNew<vtkOrientationMarkerWidget> cube_;
  vtkNew<vtkCellPicker> picker_;
  Eyes eyes_{*renderer_.Get()};  // goes before the renderer does
  vtkRenderWindow* window_ = nullptr;
};

}  // namespace explica::viewer
