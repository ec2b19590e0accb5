// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/StudyReport.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Verify.h"
#include "Explica/Report/Chart.h"
#include "Explica/Report/Drawing.h"
#include "Explica/Report/Figure.h"
#include "Table.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <set>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr int kMostFrames = 60;  // in the interactive view
constexpr double kAreaErrorGood =
    0.02;  // mean; the printed area of a map is trusted to a few per cent
constexpr double kAreaErrorBad = 0.10;

/// One command's output folder.
struct StepFolder {
  std::string name;
  std::string command;
  fs::path folder;
  Json record;
  Json summary;

  [[nodiscard]] std::optional<double> number(const char* key) const {
    const auto found = summary.find(key);
    if (found == summary.end() || !found->is_number()) return {};
    return found->get<double>();
  }
  [[nodiscard]] bool has(const char* file) const { return fs::exists(folder / file); }
};

/// A run's or command's folder, read once.
class Study {
 public:
  Study(const fs::path& folder, const Monitor& monitor, report::ReportContent& content)
      : monitor_(monitor), content_(content) {
    notes_ = readRunState(folder / kRunStateName);
    if (notes_.empty() && fs::exists(folder / provenance::kRecordName)) {
      add(folder, folder.filename().string());
    }
    for (const StepNote& note : notes_) {
      if (fs::exists(folder / note.name / provenance::kRecordName))
        add(folder / note.name, note.name);
    }
    if (notes_.empty() && steps_.empty()) {
      std::set<fs::path> folders;
      for (const auto& entry : fs::directory_iterator(folder)) {
        if (fs::exists(entry.path() / provenance::kRecordName)) folders.insert(entry.path());
      }
      for (const fs::path& f : folders) add(f, f.filename().string());
    }
    if (steps_.empty() && notes_.empty()) {
      throw InvalidInput(folder.string() +
                         ": holds no provenance.json; give the --out folder of a command or run");
    }
  }

  [[nodiscard]] const std::vector<StepNote>& notes() const { return notes_; }
  [[nodiscard]] const std::vector<StepFolder>& steps() const { return steps_; }
  [[nodiscard]] const StepFolder* step(std::string_view command) const {
    for (const StepFolder& s : steps_) {
      if (s.command == command) return &s;
    }
    return nullptr;
  }

  /// Does a part of the report; what goes wrong leaves only that part out.
  void attempt(const std::string& what, const std::function<void()>& part) {
    try {
      part();
    } catch (const Error& fault) {
      monitor_.warn("report: " + what + " left out: " + fault.what());
      content_.flags.push_back({report::FlagLevel::Notice, what + " left out:", fault.what()});
    }
  }

 private:
  void add(const fs::path& folder, const std::string& name) {
    StepFolder step;
    step.name = name;
    step.folder = folder;
    attempt("record of " + name, [&] {
      step.record = provenance::readRecord(folder / provenance::kRecordName);
      step.command = step.record.value("command", "");
      if (fs::exists(folder / provenance::kSummaryName)) {
        step.summary = provenance::readJson(folder / provenance::kSummaryName);
      }
      steps_.push_back(std::move(step));
    });
  }

  const Monitor& monitor_;
  report::ReportContent& content_;
  std::vector<StepNote> notes_;
  std::vector<StepFolder> steps_;
};

std::string plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g", value.get<double>());
    return text.data();
  }
  return value.dump();
}

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f %%", 100 * share);
  return text.data();
}

std::string count(double value) {
  return std::to_string(static_cast<long long>(std::llround(value)));
}

