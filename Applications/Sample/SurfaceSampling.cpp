// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LabelVolumeNames.h"
#include "PointTable.h"
#include "Settings.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeSeries.h"
#include "Explica/Sampling/NearestColumn.h"
#include "Explica/Sampling/Ribbon.h"
#include "Explica/Sampling/Summary.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <memory>
#include <span>

namespace explica::app {
namespace {

std::string depthText(double depth) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, depth).ptr;
  return {text, end};
}

/// What all volumes of a run have in common, and what they leave behind.
class SurfaceSampling {
 public:
  SurfaceSampling(Context& context, const SampleSettings& s)
      : context_(context),
        s_(s),
        cortex_(readCortex(context, s.cortex)),
        depths_(sampling::depthsFromText(s.depths.value_or("0.5"))),
        ribbon_(s.across == sampling::Across::Ribbon),
        layers_(ribbon_ ? 1 : depths_.size()),
        count_(static_cast<std::size_t>(cortex_.white.vertexCount())),
        regions_(regionsOf(s, cortex_.white.vertexCount())) {
    if (s.points) points_ = io::readPointTable(*s.points);
    sayHowRead(context, cortex_.origin);
  }

  Termination run() {
    requireUsable(context_, s_, &cortex_);
    auto step = context_.step("sample");
    if (!ribbon_)
      at_ = sampling::positionsAtDepths(cortex_.white, cortex_.pial, depths_, s_.depthKind);
    std::size_t done = 0, rows = 0;
    try {
      for (; done < s_.volumes.size(); ++done) {
        rows = profiles_.size();
        sampleSeries(s_.volumes[done]);
      }
      rows = profiles_.size();
      for (const std::string& path : s_.labelVolumes) sampleLabels(path);
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
      writeMaps(writers, name, values, frame, series.frames());
      frame += static_cast<int>(frames);
      context_.monitor().progress(static_cast<double>(frame) / series.frames(), name);
      checkpoint();
    }
    for (io::GiftiMapsWriter& writer : writers) writer.finish();
    addValid(path, name, known);
  }

  void noteKnown(const std::vector<float>& values, std::vector<std::uint8_t>& known) {
    parallelForBlocks(known.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
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
                      (frames > 1 ? frame : "n/a") + "\t" + cellText(moments[r].mean) + "\t" +
                      cellText(moments[r].deviation) + "\t" + std::to_string(moments[r].count) +
                      "\n";
      }
    });
    for (const std::string& text : texts) profiles_ += text;
  }

  /// Maps are called by their volume and what of it they are: "bold frame 3", "T1w depth 0.5".
  void writeMaps(std::vector<io::GiftiMapsWriter>& writers, const std::string& volume,
                 const std::vector<float>& values, int firstFrame, int frames) {
    const std::size_t depths = layers_, some = values.size() / (depths * count_);
    const auto at = [&](std::size_t frame, std::size_t depth) {
      return std::span(values).subspan((frame * depths + depth) * count_, count_);
    };
    const auto frameName = [&](std::size_t f, std::string_view one) {
      if (frames > 1) return volume + " frame " + std::to_string(firstFrame + f);
      return volume + " " + std::string(one);
    };
    if (ribbon_) {
      for (std::size_t f = 0; f < some; ++f) {
        writers[0].add(frameName(f, "ribbon"), "", at(f, 0));
      }
    } else if (s_.across != sampling::Across::None) {
      for (std::size_t f = 0; f < some; ++f) {
        const auto all = std::span(values).subspan(f * depths * count_, depths * count_);
        writers[0].add(frameName(f, nameOf(s_.across)), "",
                       sampling::acrossDepths(all, depths, s_.across));
      }
    } else if (frames == 1) {
      for (std::size_t d = 0; d < depths; ++d) {
        writers[0].add(volume + " depth " + depthText(depths_[d]), "", at(0, d));
      }
    } else {
      parallelFor(depths, 1, [&](std::size_t d) {
        for (std::size_t f = 0; f < some; ++f) writers[d].add(frameName(f, ""), "", at(f, d));
      });
    }
  }

  void addValid(const std::string& path, const std::string& name,
                const std::vector<std::uint8_t>& known) {
    const auto sum = std::count(known.begin(), known.end(), 1);
    if (sum == 0) {
      throw InvalidInput("'" + path +
                         "': is known at no vertex of the surface; do both lie in the same space? "
                         "(--to-volume, --surface-space and --fs-volume say how)");
    }
    const double share = static_cast<double>(sum) / static_cast<double>(known.size());
    summary_.known.emplace_back(name, share);
    if (share < 0.5) {
      context_.warn(
          printed("'%s' is known at %.1f %% of the vertices only: the others lie outside the field "
                  "of view, the mask or the map",
                  name.c_str(), 100 * share));
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
    const LabelVolumeNames names(path);
    const auto write = [&](const std::string& file, std::span<const Label> keys) {
      io::writeGiftiLabel(context_.output(file), names.mapOf(name, keys), cortex_.structure);
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

}  // namespace

Termination sampleSurfaces(Context& context, const SampleSettings& s) {
  return SurfaceSampling(context, s).run();
}

}  // namespace explica::app
