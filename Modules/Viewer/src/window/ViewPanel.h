// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Session.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QToolButton>
#include <QWidget>

#include <array>
#include <functional>
#include <vector>

namespace explica::viewer {

/// From where the region is looked at: points with weights, a line between two points, a surface.
class ViewPanel : public QWidget {
 public:
  explicit ViewPanel(QWidget* parent = nullptr);

  /// What the user wants; buttons and fields call them.
  struct Calls {
    std::function<void(View)> change;       ///< to these viewpoints
    std::function<void()> takeView;         ///< the present view instead of those taken
    std::function<void()> addView;          ///< the present view, too
    std::function<void()> lineAlong;        ///< a line along the present view
    std::function<void()> lineTo;           ///< a line to the present view
    std::function<void()> openViewSurface;  ///< another surface to look from
  } calls;

  void show(const View& view);

 private:
  QWidget* pointsPage();
  QWidget* linePage();
  QWidget* surfacePage();
  void fillRows();
  void addRow();
  void changeKind(ViewKind kind);
  void change(const std::function<void(View&)>& change);

  /// A viewpoint's line in the list.
  struct Row {
    QWidget* widget = nullptr;
    QLabel* direction = nullptr;
    QDoubleSpinBox* weight = nullptr;
    QToolButton* remove = nullptr;
  };

  View view_;
  bool filling_ = false;  ///< fields are being set by the program
  QComboBox* kind_ = nullptr;
  std::array<QWidget*, 3> pages_ = {};
  QWidget* list_ = nullptr;
  std::vector<Row> rows_;
  QDoubleSpinBox* distance_ = nullptr;
  std::array<std::array<QDoubleSpinBox*, 3>, 2> ends_ = {};
  QLabel* surface_ = nullptr;
};

}  // namespace explica::viewer
