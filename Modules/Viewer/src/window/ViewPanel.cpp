// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ViewPanel.h"

#include "Fields.h"

#include <QFileInfo>
#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace explica::viewer {
namespace {

constexpr std::array kKindNames = {"points", "line", "surface"};  // rows of the list

/// A direction as two letters would say it, the largest part first: "L 0.98, S 0.20".
QString inLetters(const Vector& direction) {
  constexpr std::array kPositive = {"R", "A", "S"};
  constexpr std::array kNegative = {"L", "P", "I"};
  constexpr double kLeast = 0.05;  // smaller parts are left out
  const Vector unit = direction.normalized();
  std::array<int, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::abs(unit[a]) > std::abs(unit[b]); });
  QStringList parts;
  for (const int axis : order) {
    if (std::abs(unit[axis]) < kLeast) continue;
    parts << QString("%1 %2")
                 .arg(unit[axis] > 0 ? kPositive[axis] : kNegative[axis])
                 .arg(std::abs(unit[axis]), 0, 'f', 2);
  }
  return parts.join(", ");
}

QPushButton* button(const char* text, const char* name, const char* tip) {
  auto* made = named(new QPushButton(text), name, tip);
  made->setFocusPolicy(Qt::NoFocus);
  return made;
}

}  // namespace

ViewPanel::ViewPanel(QWidget* parent) : QWidget(parent) {
  kind_ = named(new QComboBox, "viewKind", "What the region is looked at from");
  for (const char* name : kKindNames) kind_->addItem(name);
  auto* form = new QFormLayout;
  form->addRow("Look from", kind_);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addLayout(form);
  pages_ = {pointsPage(), linePage(), surfacePage()};
  for (QWidget* page : pages_) {
    page->layout()->setContentsMargins(0, 0, 0, 0);
    column->addWidget(page);
  }
  const auto index = static_cast<void (QComboBox::*)(int)>(&QComboBox::currentIndexChanged);
  connect(kind_, index, this, [this](int at) { changeKind(static_cast<ViewKind>(at)); });
}

QWidget* ViewPanel::pointsPage() {
  auto* page = new QWidget;
  auto* column = new QVBoxLayout(page);
  list_ = new QWidget;
  auto* lines = new QVBoxLayout(list_);
  lines->setContentsMargins(0, 0, 0, 0);
  lines->setSpacing(2);
  auto* take = button("Take the view (V)", "takeView",
                      "The region is opened towards the side from which you look now");
  auto* add = button("Add it (Shift+V)", "addView",
                     "The side from which you look now counts beside those taken before");
  connect(take, &QPushButton::clicked, this, [this] { calls.takeView(); });
  connect(add, &QPushButton::clicked, this, [this] { calls.addView(); });
  auto* buttons = new QHBoxLayout;
  buttons->addWidget(take);
  buttons->addWidget(add);
  distance_ = numberField("distance", "How far the viewpoints are from the region's centroid",
                          {10, 1e6, 100, 0, " mm"});
  const auto number = static_cast<void (QDoubleSpinBox::*)(double)>(&QDoubleSpinBox::valueChanged);
  connect(distance_, number, this,
          [this](double mm) { change([mm](View& view) { view.distance = mm; }); });
  auto* form = new QFormLayout;
  form->addRow("Distance", distance_);
  column->addWidget(list_);
  column->addLayout(buttons);
  column->addLayout(form);
  return page;
}

QWidget* ViewPanel::linePage() {
  auto* page = new QWidget;
  auto* column = new QVBoxLayout(page);
  auto* grid = new QGridLayout;
  grid->addWidget(new QLabel("from"), 1, 0);
  grid->addWidget(new QLabel("to"), 2, 0);
  const auto number = static_cast<void (QDoubleSpinBox::*)(double)>(&QDoubleSpinBox::valueChanged);
  for (int axis = 0; axis < 3; ++axis) {
    auto* title = new QLabel(QString("%1 (mm)").arg("xyz"[axis]));
    grid->addWidget(title, 0, axis + 1);
    for (int end = 0; end < 2; ++end) {
      const QString name = QString("line%1%2").arg("XYZ"[axis]).arg(end);
      QDoubleSpinBox* field =
          numberField(name, "An end of the line, RAS mm", {-1e6, 1e6, 10, 1, ""});
      field->setButtonSymbols(QAbstractSpinBox::NoButtons);
      connect(field, number, this, [this, end, axis](double mm) {
        change([=](View& view) { view.line[end][axis] = mm; });
      });
      ends_[end][axis] = field;
      grid->addWidget(field, end + 1, axis + 1);
    }
  }
  auto* along = button("Along the view (L)", "lineAlong",
                       "From near the region to the distance, along the present view");
  auto* to = button("To the view (Shift+L)", "lineTo",
                    "From the first viewpoint to where you look from now, at the distance");
  connect(along, &QPushButton::clicked, this, [this] { calls.lineAlong(); });
  connect(to, &QPushButton::clicked, this, [this] { calls.lineTo(); });
  auto* buttons = new QHBoxLayout;
  buttons->addWidget(along);
  buttons->addWidget(to);
  column->addLayout(grid);
  column->addLayout(buttons);
  return page;
}

