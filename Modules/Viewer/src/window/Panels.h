// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMainWindow>
#include <QPushButton>
#include <QSlider>

namespace explica::viewer {

/// The fields beside the picture; each has an object name, by which scripts set it.
struct Panels {
  // Region
  QDoubleSpinBox* radius = nullptr;
  QComboBox* regionLabels = nullptr;  ///< "ball about the centre", or a label of those opened
  QComboBox* regionKey = nullptr;
  QDoubleSpinBox* above = nullptr;  ///< threshold of the map shown
  QPushButton* takeAbove = nullptr;
  QLabel* regionSays = nullptr;
  // Viewpoint and surroundings
  QLabel* direction = nullptr;
  QPushButton* takeView = nullptr;
  QDoubleSpinBox* distance = nullptr;
  QComboBox* surround = nullptr;
  QDoubleSpinBox* target = nullptr;  ///< 0: none
  // Run
  QPushButton* run = nullptr;
  QSlider* state = nullptr;
  QLabel* stateSays = nullptr;
  // Maps
  QComboBox* map = nullptr;
  QDoubleSpinBox* low = nullptr;
  QDoubleSpinBox* high = nullptr;
  QCheckBox* automatic = nullptr;
};

/// Builds the panels into docks of the window.
[[nodiscard]] Panels buildPanels(QMainWindow& window);

/// Shows or hides a field of a form together with its name.
void showField(QWidget* field, bool shown);

}  // namespace explica::viewer
