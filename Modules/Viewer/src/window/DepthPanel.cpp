// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "DepthPanel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QPainterPath>
#include <QVBoxLayout>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace explica::viewer {
namespace {

constexpr std::size_t kMostCurves = 8;            // more cannot be told apart
constexpr int kAllRegions = 0, kFirstRegion = 1;  // rows of the list
/// Colours that differ for colour-blind readers too [Okabe2008], for regions that have none.
constexpr std::array<Rgb, kMostCurves> kColours = {{{0, 114, 178},
                                                    {213, 94, 0},
                                                    {0, 158, 115},
                                                    {204, 121, 167},
                                                    {86, 180, 233},
                                                    {230, 159, 0},
                                                    {120, 94, 240},
                                                    {90, 90, 90}}};

/// A colour that can be seen on a light ground.
QColor inkOf(const Rgb& rgb) {
  constexpr int kLightest = 190;
  const QColor colour(rgb[0], rgb[1], rgb[2]);
  const int light = qGray(colour.rgb());
  return light > kLightest ? colour.darker(100 * light / (kLightest - 40)) : colour;
}

/// Distance of the ticks of an axis: 1, 2 or 5 times a power of ten.
double tickStep(double span, int most) {
  const double least = span / std::max(1, most),
               power = std::pow(10, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= least) return step * power;
  }
  return 10 * power;
}

struct Line {
  const DepthCurve* curve = nullptr;
  QColor colour;
  bool spread = false;  ///< drawn with a band of a standard deviation to either side
};

/// Values that lines reach, with their bands.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;

  void hold(const Line& line) {
    for (std::size_t n = 0; n < line.curve->mean.size(); ++n) {
      const double mean = line.curve->mean[n], by = line.spread ? line.curve->deviation[n] : 0;
      if (!std::isfinite(mean)) continue;
      low = std::min(low, mean - (std::isfinite(by) ? by : 0));
      high = std::max(high, mean + (std::isfinite(by) ? by : 0));
    }
  }
  void pad() {
    constexpr double kPadding = 0.05;
    if (!(high > low)) {
      low -= 0.5;
      high = low + 1;
    }
    const double by = kPadding * (high - low);
    low -= by;
    high += by;
  }
};

}  // namespace

/// Axes, curves, and their names at the right.
class DepthPanel::Chart : public QWidget {
 public:
  explicit Chart(QWidget* parent) : QWidget(parent) { setMinimumSize(280, 190); }

