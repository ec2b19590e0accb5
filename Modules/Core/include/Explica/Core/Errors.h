// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace explica {

/// Root of every exception that Explica throws on purpose; what() is one sentence for the user.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller's data or option cannot be used: names it, what was found and what is needed.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A command line that cannot be understood.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A file that cannot be read, or is not what it claims to be: names the path and the cause.
class IOError : public Error {
 public:
  using Error::Error;
};

/// The machine's fault: disk full, no permission to write, no display, memory.
class EnvironmentError : public Error {
 public:
  using Error::Error;
};

}  // namespace explica
