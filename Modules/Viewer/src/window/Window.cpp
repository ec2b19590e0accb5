// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Viewer/Window.h"

#include "Display.h"
#include "MainWindow.h"

#include <QVTKOpenGLNativeWidget.h>

#include <QApplication>
#include <QSurfaceFormat>
#include <array>

namespace explica::viewer {

void showWindow(Session& session, const WindowCalls& calls, const WindowOptions& options) {
  requireDisplay();
  QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
  std::string program = "explica";
  std::array<char*, 2> words = {program.data(), nullptr};
  int count = 1;
  QApplication application(count, words.data());
  MainWindow window(session, calls, options);
  window.show();
  if (!options.script) {
    QApplication::exec();
    return;
  }
  QApplication::processEvents();
  playScript(window, *options.script);
}

}  // namespace explica::viewer
