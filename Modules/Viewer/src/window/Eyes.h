// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Viewer/Session.h"

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <vector>

class vtkActor;
class vtkRenderer;
class vtkStaticCellLocator;

namespace explica::viewer {

/// Marks in the picture from where the region is looked at: a ball at each viewpoint and an arrow
/// towards it, a line of viewpoints as a rod, a surface of them as glass.  Weights show as the size
/// of balls and arrows.  Nothing hides the region or tints its colours: what lies between it and
/// the eye is left out, and of a surface there only the edges are drawn.
class Eyes {
 public:
  explicit Eyes(vtkRenderer& renderer);
  ~Eyes();

  /// @param from   centroid of the region, RAS mm
  /// @param reach  mm: what is farther from there is outside the picture
  void show(const View& view, const visibility::Viewpoints& points, const Point& from,
            double reach);
  void setShown(bool shown);
  [[nodiscard]] bool isShown() const { return shown_; }

 private:
  /// A ball or an arrow, and where it lies as seen from the region.
  struct Mark {
    vtkSmartPointer<vtkActor> actor;
    Vector towards;
  };
  void add(vtkSmartPointer<vtkActor> actor);
  void addBall(const Point& centre, double radius);
  void addArrow(const Point& to, double length, double thickness);
  void addGlass(const TriangleMesh& mesh);
  /// Shows what the present camera may see; before each picture.
  void suitCamera();

  vtkRenderer& renderer_;
  std::vector<vtkSmartPointer<vtkActor>> actors_;
  std::vector<Mark> marks_;
  Point from_ = Point::Zero();  ///< centroid of the region, RAS mm
  vtkSmartPointer<vtkActor> glass_;
  vtkSmartPointer<vtkStaticCellLocator> glassFaces_;
  unsigned long observer_ = 0;
  bool shown_ = true;
};

}  // namespace explica::viewer
