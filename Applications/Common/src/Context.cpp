// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Context.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Provenance/Results.h"
#include "Explica/Provenance/Verify.h"
#include "RunState.h"

#include <fnmatch.h>

#include <algorithm>
#include <iterator>

namespace explica::app {

namespace fs = std::filesystem;
using provenance::Json;

Json Context::State::reasonsInWords() const {
  Json words = Json::array();
  if (!reachedGoal(record.termination)) {
    words.push_back("ended before its goal was reached: " +
                    std::string(nameOf(record.termination)));
  }
  for (const auto& [judgement, sentence] : reasons) words.push_back(sentence);
  for (const Json& flag : flags.value_or(Json::array())) {
    if (!flag.contains("step")) words.push_back(flag["message"]);  // else the step's own reason
  }
  for (const provenance::Doubt& doubt : provenance::kDoubts) {
    const auto count = summary.value(doubt.key, std::size_t{0});
    if (count > 0) {
      words.push_back(std::string(doubt.what) + ": " + std::to_string(count) + " " + doubt.meaning);
    }
  }
  return words;
}

const char* Context::State::verdict(const Json& words) const {
  if (!reachedGoal(record.termination)) return "stopped";
  if (doubtful()) return "doubtful";
  return words.empty() ? "right" : "look";
}

void Context::State::adopt(State&& part) {
  std::ranges::move(part.record.steps, std::back_inserter(record.steps));
  std::ranges::move(part.nestedRecords, std::back_inserter(nestedRecords));
  std::ranges::move(part.reasons, std::back_inserter(reasons));
  plausible = plausible && part.plausible;
  if (!part.flags) return;
  if (!flags) flags = Json::array();
  for (Json& flag : *part.flags) {
    if (std::ranges::find(*flags, flag) == flags->end()) flags->push_back(std::move(flag));
  }
}

Context::Step::Step(Context& context, std::string name)
    : context_(context),
      entry_(context.state_->record.steps.size()),
      begin_(context.state_->seconds()) {
  context.state_->console.detail(context.state_->run.prefix + name);
  context.state_->record.steps.push_back({std::move(name), 0, {}, Termination::NotRun});
}

Context::Step::~Step() {
  auto& entry = context_.state_->record.steps[entry_];
  entry.seconds = context_.state_->seconds() - begin_;
  if (entry.termination == Termination::NotRun) entry.termination = Termination::Finished;
  context_.state_->console.endProgress();
}

void Context::Step::iterations(int count) {
  context_.state_->record.steps[entry_].iterations = count;
}

void Context::Step::termination(Termination termination) {
  context_.state_->record.steps[entry_].termination = termination;
}

fs::path Context::input(const fs::path& path, std::string_view role) {
  provenance::InputFile file;
  file.role = role;
  file.given = path;
  file.digest = provenance::digestOf(path);
  std::error_code ignored;
  file.absolute = fs::absolute(path, ignored).lexically_normal();
  if (!state_->known.emplace(file.role, file.absolute.string()).second) return path;
  const auto found = provenance::findRecordOf(path, file.digest);
  for (const std::string& sentence :
       state_->meeting->add(file.role, path, file.digest.sha256, found)) {
    doubt(provenance::kInputsContradict, 1, sentence + "; accepted");
  }
  if (found) {
    if (found->sameContent) {
      file.parent = provenance::Parent{found->record["id"],
                                       provenance::digestOf(found->path).sha256, found->path};
    } else {
      doubt(provenance::kInputsChanged, 1,
            path.string() + " was changed since " + found->path.string() + " recorded it");
    }
  }
  state_->record.inputs.push_back(std::move(file));
  return path;
}

fs::path Context::output(const std::string& name) {
  if (state_->run.common.dryRun) throw DryRunEnds{};
  if (!state_->folder) throw std::logic_error("command writes no folder, yet asks for " + name);
  const auto& slots = state_->declaration().outputs;
  const auto slot = std::find_if(slots.begin(), slots.end(), [&](const OutputSlot& s) {
    return fnmatch(s.pattern.c_str(), name.c_str(), 0) == 0;
  });
  if (slot == slots.end()) throw std::logic_error("undeclared output " + name);
  if (slot->varies) state_->varying.push_back(name);
  return state_->folder->place(name);
}

fs::path Context::outputFolder() const {
  return state_->run.common.out ? fs::path(*state_->run.common.out) : fs::path();
}

Context::Step Context::step(std::string name) {
  if (state_->run.common.dryRun) throw DryRunEnds{};
  checkpoint();
  return Step(*this, std::move(name));
}

void Context::results(const Results& listed) {
  for (const Result& result : listed) {
    if (!state_->declaration().stageResults.find(result.key)) {
      throw std::logic_error("undeclared result " + result.key);
    }
    if (std::holds_alternative<std::monostate>(result.value)) continue;
    state_->setResult(result.key, provenance::valueOf(result.value));
    state_->record.meanings[result.key] = provenance::meaningOf(result);
    const Judgement judgement = result.judgement().value_or(Judgement::Good);
    if (judgement != Judgement::Good) state_->reasons.emplace_back(judgement, result.sentence());
  }
  for (std::string& line : listed.head()) state_->head.push_back(std::move(line));
}

void Context::result(const std::string& key, const Result::Value& value) {
  state_->setResult(key, provenance::valueOf(value));
}
void Context::result(const std::string& key, const Json& value) {
  state_->setResult(key, value);
}

void Context::note(const std::string& key, const Json& value) {
  state_->record.notes[key] = value;
}

void Context::judged() {
  if (!state_->flags) state_->flags = Json::array();
}

void Context::flag(const Json& flag) {
  judged();
  for (const Json& known : *state_->flags) {
    if (known == flag) return;
  }
  state_->flags->push_back(flag);
  if (flag["accepted"].get<bool>()) {
    info("accepted: " + flag["message"].get<std::string>());
    return;
  }
  state_->plausible = false;
  if (flag.contains("step")) return;  // the step has said it
  warn(flag["message"].get<std::string>());
}

void Context::doubt(const char* key, std::size_t count, const std::string& sentence) {
  Json& number = state_->summary[key];
  number = number.is_null() ? count : number.get<std::size_t>() + count;
  if (count > 0 && !sentence.empty()) warn(sentence);
}

const Monitor& Context::monitor() const {
  return state_->monitor;
}

void Context::info(const std::string& message) {
  state_->console.info(state_->run.prefix + message);
}
void Context::detail(const std::string& message) {
  state_->console.detail(state_->run.prefix + message);
}
void Context::warn(const std::string& message) {
  state_->monitor.warn(message);
}

bool Context::given(std::string_view name) const {
  if (name == "dry-run") return state_->run.common.dryRun;  // of steps, too
  if (name == "max-memory") return state_->run.common.maxMemory.has_value();
  return state_->run.given.count(std::string(name)) > 0;
}
int Context::threads() const {
  return state_->record.threads;
}
bool Context::isPrivate() const {
  return state_->run.common.privateRecord;
}

}  // namespace explica::app
