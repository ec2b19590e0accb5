// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VolumeSeries.h"

#include "ByteSource.h"
#include "StoredVolume.h"

#include <algorithm>

namespace explica::io {

struct VolumeSeries::State {
  State(const std::filesystem::path& path, const VolumeReadOptions& options)
      : source(openedFor(path)),
        stored(readStored(source, path, options, Extent::Positioned)),
        held(!stored.values.empty()) {}

  ByteSource source;
  StoredVolume stored;
  bool held;       ///< the values are in memory
  int frames = 1;  ///< of the series
  int at = 0;      ///< next frame of the series
  int first = 0;   ///< frame of the file at which the series begins
};

VolumeSeries::VolumeSeries(const std::filesystem::path& path, const VolumeReadOptions& options)
    : state_(std::make_unique<State>(path, options)) {
  const auto count = static_cast<int>(state_->stored.valuesPerVoxel);
  state_->frames = count;
  if (!options.frame) return;
  if (*options.frame < 0 || *options.frame >= count) {
    refuse(path, "holds " + std::to_string(count) + " volume(s); --frame " +
                     std::to_string(*options.frame) + " does not exist (0 to " +
                     std::to_string(count - 1) + ")");
  }
  state_->frames = 1;
  state_->first = *options.frame;
  const StoredVolume& stored = state_->stored;
  if (!state_->held) {
    state_->source.skip(static_cast<std::uint64_t>(*options.frame) * stored.grid.voxelCount() *
                        widthOf(stored.type));
  }
}

VolumeSeries::~VolumeSeries() = default;
VolumeSeries::VolumeSeries(VolumeSeries&&) noexcept = default;

const Grid& VolumeSeries::grid() const {
  return state_->stored.grid;
}
int VolumeSeries::frames() const {
  return state_->frames;
}
const VolumeOrigin& VolumeSeries::origin() const {
  return state_->stored.origin;
}
std::optional<double> VolumeSeries::frameSeconds() const {
  return state_->stored.frameSeconds;
}

std::vector<float> VolumeSeries::next(int count) {
  State& s = *state_;
  const int some = std::min(count, s.frames - s.at);
  if (some <= 0) return {};
  const std::size_t voxels = s.stored.grid.voxelCount(), width = widthOf(s.stored.type);
  std::vector<float> values(static_cast<std::size_t>(some) * voxels);
  for (int n = 0; n < some; ++n, ++s.at) {
    float* to = values.data() + static_cast<std::size_t>(n) * voxels;
    if (!s.held) {
      Bytes raw = s.source.take(voxels * width);
      if (s.stored.bigEndian) swapBytes(raw.data(), voxels, width);
      scaledFloats(s.stored, raw.data(), to);
      continue;
    }
    const auto frame = static_cast<std::size_t>(s.first + s.at);
    const std::uint8_t* from = s.stored.values.data();
    if (!s.stored.interleaved) {
      scaledFloats(s.stored, from + frame * voxels * width, to);
      continue;
    }
    const auto perVoxel = static_cast<std::size_t>(s.stored.valuesPerVoxel);
    Bytes raw(voxels * width);
    for (std::size_t v = 0; v < voxels; ++v) {
      std::memcpy(raw.data() + v * width, from + (v * perVoxel + frame) * width, width);
    }
    scaledFloats(s.stored, raw.data(), to);
  }
  if (s.at == s.frames && !s.held) s.source.finish();
  return values;
}

}  // namespace explica::io
