// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Curves.h"

#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>

namespace explica::viewer {

Curves::Curves(QWidget* parent) : QWidget(parent) {
  setMinimumHeight(160);
}

void Curves::show(std::vector<Curve> curves, std::size_t state) {
  std::erase_if(curves, [](const Curve& curve) {
    return std::none_of(curve.values.begin(), curve.values.end(),
                        [](double v) { return std::isfinite(v); });
  });
  curves_ = std::move(curves);
  state_ = state;
  setVisible(!curves_.empty());
  update();
}

void Curves::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  if (curves_.empty()) return;
  const double each = static_cast<double>(height()) / static_cast<double>(curves_.size());
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    drawCurve(painter, curves_[c], QRectF(0, each * static_cast<double>(c), width(), each));
  }
}

void Curves::drawCurve(QPainter& painter, const Curve& curve, const QRectF& box) const {
  const double letters = painter.fontMetrics().height();
  const QRectF plot = box.adjusted(4, letters + 2, -4, -4);
  painter.setPen(palette().color(QPalette::WindowText));
  QString words = QString::fromStdString(curve.name);
  if (state_ < curve.values.size() && std::isfinite(curve.values[state_])) {
    const double value = curve.values[state_] * (curve.percent ? 100 : 1);
    words += QString(": %1%2").arg(value, 0, 'g', 3).arg(curve.percent ? " %" : "");
  }
  painter.drawText(QPointF(box.left() + 4, box.top() + letters - 2), words);
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawRect(plot);
  double low = 0, high = 1e-9;
  for (const double v : curve.values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double steps = std::max<double>(1, static_cast<double>(curve.values.size()) - 1);
  const auto at = [&](std::size_t n) {
    return QPointF(plot.left() + plot.width() * static_cast<double>(n) / steps,
                   plot.bottom() - plot.height() * (curve.values[n] - low) / (high - low));
  };
  QPainterPath path;
  for (std::size_t n = 0; n < curve.values.size(); ++n) {
    if (!std::isfinite(curve.values[n])) continue;
    if (path.elementCount() == 0) {
      path.moveTo(at(n));
    } else {
      path.lineTo(at(n));
    }
  }
  painter.setPen(QPen(curve.colour, 2));
  painter.drawPath(path);
  if (state_ >= curve.values.size()) return;
  painter.setPen(QPen(palette().color(QPalette::WindowText), 1, Qt::DashLine));
  const double x = plot.left() + plot.width() * static_cast<double>(state_) / steps;
  painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()));
}

}  // namespace explica::viewer
