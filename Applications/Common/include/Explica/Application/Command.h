// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace explica::app {

/// One use of a command: its declaration, bound to fresh settings, and the work.
struct Invocation {
  Declaration declaration;
  std::function<Termination(Context&)> run;
  std::shared_ptr<void> settings;  ///< what the declaration's options point into
};

/// A verb of `explica`.  Holds no state: each begin() is independent, so that several may live in
/// one process.
class Command {
 public:
  Command(std::string name, std::function<Invocation()> begin)
      : name_(std::move(name)), begin_(std::move(begin)) {}

  /// One word, or two for a kind of a verb: "phantom shell".
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Invocation begin() const {
    Invocation invocation = begin_();
    invocation.declaration.name = name_;
    return invocation;
  }

 private:
  std::string name_;
  std::function<Invocation()> begin_;
};

/// A command from its settings (an aggregate whose members hold the defaults), its declaration and
/// its work.
template <class Settings>
[[nodiscard]] Command makeCommand(std::string name, void (*declare)(Declaration&, Settings&),
                                  Termination (*run)(Context&, const Settings&)) {
  return Command(std::move(name), [declare, run] {
    auto settings = std::make_shared<Settings>();
    Invocation invocation;
    declare(invocation.declaration, *settings);
    invocation.run = [run, settings](Context& context) { return run(context, *settings); };
    invocation.settings = settings;
    return invocation;
  });
}

/// Every command of this program, in the order of their names.  The build writes its body from the
/// calls of explica_add_command.
[[nodiscard]] const std::vector<Command>& allCommands();

/// The command of that name, or nullptr.
[[nodiscard]] const Command* findCommand(std::string_view name);

}  // namespace explica::app
