// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Execute.h"

int main(int argc, char** argv) {
  return explica::app::runMain(argc, argv);
}
