// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The part of the window that shows: states, colours, curves, values under the pointer.
#include "MainWindow.h"

#include "Explica/Geometry/MeshMeasures.h"
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

Rgb colourIn(const Scale& scale, double value) {
  if (!std::isfinite(value)) return scale.unknown;
  const double share = std::clamp((value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
  const double last = static_cast<double>(scale.colours.size() - 1);
  return scale.colours[static_cast<std::size_t>(std::lround(share * last))];
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
    readUnder(pointer_);
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
  showRegion();
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

void MainWindow::showRegion() {
  panels_.regionSays->setText(QString::fromStdString(session_.regionWords()));
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

std::optional<WindowMap> MainWindow::ownMap(int number) {
  if (number == kFlux) {
    return WindowMap{"faces the viewpoint", "",
                     visibility::vertexFlux(shownMesh_, session_.viewpoints())};
  }
  if (number == kAreaRatio) {
    TriangleMesh start = session_.surface();
    if (session_.momentCount() > 0) start.positions = session_.moment(0).positions;
    return WindowMap{"area now / at the start", "",
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
  return WindowMap{"share seen", "", seenValues_};
}

void MainWindow::paint() {
  const int chosen = panels_.map->currentIndex();
  const auto mapCount = static_cast<int>(maps_.size());
  shownValues_.resize(0);
  if (chosen >= kOwnMaps + mapCount) {
    paintLabels(labels_[chosen - kOwnMaps - mapCount]);
  } else if (chosen >= kOwnMaps) {
    paintValues(maps_[chosen - kOwnMaps]);
  } else if (chosen > kRegion) {
    if (const auto map = ownMap(chosen)) paintValues(*map);
  } else {
    std::vector<Rgb> faces(static_cast<std::size_t>(shownMesh_.faceCount()), kOutside);
    for (const std::int32_t f : session_.preview().region.faces) faces[f] = kInside;
    stage_->paintFaces(faces);
    stage_->showScale({}, "");
  }
}

void MainWindow::paintLabels(const WindowLabels& labels) {
  const std::map<std::int32_t, Rgb> colours(labels.colours.begin(), labels.colours.end());
  std::vector<Rgb> faces;
  for (Eigen::Index f = 0; f < shownMesh_.faceCount(); ++f) {
    const std::int32_t a = labels.keys[shownMesh_.faces(f, 0)],
                       b = labels.keys[shownMesh_.faces(f, 1)],
                       c = labels.keys[shownMesh_.faces(f, 2)];
    const auto found = colours.find(b == c ? b : a);
    faces.push_back(found == colours.end() ? kOutside : found->second);
  }
  stage_->paintFaces(faces);
  stage_->showScale({}, "");
}

void MainWindow::paintValues(const WindowMap& map) {
  Scale scale = calls_.scale(map.values);
  filling_ = true;
  if (panels_.automatic->isChecked()) {
    panels_.low->setValue(scale.low);
    panels_.high->setValue(scale.high);
  } else if (panels_.high->value() > panels_.low->value()) {
    scale.low = panels_.low->value();
    scale.high = panels_.high->value();
  }
  filling_ = false;
  std::vector<Rgb> colours;
  for (const double v : map.values) colours.push_back(colourIn(scale, v));
  stage_->paint(colours);
  stage_->showScale(scale, map.unit.empty() ? map.name : map.name + " [" + map.unit + "]");
  shownValues_ = map.values;
  shownUnit_ = map.unit;
}

std::string MainWindow::valueAt(std::int32_t vertex) const {
  const int chosen = panels_.map->currentIndex();
  const int label = chosen - kOwnMaps - static_cast<int>(maps_.size());
  if (label >= 0) {
    const WindowLabels& labels = labels_[label];
    for (const auto& [key, name] : labels.names) {
      if (key == labels.keys[vertex]) return name;
    }
    return "no label";
  }
  if (vertex >= shownValues_.size()) return "";
  const double value = shownValues_[vertex];
  if (!std::isfinite(value)) return "not known";
  return QString("%1 %2").arg(value, 0, 'g', 3).arg(shownUnit_.c_str()).toStdString();
}

void MainWindow::readUnder(const QPoint& at) {
  const QPoint pixel = fromLowerLeft(at);
  const auto picked = stage_->pick(pixel.x(), pixel.y());
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

QPoint MainWindow::fromLowerLeft(const QPoint& at) const {
  const double ratio = view_->devicePixelRatioF();
  return {static_cast<int>(at.x() * ratio),
          static_cast<int>((view_->height() - 1 - at.y()) * ratio)};
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
