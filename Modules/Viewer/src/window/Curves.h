// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <QWidget>

#include <string>
#include <vector>

namespace explica::viewer {

/// Small charts below each other, one a quantity, over the states of an unfolding; a line marks
/// the state that is shown.
class Curves : public QWidget {
 public:
  struct Curve {
    std::string name;
    std::vector<double> values;  ///< one a state
    QColor colour;
    bool percent = false;
  };

  explicit Curves(QWidget* parent = nullptr);
  /// Curves without a known value are left out.
  void show(std::vector<Curve> curves, std::size_t state);

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  void drawCurve(QPainter& painter, const Curve& curve, const QRectF& box) const;

  std::vector<Curve> curves_;
  std::size_t state_ = 0;
};

}  // namespace explica::viewer
