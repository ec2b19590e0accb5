// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PointTable.h"
#include "Settings.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeSeries.h"
#include "Explica/Sampling/NearestColumn.h"
#include "Explica/Sampling/Ribbon.h"
#include "Explica/Sampling/Summary.h"
#include "Explica/Sampling/Transfer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <span>

namespace explica::app {
namespace {

constexpr const char* kDefaultDepths = "0.5";

/// Which options need or exclude each other.
void declareRelations(Declaration& d) {
  d.find("VOLUME")->required = false;
  d.onSurface("vertex-map", "vertex-surface");
}

void declare(Declaration& d, SampleSettings& s) {
  d.synopsis("values of volumes on the cortex: at depths between surfaces, or layer by layer")
      .description(
          "Takes volumes (anatomy, maps, functional series, labels) at any depth between a white "
          "and "
          "a pial surface whose vertices correspond, or in the layers of explica thickness. "
          "Outside "
          "the field of view or the mask, and where a map holds NaN, a value is not known: it is "
          "NaN, "
          "valid.shape.gii says where, and no statistic counts it. A functional series is read "
          "some "
          "frames at a time. The volume's header says where it lies; if it lies elsewhere than the "
          "surface, --to-volume brings places of the surface to places of the volume.")
      .reference("Waehnert and others 2014, NeuroImage 93:210-220 (depths of equal volume)")
      .example(
          "explica sample bold.nii.gz --surfaces sub-01/anat --hemisphere L --depths 5 "
          "--to-volume from-boldref_to-T1w.txt --labels lh.aparc.annot --out sampled",
          "A functional series at five depths, and its profile in each region")
      .example("explica sample t1map.nii.gz --thickness thickness --depths 20 --out layers",
               "Twenty layers along the trajectories of explica thickness")
      .input("VOLUME", FileKind::Volume, "volumes to sample, of one or several frames", s.volumes)
      .inputOption("label-volume", FileKind::LabelVolume,
                   "volume of labels, which go to the majority; may be repeated", s.labelVolumes);
  declareCortex(d, s.cortex, "Surfaces");
  d.options("Surfaces", s.cortex.reading)
      .inputOption("thickness", FileKind::Folder,
                   "output folder of explica thickness: sample its layers instead of surfaces",
                   s.thickness, "Trajectories")
      .option(
          "Depths",
          Field{"depths", "",
                "number of depths from white to pial, or a list: 0 white to 1 pial (default 0.5); "
                "with --thickness the number of layers (default: those of its layers.nii.gz)"},
          s.depths)
      .option("Depths",
              Field{"depth-kind", "",
                    "depths are shares of the distance or of the "
                    "column's volume"},
              s.depthKind)
      .option(
          "Depths",
          Field{"across", "",
                "one map of all depths: their mean or maximum, of labels the most frequent; "
                "ribbon: mean over the volume of the faces about a vertex, as Workbench's ribbon "
                "mapping"},
          s.across)
      .option("Values", Field{"interpolate", "", "how values between voxel centres are made"},
              s.interpolate)
      .inputOption("mask", FileKind::Volume,
                   "where it is 0, on the volumes' grid, nothing is known", s.mask, "Values")
      .options("Values", s.reading);
  declarePlace(d, s.place, "Place");
  d.inputOption("labels", FileKind::VertexLabel,
                "regions on the surface (GIFTI, annot, .label; several files may overlap), or with "
                "--thickness one label volume: writes a profile for each",
                s.labels, "Regions")
      .inputOption("points", FileKind::Table,
                   "table with columns x, y, z (RAS mm): finds vertex, depth, distance, region",
                   s.points, "Regions")
      .inputOption(
          "vertex-map", FileKind::VertexData,
          "vertex data of another surface of the same subject (lh.thickness), carried over "
          "by nearest points; may be repeated",
          s.vertexMaps, "Other surfaces")
      .inputOption("vertex-surface", FileKind::Surface,
                   "the surface that --vertex-map belongs to (lh.white), beside our white one",
                   s.vertexSurface, "Other surfaces")
      .output(
          "*.func.gii", FileKind::VertexData,
          "NAME.func.gii: a map a depth; of a series NAME_depth-D.func.gii: a map a frame; with "
          "--across NAME.func.gii")
      .output(
          "*.label.gii", FileKind::VertexLabel,
          "NAME.label.gii of a label volume; NAME_depth-D.label.gii if there are several depths")
      .output("valid.shape.gii", FileKind::VertexData,
              "1 where the value is known (of a series, in every frame), a map a volume and depth")
      .output(
          "*.shape.gii", FileKind::VertexData,
          "NAME.shape.gii of --vertex-map: its values, and the distance in mm between the surfaces")
      .output("profiles.tsv", FileKind::Table, "volume, region, depth, mean, sd, n")
      .output("points.tsv", FileKind::Table,
              "with --points: nearest vertex, depth, distance in mm, region")
      .output("*_layers.tsv", FileKind::Table,
              "with --thickness NAME_layers.tsv: mean, sd, voxels, volume in mm^3, mean of columns")
      .results<sampling::SampleSummary>();
  declareRelations(d);
}

std::string stemOfMap(std::string name) {
  for (const std::string_view ending : {".gz", ".shape.gii", ".func.gii", ".gii", ".mgh", ".mgz"}) {
    if (name.size() > ending.size() && name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
    }
  }
  return name == "valid" ? "valid_map" : name;
}

std::string depthText(double depth) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, depth).ptr;
  return {text, end};
}

