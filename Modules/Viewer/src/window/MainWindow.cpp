// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "MainWindow.h"

#include "Explica/Core/Errors.h"

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkRenderWindowInteractor.h>
#include <QApplication>
#include <QClipboard>
#include <QDockWidget>
#include <QFileDialog>
#include <QMenuBar>
#include <QMessageBox>
#include <QMouseEvent>
#include <QStatusBar>

#include <algorithm>

namespace explica::viewer {
namespace {

constexpr int kFrameMilliseconds = 40;  // the picture follows iterations 25 times a second
}  // namespace

MainWindow::MainWindow(Session& session, WindowCalls calls, WindowOptions options)
    : session_(session),
      calls_(std::move(calls)),
      options_(std::move(options)),
      shownMesh_(session.surface()) {
  setWindowTitle(QString::fromStdString(options_.title));
  resize(options_.width, options_.height);
  view_ = new QVTKOpenGLNativeWidget(this);
  view_->setRenderWindow(vtkNew<vtkGenericOpenGLRenderWindow>().Get());
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  view_->interactor()->SetInteractorStyle(style);
  stage_ = std::make_unique<Stage>(session_.surface());
  stage_->enter(*view_->renderWindow(), *view_->interactor());
  view_->setMouseTracking(true);
  view_->setFocusPolicy(Qt::StrongFocus);
  view_->installEventFilter(this);
  setCentralWidget(view_);
  panels_ = buildPanels(*this);
  showField(panels_.regionKey, false);
  buildMenus();
  for (Opened& opened : options_.opened) take(std::move(opened));
  options_.opened.clear();
  fillMaps();
  if (!maps_.empty()) panels_.map->setCurrentIndex(kOwnMaps);
  connectPanels();
  showChoice();
  refresh();
  lookFromViewpoint();
  QObject::connect(&timer_, &QTimer::timeout, this, [this] { follow(); });
  timer_.start(kFrameMilliseconds);
  view_->setFocus();
}

MainWindow::~MainWindow() {
  session_.pause();
}

QAction* MainWindow::addAction(QMenu* menu, const char* name, const QString& text,
                               const QKeySequence& key, std::function<void()> work) {
  QAction* action = menu->addAction(text);
  action->setObjectName(name);
  action->setShortcut(key);
  QObject::connect(action, &QAction::triggered, this, [work = std::move(work)] { work(); });
  return action;
}

void MainWindow::buildMenus() {
  QMenu* file = menuBar()->addMenu("&File");
  addAction(file, "open", "&Open map or labels ...", QKeySequence::Open, [this] {
    const QString path = QFileDialog::getOpenFileName(this, "Open");
    if (!path.isEmpty()) open(path.toStdString());
  });
  addAction(file, "openFolder", "Open folder of unfold, flatten or sample ...",
            QKeySequence("Ctrl+Shift+O"), [this] {
              const QString path = QFileDialog::getExistingDirectory(
                  this, "Folder of explica unfold, flatten or sample");
              if (!path.isEmpty()) open(path.toStdString());
            });
  addAction(file, "save", "&Save the state shown", QKeySequence("W"), [this] { saveState(); });
  addAction(file, "picture", "Save &picture ...", QKeySequence("P"), [this] {
    const QString path = QFileDialog::getSaveFileName(this, "Picture", "explica.png", "*.png");
    if (!path.isEmpty()) savePicture(path);
  });
  addAction(file, "quit", "&Quit", QKeySequence("Q"), [this] { close(); });

  QMenu* edit = menuBar()->addMenu("&Choose");
  addAction(edit, "centre", "&Centre under the pointer", QKeySequence("C"),
            [this] { pickCentre(); });
  addAction(edit, "view", "Present &view is the viewpoint", QKeySequence("V"),
            [this] { takeView(); });
  addAction(edit, "undo", "&Undo the last choice", QKeySequence::Undo, [this] { undo(); });
  addAction(edit, "reset", "&Reset to choosing", QKeySequence("R"), [this] {
    session_.reset();
    shown_ = known_ = 0;
    showChoice();
    refresh();
  });

  QMenu* run = menuBar()->addMenu("&Run");
  addAction(run, "toggle", "Start or &pause", QKeySequence(Qt::Key_Space), [this] { toggle(); });
  addAction(run, "back", "Step &back", QKeySequence(Qt::Key_Left),
            [this] { step(shown_ > 0 ? shown_ - 1 : 0); });
  addAction(run, "forth", "Step &forth", QKeySequence(Qt::Key_Right), [this] { step(shown_ + 1); });
  addAction(run, "first", "&First state", QKeySequence(Qt::Key_Home), [this] { step(0); });
  addAction(run, "last", "&Last state", QKeySequence(Qt::Key_End),
            [this] { step(session_.momentCount()); });
  addAction(run, "flip", "&Before or after", QKeySequence("B"),
            [this] { step(shown_ == 0 ? session_.momentCount() : 0); });
  addAction(run, "command", "Copy the &command that gives this state", QKeySequence("Ctrl+Shift+C"),
            [this] { copyCommand(); });

  buildViewMenu();
  QMenu* helpMenu = menuBar()->addMenu("&Help");
  addAction(helpMenu, "help", "&Keys and what to do", QKeySequence::HelpContents,
            [this] { help(); });
}

void MainWindow::buildViewMenu() {
  QMenu* view = menuBar()->addMenu("&View");
  const std::array<std::tuple<const char*, const char*, Vector>, 6> sides = {
      {{"left", "From the &left", Vector(-1, 0, 0)},
       {"right", "From the &right", Vector(1, 0, 0)},
       {"top", "From &above", Vector(0, 0, 1)},
       {"bottom", "From &below", Vector(0, 0, -1)},
       {"front", "From the &front", Vector(0, 1, 0)},
       {"behind", "From b&ehind", Vector(0, -1, 0)}}};
  int key = 1;
  for (const auto& [name, text, direction] : sides) {
    addAction(view, name, text, QKeySequence(QString::number(key++)), [this, towards = direction] {
      stage_->look(towards);
      stage_->render();
    });
  }
  addAction(view, "viewpoint", "From the &viewpoint", QKeySequence("0"), [this] {
    lookFromViewpoint();
    stage_->render();
  });
  addAction(view, "nextMap", "Next &map", QKeySequence("M"), [this] {
    panels_.map->setCurrentIndex((panels_.map->currentIndex() + 1) % panels_.map->count());
  });
}

void MainWindow::connectPanels() {
  const auto changed = [this](auto set) {
    return [this, set](auto value) {
      if (filling_) return;
      Choice choice = session_.choice();
      set(choice, value);
      choose(std::move(choice));
    };
  };
  using DoubleBox = void (QDoubleSpinBox::*)(double);
  using ComboBox = void (QComboBox::*)(int);
  const auto number = static_cast<DoubleBox>(&QDoubleSpinBox::valueChanged);
  const auto index = static_cast<ComboBox>(&QComboBox::currentIndexChanged);
  for (const auto surround :
       {unfolding::Surround::Elastic, unfolding::Surround::Fixed, unfolding::Surround::None}) {
    panels_.surround->addItem(QString::fromStdString(std::string(nameOf(surround))),
                              static_cast<int>(surround));
  }
  connect(panels_.radius, number, this, changed([](Choice& c, double mm) { c.radius = mm; }));
  connect(panels_.target, number, this, changed([](Choice& c, double v) {
            c.unfold.targetVisibility = v > 0 ? std::optional(v) : std::nullopt;
          }));
  connect(panels_.surround, index, this, changed([this](Choice& c, int at) {
            c.unfold.unfolder.surround =
                static_cast<unfolding::Surround>(panels_.surround->itemData(at).toInt());
          }));
  connect(panels_.regionLabels, index, this, [this](int) { takeRegion(); });
  connect(panels_.regionKey, index, this, [this](int) {
    if (!filling_) takeRegion();
  });
  connect(panels_.takeAbove, &QPushButton::clicked, this, [this] { takeAbove(); });
  connect(panels_.takeView, &QPushButton::clicked, this, [this] { takeView(); });
  connect(panels_.distance, number, this,
          changed([](Choice& c, double mm) { c.view.distance = mm; }));
  connect(panels_.run, &QPushButton::clicked, this, [this] { toggle(); });
  connect(panels_.state, &QSlider::valueChanged, this, [this](int state) {
    if (!filling_) step(static_cast<std::size_t>(state));
  });
  connect(panels_.map, index, this, [this](int) {
    if (!filling_) refresh();
  });
  connect(panels_.automatic, &QCheckBox::toggled, this, [this](bool) { refresh(); });
  for (QDoubleSpinBox* end : {panels_.low, panels_.high}) {
    connect(end, number, this, [this](double) {
      if (filling_) return;
      const QSignalBlocker quiet(panels_.automatic);
      panels_.automatic->setChecked(false);
      refresh();
    });
  }
}

void MainWindow::open(const std::string& path) {
  try {
    take(calls_.open(path));
    fillMaps();
    showChoice();
    refresh();
  } catch (const Error& fault) {
    statusBar()->showMessage(QString::fromStdString(fault.what()));
  }
}

void MainWindow::take(Opened opened) {
  for (WindowMap& map : opened.maps) maps_.push_back(std::move(map));
  for (WindowLabels& labels : opened.labels) {
    panels_.regionLabels->addItem(QString::fromStdString(labels.name));
    labels_.push_back(std::move(labels));
  }
  if (opened.finished) {
    session_.open(std::move(*opened.finished));
    shown_ = known_ = session_.momentCount() - 1;
  }
  statusBar()->showMessage(QString::fromStdString(opened.what));
}

void MainWindow::fillMaps() {
  filling_ = true;
  const int chosen = std::max(0, panels_.map->currentIndex());
  panels_.map->clear();
  for (const char* name : kOwnMapNames) panels_.map->addItem(name);
  for (const WindowMap& map : maps_) panels_.map->addItem(QString::fromStdString(map.name));
  for (const WindowLabels& labels : labels_) {
    panels_.map->addItem(QString::fromStdString(labels.name));
  }
  panels_.map->setCurrentIndex(chosen);
  filling_ = false;
}

void MainWindow::choose(Choice choice) {
  if (session_.activity() == Activity::Running) {
    statusBar()->showMessage("It is running: pause (Space) before you change the choice.");
    showChoice();
    return;
  }
  earlier_.push_back(session_.choice());
  statusBar()->clearMessage();
  session_.choose(choice);
  shown_ = known_ = 0;
  showChoice();
  refresh();
}

void MainWindow::undo() {
  if (earlier_.empty() || session_.activity() == Activity::Running) return;
  const Choice choice = earlier_.back();
  earlier_.pop_back();
  session_.choose(choice);
  shown_ = known_ = 0;
  showChoice();
  refresh();
}

void MainWindow::pickCentre() {
  const auto picked = pick();
  if (!picked) {
    statusBar()->showMessage("There is no surface under the pointer.");
    return;
  }
  Choice choice = session_.choice();
  choice.centre = *picked;
  choice.marked.clear();
  choice.markedOptions.clear();
  choose(std::move(choice));
}

void MainWindow::takeRegion() {
  const int source = panels_.regionLabels->currentIndex() - 1;
  Choice choice = session_.choice();
  choice.marked.clear();
  choice.markedOptions.clear();
  showField(panels_.regionKey, source >= 0);
  if (source >= 0) {
    const WindowLabels& labels = labels_[source];
    if (panels_.regionKey->property("source") != source) {
      filling_ = true;
      panels_.regionKey->clear();
      for (const io::LabelEntry& entry : labels.table) {
        if (entry.key == 0) continue;
        panels_.regionKey->addItem(QString::fromStdString(entry.name), entry.key);
      }
      panels_.regionKey->setProperty("source", source);
      filling_ = false;
    }
    const int key = panels_.regionKey->currentData().toInt();
    for (const Label k : labels.keys) choice.marked.push_back(k == key);
    choice.markedOptions = {{"label", labels.file}, {"label-key", std::to_string(key)}};
  }
  choose(std::move(choice));
}

void MainWindow::takeAbove() {
  const int map = panels_.map->currentIndex() - kOwnMaps;
  if (map < 0 || map >= static_cast<int>(maps_.size())) {
    statusBar()->showMessage(
        "Choose one of the opened maps first; the window's own cannot be used.");
    return;
  }
  const WindowMap& values = maps_[map];
  if (values.file.empty()) {
    statusBar()->showMessage(
        "explica unfold takes the first map of a file: write this one into a file of its own.");
    return;
  }
  Choice choice = session_.choice();
  choice.marked.clear();
  for (const double v : values.values) choice.marked.push_back(v > panels_.above->value());
  choice.markedOptions = {
      {"label", values.file},
      {"above", QString::number(panels_.above->value(), 'g', 17).toStdString()}};
  choose(std::move(choice));
}

void MainWindow::takeView() {
  Choice choice = session_.choice();
  choice.view.direction = stage_->direction();
  choose(std::move(choice));
}

void MainWindow::lookFromViewpoint() {
  const visibility::Viewpoints points = session_.viewpoints();
  Vector towards = Vector::Zero();
  for (std::size_t n = 0; n < points.points.size(); ++n) {
    towards += points.weights[n] * (points.points[n] - session_.centre());
  }
  stage_->look(towards.norm() > 0 ? towards : Vector(-1, 0, 0));
}

void MainWindow::toggle() {
  if (session_.activity() == Activity::Running) {
    session_.pause();
    step(session_.momentCount() - 1);
    return;
  }
  if (!session_.problem().empty()) {
    statusBar()->showMessage(QString::fromStdString(session_.problem()));
    return;
  }
  newest_ = true;
  session_.run();
  refresh();
}

void MainWindow::step(std::size_t state) {
  newest_ = state + 1 >= session_.momentCount();
  shown_ = state;
  refresh();
}

void MainWindow::saveState() {
  session_.pause();
  if (session_.momentCount() == 0 || shown_ == 0) {
    statusBar()->showMessage("There is nothing to save before the first iteration.");
  } else if (isSaving()) {
    statusBar()->showMessage("It is still saving.");
  } else {
    saving_ = calls_.save(session_, shown_);
    statusBar()->showMessage("Saving ...");
  }
}

void MainWindow::copyCommand() {
  QString command = "explica unfold " + QString::fromStdString(options_.surface);
  auto options = session_.batchOptions(std::max<std::size_t>(1, shown_));
  options.insert(options.end(), options_.reading.begin(), options_.reading.end());
  for (const auto& [name, value] : options) {
    command += QString(" --%1 %2").arg(QString::fromStdString(name), QString::fromStdString(value));
  }
  QApplication::clipboard()->setText(command + " --out unfolded");
  statusBar()->showMessage(command + " --out unfolded");
}

void MainWindow::help() {
  QString text =
      "<p>Turn the surface until the fold faces you, press <b>C</b> over its middle, <b>V</b> to "
      "take this view as the viewpoint, set the radius, and press <b>Space</b>.</p><table>";
  for (const QAction* action : findChildren<QAction*>()) {
    if (action->shortcut().isEmpty()) continue;
    text += "<tr><td><b>" + action->shortcut().toString() + "</b>&nbsp;</td><td>" +
            action->text().remove('&') + "</td></tr>";
  }
  QMessageBox box(QMessageBox::NoIcon, "Keys", text + "</table>", QMessageBox::Close, this);
  box.setModal(false);
  box.exec();
}

void MainWindow::savePicture(const QString& path) {
  stage_->render();
  QApplication::processEvents();
  if (!grab().save(path)) statusBar()->showMessage("The picture could not be written: " + path);
}

}  // namespace explica::viewer
