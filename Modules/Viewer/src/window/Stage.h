// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Viewer/Window.h"

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkActor;
class vtkAnnotatedCubeActor;
class vtkCellPicker;
class vtkDoubleArray;
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

using Rgb = std::array<unsigned char, 3>;

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
  /// Values of the vertices, with the scale's bar beside the surface.
  void paint(const Eigen::VectorXd& values, const report::ColourScale& scale);
  /// Colours by face: for regions and labels, between whose colours nothing lies.
  void paint(const std::vector<Rgb>& colours);
  /// Draws the edges of the region's faces that no other face of it has.
  void showRim(const std::vector<std::int32_t>& regionFaces);

  /// The surface fills the picture, seen from this side.
  void look(const Vector& direction);
  /// From the surface to the eye.
  [[nodiscard]] Vector direction() const;
  /// The vertex of the surface under the pointer.
  /// @param x,y  pixels of the window from the lower left
  [[nodiscard]] std::optional<std::int32_t> pick(double x, double y);

 private:
  void buildSurface();
  void buildRim();
  void showBar(bool shown);
  void coarsenWhileTurning(vtkRenderWindowInteractor& interactor);

  const TriangleMesh& surface_;
  Positions positions_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkPolyData> mesh_;
  vtkNew<vtkDoubleArray> values_;
  vtkNew<vtkUnsignedCharArray> faceColours_;
  vtkNew<vtkPolyDataNormals> normals_;
  vtkNew<vtkPolyDataMapper> mapper_;
  vtkNew<vtkPolyDataMapper> coarseMapper_;
  vtkNew<vtkActor> actor_;
  vtkNew<vtkPolyData> region_;  ///< its faces on the surface's points
  vtkNew<vtkScalarBarActor> bar_;
  vtkNew<vtkTextActor> barTitle_;
  vtkNew<vtkLookupTable> barColours_;
  vtkNew<vtkOrientationMarkerWidget> cube_;
  vtkNew<vtkCellPicker> picker_;
  vtkRenderWindow* window_ = nullptr;
};

}  // namespace explica::viewer
