// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Window.h"

#include <QComboBox>
#include <QWidget>

#include <string>
#include <vector>

namespace explica::viewer {

/// Curves of a volume's values over the depth of the cortex: the largest regions in one chart, or
/// one region with its spread beside everything.
class DepthPanel : public QWidget {
 public:
  explicit DepthPanel(QWidget* parent = nullptr);

  /// Adds what was opened together, and shows the first of it.
  void add(std::vector<WindowProfiles> profiles);
  /// Draws the curve of this region stronger than the others; "" for none.
  void emphasise(const std::string& region);

 private:
  class Chart;
  void showVolume();
  void showChosen();

  std::vector<WindowProfiles> all_;
  QComboBox* volume_;
  QComboBox* region_;
  Chart* chart_;
};

}  // namespace explica::viewer
