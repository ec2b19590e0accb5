// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Core/Errors.h"
#include "Explica/Report/Figure.h"

namespace explica::python {
namespace {

using namespace py::literals;
using report::Picture;

/// Array (height, width, 3) over the picture's own memory.
py::array arrayOfPicture(Picture&& picture) {
  auto* kept = new std::vector<std::uint8_t>(std::move(picture.rgb));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<std::uint8_t>*>(p); });
  return py::array_t<std::uint8_t>({picture.height, picture.width, 3}, kept->data(), owner);
}

report::ColourScale scaleOf(const Eigen::VectorXd& values, const std::string& title,
                            const std::string& unit,
                            const std::optional<std::pair<double, double>>& range,
                            const std::optional<std::string>& colours) {
  std::optional<report::ColourMap> map;
  if (colours) map = valueOf<report::ColourMap>(*colours);
  report::ColourScale scale = report::scaleFor(values, title, unit, map);
  if (range) std::tie(scale.low, scale.high) = *range;
  return scale;
}

std::vector<report::FigureView> viewsOf(const std::vector<std::string>& names,
                                        const std::optional<Vector>& towards, const Vector& up,
                                        const std::vector<std::int32_t>& focus) {
  std::vector<report::FigureView> views;
  if (towards) {
    report::FigureView view;
    view.towards = *towards;
    view.up = up;
    view.focus = focus;
    views.push_back(view);
    return views;
  }
  for (const std::string& name : names) {
    report::FigureView view{.name = valueOf<report::ViewName>(name), .focus = focus};
    views.push_back(view);
  }
  return views;
}

void bindPictures(py::module_& m) {
  defWithOptions<report::SurfacePictureOptions>(
      m, "picture",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::optional<Eigen::VectorXd>& values, const std::vector<std::string>& views,
         const std::optional<Vector>& towards, const Vector& up,
         const std::vector<std::int32_t>& focus, const std::string& title, const std::string& unit,
         const std::optional<std::pair<double, double>>& range,
         const std::optional<std::string>& colours, const py::kwargs& keywords) {
        const auto options = optionsOf<report::SurfacePictureOptions>(keywords);
        const TriangleMesh mesh = meshOf(positions, faces);
        report::SurfacePaint paint;
        if (values) {
          if (values->size() != mesh.vertexCount()) {
            throw InvalidInput("values: one a vertex, " + std::to_string(mesh.vertexCount()) +
                               ", are needed, not " + std::to_string(values->size()));
          }
          paint.values = *values;
          paint.scale = scaleOf(*values, title, unit, range, colours);
        }
        for (const std::int32_t v : focus) {
          if (v < 0 || v >= mesh.vertexCount()) throw InvalidInput("focus: no such vertex");
        }
        const auto chosen = viewsOf(views, towards, up, focus);
        return arrayOfPicture(unlocked([&] {
          return report::surfaceFigure(mesh, paint, chosen, static_cast<int>(chosen.size()),
                                       options);
        }));
      },
      "Views of a surface side by side as pixels (height, width, 3), uint8 sRGB, drawn on the CPU\n"
      "without a display.  `values` (V,) colour it, with a bar; `views` of left, right, front, "
      "back,\n"
      "top, bottom, or one view along the direction `towards` (3,) with `up` (3,) upwards, RAS;\n"
      "`focus`: vertices to fill the picture with; range: values of the first and last colour;\n"
      "colours: sequential, heat, diverging or grey.",
      "positions"_a, "faces"_a, "values"_a = py::none(),
      "views"_a = std::vector<std::string>{"left"}, "towards"_a = py::none(),
      "up"_a = Vector(0, 0, 1), "focus"_a = std::vector<std::int32_t>{}, "title"_a = "",
      "unit"_a = "", "range"_a = py::none(), "colours"_a = py::none());
  m.def(
      "slices",
      [](const py::array& image, const Eigen::Matrix4d& affine,
         const std::vector<std::pair<Positions, Faces>>& surfaces, int count, int height) {
        if (count < 1 || height < 16) {
          throw InvalidInput("count and height: at least 1 slice of 16 pixels is needed");
        }
        const Volume<float> volume = scalarVolume(image, affine);
        std::vector<TriangleMesh> meshes;
        for (const auto& [positions, faces] : surfaces) meshes.push_back(meshOf(positions, faces));
        constexpr std::array<report::Colour, 3> kColours = {
            {{1, 0.2F, 0}, {0.1F, 0.8F, 0.2F}, {0.2F, 0.5F, 1}}};
        std::vector<report::Contour> contours;
        for (std::size_t n = 0; n < meshes.size(); ++n) {
          contours.push_back({&meshes[n], kColours[n % kColours.size()]});
        }
        return arrayOfPicture(
            unlocked([&] { return report::sliceFigure(volume, contours, count, height); }));
      },
      "image"_a, "affine"_a, "surfaces"_a = std::vector<std::pair<Positions, Faces>>{},
      "count"_a = 3, "height"_a = 300,
      "Sagittal, coronal and axial slices, `count` of each and `height` pixels high, with the cut\n"
      "lines of surfaces [(positions (V, 3) RAS mm, faces (F, 3))]: pixels (height, width, 3), "
      "uint8.");
}

}  // namespace

void bindReport(py::module_& parent) {
  py::module_ m = parent.def_submodule("report");
  bindPictures(m);
}

}  // namespace explica::python