  void show(std::vector<Line> lines, QString title) {
    lines_ = std::move(lines);
    title_ = std::move(title);
    update();
  }
  void emphasise(const std::string& region) {
    if (region == emphasised_) return;
    emphasised_ = region;
    update();
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), Qt::white);
    if (lines_.empty()) return;
    range_ = Range{};
    for (const Line& line : lines_) range_.hold(line);
    range_.pad();
    const QFontMetricsF letters(painter.fontMetrics());
    int names = 0;
    for (const Line& line : lines_) {
      const QString name = QString::fromStdString(line.curve->region);
      names = std::max(names, static_cast<int>(letters.horizontalAdvance(name)));
    }
    constexpr int kSample = 26, kGap = 10;
    const double numbers = letters.horizontalAdvance("0000.0") + 6;
    const double legend = std::min(names + kSample + kGap, width() / 2);
    plot_ = QRectF(numbers, letters.height() + 8, width() - numbers - legend - 2 * kGap,
                   height() - 3 * letters.height() - 20);
    drawAxes(painter, letters);
    painter.setClipRect(plot_);
    for (const Line& line : lines_) drawBand(painter, line);
    for (const Line& line : lines_) drawCurve(painter, line);
    painter.setClipping(false);
    drawNames(painter, letters, plot_.right() + kGap, kSample);
  }

 private:
  [[nodiscard]] QPointF at(double depth, double value) const {
    return {plot_.left() + depth * plot_.width(),
            plot_.bottom() - (value - range_.low) / (range_.high - range_.low) * plot_.height()};
  }
  [[nodiscard]] bool isPale(const Line& line) const {
    const auto named = [&](const Line& l) { return l.curve->region == emphasised_; };
    return !emphasised_.empty() && std::any_of(lines_.begin(), lines_.end(), named) && !named(line);
  }
  [[nodiscard]] QPen penOf(const Line& line) const {
    QColor colour = line.colour;
    if (isPale(line)) colour.setAlpha(70);
    return {colour, line.curve->region == emphasised_ ? 4.0 : 2.0};
  }

  void drawAxes(QPainter& painter, const QFontMetricsF& letters) const {
    painter.setPen(QColor(30, 30, 30));
    painter.drawText(QPointF(plot_.left(), letters.ascent() + 2), title_);
    const double step = tickStep(range_.high - range_.low, static_cast<int>(plot_.height() / 32));
    for (double v = std::ceil(range_.low / step) * step; v <= range_.high; v += step) {
      const QPointF p = at(0, v);
      painter.setPen(QColor(225, 225, 225));
      painter.drawLine(p, QPointF(plot_.right(), p.y()));
      painter.setPen(QColor(60, 60, 60));
      painter.drawText(QRectF(0, p.y() - 10, plot_.left() - 5, 20),
                       Qt::AlignRight | Qt::AlignVCenter,
                       QString::number(std::abs(v) < 1e-9 * step ? 0 : v, 'g', 4));
    }
    constexpr int kTicks = 4;
    for (int n = 0; n <= kTicks; ++n) {
      const QPointF p = at(n / static_cast<double>(kTicks), range_.low);
      painter.drawLine(p, p + QPointF(0, 4));
      painter.drawText(QRectF(p.x() - 30, p.y() + 5, 60, letters.height()), Qt::AlignCenter,
                       QString::number(n / static_cast<double>(kTicks)));
    }
    painter.drawText(QRectF(plot_.left(), plot_.bottom() + letters.height() + 6, plot_.width(),
                            letters.height()),
                     Qt::AlignCenter, "depth (0 white, 1 pial)");
    painter.setPen(QColor(120, 120, 120));
    painter.drawRect(plot_);
  }

  void drawBand(QPainter& painter, const Line& line) const {
    if (!line.spread) return;
    const DepthCurve& c = *line.curve;
    QPolygonF band;
    for (std::size_t n = 0; n < c.mean.size(); ++n) {
      if (std::isfinite(c.deviation[n])) band << at(c.depth[n], c.mean[n] + c.deviation[n]);
    }
    for (std::size_t n = c.mean.size(); n-- > 0;) {
      if (std::isfinite(c.deviation[n])) band << at(c.depth[n], c.mean[n] - c.deviation[n]);
    }
    QColor colour = line.colour;
    colour.setAlpha(45);
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour);
    painter.drawPolygon(band);
    painter.setBrush(Qt::NoBrush);
  }

  void drawCurve(QPainter& painter, const Line& line) const {
    const DepthCurve& c = *line.curve;
    QPainterPath path;
    bool drawing = false;
    for (std::size_t n = 0; n < c.mean.size(); ++n) {
      if (!std::isfinite(c.mean[n])) {
        drawing = false;
        continue;
      }
      const QPointF p = at(c.depth[n], c.mean[n]);
      if (drawing) {
        path.lineTo(p);
      } else {
        path.moveTo(p);
      }
      drawing = true;
    }
    painter.setPen(penOf(line));
    painter.drawPath(path);
    if (c.mean.size() > 1) return;
    painter.setBrush(line.colour);  // a single depth
    painter.drawEllipse(at(c.depth[0], c.mean[0]), 3, 3);
    painter.setBrush(Qt::NoBrush);
  }

  void drawNames(QPainter& painter, const QFontMetricsF& letters, double left,
                 double sample) const {
    const double pitch = std::min(letters.height() + 4, plot_.height() / lines_.size());
    double y = plot_.top() + pitch / 2;
    for (const Line& line : lines_) {
      painter.setPen(penOf(line));
      painter.drawLine(QPointF(left, y), QPointF(left + sample - 6, y));
      painter.setPen(isPale(line) ? QColor(150, 150, 150) : QColor(30, 30, 30));
      const QRectF box(left + sample, y - letters.height() / 2, width() - left - sample - 2,
                       letters.height());
      painter.drawText(box, Qt::AlignLeft | Qt::AlignVCenter,
                       letters.elidedText(QString::fromStdString(line.curve->region),
                                          Qt::ElideMiddle, box.width()));
      y += pitch;
    }
  }

  std::vector<Line> lines_;
  QString title_;
  std::string emphasised_;
  Range range_;
  QRectF plot_;
};

