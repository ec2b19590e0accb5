// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Panels.h"
#include "Stage.h"

#include "Explica/Viewer/Session.h"
#include "Explica/Viewer/Window.h"

#include <QVTKOpenGLNativeWidget.h>
#include <QMainWindow>
#include <QTimer>

#include <array>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace explica::viewer {

/// The window's own maps, in their order in the panel; those that were opened follow.
enum OwnMap : int { kRegion, kFlux, kSeen, kAreaRatio, kOwnMaps };
// As the panel calls them.
inline constexpr std::array kOwnMapNames = {"region", "faces the viewpoint", "share seen",
                                            "area now / at the start"};

/// The window: a session's picture, its panels and menus, and what the user's events do to them.
class MainWindow : public QMainWindow {
 public:
  MainWindow(Session& session, WindowCalls calls, WindowOptions options);
  ~MainWindow() override;

  // What menus, keys and scripts do.
  void open(const std::string& path);
  void pickCentre();  ///< under the pointer
  void step(std::size_t state);
  void savePicture(const QString& path);
  /// @return false if there is no such action, or no such field
  bool act(const QString& action);
  bool set(const QString& field, const QString& value);
  void press(const QString& key, int x, int y);
  /// With the pointer held over these places of the view, pixels from its lower left.
  void drag(const std::vector<QPointF>& places);

  [[nodiscard]] const Session& session() const { return session_; }
  [[nodiscard]] bool isSaving() const { return saving_.valid(); }
  /// True while colours are still being computed in another thread.
  [[nodiscard]] bool isPainting() const { return seen_.valid(); }
  /// Brings the picture up to date with the session.
  void follow();

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  void buildMenus();
  void buildViewMenu();
  QAction* addAction(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                     std::function<void()> work);
  void connectPanels();
  void take(Opened opened);

  void choose(Choice choice);
  void undo();
  void takeRegion();  ///< of the label or of the ball that the panel names
  void takeAbove();
  void takeView();
  void lookFromViewpoint();  ///< of several their mean
  void toggle();
  void saveState();
  void copyCommand();
  void help();

  void showChoice();  ///< whenever the choice is another
  void refresh();
  void showState(const unfolding::IterationRecord& record, std::size_t count);
  void paint();
  void paintLabels(const WindowLabels& labels);
  void paintValues(const io::VertexMap& map);
  /// Values of one of the window's own maps, of the state that is shown; empty while they are
  /// computed in another thread.
  std::optional<io::VertexMap> ownMap(int number);
  void fillMaps();
  void readUnderPointer();
  /// Name of the label at a vertex, of the labels that were opened; "" if there is none.
  [[nodiscard]] std::string valueAt(std::int32_t vertex) const;
  /// The vertex under the pointer.
  [[nodiscard]] std::optional<std::int32_t> pick();

  Session& session_;
  WindowCalls calls_;
  WindowOptions options_;

  QVTKOpenGLNativeWidget* view_ = nullptr;
  std::unique_ptr<Stage> stage_;
  Panels panels_;
  QTimer timer_;
  std::vector<Choice> earlier_;  ///< for undo
  std::vector<WindowMap> maps_;
  std::vector<WindowLabels> labels_;
  TriangleMesh shownMesh_;
  io::VertexMap shownMap_;  ///< in the picture; empty for labels
  std::size_t shown_ = 0;   ///< state in the picture
  std::size_t known_ = 0;   ///< states that the picture knows of
  Activity activity_ = Activity::Choosing;
  bool newest_ = true;    ///< the picture goes with the newest state
  bool filling_ = false;  ///< fields are being set by the program
  QPoint pointer_;
  bool pointerMoved_ = false;
  std::future<std::string> saving_;
  std::future<Eigen::VectorXd> seen_;
  std::size_t seenState_ = 0;
  Eigen::VectorXd seenValues_;
};

/// Plays a file of events.
/// @throws InvalidInput, IOError
void playScript(MainWindow& window, const std::string& path);

}  // namespace explica::viewer
