// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Window.h"

#include <QComboBox>
#include <QWidget>

#include <vector>

namespace explica::viewer {

/// A volume on a flat map, depth beside depth from white to pial, with a scale bar and a colour
/// bar.
class StackPanel : public QWidget {
 public:
  explicit StackPanel(QWidget* parent = nullptr);

  /// Adds what was opened together, and shows the first of it.
  void add(std::vector<WindowStack> stacks);

 private:
  class Montage;
  void showVolume();

  std::vector<WindowStack> all_;
  QComboBox* volume_;
  Montage* montage_;
};

}  // namespace explica::viewer
