// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Termination.h"

namespace explica::app {

/// While it lives, --max-time asks for an end so many seconds earlier: the time for what follows.
class TimeKept {
 public:
  explicit TimeKept(double seconds);
  ~TimeKept();
  TimeKept(const TimeKept&) = delete;
  TimeKept& operator=(const TimeKept&) = delete;

 private:
  double seconds_;
};

/// MaxTime for what --max-time interrupted, and no signal; any other end as it is.
[[nodiscard]] Termination causeOf(Termination termination);

}  // namespace explica::app
