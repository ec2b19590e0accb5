// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "StackPanel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QVBoxLayout>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::viewer {
namespace {

constexpr double kGap = 8;        // pixels between tiles
constexpr double kBarSpace = 74;  // pixels at the right for the colour bar and its numbers

/// How tiles are put into a box, as large as they can be.
struct Arrangement {
  int columns = 1;
  double scale = 0;  ///< pixels of the window for one of a tile
};

Arrangement arrange(int tiles, const QSizeF& tile, const QSizeF& box, double title) {
  Arrangement best;
  for (int columns = 1; columns <= tiles; ++columns) {
    const int rows = (tiles + columns - 1) / columns;
    const double scale = std::min((box.width() / columns - kGap) / tile.width(),
                                  (box.height() / rows - kGap - title) / tile.height());
    if (scale > best.scale) best = {columns, scale};
  }
  return best;
}

/// A round length that a scale bar of at most so many mm may have.
double roundLength(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= most) return step * power;
  }
  return power;
}

}  // namespace

class StackPanel::Montage : public QWidget {
 public:
  explicit Montage(QWidget* parent) : QWidget(parent) { setMinimumSize(280, 190); }

  void show(const WindowStack& stack) {
    tiles_.clear();
    for (const WindowStack::Tile& tile : stack.tiles) {
      tiles_.push_back(
          {"depth " + QString::number(tile.depth, 'g', 3), QString::number(tile.depth, 'g', 2),
           QImage(tile.rgb.data(), tile.width, tile.height, 3 * tile.width, QImage::Format_RGB888)
               .copy()});
    }
    scale_ = stack.scale;
    pixelsPerMillimetre_ = stack.pixelsPerMillimetre;
    update();
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.fillRect(rect(), Qt::white);
    if (tiles_.empty()) return;
    const double letters = painter.fontMetrics().height();
    const QSizeF box(width() - (scale_ ? kBarSpace : 0), height() - letters - kGap);
    const QSizeF tile = tiles_.front().picture.size();
    const Arrangement placed = arrange(static_cast<int>(tiles_.size()), tile, box, letters);
    if (!(placed.scale > 0)) return;
    painter.setRenderHint(QPainter::SmoothPixmapTransform, placed.scale < 1);
    const QSizeF cell(placed.scale * tile.width() + kGap,
                      placed.scale * tile.height() + kGap + letters);
    for (std::size_t n = 0; n < tiles_.size(); ++n) {
      const auto columns = static_cast<std::size_t>(placed.columns);
      const QPointF corner(kGap / 2 + cell.width() * static_cast<double>(n % columns),
                           cell.height() * static_cast<double>(n / columns));
      painter.setPen(QColor(30, 30, 30));
      const QRectF above(corner, QSizeF(cell.width() - kGap, letters));
      const bool fits = painter.fontMetrics().horizontalAdvance(tiles_[n].title) <= above.width();
      painter.drawText(above, Qt::AlignCenter, fits ? tiles_[n].title : tiles_[n].shortTitle);
      painter.drawImage(QRectF(corner + QPointF(0, letters), placed.scale * tile),
                        tiles_[n].picture);
    }
    drawLength(painter, placed.scale * pixelsPerMillimetre_, placed.scale * tile.width());
    if (scale_) drawBar(painter, letters);
  }

 private:
  void drawLength(QPainter& painter, double pixelsPerMillimetre, double tileWidth) const {
    const double length = roundLength(std::max(tileWidth / 2, 30.0) / pixelsPerMillimetre);
    const double y = height() - painter.fontMetrics().height() / 2.0 - 2;
    painter.setPen(QPen(QColor(30, 30, 30), 3));
    const double end = kGap / 2 + length * pixelsPerMillimetre;
    painter.drawLine(QPointF(kGap / 2, y), QPointF(end, y));
    painter.drawText(QPointF(end + 8, y + painter.fontMetrics().ascent() / 2.0 - 1),
                     QString("%1 mm; pale blue: off the map, or not known").arg(length));
  }

  void drawBar(QPainter& painter, double letters) const {
    const QRectF bar(width() - kBarSpace + 12, 1.5 * letters, 14,
                     std::max(40.0, height() - 4 * letters));
    const auto count = scale_->colours.size();
    for (int y = 0; y < static_cast<int>(bar.height()); ++y) {
      const double share = 1 - y / std::max(1.0, bar.height() - 1);
      const Rgb& c = scale_->colours[static_cast<std::size_t>(
          std::lround(std::clamp(share, 0.0, 1.0) * static_cast<double>(count - 1)))];
      painter.fillRect(QRectF(bar.left(), bar.top() + y, bar.width(), 1.5),
                       QColor(c[0], c[1], c[2]));
    }
    painter.setPen(QColor(30, 30, 30));
    for (const double share : {0.0, 0.5, 1.0}) {
      const double y = bar.bottom() - share * bar.height();
      painter.drawText(QRectF(bar.right() + 4, y - letters / 2, kBarSpace - 30, letters),
                       Qt::AlignLeft | Qt::AlignVCenter,
                       QString::number(scale_->low + share * (scale_->high - scale_->low), 'g', 3));
    }
  }

  struct Tile {
    QString title;
    QString shortTitle;
    QImage picture;
  };
  std::vector<Tile> tiles_;
  std::optional<Scale> scale_;
  double pixelsPerMillimetre_ = 1;
};

StackPanel::StackPanel(QWidget* parent) : QWidget(parent) {
  volume_ = new QComboBox;
  volume_->setObjectName("stackVolume");
  volume_->setToolTip("Volume whose depths are shown on the flat map");
  montage_ = new Montage(this);
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel("Volume"));
  row->addWidget(volume_, 1);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->addLayout(row);
  column->addWidget(montage_, 1);
  const auto index = static_cast<void (QComboBox::*)(int)>(&QComboBox::currentIndexChanged);
  connect(volume_, index, this, [this](int) { showVolume(); });
}

void StackPanel::showVolume() {
  if (volume_->currentIndex() < 0) return;
  montage_->show(all_[static_cast<std::size_t>(volume_->currentIndex())]);
}

void StackPanel::add(std::vector<WindowStack> stacks) {
  const int first = volume_->count();
  for (WindowStack& one : stacks) all_.push_back(std::move(one));
  {
    const QSignalBlocker quiet(volume_);
    for (std::size_t n = static_cast<std::size_t>(first); n < all_.size(); ++n) {
      volume_->addItem(QString::fromStdString(all_[n].name));
    }
    volume_->setCurrentIndex(first);
  }
  showVolume();
}

}  // namespace explica::viewer