DepthPanel::DepthPanel(QWidget* parent) : QWidget(parent) {
  const auto combo = [&](const char* name, const char* tip) {
    auto* box = new QComboBox;
    box->setObjectName(name);
    box->setToolTip(tip);
    return box;
  };
  volume_ = combo("profileVolume", "Volume whose values are shown over the depth");
  region_ = combo("profileRegion", "Regions whose curves are shown");
  chart_ = new Chart(this);
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel("Volume"));
  row->addWidget(volume_, 1);
  row->addWidget(new QLabel("Region"));
  row->addWidget(region_, 2);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->addLayout(row);
  column->addWidget(chart_, 1);
  const auto index = static_cast<void (QComboBox::*)(int)>(&QComboBox::currentIndexChanged);
  connect(volume_, index, this, [this](int) { showVolume(); });
  connect(region_, index, this, [this](int) { showChosen(); });
}

void DepthPanel::add(std::vector<WindowProfiles> profiles) {
  const int first = volume_->count();
  for (WindowProfiles& one : profiles) all_.push_back(std::move(one));
  {
    const QSignalBlocker quiet(volume_);
    for (std::size_t n = static_cast<std::size_t>(first); n < all_.size(); ++n) {
      volume_->addItem(QString::fromStdString(all_[n].name));
    }
    volume_->setCurrentIndex(first);
  }
  showVolume();
}

void DepthPanel::emphasise(const std::string& region) {
  chart_->emphasise(region);
}

void DepthPanel::showVolume() {
  const WindowProfiles& profiles = all_[static_cast<std::size_t>(volume_->currentIndex())];
  const QString before = region_->currentText();
  {
    const QSignalBlocker quiet(region_);
    region_->clear();
    const std::size_t shown = std::min(kMostCurves, profiles.regions.size());
    region_->addItem(profiles.regions.empty() ? QString("everything")
                     : shown == profiles.regions.size()
                         ? QString("all regions")
                         : QString("the %1 largest regions").arg(shown));
    for (const DepthCurve& curve : profiles.regions) {
      region_->addItem(QString::fromStdString(curve.region));
    }
    region_->setCurrentIndex(std::max(0, region_->findText(before)));
  }
  showChosen();
}

void DepthPanel::showChosen() {
  if (volume_->currentIndex() < 0 || region_->currentIndex() < 0) return;
  const WindowProfiles& profiles = all_[static_cast<std::size_t>(volume_->currentIndex())];
  const int chosen = region_->currentIndex();
  std::vector<Line> lines;
  const auto lineOf = [&](std::size_t n) {
    const DepthCurve& curve = profiles.regions[n];
    const Rgb rgb = curve.colour.value_or(kColours[n % kColours.size()]);
    return Line{&curve, inkOf(rgb), chosen != kAllRegions};
  };
  if (profiles.all) {
    lines.push_back({&*profiles.all, QColor(40, 40, 40), profiles.regions.empty()});
  }
  if (chosen == kAllRegions) {
    for (std::size_t n = 0; n < std::min(kMostCurves, profiles.regions.size()); ++n) {
      lines.push_back(lineOf(n));
    }
  } else {
    lines.push_back(lineOf(static_cast<std::size_t>(chosen - kFirstRegion)));
  }
  const bool band = std::any_of(lines.begin(), lines.end(), [](const Line& l) { return l.spread; });
  chart_->show(std::move(lines),
               QString::fromStdString(profiles.name) +
                   (band ? ": mean, and one standard deviation to either side" : ": mean"));
}

}  // namespace explica::viewer
