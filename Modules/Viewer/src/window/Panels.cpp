// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Panels.h"

#include <QDockWidget>
#include <QFormLayout>
#include <QGroupBox>
#include <QScrollArea>
#include <QVBoxLayout>

namespace explica::viewer {
namespace {

template <class Field>
Field* named(Field* field, const char* name, const char* tip) {
  field->setObjectName(name);
  field->setToolTip(tip);
  return field;
}

QDoubleSpinBox* number(const char* name, const char* tip, double low, double high, double step,
                       int decimals, const char* unit) {
  auto* box = named(new QDoubleSpinBox, name, tip);
  box->setRange(low, high);
  box->setSingleStep(step);
  box->setDecimals(decimals);
  box->setSuffix(unit);
  box->setKeyboardTracking(false);
  box->setFocusPolicy(Qt::ClickFocus);
  return box;
}

QGroupBox* group(const char* title, QLayout* layout) {
  auto* box = new QGroupBox(title);
  box->setLayout(layout);
  return box;
}

QGroupBox* regionGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.radius = number("radius", "Radius of the region about its centre", 1, 200, 1, 1, " mm");
  p.regionLabels = named(new QComboBox, "regionLabels", "What makes the region");
  p.regionLabels->addItem("ball about the centre (C)");
  p.regionKey = named(new QComboBox, "regionKey", "Which label is the region");
  p.regionKey->setEnabled(false);
  p.above =
      number("above", "The region is where the map shown is above this", -1e9, 1e9, 0.1, 3, "");
  p.takeAbove = named(new QPushButton("Take where map is above"), "takeAbove",
                      "Makes the region of the vertices where the map shown is above the value");
  p.regionSays = named(new QLabel, "regionSays", "What the choice selects");
  p.regionSays->setWordWrap(true);
  form->addRow("Radius", p.radius);
  form->addRow("Region", p.regionLabels);
  form->addRow("Label", p.regionKey);
  form->addRow("Above", p.above);
  form->addRow(p.takeAbove);
  form->addRow(p.regionSays);
  return group("Region", form);
}

QGroupBox* viewGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.takeView = named(new QPushButton("Take the present view (V)"), "takeView",
                     "The region is opened towards the side from which you look now");
  p.addView = named(new QPushButton("Add the present view (Shift+V)"), "addView",
                    "The side from which you look now counts as much as those taken before");
  p.distance = number("distance", "How far the viewpoint is", 10, 1e6, 100, 0, " mm");
  p.surround = named(new QComboBox, "surround", "What becomes of the surface around the region");
  p.target = number("target", "Average visibility at which to stop; 0: where it no longer pays", 0,
                    1, 0.01, 3, "");
  form->addRow(p.takeView);
  form->addRow(p.addView);
  form->addRow("Distance", p.distance);
  form->addRow("Surroundings", p.surround);
  form->addRow("Target", p.target);
  return group("Viewpoint and surroundings", form);
}

QGroupBox* runGroup(Panels& p) {
  auto* column = new QVBoxLayout;
  p.run = named(new QPushButton("Start (Space)"), "run", "Starts and pauses the unfolding");
  p.state = named(new QSlider(Qt::Horizontal), "state", "State that is shown");
  p.state->setEnabled(false);
  p.stateSays = named(new QLabel, "stateSays", "State that is shown");
  p.stateSays->setWordWrap(true);
  p.curves = named(new Curves, "curves", "How the unfolding went");
  for (QWidget* w : {static_cast<QWidget*>(p.run), static_cast<QWidget*>(p.state),
                     static_cast<QWidget*>(p.stateSays), static_cast<QWidget*>(p.curves)}) {
    column->addWidget(w);
  }
  return group("Run", column);
}

QGroupBox* mapGroup(Panels& p) {
  auto* form = new QFormLayout;
  p.map = named(new QComboBox, "map", "What colours the surface");
  p.automatic = named(new QCheckBox("range from the values"), "automatic", "Range of the colours");
  p.automatic->setChecked(true);
  p.low = number("low", "Value of the first colour", -1e9, 1e9, 0.1, 3, "");
  p.high = number("high", "Value of the last colour", -1e9, 1e9, 0.1, 3, "");
  form->addRow("Map", p.map);
  form->addRow(p.automatic);
  form->addRow("From", p.low);
  form->addRow("To", p.high);
  return group("Map", form);
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

  p.slices = new SlicePanel;
  p.slicesDock = new QDockWidget("Slices", &window);
  p.slicesDock->setObjectName("slicesDock");
  p.slicesDock->setWidget(p.slices);
  p.slices->setMinimumWidth(240);
  window.addDockWidget(Qt::RightDockWidgetArea, p.slicesDock);
  p.slicesDock->hide();

  p.profiles = new DepthPanel;
  p.profilesDock = new QDockWidget("Over the depth", &window);
  p.profilesDock->setObjectName("profilesDock");
  p.profilesDock->setWidget(p.profiles);
  p.stack = new StackPanel;
  p.stackDock = new QDockWidget("Flat map, depth by depth", &window);
  p.stackDock->setObjectName("stackDock");
  p.stackDock->setWidget(p.stack);
  window.setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
  for (QDockWidget* below : {p.profilesDock, p.stackDock}) {
    window.addDockWidget(Qt::BottomDockWidgetArea, below);
    below->hide();
  }
  window.splitDockWidget(p.profilesDock, p.stackDock, Qt::Horizontal);
  return p;
}

void shareRoomBelow(QMainWindow& window, const Panels& panels) {
  constexpr int kHeight = 320;  // pixels, of a window of 900
  const QList<QDockWidget*> docks = {panels.profilesDock, panels.stackDock};
  window.resizeDocks(docks, {kHeight, kHeight}, Qt::Vertical);
  window.resizeDocks(docks, {1, 1}, Qt::Horizontal);
}

}  // namespace explica::viewer
