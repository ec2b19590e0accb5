// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The part of the window that shows: states, colours, curves, values under the pointer.
#include "MainWindow.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <QDockWidget>
#include <QMouseEvent>
#include <QStatusBar>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

namespace explica::viewer {
namespace {

/// As the screen has it.
Rgb bytesOf(const report::Colour& colour) {
  Rgb rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = report::encodeSrgb(colour[c]);
  return rgb;
}

constexpr Rgb kOutside = {205, 198, 190};  // pale brown
constexpr Rgb kInside = {224, 150, 84};    // orange

std::string wordOf(const Session& session) {
  switch (session.activity()) {
    case Activity::Choosing:
      return "choosing";
    case Activity::Running:
      return session.momentCount() > 0 ? "running" : "parting faces that cross";
    case Activity::Paused:
      return "paused";
    default:
      return session.termination() == Termination::NotRun
                 ? "finished earlier"
                 : std::string(nameOf(session.termination()));
  }
}

/// What is known of a state's numbers.
QString inWords(const unfolding::IterationRecord& record) {
  QStringList words;
  const auto say = [&](const char* text, double value, int digits) {
    if (std::isfinite(value)) words << QString(text).arg(value, 0, 'f', digits);
  };
  say("visibility %1", record.visibility, 3);
  say("area error %1 %", 100 * record.areaErrorMean, 2);
  say("edge strain %1 %", 100 * record.edgeStrainMean, 1);
  return words.join(", ");
}

/// What was done before the first state, where there was something to do.
QString inWords(const Parting& parting) {
  if (parting.parted == 0) return "";
  return QString("\n%1 crossing pairs parted first, by moves of at most %2 mm")
      .arg(parting.parted)
      .arg(parting.moveMax, 0, 'f', 2);
}

}  // namespace

void MainWindow::follow() {
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    statusBar()->showMessage(QString::fromStdString(saving_.get()));
  }
  bool stale = false;
  if (seen_.valid() && seen_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    seenValues_ = seen_.get();
    stale = panels_.map->currentIndex() == kSeen;
  }
  const std::size_t count = session_.momentCount();
  const Activity now = session_.activity();
  if (count != known_ || now != activity_) {
    known_ = count;
    activity_ = now;
    if (newest_) shown_ = count > 0 ? count - 1 : 0;
    stale = true;
  }
  if (stale) refresh();
  if (pointerMoved_) {
    pointerMoved_ = false;
    readUnderPointer();
  }
}

void MainWindow::refresh() {
  const std::size_t count = session_.momentCount();
  shown_ = count == 0 ? 0 : std::min(shown_, count - 1);
  unfolding::IterationRecord record;
  shownMesh_.positions = session_.surface().positions;
  if (count > 0) {
    Moment moment = session_.moment(shown_);
    shownMesh_.positions = std::move(moment.positions);
    record = moment.record;
  }
  stage_->place(shownMesh_.positions);
  panels_.regionSays->setText(QString::fromStdString(session_.regionWords()));
  paint();
  showState(record, count);
  stage_->render();
}

void MainWindow::showChoice() {
  const Choice choice = session_.choice();
  filling_ = true;
  panels_.radius->setValue(choice.radius);
  panels_.target->setValue(choice.unfold.targetVisibility.value_or(0));
  panels_.surround->setCurrentIndex(
      panels_.surround->findData(static_cast<int>(choice.unfold.unfolder.surround)));
  const Vector towards = choice.view.direction.normalized();
  panels_.direction->setText(QString("%1, %2, %3")
                                 .arg(towards.x(), 0, 'f', 2)
                                 .arg(towards.y(), 0, 'f', 2)
                                 .arg(towards.z(), 0, 'f', 2));
  panels_.distance->setValue(choice.view.distance);
  filling_ = false;
  stage_->showRim(session_.preview().region.faces);
}

void MainWindow::showState(const unfolding::IterationRecord& record, std::size_t count) {
  filling_ = true;
  panels_.state->setEnabled(count > 1);
  panels_.state->setRange(0, count > 0 ? static_cast<int>(count) - 1 : 0);
  panels_.state->setValue(static_cast<int>(shown_));
  filling_ = false;
  const Activity activity = session_.activity();
  panels_.run->setText(activity == Activity::Running ? "Pause (Space)"
                       : count > 0                   ? "Go on (Space)"
                                                     : "Start (Space)");
  panels_.run->setEnabled(activity != Activity::Over);
  QString says = QString::fromStdString(wordOf(session_));
  if (count > 0) {
    says = QString("state %1 of %2 (%3)\n%4")
               .arg(shown_)
               .arg(count - 1)
               .arg(says)
               .arg(inWords(record));
    if (const auto parting = session_.parting()) says += inWords(*parting);
  }
  panels_.stateSays->setText(says);
}