/// Vertices at all depths, depth after depth.
Positions positionsAtDepths(const Cortex& cortex, const std::vector<double>& depths,
                            sampling::DepthKind kind) {
  const Eigen::Index count = cortex.white.vertexCount();
  Positions points(static_cast<Eigen::Index>(depths.size()) * count, 3);
  for (std::size_t d = 0; d < depths.size(); ++d) {
    points.middleRows(static_cast<Eigen::Index>(d) * count, count) =
        sampling::positionsAtDepth(cortex.white, cortex.pial, depths[d], kind);
  }
  return points;
}

sampling::Regions regionsOf(const SampleSettings& s, Eigen::Index vertexCount) {
  if (s.labels.empty()) return sampling::Regions(vertexCount);
  const auto files = io::readRegions({s.labels.begin(), s.labels.end()}, vertexCount);
  std::vector<sampling::RegionTable> tables;
  for (const io::LabelMap& labels : files) {
    sampling::RegionTable& table = tables.emplace_back();
    table.keys = {labels.keys.data(), static_cast<std::size_t>(labels.keys.size())};
    for (const io::LabelEntry& entry : labels.table) table.table.push_back({entry.key, entry.name});
  }
  return sampling::Regions(tables);
}

/// What all volumes of a run have in common, and what they leave behind.
class SurfaceSampling {
 public:
  SurfaceSampling(Context& context, const SampleSettings& s)
      : context_(context),
        s_(s),
        cortex_(readCortex(context, s.cortex)),
        depths_(sampling::depthsFromText(s.depths.value_or(kDefaultDepths))),
        ribbon_(s.across == sampling::Across::Ribbon),
        layers_(ribbon_ ? 1 : depths_.size()),
        count_(static_cast<std::size_t>(cortex_.white.vertexCount())),
        regions_(regionsOf(s, cortex_.white.vertexCount())) {
    if (s.points) points_ = io::readPointTable(*s.points);
    sayHowRead(context, cortex_.origin);
  }