report::ReportStep reportStep(const StepFolder& step) {
  report::ReportStep out;
  out.name = step.name;
  const Json execution = step.record.value("execution", Json::object());
  out.seconds = execution.value("seconds", 0.0);
  if (execution.contains("argv")) {
    for (const Json& word : execution["argv"])
      out.commandLine += (out.commandLine.empty() ? "" : " ") + plain(word);
  }
  if (step.record.contains("software")) {
    const Json& software = step.record["software"];
    out.version =
        "explica " + software.value("version", "") + ", commit " + software.value("commit", "");
  }
  const std::string termination = step.record.value("termination", "not-run");
  if (step.record.value("exit_code", 0) != 0) {
    out.state = report::StepState::StoppedEarly;
    out.message = "stopped: " + termination;
  }
  for (const auto& [key, value] : step.summary.items()) {
    if (key != "warnings" && key != "command" && !value.is_object() && !value.is_null())
      out.numbers.emplace_back(key, plain(value));
  }
  const Json options = step.record.value("options", Json::object());
  for (const auto& [key, value] : options.items()) out.options.emplace_back(key, plain(value));
  const Json warnings = step.record.value("warnings", Json::array());
  for (const Json& warning : warnings) out.warnings.push_back(plain(warning));
  return out;
}

using report::FlagLevel;

void flagSurface(const StepFolder& step, std::vector<report::ReportFlag>& flags) {
  if (const auto chi = step.number("euler_characteristic")) {
    flags.push_back({*chi == 2 ? FlagLevel::Good : FlagLevel::Bad, "Topology:",
                     "Euler characteristic " + count(*chi) +
                         (*chi == 2 ? ", a sphere's" : ", not a sphere's 2")});
  }
  if (const auto defects = step.number("defects_corrected"); defects && *defects > 0) {
    flags.push_back({FlagLevel::Notice, "Topology corrected:",
                     count(*defects) + " defects, " +
                         count(step.number("voxels_changed").value_or(0)) +
                         " voxels changed (topology.tsv lists them)"});
  }
  if (const auto pairs = step.number("self_intersections")) {
    flags.push_back(
        {*pairs == 0 ? FlagLevel::Good : FlagLevel::Bad, "Surface meets itself:",
         *pairs == 0 ? "nowhere, by an exact test" : "at " + count(*pairs) + " pairs of faces"});
  }
  if (const auto thickness = step.number("thickness_mean")) {
    const bool usual = *thickness > 1.5 && *thickness < 3.5;
    flags.push_back({usual ? FlagLevel::Good : FlagLevel::Notice, "Mean thickness:",
                     plain(*thickness) + " mm" + (usual ? "" : ", unusual for an adult's cortex")});
  }
}

void flagThickness(const StepFolder& step, std::vector<report::ReportFlag>& flags) {
  if (const auto recovered = step.number("sulcal_voxels_recovered"); recovered && *recovered > 0) {
    flags.push_back(
        {FlagLevel::Notice, "Hidden sulci recovered:", count(*recovered) + " voxels changed"});
  }
}

void flagUnfold(const StepFolder& step, std::vector<report::ReportFlag>& flags) {
  const auto before = step.number("self_intersections_initial");
  const auto after = step.number("self_intersections_final");
  if (after) {
    const bool good = *after <= before.value_or(0);
    flags.push_back({*after == 0 ? FlagLevel::Good : (good ? FlagLevel::Notice : FlagLevel::Bad),
                     "Unfolded surface meets itself:",
                     *after == 0 ? "nowhere, by an exact test"
                                 : "at " + count(*after) + " pairs of faces, " +
                                       count(before.value_or(0)) + " at the start"});
  }
  if (const auto area = step.number("area_error_mean")) {
    flags.push_back({*area < kAreaErrorGood
                         ? FlagLevel::Good
                         : (*area < kAreaErrorBad ? FlagLevel::Notice : FlagLevel::Bad),
                     "Areas kept:",
                     "mean error " + percent(*area) + ", largest " +
                         percent(step.number("area_error_max").value_or(kNaN))});
  }
  if (const auto visibility = step.number("visibility_final")) {
    flags.push_back(
        {*visibility > 0.9 ? FlagLevel::Good : FlagLevel::Notice, "Average visibility:",
         plain(step.number("visibility_initial").value_or(kNaN)) + " at the start, " +
             plain(*visibility) + " at the end" +
             (step.summary.contains("stop_reason") ? " (" + plain(step.summary["stop_reason"]) + ")"
                                                   : "")});
  }
}

