// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Viewer/Window.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace explica::viewer {
namespace {

TEST(LoadWindow, WhatTheWindowThrowsIsCaughtByTheProgramThatLoadedIt) {
  unsetenv("DISPLAY");
  Session session(geometry::makeFoldedSphere(3, 30));
  try {
    showWindow(session, {});
    ADD_FAILURE() << "a window without a display";
  } catch (const EnvironmentError& error) {
    EXPECT_NE(std::string(error.what()).find("display"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace explica::viewer