  Termination run() {
    // Headers are read, and what cannot be used is refused, before any work.
    for (const std::string& path : s_.volumes) {
      const io::VolumeSeries series(path, s_.reading);
      if (s_.mask) static_cast<void>(maskFor(series.grid(), s_));
    }
    auto step = context_.step("sample");
    if (!ribbon_) at_ = positionsAtDepths(cortex_, depths_, s_.depthKind);
    std::size_t done = 0, rows = 0;
    try {
      for (; done < s_.volumes.size(); ++done) {
        rows = profiles_.size();
        sampleSeries(s_.volumes[done]);
      }
      rows = profiles_.size();
      for (const std::string& path : s_.labelVolumes) sampleLabels(path);
      carryOver();
    } catch (const Interrupted&) {
      if (done == 0) throw;
      const StopScope kept(nullptr);
      profiles_.resize(rows);
      context_.warn("stopped before every volume was sampled; outputs are of those that were");
      return finish(Termination::Interrupted);
    }
    return finish(Termination::NotRun);
  }

 private:
  sampling::Sampler samplerFor(const Grid& grid, sampling::Interpolation way) {
    const auto mask = maskFor(grid, s_);
    return {grid, placesIn(context_, grid, s_, &cortex_, at_), way, mask ? &*mask : nullptr};
  }

  using Values = std::function<std::vector<float>(std::span<const float> frames)>;

  /// How frames become values, frame after frame, in each of them layers_ x V.
  Values valuesOn(const Grid& grid) {
    if (!ribbon_) {
      auto sampler = std::make_shared<sampling::Sampler>(samplerFor(grid, s_.interpolate));
      return [sampler](std::span<const float> frames) { return sampler->sample(frames); };
    }
    auto mask = std::make_shared<std::optional<Volume<std::uint8_t>>>(maskFor(grid, s_));
    std::function<Positions(const Positions&)> toVolume;
    if (const auto transform = transformTo(context_, grid, s_.place, &cortex_))
      toVolume = *transform;
    const sampling::RibbonSampler sampler(grid, cortex_.white, cortex_.pial, s_.interpolate,
                                          toVolume, *mask ? &**mask : nullptr);
    return [sampler, mask](std::span<const float> frames) { return sampler.sample(frames); };
  }

  /// What a layer is called in tables.
  [[nodiscard]] std::string layerText(std::size_t layer) const {
    return ribbon_ ? "n/a" : depthText(depths_[layer]);
  }

  /// Maps of a volume are written while it is read: one file, or one a depth.
  std::vector<io::GiftiMapsWriter> writersFor(const std::string& name,
                                              const io::VolumeSeries& series) {
    std::vector<io::GiftiMapsWriter> writers;
    const auto frames = static_cast<std::size_t>(series.frames());
    const bool many = frames > 1;
    const auto seconds = many ? series.frameSeconds() : std::nullopt;
    if (s_.across != sampling::Across::None || !many) {
      const std::size_t maps = s_.across == sampling::Across::None ? depths_.size() : frames;
      writers.emplace_back(context_.output(name + ".func.gii"), cortex_.structure, maps, seconds);
      return writers;
    }
    for (const double depth : depths_) {
      writers.emplace_back(context_.output(name + "_depth-" + depthText(depth) + ".func.gii"),
                           cortex_.structure, frames, seconds);
    }
    return writers;
  }

  void sampleSeries(const std::string& path) {
    io::VolumeSeries series(path, s_.reading);
    const std::string name = stemOf(path);
    const Values sample = valuesOn(series.grid());
    std::vector<io::GiftiMapsWriter> writers = writersFor(name, series);
    std::vector<std::uint8_t> known(layers_ * count_, 1);
    int frame = 0;
    for (auto block = series.next(sampling::Sampler::kFramesAtOnce); !block.empty();
         block = series.next(sampling::Sampler::kFramesAtOnce)) {
      const std::vector<float> values = sample(block);
      block.clear();
      const std::size_t frames = values.size() / known.size();
      noteKnown(values, known);
      addProfiles(name, values, frame, series.frames());
      writeMaps(writers, values, frame, series.frames());
      frame += static_cast<int>(frames);
      context_.monitor().progress(static_cast<double>(frame) / series.frames(), name);
      checkpoint();
    }
    for (io::GiftiMapsWriter& writer : writers) writer.finish();
    addValid(path, name, known);
  }