void flagSteps(const Study& study, report::ReportContent& content) {
  for (const report::ReportStep& step : content.steps) {
    if (step.state == report::StepState::Failed)
      content.flags.push_back({FlagLevel::Bad, step.name + " failed:", step.message});
    if (step.state == report::StepState::StoppedEarly)
      content.flags.push_back({FlagLevel::Notice, step.name + " stopped early:", step.message});
    if (step.state == report::StepState::Missing)
      content.flags.push_back({FlagLevel::Notice, step.name + " was not run:", step.message});
    for (const std::string& warning : step.warnings)
      content.flags.push_back({FlagLevel::Notice, step.name + ":", warning});
  }
  for (const StepFolder& step : study.steps()) {
    if (step.command == "surface") flagSurface(step, content.flags);
    if (step.command == "thickness") flagThickness(step, content.flags);
    if (step.command == "unfold") flagUnfold(step, content.flags);
  }
  std::stable_sort(content.flags.begin(), content.flags.end(), [](const auto& a, const auto& b) {
    return static_cast<int>(a.level) > static_cast<int>(b.level);
  });
}

/// The file that a step read under a role, where it lies now.
std::optional<fs::path> inputOf(const StepFolder& step, std::string_view role) {
  const Json inputs = step.record.value("inputs", Json::array());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].value("role", "") == role) {
      return provenance::locateInput(step.record, i, step.folder / provenance::kRecordName);
    }
  }
  return {};
}

std::optional<io::VertexMap> mapNamed(const fs::path& file, Eigen::Index vertexCount,
                                      std::string_view name) {
  if (!fs::exists(file)) return {};
  for (io::VertexMap& map : io::readVertexMaps(file, vertexCount)) {
    if (map.name == name || name.empty()) return std::move(map);
  }
  return {};
}

report::SurfacePaint paintOf(const io::VertexMap& map) {
  report::SurfacePaint paint;
  paint.values = map.values;
  paint.scale = report::scaleFor(map.values, map.name, map.unit);
  return paint;
}

std::vector<report::FigureView> bothSides() {
  report::FigureView left;
  left.name = report::ViewName::Left;
  report::FigureView right;
  right.name = report::ViewName::Right;
  return {left, right};
}

report::SurfacePictureOptions pictureSize(int width, int height) {
  report::SurfacePictureOptions options;
  options.width = width;
  options.height = height;
  return options;
}

void showSegmentation(const StepFolder& step, report::ReportContent& content) {
  const char* file = step.has("hemisphere.nii.gz") ? "hemisphere.nii.gz" : "seg.nii.gz";
  const Volume<Label> labels = io::readLabels(step.folder / file).volume;
  Volume<float> tissue(labels.grid, 0.0f);
  for (std::size_t v = 0; v < labels.size(); ++v) tissue[v] = labels[v] != 0 ? 1.0f : 0.0f;
  const report::WorldBox box = report::boxAbove(tissue, 0);
  if (box.empty()) return;
  std::vector<report::Picture> slices;
  const Point middle = 0.5 * (box.low + box.high);
  constexpr int kHeight = 300;
  Point inHalf = middle;
  if (step.has("hemisphere.nii.gz"))
    inHalf.x() +=
        (step.summary.value("hemisphere", "L") == "L" ? -0.2 : 0.2) * (box.high.x() - box.low.x());
  for (const report::SliceAxis axis :
       {report::SliceAxis::Axial, report::SliceAxis::Coronal, report::SliceAxis::Sagittal}) {
    const int normal =
        axis == report::SliceAxis::Sagittal ? 0 : (axis == report::SliceAxis::Coronal ? 1 : 2);
    slices.push_back(report::renderLabelSlice(
        labels, report::frameAround(axis, inHalf[normal], box.low, box.high, kHeight)));
  }
  content.pictures.push_back({"Tissues",
                              step.has("hemisphere.nii.gz")
                                  ? "Green: white matter, filled. Blue: grey ribbon. Orange: "
                                    "fluid. Yellow: tissue cut off at the midline and stem."
                                  : "Orange: fluid. Blue: grey matter. Green: white matter.",
                              report::tilePictures(slices, 3)});
}

