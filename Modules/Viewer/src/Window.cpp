// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Viewer/Window.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <X11/Xlib.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCellPicker.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSliderRepresentation2D.h>
#include <vtkSliderWidget.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

namespace explica::viewer {
namespace {

constexpr int kFrameMilliseconds = 40;  // the picture follows iterations 25 times a second

/// The window's own maps; those of the options follow.
enum OwnMap : std::size_t { kRegion, kFlux, kSeen, kAreaRatio, kOwnMaps };

constexpr std::array kOwnMapNames = {"region", "flux (1 faces the viewer)", "seen share",
                                     "area now / area at the start"};

void requireDisplay() {
  const char* name = std::getenv("DISPLAY");
  Display* display = name && *name ? XOpenDisplay(name) : nullptr;
  if (!display) {
    throw EnvironmentError(
        std::string("no window can be opened: ") +
        (name && *name ? "the display '" + std::string(name) + "' does not answer"
                       : "DISPLAY is not set") +
        "; use --screenshot, which needs none, or log in with a display (ssh -X)");
  }
  XCloseDisplay(display);
}

/// The window's objects and what the user's events do to them.
class Stage {
 public:
  Stage(Session& session, const Paint& paint, const Save& save, const WindowOptions& options)
      : session_(session), paint_(paint), save_(save), options_(options) {
    buildSurface();
    buildOverlays();
    renderer_->SetBackground(1, 1, 1);
    window_->AddRenderer(renderer_);
    window_->SetSize(options.width, options.height);
    window_->SetWindowName(options.title.c_str());
    window_->SetMultiSamples(4);
    interactor_->SetRenderWindow(window_);
    vtkNew<vtkInteractorStyleTrackballCamera> style;
    interactor_->SetInteractorStyle(style);
    listen(style, vtkCommand::CharEvent, &Stage::onChar);
    listen(interactor_, vtkCommand::KeyPressEvent, &Stage::onKey);
    listen(interactor_, vtkCommand::TimerEvent, &Stage::onTimer);
    buildSliders();
    look(session_.choice().direction);
    refresh();
  }

  void run() {
    interactor_->Initialize();
    window_->Render();
    interactor_->CreateRepeatingTimer(kFrameMilliseconds);
    if (options_.script) {
      play(*options_.script);
    } else {
      interactor_->Start();
    }
    session_.pause();
  }

 private:
  using Handler = void (Stage::*)();

  void listen(vtkObject* source, unsigned long event, Handler handler) {
    struct Bound {
      Stage* stage;
      Handler handler;
    };
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(new Bound{this, handler});
    command->SetClientDataDeleteCallback([](void* data) { delete static_cast<Bound*>(data); });
    command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
      const auto* bound = static_cast<Bound*>(data);
      (bound->stage->*bound->handler)();
    });
    source->AddObserver(event, command, 1.0f);
  }

  void buildSurface() {
    const TriangleMesh& surface = session_.surface();
    points_->SetDataTypeToFloat();
    points_->SetNumberOfPoints(surface.vertexCount());
    place(surface.positions);
    vtkNew<vtkCellArray> cells;
    for (Eigen::Index f = 0; f < surface.faceCount(); ++f) {
      const vtkIdType corners[3] = {surface.faces(f, 0), surface.faces(f, 1), surface.faces(f, 2)};
      cells->InsertNextCell(3, corners);
    }
    mesh_->SetPoints(points_);
    mesh_->SetPolys(cells);
    colours_->SetNumberOfComponents(3);
    colours_->SetNumberOfTuples(surface.vertexCount());
    mesh_->GetPointData()->SetScalars(colours_);
    normals_->SetInputData(mesh_);
    normals_->SplittingOff();
    normals_->ConsistencyOff();
    mapper_->SetInputConnection(normals_->GetOutputPort());
    actor_->SetMapper(mapper_);
    actor_->GetProperty()->SetSpecular(0.15);
    actor_->GetProperty()->SetAmbient(0.15);
    actor_->GetProperty()->SetDiffuse(0.85);
    renderer_->AddActor(actor_);
  }

  void buildOverlays() {
    for (vtkTextActor* text : {status_.Get(), help_.Get()}) {
      text->GetTextProperty()->SetFontSize(16);
      text->GetTextProperty()->SetColor(0.1, 0.1, 0.1);
      text->GetTextProperty()->SetFontFamilyToCourier();
      renderer_->AddActor2D(text);
    }
    status_->SetPosition(16, options_.height - 120);
    help_->SetPosition(16, 120);
    help_->SetInput(
        "c centre under pointer   v view is viewpoint   space run/pause   left/right step\n"
        "home/end first/last      m map                 r reset           w save   h help   q "
        "close");
  }