  void noteKnown(const std::vector<float>& values, std::vector<std::uint8_t>& known) {
    constexpr std::size_t kGrain = 1 << 14;  // elements a task
    parallelForBlocks(known.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t frame = 0; frame < values.size(); frame += known.size()) {
        const float* at = values.data() + frame;
        for (std::size_t p = begin; p < end; ++p) known[p] &= at[p] == at[p];  // not NaN
      }
    });
  }

  /// Rows of the regions for each frame and depth.
  void addProfiles(const std::string& name, const std::vector<float>& values, int firstFrame,
                   int frames) {
    const std::size_t rows = values.size() / count_;
    std::vector<std::string> texts(rows);
    parallelFor(rows, 1, [&](std::size_t row) {
      const std::size_t layer = row % layers_;
      const std::string frame = std::to_string(firstFrame + static_cast<int>(row / layers_));
      const auto moments = regions_.momentsOf(std::span(values).subspan(row * count_, count_));
      for (std::size_t r = 0; r < moments.size(); ++r) {
        texts[row] += name + "\t" + regions_.names()[r] + "\t" + layerText(layer) + "\t" +
                      (frames > 1 ? frame : "n/a") + "\t" + cell(moments[r].mean) + "\t" +
                      cell(moments[r].deviation) + "\t" + std::to_string(moments[r].count) + "\n";
      }
    });
    for (const std::string& text : texts) profiles_ += text;
  }

  void writeMaps(std::vector<io::GiftiMapsWriter>& writers, const std::vector<float>& values,
                 int firstFrame, int frames) {
    const std::size_t depths = layers_, some = values.size() / (depths * count_);
    const auto at = [&](std::size_t frame, std::size_t depth) {
      return std::span(values).subspan((frame * depths + depth) * count_, count_);
    };
    const auto frameName = [&](std::size_t f) { return "frame " + std::to_string(firstFrame + f); };
    if (ribbon_) {
      for (std::size_t f = 0; f < some; ++f) {
        writers[0].add(frames > 1 ? frameName(f) : "ribbon", "", at(f, 0));
      }
    } else if (s_.across != sampling::Across::None) {
      for (std::size_t f = 0; f < some; ++f) {
        const auto all = std::span(values).subspan(f * depths * count_, depths * count_);
        writers[0].add(frames > 1 ? frameName(f) : std::string(nameOf(s_.across)), "",
                       sampling::acrossDepths(all, depths, s_.across));
      }
    } else if (frames == 1) {
      for (std::size_t d = 0; d < depths; ++d) {
        writers[0].add("depth " + depthText(depths_[d]), "", at(0, d));
      }
    } else {
      parallelFor(depths, 1, [&](std::size_t d) {
        for (std::size_t f = 0; f < some; ++f) writers[d].add(frameName(f), "", at(f, d));
      });
    }
  }

  void addValid(const std::string& path, const std::string& name,
                const std::vector<std::uint8_t>& known) {
    const auto sum = std::count(known.begin(), known.end(), 1);
    if (sum == 0) {
      throw InvalidInput("'" + path +
                         "': is known at no vertex of the surface; do both lie in the "
                         "same space? (--to-volume, --surface-space and --fs-volume say how)");
    }
    const double share = static_cast<double>(sum) / static_cast<double>(known.size());
    summary_.known.emplace_back(name, share);
    constexpr double kFew = 0.5;
    if (share < kFew) {
      char text[160];
      std::snprintf(
          text, sizeof text,
          "'%s' is known at %.1f %% of the vertices only: the others lie outside the field "
          "of view, the mask or the map",
          name.c_str(), 100 * share);
      context_.warn(text);
    }
    for (std::size_t d = 0; d < layers_; ++d) {
      io::VertexMap map{name + (ribbon_ ? " ribbon" : " depth " + layerText(d)), "", {}};
      map.values.resize(static_cast<Eigen::Index>(count_));
      for (std::size_t v = 0; v < count_; ++v) map.values[v] = known[d * count_ + v];
      valid_.push_back(std::move(map));
    }
  }

  void sampleLabels(const std::string& path) {
    io::VolumeReadOptions reading = s_.reading;
    const Volume<Label> volume = readLabels(context_, "label-volume", path, reading);
    const std::string name = stemOf(path);
    const std::vector<Label> labels =
        samplerFor(volume.grid, s_.interpolate).sampleLabels(volume.data);
    std::vector<std::uint8_t> known(labels.size());
    for (std::size_t p = 0; p < labels.size(); ++p) known[p] = labels[p] != sampling::kNoLabel;
    addValid(path, name, known);
    io::LabelNames names;
    if (const auto legend = io::findLegend(path)) names = io::readLabelNames(*legend);
    io::LabelColours colours;
    if (const auto file = io::findColours(path)) colours = io::readLabelColours(*file);
    const bool freeSurfer = path.find(".mgz") != std::string::npos ||
                            path.find("aseg") != std::string::npos ||
                            path.find("aparc") != std::string::npos;
    const auto write = [&](const std::string& file, std::span<const Label> keys) {
      constexpr Label kNotKnownKey = -1;
      io::LabelMap map{name, {}, {}};
      map.keys.resize(static_cast<Eigen::Index>(keys.size()));
      std::vector<Label> used;
      for (std::size_t v = 0; v < keys.size(); ++v) {
        map.keys[v] = keys[v] == sampling::kNoLabel ? kNotKnownKey : keys[v];
      }
      used.assign(map.keys.begin(), map.keys.end());
      std::sort(used.begin(), used.end());
      used.erase(std::unique(used.begin(), used.end()), used.end());
      map.table = io::tableFor(used, names, freeSurfer);
      for (io::LabelEntry& entry : map.table) {
        if (const auto own = colours.find(entry.key); own != colours.end()) {
          entry.colour = own->second;
        }
        if (entry.key == kNotKnownKey) entry = {kNotKnownKey, "not known", {0, 0, 0, 0}};
      }
      io::writeGiftiLabel(context_.output(file), map, cortex_.structure);
    };
    if (s_.across != sampling::Across::None || depths_.size() == 1) {
      write(name + ".label.gii", sampling::majorityAcross(labels, depths_.size()));
      return;
    }
    for (std::size_t d = 0; d < depths_.size(); ++d) {
      write(name + "_depth-" + depthText(depths_[d]) + ".label.gii",
            std::span(labels).subspan(d * count_, count_));
    }
  }

  /// Vertex data of another surface of the same subject, and how far off that surface is.
  void carryOver() {
    if (s_.vertexMaps.empty()) return;
    io::SurfaceReadOptions reading = s_.cortex.reading;
    const TriangleMesh theirs =
        readSurface(context_, "vertex-surface", *s_.vertexSurface, reading).mesh;
    const sampling::NearestOnSurface nearest = sampling::nearestOn(theirs, cortex_.white.positions);
    const double mean = nearest.distance.mean();
    summary_.surfaceDistance = mean;
    summary_.surfaceDistanceMax = nearest.distance.maxCoeff();
    constexpr double kNear = 2;  // mm: white surfaces of one subject by two programs
    if (mean > kNear) {
      context_.warn(
          "the surface of --vertex-map is " + cell(mean) +
          " mm off in the mean: do both lie in the same space and belong to one subject?");
    }
    for (const std::string& path : s_.vertexMaps) {
      const std::string name = std::filesystem::path(path).filename().string();
      std::vector<io::VertexMap> maps = io::readVertexMaps(path, theirs.vertexCount());
      for (io::VertexMap& map : maps) map.values = sampling::carryOver(nearest, map.values);
      maps.push_back({"distance", "mm", nearest.distance});
      io::GiftiMapsWriter writer(context_.output(stemOfMap(name) + ".shape.gii"), cortex_.structure,
                                 maps.size());
      for (const io::VertexMap& map : maps) {
        const Eigen::VectorXf values = map.values.cast<float>();
        writer.add(map.name, map.unit, {values.data(), static_cast<std::size_t>(values.size())});
      }
      writer.finish();
    }
  }

  Termination finish(Termination termination) {
    summary_.vertices = static_cast<std::int64_t>(count_);
    if (!ribbon_) summary_.depths = depths_;
    if (!valid_.empty()) {
      io::writeGiftiShape(context_.output("valid.shape.gii"), valid_, cortex_.structure);
    }
    if (!profiles_.empty()) {
      writeTextFile(context_.output("profiles.tsv"),
                    "volume\tregion\tdepth\tframe\tmean\tsd\tn\n" + profiles_);
    }
    if (points_) {
      const auto places = sampling::nearestColumns(cortex_.white, cortex_.pial, points_->places);
      double farthest = 0;
      for (const sampling::ColumnPlace& place : places) {
        farthest = std::max(farthest, place.distance);
      }
      summary_.points = static_cast<std::int64_t>(places.size());
      summary_.pointsDistance = farthest;
      writeTextFile(context_.output("points.tsv"), textOf(*points_, places, regions_));
    }
    context_.results(summary_);
    return termination;
  }

  Context& context_;
  const SampleSettings& s_;
  Cortex cortex_;
  std::vector<double> depths_;
  bool ribbon_;         ///< means over the tissue's volume instead of values at depths
  std::size_t layers_;  ///< maps a frame: the depths, or the one of the ribbon
  std::size_t count_;
  sampling::Regions regions_;
  std::optional<io::PointTable> points_;
  Positions at_;  ///< depths x V
  std::vector<io::VertexMap> valid_;
  std::string profiles_;
  sampling::SampleSummary summary_;
};

