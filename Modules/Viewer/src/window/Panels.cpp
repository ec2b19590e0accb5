// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Panels.h"

#include "Fields.h"

#include <QDockWidget>
#include <QFormLayout>
#include <QGroupBox>
#include <QHBoxLayout>
#include <QScrollArea>
#include <QVBoxLayout>

namespace explica::viewer {
namespace {

QGroupBox* group(const char* title, QLayout* layout) {
  constexpr int kMargin = 7, kSpacing = 4;  // pixels: all groups fit into a window of 900
  layout->setContentsMargins(kMargin, kMargin, kMargin, kMargin);
  layout->setSpacing(kSpacing);
  auto* box = new QGroupBox(title);
  box->setLayout(layout);
  return box;
}

QGroupBox* regionGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.radius = numberField("radius", "Radius of the region about its centre", {1, 200, 1, 1, " mm"});
  p.regionLabels = named(new QComboBox, "regionLabels", "What makes the region");
  p.regionLabels->addItem("ball about the centre (C)");
  p.regionKey = named(new QComboBox, "regionKey", "Which label is the region");
  p.above = numberField("above", "The region is where the map shown is above this",
                        {-1e9, 1e9, 0.1, 3, ""});
  p.takeAbove = named(new QPushButton("Take"), "takeAbove",
                      "Makes the region of the vertices where the map shown is above the value");
  p.regionSays = named(new QLabel, "regionSays", "What the choice selects");
  p.regionSays->setWordWrap(true);
  auto* above = new QHBoxLayout;
  above->addWidget(p.above, 1);
  above->addWidget(p.takeAbove);
  form->addRow("Region", p.regionLabels);
  form->addRow("Radius", p.radius);
  form->addRow("Label", p.regionKey);
  form->addRow("Map above", above);
  form->addRow(p.regionSays);
  return group("1. Choose: press C over a place, or take a label", form);
}

QGroupBox* viewGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.direction = named(new QLabel, "direction", "From the region to the viewpoint, a unit vector");
  p.takeView = named(new QPushButton("Take the view (V)"), "takeView",
                     "The region is opened towards the side from which you look now");
  p.takeView->setFocusPolicy(Qt::NoFocus);
  p.distance = numberField("distance", "How far the viewpoint is from the region's centroid",
                           {10, 1e6, 100, 0, " mm"});
  p.surround = named(new QComboBox, "surround", "What becomes of the surface around the region");
  p.target = numberField(
      "target", "Average visibility at which to stop; none: where more of it costs too much",
      {0, 1, 0.01, 3, ""});
  p.target->setSpecialValueText("none");
  form->addRow("Look from", p.direction);
  form->addRow(p.takeView);
  form->addRow("Distance", p.distance);
  form->addRow("Surroundings", p.surround);
  form->addRow("Target", p.target);
  return group("2. Look: turn it until the fold faces you, press V", form);
}

QGroupBox* runGroup(Panels& p) {
  auto* column = new QVBoxLayout;
  p.run = named(new QPushButton("Start (Space)"), "run", "Starts and pauses the unfolding");
  p.state = named(new QSlider(Qt::Horizontal), "state", "State that is shown");
  p.state->setEnabled(false);
  p.stateSays = named(new QLabel, "stateSays", "State that is shown");
  p.stateSays->setWordWrap(true);
  for (QWidget* w : {static_cast<QWidget*>(p.run), static_cast<QWidget*>(p.state),
                     static_cast<QWidget*>(p.stateSays)}) {
    column->addWidget(w);
  }
  return group("3. Unfold: press the space bar", column);
}

QGroupBox* mapGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.map = named(new QComboBox, "map", "What colours the surface");
  p.automatic = named(new QCheckBox("range from the values"), "automatic", "Range of the colours");
  p.automatic->setChecked(true);
  p.low = numberField("low", "Value of the first colour", {-1e9, 1e9, 0.1, 3, ""});
  p.high = numberField("high", "Value of the last colour", {-1e9, 1e9, 0.1, 3, ""});
  form->addRow("Map", p.map);
  auto* range = new QHBoxLayout;
  range->addWidget(p.low, 1);
  range->addWidget(new QLabel("to"));
  range->addWidget(p.high, 1);
  form->addRow("Range", range);
  form->addRow("", p.automatic);
  return group("Colours", form);
}

}  // namespace

Panels buildPanels(QMainWindow& window) {
  Panels p;
  auto* column = new QVBoxLayout;
  for (QGroupBox* box : {regionGroup(p), viewGroup(p), runGroup(p), mapGroup(p)}) {
    column->addWidget(box);
  }
  column->addStretch();
  auto* inside = new QWidget;
  inside->setLayout(column);
  auto* scroll = new QScrollArea;
  scroll->setWidget(inside);
  scroll->setWidgetResizable(true);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setMinimumWidth(300);
  auto* dock = new QDockWidget("Unfolding", &window);
  dock->setObjectName("unfoldingDock");
  dock->setWidget(scroll);
  window.addDockWidget(Qt::LeftDockWidgetArea, dock);

  return p;
}

void showField(QWidget* field, bool shown) {
  field->setVisible(shown);
  const auto* form = qobject_cast<QFormLayout*>(field->parentWidget()->layout());
  if (form == nullptr) return;
  if (QWidget* name = form->labelForField(field)) name->setVisible(shown);
}

}  // namespace explica::viewer
