// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Events from a file, for tests and demonstrations.
#include "MainWindow.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"

#include <QAction>
#include <QApplication>
#include <QKeyEvent>
#include <QMouseEvent>

#include <chrono>
#include <cmath>
#include <sstream>
#include <thread>

namespace explica::viewer {
namespace {

/// A little time goes by, as between two pictures.
void pass(MainWindow& window) {
  constexpr int kMilliseconds = 20;
  std::this_thread::sleep_for(std::chrono::milliseconds(kMilliseconds));
  QApplication::processEvents();
  window.follow();
}

void waitFor(MainWindow& window, std::size_t states) {
  const Session& session = window.session();
  while (session.activity() == Activity::Running && session.momentCount() < states) pass(window);
  window.follow();
}

/// Places about the middle of the view, a picture each.
std::vector<QPointF> circleOf(int pictures) {
  const QPointF middle(500, 400);
  std::vector<QPointF> places = {middle};
  for (int n = 1; n <= pictures; ++n) {
    places.push_back(middle + 150 * QPointF(std::cos(0.1 * n), std::sin(0.1 * n)));
  }
  return places;
}

/// @return false if the words are no event
bool playEvent(MainWindow& window, const std::string& verb, std::istringstream& words) {
  std::string name, value;
  int x = 0, y = 0, x1 = 0, y1 = 0, pictures = 0;
  std::size_t states = 0;
  if (verb == "key" && words >> name >> x >> y) {
    window.press(QString::fromStdString(name), x, y);
  } else if (verb == "drag" && words >> x >> y >> x1 >> y1) {
    window.drag({QPointF(x, y), QPointF(x1, y1)});
  } else if (verb == "turn" && words >> pictures) {
    window.drag(circleOf(pictures));
  } else if (verb == "do" && words >> name) {
    return window.act(QString::fromStdString(name));
  } else if (verb == "set" && words >> name && std::getline(words >> std::ws, value)) {
    return window.set(QString::fromStdString(name), QString::fromStdString(value));
  } else if (verb == "open" && words >> name) {
    window.open(name);
  } else if (verb == "wait" && words >> states) {
    waitFor(window, states);
  } else if (verb == "saved") {
    while (window.isSaving()) pass(window);
  } else if (verb == "picture" && words >> name) {
    do pass(window);
    while (window.isPainting());
    window.savePicture(QString::fromStdString(name));
  } else {
    return false;
  }
  QApplication::processEvents();
  return true;
}

}  // namespace

void playScript(MainWindow& window, const std::string& path) {
  std::istringstream script(fileText(path));
  std::string line;
  while (std::getline(script, line)) {
    std::istringstream words(line);
    std::string verb;
    if (!(words >> verb) || verb[0] == '#') continue;
    if (!playEvent(window, verb, words)) {
      throw InvalidInput(path + ": '" + line +
                         "' is no event (key, drag, turn, do, set, open, wait, saved, picture)");
    }
  }
}

bool MainWindow::act(const QString& action) {
  auto* found = findChild<QAction*>(action);
  if (found != nullptr) found->trigger();
  return found != nullptr;
}

bool MainWindow::set(const QString& field, const QString& value) {
  if (auto* box = findChild<QDoubleSpinBox*>(field)) {
    box->setValue(value.toDouble());
  } else if (auto* choice = findChild<QComboBox*>(field)) {
    const int at = choice->findText(value);
    if (at < 0) return false;
    choice->setCurrentIndex(at);
  } else if (auto* check = findChild<QCheckBox*>(field)) {
    check->setChecked(value == "on");
  } else {
    return false;
  }
  return true;
}

void MainWindow::press(const QString& key, int x, int y) {
  const double ratio = view_->devicePixelRatioF();
  pointer_ = QPoint(static_cast<int>(x / ratio), static_cast<int>(view_->height() - 1 - y / ratio));
  const QKeySequence sequence(key.size() == 1  ? key.toUpper()
                              : key == "space" ? QString("Space")
                                               : key);
  for (QAction* action : findChildren<QAction*>()) {
    if (action->shortcut() == sequence) {
      action->trigger();
      return;
    }
  }
}

void MainWindow::drag(const std::vector<QPointF>& places) {
  const auto send = [&](QEvent::Type type, const QPointF& place, Qt::MouseButton button) {
    QMouseEvent event(type, QPointF(place.x(), view_->height() - 1 - place.y()), button,
                      Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(view_, &event);
    QApplication::processEvents();
  };
  send(QEvent::MouseButtonPress, places.front(), Qt::LeftButton);
  for (std::size_t n = 1; n < places.size(); ++n) {
    send(QEvent::MouseMove, places[n], Qt::NoButton);
  }
  send(QEvent::MouseButtonRelease, places.back(), Qt::LeftButton);
}

}  // namespace explica::viewer
