// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  /// The surface fills the picture, seen from this side.
  void look(const Vector& direction);
  /// From the surface to the eye.
  [[nodiscard]] Vector direction() const;
  /// The vertex of the surface under the pointer.
  /// @param x,y  pixels of the window from the lower left
  [[nodiscard]] std::optional<std::int32_t> pick(int x, int y);

 private:
  void buildSurface();
  void buildRim();
  void placeRim();
  void coarsenWhileTurning(vtkRenderWindowInteractor& interactor);
  void show(vtkPolyData& mesh);

  const TriangleMesh& surface_;
  Positions positions_;
  std::vector<std::int32_t> rim_;  ///< ends of its edges, two by two
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
  vtkNew<vtkScalarBarActor> bar_;
  vtkNew<vtkTextActor> barTitle_;
  vtkNew<vtkLookupTable> barColours_;
  vtkNew<vtkOrientationMarkerWidget> cube_;
  vtkNew<vtkCellPicker> picker_;
  vtkRenderWindow* window_ = nullptr;
};

}  // namespace explica::viewer
