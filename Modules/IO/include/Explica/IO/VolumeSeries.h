// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/VolumeFile.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace explica::io {

/// A file of one or several volumes on one grid, read a few frames at a time, so that memory holds
/// those only (NIfTI in one file, MGH; other formats are held whole).  NaN and infinity are kept.
class VolumeSeries {
 public:
  /// Reads the header.  Of `options` the placement and the frame count: with `frame` the series is
  /// that one volume.
  /// @throws IOError, InvalidInput  as readScalars(), but for values
  explicit VolumeSeries(const std::filesystem::path& path, const VolumeReadOptions& options = {});
  ~VolumeSeries();
  VolumeSeries(VolumeSeries&&) noexcept;

  [[nodiscard]] const Grid& grid() const;
  [[nodiscard]] int frames() const;
  [[nodiscard]] const VolumeOrigin& origin() const;
  /// Time between frames, s, if the header says it.
  [[nodiscard]] std::optional<double> frameSeconds() const;

  /// The next frames, at most `count`, one after the other; none at the end.
  /// @throws IOError  the file ends too early or is damaged
  [[nodiscard]] std::vector<float> next(int count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace explica::io
