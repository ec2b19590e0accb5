// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Stage.h"
#include "Explica/Core/EigenViews.h"

#include <vtkActor.h>
#include <vtkAnnotatedCubeActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellPicker.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkLookupTable.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkQuadricClustering.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::viewer {
namespace {

constexpr Eigen::Index kManyFaces = 60000;  // above it, turning shows a coarser surface
constexpr int kCoarseCells = 55;            // of it, along each axis of the surface's box
constexpr int kSamples = 4;                 // of a pixel against jagged edges, while nothing turns

/// Round numbers from low to high, 1, 2 or 5 times a power of ten apart, three to seven of them.
std::vector<double> roundValues(double low, double high) {
  const double least = (high - low) / 6;
  double step = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {2.0, 2.5, 2.0}) {
    if (step < least) step *= factor;
  }
  std::vector<double> values;
  constexpr double kRoundOff = 1e-9;  // of a step
  for (double n = std::ceil(low / step - kRoundOff); n * step <= high + kRoundOff * step; ++n) {
    values.push_back(n * step + 0.0);
  }
  return values;
}

vtkNew<vtkCellArray> cellsOf(const Faces& faces, const std::vector<std::int32_t>& chosen) {
  vtkNew<vtkCellArray> cells;
  for (const std::int32_t f : chosen) {
    const vtkIdType corners[3] = {faces(f, 0), faces(f, 1), faces(f, 2)};
    cells->InsertNextCell(3, corners);
  }
  return cells;
}

}  // namespace

Stage::Stage(const TriangleMesh& surface) : surface_(surface), positions_(surface.positions) {
  buildSurface();
  buildRim();
  renderer_->SetBackground(0.97, 0.975, 0.98);
  bar_->SetLookupTable(barColours_);
  bar_->SetPosition(0.93, 0.3);
  bar_->SetWidth(0.06);
  bar_->SetHeight(0.4);
  bar_->SetBarRatio(0.3);
  bar_->SetUnconstrainedFontSize(true);
  barTitle_->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  barTitle_->SetPosition(0.985, 0.73);
  barTitle_->GetTextProperty()->SetJustificationToRight();
  showBar(false);
  for (vtkTextProperty* text : {bar_->GetLabelTextProperty(), barTitle_->GetTextProperty()}) {
    text->SetColor(0.1, 0.1, 0.1);
    text->SetFontSize(15);
    text->ShadowOff();
    text->BoldOff();
    text->ItalicOff();
  }
  renderer_->AddActor2D(bar_);
  renderer_->AddActor2D(barTitle_);
}

Stage::~Stage() = default;

void Stage::buildSurface() {
  points_->SetDataTypeToFloat();
  points_->SetNumberOfPoints(surface_.vertexCount());
  mesh_->SetPoints(points_);
  mesh_->SetPolys(cellsOf(surface_.faces, surface_.allFaces()));
  faceColours_->SetNumberOfComponents(3);
  normals_->SetInputData(mesh_);
  normals_->SplittingOff();
  normals_->ConsistencyOff();
  mapper_->SetInputConnection(normals_->GetOutputPort());
  for (vtkPolyDataMapper* mapper : {mapper_.Get(), coarseMapper_.Get()}) {
    mapper->SetLookupTable(barColours_);
    mapper->UseLookupTableScalarRangeOn();
  }
  actor_->SetMapper(mapper_);
  actor_->GetProperty()->SetSpecular(0.1);
  actor_->GetProperty()->SetAmbient(0.15);
  actor_->GetProperty()->SetDiffuse(0.85);
  renderer_->AddActor(actor_);
  picker_->SetTolerance(1e-4);
  picker_->AddPickList(actor_);
  picker_->PickFromListOn();
  place(surface_.positions);
}

void Stage::buildRim() {
  region_->SetPoints(points_);
  vtkNew<vtkFeatureEdges> rim;
  rim->SetInputData(region_);
  rim->FeatureEdgesOff();
  rim->NonManifoldEdgesOff();
  rim->ColoringOff();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(rim->GetOutputPort());
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyLineOffsetParameters(0, -8);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.05, 0.06, 0.08);
  actor->GetProperty()->SetLineWidth(3);
  actor->GetProperty()->LightingOff();
  actor->PickableOff();
  renderer_->AddActor(actor);
}

void Stage::enter(vtkRenderWindow& window, vtkRenderWindowInteractor& interactor) {
  window_ = &window;
  window.SetMultiSamples(kSamples);
  window.AddRenderer(renderer_);
  vtkNew<vtkAnnotatedCubeActor> cube;
  cube->SetXPlusFaceText("R");
  cube->SetXMinusFaceText("L");
  cube->SetYPlusFaceText("A");
  cube->SetYMinusFaceText("P");
  cube->SetZPlusFaceText("S");
  cube->SetZMinusFaceText("I");
  cube->GetCubeProperty()->SetColor(0.82, 0.85, 0.88);
  cube->GetTextEdgesProperty()->SetColor(0.1, 0.1, 0.1);
  cube_->SetOrientationMarker(cube);
  cube_->SetInteractor(&interactor);
  cube_->SetViewport(0, 0, 0.12, 0.16);
  cube_->SetEnabled(1);
  cube_->InteractiveOff();
  if (surface_.faceCount() > kManyFaces) coarsenWhileTurning(interactor);
}

