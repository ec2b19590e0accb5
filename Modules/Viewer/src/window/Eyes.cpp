// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Eyes.h"

#include <vtkActor.h>
#include <vtkArrowSource.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkLineSource.h>
#include <vtkMatrix4x4.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <cmath>

namespace explica::viewer {
namespace {

constexpr std::array kColour = {0.42, 0.24, 0.70};  // violet
constexpr double kBall = 0.03;           // radius of a ball of mean weight, share of the reach
constexpr double kFarBall = 0.02;        // of one outside the picture, share of its distance
constexpr double kSmallBall = 0.015;     // of one on a line, share of the reach
constexpr double kThickness = 0.045;     // of an arrow of mean weight, share of the reach
constexpr double kTowardsEye = 0.97;     // cosine: what is nearer to the line of sight is left out
constexpr std::size_t kManyPoints = 16;  // of more than these one arrow stands for all

template <class Source>
vtkSmartPointer<vtkActor> actorOf(Source& source) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(source.GetOutputPort());
  const auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

vtkSmartPointer<vtkPolyData> dataOf(const TriangleMesh& mesh) {
  vtkNew<vtkPoints> points;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    points->InsertNextPoint(mesh.positions(v, 0), mesh.positions(v, 1), mesh.positions(v, 2));
  }
  vtkNew<vtkCellArray> cells;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const vtkIdType corners[3] = {mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
    cells->InsertNextCell(3, corners);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

}  // namespace

Eyes::Eyes(vtkRenderer& renderer) : renderer_(renderer) {
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(this);
  command->SetCallback(
      [](vtkObject*, unsigned long, void* eyes, void*) { static_cast<Eyes*>(eyes)->suitCamera(); });
  observer_ = renderer_.AddObserver(vtkCommand::StartEvent, command);
}

Eyes::~Eyes() {
  renderer_.RemoveObserver(observer_);
}

void Eyes::add(vtkSmartPointer<vtkActor> actor) {
  actor->GetProperty()->SetColor(kColour[0], kColour[1], kColour[2]);
  actor->PickableOff();
  renderer_.AddActor(actor);
  actors_.push_back(std::move(actor));
}

void Eyes::addBall(const Point& centre, double radius) {
  vtkNew<vtkSphereSource> ball;
  ball->SetCenter(centre.x(), centre.y(), centre.z());
  ball->SetRadius(radius);
  ball->SetThetaResolution(20);
  ball->SetPhiResolution(20);
  add(actorOf(*ball.Get()));
  marks_.push_back({actors_.back(), (centre - from_).normalized()});
}

void Eyes::addArrow(const Point& to, double length, double thickness) {
  if (!(length > 0)) return;
  const Vector along = (to - from_).normalized();
  vtkNew<vtkArrowSource> arrow;  // from the origin along x, 1 long
  arrow->SetTipLength(2.5 * thickness / length);
  arrow->SetTipRadius(0.5 * thickness / length);
  arrow->SetShaftRadius(0.12 * thickness / length);
  arrow->SetTipResolution(20);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector::UnitX(), along);
  const Eigen::Matrix3d axes = length * turn.toRotationMatrix();
  vtkNew<vtkMatrix4x4> place;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) place->SetElement(row, column, axes(row, column));
    place->SetElement(row, 3, from_[row]);
  }
  add(actorOf(*arrow.Get()));
  actors_.back()->SetUserMatrix(place);
  marks_.push_back({actors_.back(), along});
}

void Eyes::addGlass(const TriangleMesh& mesh) {
  const auto data = dataOf(mesh);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  glass_ = vtkSmartPointer<vtkActor>::New();
  glass_->SetMapper(mapper);
  glass_->GetProperty()->SetOpacity(0.3);
  add(glass_);
  glassFaces_ = vtkSmartPointer<vtkStaticCellLocator>::New();
  glassFaces_->SetDataSet(data);
  glassFaces_->BuildLocator();
}

void Eyes::show(const View& view, const visibility::Viewpoints& points, const Point& from,
                double reach) {
  for (const auto& actor : actors_) renderer_.RemoveActor(actor);
  actors_.clear();
  marks_.clear();
  glass_ = nullptr;
  from_ = from;
  const auto arrow = [&](const Point& to, double size) {
    addArrow(to, std::min((to - from_).norm(), reach), size * kThickness * reach);
  };
  const std::size_t count = points.points.size();
  if (count > kManyPoints) {
    Point mean = Point::Zero();
    for (std::size_t n = 0; n < count; ++n) mean += points.weights[n] * points.points[n];
    arrow(mean, 1);
  }
  for (std::size_t n = 0; n < count && count <= kManyPoints; ++n) {
    const double size = std::cbrt(static_cast<double>(count) * points.weights[n]);
    const double off = (points.points[n] - from_).norm();
    arrow(points.points[n], size);
    const double ball = off > reach ? kFarBall * off : kBall * reach;
    addBall(points.points[n], size * (view.kind == ViewKind::Points ? ball : kSmallBall * reach));
  }
  if (view.kind == ViewKind::Line) {
    Point start = view.line[0], end = view.line[1];
    vtkNew<vtkLineSource> rod;
    rod->SetPoint1(start.data());
    rod->SetPoint2(end.data());
    add(actorOf(*rod.Get()));
    actors_.back()->GetProperty()->SetLineWidth(4);
    actors_.back()->GetProperty()->LightingOff();
  }
  if (view.kind == ViewKind::Surface && view.surface) addGlass(view.surface->mesh);
}

void Eyes::setShown(bool shown) {
  shown_ = shown;
}

void Eyes::suitCamera() {
  double eye[3];
  renderer_.GetActiveCamera()->GetPosition(eye);
  const Vector sight = Point(eye[0], eye[1], eye[2]) - from_;
  for (const auto& actor : actors_) actor->SetVisibility(shown_);
  for (const Mark& mark : marks_) {
    mark.actor->SetVisibility(shown_ && mark.towards.dot(sight.normalized()) < kTowardsEye);
  }
  if (glass_ == nullptr) return;
  double share = 0, place[3], parametric[3];
  int part = 0;
  vtkIdType face = 0;
  const bool between = glassFaces_->IntersectWithLine(eye, from_.data(), 0, share, place,
                                                      parametric, part, face) != 0;
  if (between) {
    glass_->GetProperty()->SetRepresentationToWireframe();
  } else {
    glass_->GetProperty()->SetRepresentationToSurface();
  }
}

}  // namespace explica::viewer