void showSurface(const Study& study, const StepFolder& step, report::ReportContent& content) {
  const TriangleMesh white = io::readSurface(step.folder / "white.surf.gii").mesh;
  const TriangleMesh pial = io::readSurface(step.folder / "pial.surf.gii").mesh;
  const StepFolder* segment = study.step("segment");
  std::optional<fs::path> image = segment != nullptr ? inputOf(*segment, "T1") : std::nullopt;
  if (!image || !fs::exists(*image)) image = inputOf(step, "SEG");
  if (image && fs::exists(*image)) {
    io::VolumeReadOptions reading;
    reading.allowNonFinite = true;
    const Volume<float> volume = io::readScalars(*image, reading).volume;
    content.pictures.push_back(
        {"White and pial surface on the image",
         "Red: white surface. Yellow: pial surface. They must follow the borders of the grey "
         "ribbon.",
         report::sliceFigure(
             volume, {{&white, {1, 0.05f, 0.03f}, 1.3}, {&pial, {1, 0.75f, 0}, 1.3}}, 3, 330)});
  }
  report::SurfacePaint paint;
  if (const auto thickness =
          mapNamed(step.folder / "thickness.shape.gii", pial.vertexCount(), "")) {
    paint = paintOf(*thickness);
    std::vector<double> ribbon;
    for (const double t : thickness->values) {
      if (t > 0) ribbon.push_back(t);  // 0 marks the medial wall
    }
    content.charts.push_back(report::histogramSvg(
        Eigen::Map<const Eigen::VectorXd>(ribbon.data(), static_cast<Eigen::Index>(ribbon.size())),
        {"Cortical thickness", "thickness [mm]", "share of vertices"}));
  }
  content.pictures.push_back(
      {"Pial surface", "Coloured by thickness, from the left and from the right.",
       report::surfaceFigure(pial, paint, bothSides(), 2, pictureSize(520, 400))});
}

/// Frames of an unfolding in their order, evenly thinned to `most`, the first and last kept.
std::vector<fs::path> frameFiles(const fs::path& folder, std::size_t most) {
  std::set<fs::path> found;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name.rfind("frame-", 0) == 0 && name.find(".surf.gii") != std::string::npos)
        found.insert(entry.path());
    }
  }
  std::vector<fs::path> all(found.begin(), found.end());
  if (all.size() <= most) return all;
  std::vector<fs::path> some;
  for (std::size_t f = 0; f < most; ++f) some.push_back(all[f * (all.size() - 1) / (most - 1)]);
  return some;
}

std::optional<Point> pointIn(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 3) return {};
  for (const Json& x : *found) {
    if (!x.is_number()) return {};
  }
  return Point((*found)[0], (*found)[1], (*found)[2]);
}

void addMaps(const StepFolder& step, report::Evolution& evolution, const char* file,
             bool regionOnly) {
  if (!step.has(file)) return;
  const Eigen::Index n = evolution.mesh.vertexCount();
  for (io::VertexMap& map : io::readVertexMaps(step.folder / file, n)) {
    Eigen::VectorXd shown = map.values;
    if (regionOnly) {
      // The scale is that of the region; elsewhere these maps hold nothing.
      shown.resize(static_cast<Eigen::Index>(evolution.moved.size()));
      for (std::size_t m = 0; m < evolution.moved.size(); ++m)
        shown[static_cast<Eigen::Index>(m)] = map.values[evolution.moved[m]];
    }
    evolution.maps.push_back({map.values, report::scaleFor(shown, map.name, map.unit)});
  }
}