void requireDistinctNames(const SampleSettings& s) {
  std::set<std::string> names;
  for (const auto* list : {&s.volumes, &s.labelVolumes}) {
    for (const std::string& path : *list) {
      if (!names.insert(stemOf(path)).second) {
        throw UsageError(
            "two volumes are called '" + stemOf(path) +
            "', and outputs follow their names; sample them into folders of their own");
      }
    }
  }
}

Termination run(Context& context, const SampleSettings& s) {
  requireDistinctNames(s);
  if (s.volumes.empty() && s.labelVolumes.empty() && !s.points && s.vertexMaps.empty()) {
    throw UsageError(
        "there is nothing to sample: give volumes, --label-volume, --points or --vertex-map");
  }
  if (s.vertexMaps.empty() == s.vertexSurface.has_value()) {
    throw UsageError("--vertex-map and --vertex-surface belong together; one of them is missing");
  }
  if (s.across == sampling::Across::Ribbon && (s.depths || !s.labelVolumes.empty())) {
    throw UsageError(
        "--across ribbon takes values over the whole depth: leave --depths out, and sample label "
        "volumes with --across mean");
  }
  if (s.thickness) return sampleLayers(context, s);
  return SurfaceSampling(context, s).run();
}

}  // namespace

Positions placesIn(Context& context, const Grid& volume, const SampleSettings& s,
                   const Cortex* cortex, const Positions& points) {
  const auto transform = transformTo(context, volume, s.place, cortex);
  return transform ? (*transform)(points) : points;
}

std::optional<Volume<std::uint8_t>> maskFor(const Grid& volume, const SampleSettings& s) {
  if (!s.mask) return {};
  io::VolumeReadOptions reading;
  reading.allowNonFinite = true;
  const Volume<float> read = io::readScalars(*s.mask, reading).volume;
  if (!sameGrid(read.grid, volume, 0.1)) {
    throw InvalidInput("'" + *s.mask +
                       "': its grid is not that of the volume it is to mask; resample "
                       "it to that grid");
  }
  Volume<std::uint8_t> mask(read.grid);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    mask[v] = read[v] != 0 && std::isfinite(read[v]);
  }
  return mask;
}

Command sampleCommand() {
  return makeCommand<SampleSettings>("sample", declare, run);
}

}  // namespace explica::app