std::optional<io::VertexMap> MainWindow::ownMap(int number) {
  const char* name = kOwnMapNames[number];
  if (number == kFlux) {
    return io::VertexMap{name, "", visibility::vertexFlux(shownMesh_, session_.viewpoints())};
  }
  if (number == kAreaRatio) {
    TriangleMesh start = session_.surface();
    if (session_.momentCount() > 0) start.positions = session_.moment(0).positions;
    return io::VertexMap{name, "",
                         geometry::vertexAreas(shownMesh_)
                             .cwiseQuotient(geometry::vertexAreas(start).cwiseMax(1e-12))};
  }
  // Rays take long on a large surface: another thread casts them, and the picture waits.
  const bool fresh = seenState_ == shown_ && seenValues_.size() == shownMesh_.vertexCount();
  if (!fresh && !seen_.valid()) {
    seenState_ = shown_;
    seen_ = std::async(std::launch::async, [mesh = shownMesh_, points = session_.viewpoints()] {
      return visibility::visibleFraction(mesh, points).vertex;
    });
  }
  if (seenValues_.size() != shownMesh_.vertexCount()) return {};
  return io::VertexMap{name, "", seenValues_};
}

void MainWindow::paint() {
  const int chosen = panels_.map->currentIndex();
  const auto mapCount = static_cast<int>(maps_.size());
  shownMap_ = {};
  if (chosen >= kOwnMaps + mapCount) {
    paintLabels(labels_[chosen - kOwnMaps - mapCount]);
  } else if (chosen >= kOwnMaps) {
    paintValues(maps_[chosen - kOwnMaps]);
  } else if (chosen > kRegion) {
    if (const auto map = ownMap(chosen)) paintValues(*map);
  } else {
    std::vector<Rgb> faces(static_cast<std::size_t>(shownMesh_.faceCount()), kOutside);
    for (const std::int32_t f : session_.preview().region.faces) faces[f] = kInside;
    stage_->paint(faces);
  }
}

void MainWindow::paintLabels(const WindowLabels& labels) {
  std::map<Label, Rgb> colours;
  for (const io::LabelEntry& entry : labels.table) {
    colours[entry.key] = bytesOf(report::colourOfLabel(entry.key, entry.colour));
  }
  std::vector<Rgb> faces;
  for (Eigen::Index f = 0; f < shownMesh_.faceCount(); ++f) {
    const auto keyOf = [&](int corner) { return labels.keys[shownMesh_.faces(f, corner)]; };
    const Label a = keyOf(0), b = keyOf(1), c = keyOf(2);
    const auto found = colours.find(b == c ? b : a);
    faces.push_back(found == colours.end() ? kOutside : found->second);
  }
  stage_->paint(faces);
}

void MainWindow::paintValues(const io::VertexMap& map) {
  report::ColourScale scale = report::scaleFor(map.values, map.name, map.unit);
  filling_ = true;
  if (panels_.automatic->isChecked()) {
    panels_.low->setValue(scale.low);
    panels_.high->setValue(scale.high);
  } else if (panels_.high->value() > panels_.low->value()) {
    scale.low = panels_.low->value();
    scale.high = panels_.high->value();
  }
  filling_ = false;
  stage_->paint(map.values, scale);
  shownMap_ = map;
}

std::string MainWindow::valueAt(std::int32_t vertex) const {
  const int chosen = panels_.map->currentIndex();
  const int label = chosen - kOwnMaps - static_cast<int>(maps_.size());
  if (label >= 0) {
    const WindowLabels& labels = labels_[label];
    const auto entry = std::ranges::find(labels.table, labels.keys[vertex], &io::LabelEntry::key);
    return entry == labels.table.end() ? "no label" : entry->name;
  }
  if (vertex >= shownMap_.values.size()) return "";
  const double value = shownMap_.values[vertex];
  if (!std::isfinite(value)) return "not known";
  return QString("%1 %2").arg(value, 0, 'g', 3).arg(shownMap_.unit.c_str()).toStdString();
}

void MainWindow::readUnderPointer() {
  const auto picked = pick();
  if (!picked) return;
  const Point p = session_.surface().positions.row(*picked).transpose();
  statusBar()->showMessage(QString("%1: %2   vertex %3 at %4, %5, %6 mm on the folded surface")
                               .arg(panels_.map->currentText())
                               .arg(QString::fromStdString(valueAt(*picked)))
                               .arg(*picked)
                               .arg(p.x(), 0, 'f', 1)
                               .arg(p.y(), 0, 'f', 1)
                               .arg(p.z(), 0, 'f', 1));
}

std::optional<std::int32_t> MainWindow::pick() {
  const double ratio = view_->devicePixelRatioF();
  return stage_->pick(pointer_.x() * ratio, (view_->height() - 1 - pointer_.y()) * ratio);
}

bool MainWindow::eventFilter(QObject* object, QEvent* event) {
  if (object == view_ && event->type() == QEvent::MouseMove) {
    const auto* mouse = static_cast<QMouseEvent*>(event);
    pointer_ = mouse->pos();
    pointerMoved_ = mouse->buttons() == Qt::NoButton;
  }
  return QMainWindow::eventFilter(object, event);
}

}  // namespace explica::viewer