/// The part's faces, and those of the whole that touch no vertex of the part.
Faces withSurroundings(const Faces& part, const TriangleMesh& whole) {
  std::vector<bool> inPart(static_cast<std::size_t>(whole.vertexCount()), false);
  for (const std::int32_t v : part.reshaped()) inPart[v] = true;
  Faces faces(part.rows() + whole.faceCount(), 3);
  faces.topRows(part.rows()) = part;
  Eigen::Index count = part.rows();
  for (Eigen::Index f = 0; f < whole.faceCount(); ++f) {
    if (inPart[whole.faces(f, 0)] || inPart[whole.faces(f, 1)] || inPart[whole.faces(f, 2)])
      continue;
    faces.row(count++) = whole.faces.row(f);
  }
  faces.conservativeResize(count, 3);
  return faces;
}

void showEvolution(const Study& study, const StepFolder& step, report::ReportContent& content) {
  const std::optional<fs::path> source = inputOf(step, "SURFACE");
  std::vector<TriangleMesh> frames;
  const std::vector<fs::path> files = frameFiles(step.folder / "frames", kMostFrames);
  for (const fs::path& file : files) frames.push_back(io::readSurface(file).mesh);
  if (frames.empty()) {
    // Without frames, before and after.
    if (source && fs::exists(*source)) frames.push_back(io::readSurface(*source).mesh);
    frames.push_back(io::readSurface(step.folder / "unfolded.surf.gii").mesh);
    if (frames.size() == 2 && frames[0].faces.rows() != frames[1].faces.rows())
      frames.erase(frames.begin());
  }
  // A patch that was unfolded alone is shown beside the surface it was taken from.
  std::optional<TriangleMesh> whole;
  if (source && fs::exists(*source)) whole = io::readSurface(*source).mesh;
  report::Evolution evolution = report::evolutionOf(frames);
  if (whole && whole->faceCount() > evolution.mesh.faceCount() &&
      whole->vertexCount() == evolution.mesh.vertexCount()) {
    evolution.mesh.faces = withSurroundings(evolution.mesh.faces, *whole);
    evolution.mesh.positions = whole->positions;
  }
  for (std::size_t f = 0; f < files.size(); ++f) {
    const std::string stem = files[f].filename().string();
    const std::size_t number = std::stoul(stem.substr(6));
    evolution.frameTitles[f] = "frame " + std::to_string(number);
    const Json visibilities = step.summary.value("frame_visibilities", Json::array());
    if (number < visibilities.size() && visibilities[number].is_number()) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), ", visibility %.3f",
                    visibilities[number].get<double>());
      evolution.frameTitles[f] += text.data();
    }
  }
  const Json options = step.record.value("options", Json::object());
  evolution.viewpoint = pointIn(step.summary, "viewpoint");
  if (!evolution.viewpoint) evolution.viewpoint = pointIn(options, "viewpoint");
  if (const auto direction = pointIn(options, "direction"); !evolution.viewpoint && direction) {
    Point middle = Point::Zero();
    for (Eigen::Index m = 0; m < evolution.frames.front().rows(); ++m)
      middle += evolution.frames.front().row(m).transpose();
    middle /= std::max<double>(1, static_cast<double>(evolution.moved.size()));
    evolution.viewpoint = middle + options.value("distance", 1000.0) * direction->normalized();
  }
  addMaps(step, evolution, "visibility.shape.gii", true);
  addMaps(step, evolution, "distortion.shape.gii", true);
  if (const StepFolder* surface = study.step("surface")) {
    for (const char* file : {"thickness.shape.gii", "curvature.shape.gii", "sulc.shape.gii"}) {
      if (const auto map = surface->has(file)
                               ? mapNamed(surface->folder / file, evolution.mesh.vertexCount(), "")
                               : std::nullopt) {
        evolution.maps.push_back(
            {map->values, report::scaleFor(map->values, map->name, map->unit)});
      }
    }
  }

  // Before and after from the viewpoint and from the side, filled by the region.
  if (!evolution.moved.empty() && evolution.viewpoint) {
    const TriangleMesh& before = whole ? *whole : frames.front();
    const TriangleMesh& after = frames.back();
    Point middle = Point::Zero();
    for (const std::int32_t v : evolution.moved) middle += before.positions.row(v).transpose();
    middle /= static_cast<double>(evolution.moved.size());
    const Vector towards = (middle - *evolution.viewpoint).normalized();
    report::FigureView front;
    front.towards = towards;
    front.focus = evolution.moved;
    report::FigureView oblique = front;
    const Vector sideways = towards.cross(Vector(0, 0, 1)).norm() > 1e-3
                                ? towards.cross(Vector(0, 0, 1)).normalized()
                                : Vector(1, 0, 0);
    oblique.towards = (towards + 1.7 * sideways).normalized();
    // Sulci painted on the surface show on the unfolded patch what was folded.
    report::SurfacePaint paint;
    paint.region.setZero(before.vertexCount());
    for (const std::int32_t v : evolution.moved) paint.region[v] = 1;
    const StepFolder* surface = study.step("surface");
    if (const auto curvature =
            surface != nullptr
                ? mapNamed(surface->folder / "curvature.shape.gii", before.vertexCount(), "")
                : std::nullopt) {
      paint.values = curvature->values;
      paint.scale = report::scaleFor(paint.values, curvature->name, curvature->unit,
                                     report::ColourMap::Diverging);
    } else {
      paint.labels = paint.region;
    }
    for (const bool folded : {true, false}) {
      content.pictures.push_back(
          {folded ? "Before" : "After",
           folded ? "The region as it lies, from the viewpoint and from the side."
                  : "The region unfolded for the viewpoint, from the same two sides, with the same "
                    "colours.",
           report::surfaceFigure(folded ? before : after, paint, {front, oblique}, 2,
                                 pictureSize(520, 400))});
    }
  }
  content.evolution = std::move(evolution);
}