  void buildSlider(vtkSliderWidget* slider, vtkSliderRepresentation2D* shape, const char* title,
                   double left, double right, Handler handler) {
    shape->SetTitleText(title);
    shape->GetPoint1Coordinate()->SetCoordinateSystemToNormalizedDisplay();
    shape->GetPoint1Coordinate()->SetValue(left, 0.075);
    shape->GetPoint2Coordinate()->SetCoordinateSystemToNormalizedDisplay();
    shape->GetPoint2Coordinate()->SetValue(right, 0.075);
    shape->SetSliderLength(0.015);
    shape->SetTubeWidth(0.004);
    shape->SetEndCapLength(0.002);
    shape->SetTitleHeight(0.018);
    shape->SetLabelHeight(0.018);
    for (vtkTextProperty* text : {shape->GetTitleProperty(), shape->GetLabelProperty()}) {
      text->SetColor(0.1, 0.1, 0.1);
      text->ShadowOff();
      text->BoldOff();
    }
    shape->GetTubeProperty()->SetColor(0.75, 0.75, 0.75);
    shape->GetSliderProperty()->SetColor(0.13, 0.4, 0.67);
    slider->SetInteractor(interactor_);
    slider->SetRepresentation(shape);
    slider->SetAnimationModeToJump();
    slider->EnabledOn();
    listen(slider, vtkCommand::InteractionEvent, handler);
  }

  void buildSliders() {
    radiusShape_->SetMinimumValue(2);
    radiusShape_->SetMaximumValue(80);
    radiusShape_->SetValue(session_.choice().radius);
    radiusShape_->SetLabelFormat("%.1f");
    buildSlider(radiusSlider_, radiusShape_, "radius, mm", 0.05, 0.4, &Stage::onRadius);
    momentShape_->SetMinimumValue(0);
    momentShape_->SetMaximumValue(1);
    momentShape_->SetValue(0);
    momentShape_->SetLabelFormat("%.0f");
    buildSlider(momentSlider_, momentShape_, "iteration", 0.5, 0.95, &Stage::onMoment);
  }

  void look(const Vector& direction) {
    const Positions& p = session_.surface().positions;
    const Point middle = 0.5 * (p.colwise().minCoeff() + p.colwise().maxCoeff()).transpose();
    const double size = (p.colwise().maxCoeff() - p.colwise().minCoeff()).norm();
    const Point eye = middle + 2 * size * direction.normalized();
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->SetFocalPoint(middle.x(), middle.y(), middle.z());
    camera->SetPosition(eye.x(), eye.y(), eye.z());
    if (std::abs(direction.normalized().z()) > 0.95) {
      camera->SetViewUp(0, 1, 0);
    } else {
      camera->SetViewUp(0, 0, 1);
    }
    renderer_->ResetCamera();
    renderer_->ResetCameraClippingRange();
  }

