// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "SlicePanel.h"

#include <QMouseEvent>
#include <QPainter>
#include <QVBoxLayout>

#include <algorithm>

namespace explica::viewer {

/// One slice, as large as its place allows.
class SlicePanel::Slice : public QWidget {
 public:
  Slice(int axis, SlicePanel* panel) : QWidget(panel), panel_(*panel), axis_(axis) {
    setMinimumSize(160, 120);
  }

  void show(SlicePixels pixels, const Point& through) {
    pixels_ = std::move(pixels);
    through_ = through;
    image_ = QImage(pixels_.rgb.data(), pixels_.width, pixels_.height, 3 * pixels_.width,
                    QImage::Format_RGB888)
                 .copy();
    update();
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.fillRect(rect(), Qt::black);
    if (image_.isNull()) return;
    const QRectF box = place();
    painter.drawImage(box, image_);
    const QPointF cross = onWidget(through_);
    painter.setPen(QPen(QColor(90, 200, 250), 1));
    painter.drawLine(QPointF(box.left(), cross.y()), QPointF(box.right(), cross.y()));
    painter.drawLine(QPointF(cross.x(), box.top()), QPointF(cross.x(), box.bottom()));
    painter.setPen(Qt::white);
    const QString letters = axis_ == 0 ? "AP" : "LR";
    painter.drawText(box, Qt::AlignLeft | Qt::AlignVCenter, letters.left(1));
    painter.drawText(box, Qt::AlignRight | Qt::AlignVCenter, letters.right(1));
    painter.drawText(box, Qt::AlignTop | Qt::AlignHCenter, axis_ == 2 ? "A" : "S");
    painter.drawText(box, Qt::AlignBottom | Qt::AlignHCenter, axis_ == 2 ? "P" : "I");
    painter.drawText(box, Qt::AlignBottom | Qt::AlignLeft,
                     QString("%1 = %2 mm").arg("xyz"[axis_]).arg(through_[axis_], 0, 'f', 1));
  }

  void mousePressEvent(QMouseEvent* event) override {
    if (image_.isNull() || !panel_.onPoint) return;
    const QRectF box = place();
    const double x = (event->localPos().x() - box.left()) / box.width() * pixels_.width - 0.5;
    const double y = (event->localPos().y() - box.top()) / box.height() * pixels_.height - 0.5;
    panel_.onPoint(pixels_.topLeft + x * pixels_.right + y * pixels_.down);
  }

 private:
  [[nodiscard]] QRectF place() const {
    const double scale = std::min(width() / static_cast<double>(pixels_.width),
                                  height() / static_cast<double>(pixels_.height));
    const double w = scale * pixels_.width, h = scale * pixels_.height;
    return {0.5 * (width() - w), 0.5 * (height() - h), w, h};
  }

  [[nodiscard]] QPointF onWidget(const Point& p) const {
    const Vector from = p - pixels_.topLeft;
    const double x = from.dot(pixels_.right) / pixels_.right.squaredNorm() + 0.5;
    const double y = from.dot(pixels_.down) / pixels_.down.squaredNorm() + 0.5;
    const QRectF box = place();
    return {box.left() + x / pixels_.width * box.width(),
            box.top() + y / pixels_.height * box.height()};
  }

  SlicePanel& panel_;
  int axis_;
  SlicePixels pixels_;
  QImage image_;
  Point through_ = Point::Zero();
};

SlicePanel::SlicePanel(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    slices_[axis] = new Slice(2 - axis, this);
    layout->addWidget(slices_[axis]);
  }
}

void SlicePanel::show(const DrawSlice& draw, const Point& through, const TriangleMesh& surface) {
  for (int n = 0; n < 3; ++n) slices_[n]->show(draw(2 - n, through, surface), through);
}

}  // namespace explica::viewer