QWidget* ViewPanel::surfacePage() {
  auto* page = new QWidget;
  auto* column = new QVBoxLayout(page);
  surface_ = named(new QLabel, "viewSurface", "All points of this surface count alike, by area");
  surface_->setWordWrap(true);
  auto* open = button("Open another ...", "openViewSurface", "A file of a surface to look from");
  connect(open, &QPushButton::clicked, this, [this] { calls.openViewSurface(); });
  column->addWidget(surface_);
  column->addWidget(open);
  return page;
}

void ViewPanel::change(const std::function<void(View&)>& change) {
  if (filling_) return;
  View view = view_;
  change(view);
  calls.change(std::move(view));
}

void ViewPanel::changeKind(ViewKind kind) {
  if (filling_) return;
  const bool missing = (kind == ViewKind::Line && view_.line[0] == view_.line[1]) ||
                       (kind == ViewKind::Surface && !view_.surface);
  if (!missing) {
    change([kind](View& view) { view.kind = kind; });
  } else if (kind == ViewKind::Line) {
    calls.lineAlong();
  } else {
    calls.openViewSurface();
    show(view_);  // where none was opened, the kind stays what it was
  }
}

void ViewPanel::show(const View& view) {
  view_ = view;
  filling_ = true;
  kind_->setCurrentIndex(static_cast<int>(view.kind));
  for (std::size_t k = 0; k < pages_.size(); ++k) {
    pages_[k]->setVisible(static_cast<ViewKind>(k) == view.kind);
  }
  fillRows();
  distance_->setValue(view.distance);
  for (int end = 0; end < 2; ++end) {
    for (int axis = 0; axis < 3; ++axis) ends_[end][axis]->setValue(view.line[end][axis]);
  }
  surface_->setText(view.surface ? QString("%1: %2 faces")
                                       .arg(QFileInfo(view.surface->file.c_str()).fileName())
                                       .arg(view.surface->mesh.faceCount())
                                 : QString("none yet"));
  filling_ = false;
}

void ViewPanel::addRow() {
  const auto number = static_cast<void (QDoubleSpinBox::*)(double)>(&QDoubleSpinBox::valueChanged);
  const std::size_t n = rows_.size();
  Row row;
  row.widget = new QWidget;
  auto* line = new QHBoxLayout(row.widget);
  line->setContentsMargins(0, 0, 0, 0);
  row.direction = new QLabel;
  row.direction->setToolTip("From the region to the viewpoint, parts of a unit vector");
  row.weight =
      numberField(QString("weight%1").arg(n + 1),
                  "How much this viewpoint counts beside the others", {0.01, 1000, 0.5, 2, ""});
  row.weight->setPrefix("x ");
  connect(row.weight, number, this,
          [this, n](double weight) { change([=](View& view) { view.weights[n] = weight; }); });
  row.remove = named(new QToolButton, QString("removeView%1").arg(n + 1), "Leave it out");
  row.remove->setText("-");
  row.remove->setFocusPolicy(Qt::NoFocus);
  connect(row.remove, &QToolButton::clicked, this, [this, n] {
    change([at = static_cast<std::ptrdiff_t>(n)](View& view) {
      view.directions.erase(view.directions.begin() + at);
      view.weights.erase(view.weights.begin() + at);
    });
  });
  line->addWidget(row.direction, 1);
  line->addWidget(row.weight);
  line->addWidget(row.remove);
  list_->layout()->addWidget(row.widget);
  rows_.push_back(row);
}

void ViewPanel::fillRows() {
  while (rows_.size() > view_.directions.size()) {
    rows_.back().widget->hide();
    rows_.back().widget->deleteLater();  // its own button may have asked for it
    rows_.pop_back();
  }
  while (rows_.size() < view_.directions.size()) addRow();
  const bool several = rows_.size() > 1;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    rows_[n].direction->setText(inLetters(view_.directions[n]));
    rows_[n].weight->setValue(view_.weights[n]);
    rows_[n].weight->setVisible(several);
    rows_[n].remove->setVisible(several);
  }
}

}  // namespace explica::viewer