  void place(const Positions& positions) {
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      points_->SetPoint(v, positions(v, 0), positions(v, 1), positions(v, 2));
    }
    points_->Modified();
  }

  /// Draws the state shown, its colours and the words about it.
  void refresh() {
    const std::size_t count = session_.momentCount();
    shown_ = count == 0 ? 0 : std::min(shown_, count - 1);
    TriangleMesh mesh = session_.surface();
    unfolding::IterationRecord record;
    if (count > 0) {
      Moment moment = session_.moment(shown_);
      mesh.positions = std::move(moment.positions);
      record = moment.record;
    }
    place(mesh.positions);
    paint(mesh);
    describe(record, count);
    if (count > 1) momentShape_->SetMaximumValue(static_cast<double>(count - 1));
    momentShape_->SetValue(static_cast<double>(shown_));
    renderer_->ResetCameraClippingRange();
    window_->Render();
  }

  [[nodiscard]] std::string mapName() const {
    return map_ < kOwnMaps ? kOwnMapNames[map_] : options_.maps[map_ - kOwnMaps].name;
  }

  /// Values of the map that is shown, of the state that is shown.
  [[nodiscard]] Eigen::VectorXd mapValues(const TriangleMesh& mesh) const {
    const Choice choice = session_.choice();
    const auto viewpoint = visibility::viewpoint(mesh.positions.colwise().mean().transpose() +
                                                 choice.distance * choice.direction.normalized());
    switch (map_) {
      case kFlux:
        return visibility::vertexFlux(mesh, viewpoint);
      case kSeen:
        return visibility::visibleFraction(mesh, viewpoint).vertex;
      case kAreaRatio:
        return geometry::vertexAreas(mesh).cwiseQuotient(
            geometry::vertexAreas(session_.surface()).cwiseMax(1e-12));
      default:
        return options_.maps[map_ - kOwnMaps].values;
    }
  }

  void paint(const TriangleMesh& mesh) {
    std::vector<Rgb> colours;
    if (map_ == kRegion) {
      colours.assign(static_cast<std::size_t>(mesh.vertexCount()), {205, 198, 190});
      for (const std::int32_t v : session_.preview().region.vertices) colours[v] = {88, 150, 214};
    } else {
      colours = paint_(mapName(), mapValues(mesh));
    }
    for (std::size_t v = 0; v < colours.size(); ++v) {
      colours_->SetTypedTuple(static_cast<vtkIdType>(v), colours[v].data());
    }
    colours_->Modified();
  }

  void describe(const unfolding::IterationRecord& record, std::size_t count) {
    const Preview& preview = session_.preview();
    char text[512];
    if (count == 0) {
      std::snprintf(text, sizeof text,
                    "region %zu faces, radius %.1f mm\naverage visibility %.3f\n%s",
                    preview.region.faces.size(), session_.choice().radius, preview.visibility,
                    preview.problem.c_str());
    } else {
      static constexpr const char* kWords[] = {"choosing", "running", "paused", "no further step"};
      std::snprintf(text, sizeof text,
                    "iteration %zu of %zu (%s)\naverage visibility %.3f\narea error %.2f %%, "
                    "edge strain %.1f %%\nmap: %s",
                    shown_, count - 1, kWords[static_cast<int>(session_.activity())],
                    record.visibility, 100 * record.areaErrorMean, 100 * record.edgeStrainMean,
                    mapName().c_str());
    }
    status_->SetInput((std::string(text) + (message_.empty() ? "" : "\n" + message_)).c_str());
  }

  void play(const std::string& path) {
    std::ifstream script(path);
    if (!script) throw IOError(path + ": cannot be read");
    std::string line;
    while (std::getline(script, line)) {
      std::istringstream words(line);
      std::string verb;
      if (!(words >> verb) || verb[0] == '#') continue;
      if (!playEvent(verb, words)) {
        throw InvalidInput(path + ": '" + line + "' is no event (key, drag, wait, saved, picture)");
      }
    }
  }

  bool playEvent(const std::string& verb, std::istringstream& words) {
    if (verb == "key") {
      std::string key;
      int x = 0, y = 0;
      if (!(words >> key >> x >> y)) return false;
      const char code = key.size() == 1 ? key[0] : '\0';
      interactor_->SetEventInformation(x, y, 0, 0, code, 0, key.c_str());
      interactor_->InvokeEvent(vtkCommand::KeyPressEvent);
      interactor_->InvokeEvent(vtkCommand::CharEvent);
    } else if (verb == "drag") {
      int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
      if (!(words >> x0 >> y0 >> x1 >> y1)) return false;
      interactor_->SetEventInformation(x0, y0);
      interactor_->InvokeEvent(vtkCommand::LeftButtonPressEvent);
      interactor_->SetEventInformation(x1, y1);
      interactor_->InvokeEvent(vtkCommand::MouseMoveEvent);
      interactor_->InvokeEvent(vtkCommand::LeftButtonReleaseEvent);
    } else if (verb == "wait") {
      std::size_t states = 0;
      if (!(words >> states)) return false;
      while (session_.activity() == Activity::Running && session_.momentCount() < states) pass();
    } else if (verb == "saved") {
      while (saving_.valid()) pass();
    } else if (verb == "picture") {
      std::string file;
      if (!(words >> file)) return false;
      savePicture(file);
    } else {
      return false;
    }
    return true;
  }

  /// A little time goes by, as between two frames.
  void pass() {
    std::this_thread::sleep_for(std::chrono::milliseconds(kFrameMilliseconds));
    onTimer();
  }

  void onTimer() {
    if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      message_ = saving_.get();
      refresh();
    }
    const std::size_t count = session_.momentCount();
    if (count == seen_ || !follow_) return;
    seen_ = count;
    shown_ = count > 0 ? count - 1 : 0;
    refresh();
  }

  /// Characters that VTK's style would take for itself (w wireframe, e exit, ...) are ours.
  void onChar() {}

  void onKey() {
    const std::string key = interactor_->GetKeySym() ? interactor_->GetKeySym() : "";
    message_.clear();
    if (key == "c") pickCentre();
    if (key == "v") takeView();
    if (key == "space") toggle();
    if (key == "Left" && shown_ > 0) step(shown_ - 1);
    if (key == "Right") step(shown_ + 1);
    if (key == "Home") step(0);
    if (key == "End") step(session_.momentCount());
    if (key == "m") map_ = (map_ + 1) % (kOwnMaps + options_.maps.size());
    if (key == "r") session_.reset(), shown_ = seen_ = 0;
    if (key == "w") saveState();
    if (key == "h") help_->SetVisibility(!help_->GetVisibility());
    if (key == "q") {
      interactor_->TerminateApp();
      return;
    }
    refresh();
  }

  void pickCentre() {
    const int* at = interactor_->GetEventPosition();
    vtkNew<vtkCellPicker> picker;
    picker->SetTolerance(1e-4);
    picker->AddPickList(actor_);
    picker->PickFromListOn();
    if (!picker->Pick(at[0], at[1], 0, renderer_)) {
      message_ = "no surface under the pointer";
      return;
    }
    const double* where = picker->GetPickPosition();
    Choice choice = session_.choice();
    choice.centre = session_.nearestVertex(Point(where[0], where[1], where[2]));
    choose(choice);
  }

  void takeView() {
    vtkCamera* camera = renderer_->GetActiveCamera();
    Choice choice = session_.choice();
    double towards[3];
    camera->GetDirectionOfProjection(towards);
    choice.direction = -Vector(towards[0], towards[1], towards[2]);
    choose(choice);
  }

  void choose(const Choice& choice) {
    if (session_.activity() == Activity::Running) {
      message_ = "running: pause (space) before you change the choice";
      return;
    }
    session_.choose(choice);
    shown_ = seen_ = 0;
  }

  void toggle() {
    if (session_.activity() == Activity::Running) {
      session_.pause();
      step(session_.momentCount() - 1);
    } else {
      follow_ = true;
      session_.run();
    }
  }

  void step(std::size_t number) {
    follow_ = number + 1 >= session_.momentCount();
    shown_ = number;
  }

  void saveState() {
    session_.pause();
    if (session_.momentCount() == 0) {
      message_ = "nothing to save before the first iteration";
    } else if (saving_.valid()) {
      message_ = "still saving";
    } else {
      saving_ = save_(session_, shown_);
      message_ = "saving ...";
    }
  }

  void onRadius() {
    Choice choice = session_.choice();
    choice.radius = radiusShape_->GetValue();
    choose(choice);
    refresh();
  }

  void onMoment() {
    step(static_cast<std::size_t>(std::lround(momentShape_->GetValue())));
    refresh();
  }

  void savePicture(const std::string& path) {
    window_->Render();
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window_);
    grab->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputConnection(grab->GetOutputPort());
    writer->Write();
  }

  Session& session_;
  const Paint& paint_;
  const Save& save_;
  const WindowOptions& options_;
  std::size_t shown_ = 0;  ///< state in the picture
  std::size_t seen_ = 0;   ///< states that the picture knows of
  bool follow_ = true;     ///< the picture goes with the newest state
  std::size_t map_ = kRegion;
  std::string message_;
  std::future<std::string> saving_;

  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkPolyData> mesh_;
  vtkNew<vtkUnsignedCharArray> colours_;
  vtkNew<vtkPolyDataNormals> normals_;
  vtkNew<vtkPolyDataMapper> mapper_;
  vtkNew<vtkActor> actor_;
  vtkNew<vtkTextActor> status_;
  vtkNew<vtkTextActor> help_;
  vtkNew<vtkSliderWidget> radiusSlider_;
  vtkNew<vtkSliderRepresentation2D> radiusShape_;
  vtkNew<vtkSliderWidget> momentSlider_;
  vtkNew<vtkSliderRepresentation2D> momentShape_;
};

}  // namespace

void showWindow(Session& session, const Paint& paint, const Save& save,
                const WindowOptions& options) {
  requireDisplay();
  Stage(session, paint, save, options).run();
}

}  // namespace explica::viewer
