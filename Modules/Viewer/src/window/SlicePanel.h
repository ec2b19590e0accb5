// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Window.h"

#include <QLabel>
#include <QWidget>

#include <array>
#include <functional>

namespace explica::viewer {

/// Three slices of a volume through one point, with the surface's cut lines and directions; a click
/// moves the point.
class SlicePanel : public QWidget {
 public:
  explicit SlicePanel(QWidget* parent = nullptr);

  /// Called with the point that the user clicked on, RAS mm.
  std::function<void(const Point&)> onPoint;

  void show(const DrawSlice& draw, const Point& through, const TriangleMesh& surface);

 private:
  class Slice;
  std::array<Slice*, 3> slices_;
};

}  // namespace explica::viewer