void chartEvolution(const StepFolder& step, report::ReportContent& content) {
  const Table table = readTable(step.folder / "evolution.tsv");
  const std::vector<double>* iteration = table.column("iteration");
  if (iteration == nullptr) return;
  const auto chart = [&](const char* title, const char* yTitle,
                         const std::vector<std::string>& names) {
    std::vector<report::Series> series;
    for (const std::string& name : names) {
      if (const std::vector<double>* values = table.column(name))
        series.push_back({name, *iteration, *values});
    }
    if (!series.empty())
      content.charts.push_back(report::curvesSvg(series, {title, "iteration", yTitle}));
  };
  chart("Visibility", "average flux", {"visibility", "seen"});
  chart("Distortion", "share", {"area_error_mean", "edge_strain_mean"});
  std::vector<std::string> energies;
  for (const std::string& name : table.names) {
    if (name.rfind("energy", 0) == 0) energies.push_back(name);
  }
  chart("Energies", "mm\u00b2", energies);
}

void chartMaps(const StepFolder& step, const char* file, report::ReportContent& content) {
  if (!step.has(file)) return;
  std::vector<bool> inRegion;
  if (step.has("region.label.gii")) {
    for (const Label key : io::readVertexLabels(step.folder / "region.label.gii").keys)
      inRegion.push_back(key != 0);
  }
  for (const io::VertexMap& map : io::readVertexMaps(step.folder / file)) {
    std::vector<double> values;
    for (Eigen::Index v = 0; v < map.values.size(); ++v) {
      if (inRegion.empty() || (static_cast<std::size_t>(v) < inRegion.size() && inRegion[v]))
        values.push_back(map.values[v]);
    }
    const std::string axis = map.unit.empty() ? map.name : map.name + " [" + map.unit + "]";
    content.charts.push_back(report::histogramSvg(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())),
        {map.name, axis, "share of vertices"}));
  }
}

