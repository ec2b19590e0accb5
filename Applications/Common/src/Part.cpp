// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Part.h"

#include "RunState.h"

namespace explica::app {

Part::Part(Context& whole, std::function<bool()> stopWanted)
    : whole_(*whole.state_),
      own_(new Context::State{
          .run = whole_.run, .console = whole_.console, .record = {}, .monitor = whole_.monitor}),
      context_(*own_) {
  own_->monitor.stopWanted = [&outer = whole_.monitor, own = std::move(stopWanted)] {
    return outer.shouldStop() || own();
  };
}

Part::Part(Part&&) noexcept = default;
Part::~Part() = default;

void Part::join() {
  whole_.adopt(std::move(*own_));
}

}  // namespace explica::app