void Stage::coarsenWhileTurning(vtkRenderWindowInteractor& interactor) {
  vtkNew<vtkQuadricClustering> coarse;
  coarse->SetInputConnection(normals_->GetOutputPort());
  coarse->SetNumberOfDivisions(kCoarseCells, kCoarseCells, kCoarseCells);
  coarse->CopyCellDataOff();
  coarse->AutoAdjustNumberOfDivisionsOff();
  coarse->UseInputPointsOn();
  coarseMapper_->SetInputConnection(coarse->GetOutputPort());
  const auto listen = [&](unsigned long event, bool turning) {
    struct Bound {
      Stage* stage;
      bool turning;
    };
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(new Bound{this, turning});
    command->SetClientDataDeleteCallback([](void* data) { delete static_cast<Bound*>(data); });
    command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
      const auto* bound = static_cast<Bound*>(data);
      Stage& stage = *bound->stage;
      stage.actor_->SetMapper(bound->turning ? stage.coarseMapper_ : stage.mapper_);
      if (stage.window_ != nullptr) stage.window_->SetMultiSamples(bound->turning ? 0 : kSamples);
    });
    interactor.GetInteractorStyle()->AddObserver(event, command, 1.0f);
  };
  listen(vtkCommand::StartInteractionEvent, true);
  listen(vtkCommand::EndInteractionEvent, false);
}

void Stage::render() {
  renderer_->ResetCameraClippingRange();
  if (window_ != nullptr) window_->Render();
}

void Stage::place(const Positions& positions) {
  positions_ = positions;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    points_->SetPoint(v, positions(v, 0), positions(v, 1), positions(v, 2));
  }
  points_->Modified();
}

void Stage::paint(const std::vector<Rgb>& colours) {
  mesh_->GetPointData()->SetScalars(nullptr);
  faceColours_->SetNumberOfTuples(colours.size());
  std::copy(colours.front().data(), colours.back().data() + 3, faceColours_->GetPointer(0));
  faceColours_->Modified();
  mesh_->GetCellData()->SetScalars(faceColours_);
  mapper_->SetScalarModeToUseCellData();
  showBar(false);
}

void Stage::showBar(bool shown) {
  bar_->SetVisibility(shown);
  barTitle_->SetVisibility(shown);
}

void Stage::paint(const Eigen::VectorXd& values, const report::ColourScale& scale) {
  mesh_->GetCellData()->SetScalars(nullptr);
  values_->SetNumberOfValues(values.size());
  std::copy(values.begin(), values.end(), values_->GetPointer(0));
  values_->Modified();
  mesh_->GetPointData()->SetScalars(values_);
  mapper_->SetScalarModeToUsePointData();
  const auto onScreen = [](const report::Colour& c, int k) {
    return report::encodeSrgb(c[k]) / 255.0;
  };
  constexpr int kColours = 256;
  barColours_->SetNumberOfTableValues(kColours);
  for (int n = 0; n < kColours; ++n) {
    const report::Colour c = report::colourAt(scale.map, n / (kColours - 1.0));
    barColours_->SetTableValue(n, onScreen(c, 0), onScreen(c, 1), onScreen(c, 2));
  }
  const report::Colour unknown = report::colourAt(scale.map, kNaN);
  barColours_->SetNanColor(onScreen(unknown, 0), onScreen(unknown, 1), onScreen(unknown, 2), 1);
  barColours_->SetRange(scale.low, scale.high);
  vtkNew<vtkDoubleArray> ticks;
  for (const double value : roundValues(scale.low, scale.high)) ticks->InsertNextValue(value);
  bar_->SetUseCustomLabels(true);
  bar_->SetCustomLabels(ticks);
  showBar(true);
  barTitle_->SetInput((scale.title + (scale.unit.empty() ? "" : " [" + scale.unit + "]")).c_str());
  const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
  const double shares = std::max(1.0, largest / std::max(1e-300, scale.high - scale.low));
  const int digits = std::min(9, 3 + static_cast<int>(std::log10(shares)));
  bar_->SetLabelFormat(("%-." + std::to_string(digits) + "g").c_str());
}

void Stage::showRim(const std::vector<std::int32_t>& regionFaces) {
  region_->SetPolys(cellsOf(surface_.faces, regionFaces));
}

void Stage::look(const Vector& direction) {
  const Eigen::AlignedBox3d box = boundingBox(positions_);
  const Point middle = box.center();
  const Point eye = middle + 2 * box.diagonal().norm() * direction.normalized();
  vtkCamera* camera = renderer_->GetActiveCamera();
  camera->SetFocalPoint(middle.x(), middle.y(), middle.z());
  camera->SetPosition(eye.x(), eye.y(), eye.z());
  constexpr double kUpright = 0.95;  // nearer to the head's axis than this, anterior is up
  const bool along = std::abs(direction.normalized().z()) > kUpright;
  camera->SetViewUp(0, along ? 1 : 0, along ? 0 : 1);
  double bounds[6];
  for (int axis = 0; axis < 3; ++axis) {
    bounds[2 * axis] = box.min()[axis];
    bounds[2 * axis + 1] = box.max()[axis];
  }
  renderer_->ResetCamera(bounds);
}

Vector Stage::direction() const {
  double towards[3];
  renderer_->GetActiveCamera()->GetDirectionOfProjection(towards);
  return -Vector(towards[0], towards[1], towards[2]);
}

std::optional<std::int32_t> Stage::pick(double x, double y) {
  if (picker_->Pick(std::floor(x), std::floor(y), 0, renderer_) == 0) return {};
  const auto vertex = static_cast<std::int32_t>(picker_->GetPointId());
  return vertex < 0 ? std::nullopt : std::optional(vertex);
}

}  // namespace explica::viewer