void chartVolume(const StepFolder& step, report::ReportContent& content) {
  io::VolumeReadOptions reading;
  reading.allowNonFinite = true;
  reading.allowAllZero = true;
  const Volume<float> thickness = io::readScalars(step.folder / "thickness.nii.gz", reading).volume;
  std::vector<double> values;
  for (const float t : thickness.data) {
    if (t > 0 && std::isfinite(t)) values.push_back(t);
  }
  content.charts.push_back(report::histogramSvg(
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())),
      {"Thickness in the tissue's voxels", "thickness [mm]", "share of voxels"}));
}

}  // namespace

void writeRunState(const std::filesystem::path& file, const std::vector<StepNote>& steps) {
  static constexpr std::array kWords = {"done", "stopped", "failed", "missing"};
  Json all = Json::array();
  for (const StepNote& step : steps) {
    all.push_back({{"name", step.name},
                   {"command", step.command},
                   {"state", kWords[static_cast<int>(step.state)]},
                   {"message", step.message}});
  }
  provenance::writeJson(file, Json{{"steps", all}});
}

std::vector<StepNote> readRunState(const std::filesystem::path& file) {
  std::vector<StepNote> steps;
  if (!fs::exists(file)) return steps;
  const Json state = provenance::readJson(file);
  const Json entries = state.value("steps", Json::array());
  for (const Json& entry : entries) {
    StepNote step{entry.value("name", ""), entry.value("command", ""), report::StepState::Missing,
                  entry.value("message", "")};
    const std::string word = entry.value("state", "missing");
    if (word == "done") step.state = report::StepState::Done;
    if (word == "stopped") step.state = report::StepState::StoppedEarly;
    if (word == "failed") step.state = report::StepState::Failed;
    steps.push_back(std::move(step));
  }
  return steps;
}

report::ReportContent collectReport(const std::filesystem::path& folder, const Monitor& monitor) {
  if (!fs::is_directory(folder)) throw InvalidInput(folder.string() + ": no such folder");
  report::ReportContent content;
  content.title = "Explica: " + fs::weakly_canonical(folder).filename().string();
  Study study(folder, monitor, content);
  if (study.notes().empty()) {
    for (const StepFolder& step : study.steps()) content.steps.push_back(reportStep(step));
  }
  for (const StepNote& note : study.notes()) {
    const auto found = std::find_if(study.steps().begin(), study.steps().end(),
                                    [&](const StepFolder& s) { return s.name == note.name; });
    report::ReportStep step;
    if (found != study.steps().end() && note.state != report::StepState::Failed) {
      step = reportStep(*found);
    } else {
      step.name = note.name;
      step.state = note.state == report::StepState::Done ? report::StepState::Missing : note.state;
      step.message = note.message;
    }
    content.steps.push_back(std::move(step));
  }

  if (const StepFolder* step = study.step("segment"))
    study.attempt("Segmentation", [&] { showSegmentation(*step, content); });
  monitor.progress(0.2, "report");
  if (const StepFolder* step = study.step("surface"))
    study.attempt("Surfaces", [&] { showSurface(study, *step, content); });
  monitor.progress(0.5, "report");
  if (const StepFolder* step = study.step("thickness");
      step != nullptr && step->has("thickness.nii.gz")) {
    study.attempt("Thickness", [&] { chartVolume(*step, content); });
  }
  if (const StepFolder* step = study.step("unfold")) {
    study.attempt("Evolution", [&] { showEvolution(study, *step, content); });
    if (step->has("evolution.tsv"))
      study.attempt("Curves", [&] { chartEvolution(*step, content); });
    study.attempt("Visibility maps", [&] { chartMaps(*step, "visibility.shape.gii", content); });
    study.attempt("Distortion maps", [&] { chartMaps(*step, "distortion.shape.gii", content); });
  }
  flagSteps(study, content);
  monitor.progress(1, "report");
  return content;
}

}  // namespace explica::pipeline
