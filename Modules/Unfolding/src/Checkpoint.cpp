// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Unfolding/Unfold.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace explica::unfolding {
namespace {

constexpr char kMagic[] = "ExplicaUnfold7\n";
static_assert(sizeof(std::int64_t) == 8 && sizeof(double) == 8 && sizeof(HeldPair) == 20);

/// FNV-1a: tells a damaged file, not a forged one.
std::uint64_t checkSum(std::string_view bytes) {
  std::uint64_t sum = 14695981039346656037u;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return sum;
}

class Writer {
 public:
  void number(double value) { raw(&value, sizeof value); }
  void count(std::int64_t value) { raw(&value, sizeof value); }
  void points(const Positions& p) {
    count(p.rows());
    raw(p.data(), static_cast<std::size_t>(p.size()) * sizeof(double));
  }
  void numbers(const std::vector<double>& list) {
    count(static_cast<std::int64_t>(list.size()));
    raw(list.data(), list.size() * sizeof(double));
  }
  void raw(const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  }
  std::string bytes;
};

class Reader {
 public:
  Reader(std::string bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {}
  double number() {
    double value;
    raw(&value, sizeof value);
    return value;
  }
  std::int64_t count() {
    std::int64_t value;
    raw(&value, sizeof value);
    if (value < 0 || static_cast<std::size_t>(value) > bytes_.size()) fail("is damaged");
    return value;
  }
  Positions points() {
    Positions p(count(), 3);
    raw(p.data(), static_cast<std::size_t>(p.size()) * sizeof(double));
    return p;
  }
  std::vector<double> numbers() {
    std::vector<double> list(static_cast<std::size_t>(count()));
    raw(list.data(), list.size() * sizeof(double));
    return list;
  }
  void raw(void* data, std::size_t size) {
    if (at_ + size > bytes_.size()) fail("is truncated");
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& cause) const {
    throw IOError(name_ + " " + cause + "; it is not a complete state of an unfolding");
  }

 private:
  std::string bytes_, name_;
  std::size_t at_ = 0;
};

/// The members of a record, one list for writing and reading.
template <class Record, class Visit>
void visitNumbers(Record& r, const Visit& visit) {
  for (auto* member :
       {&r.visibility, &r.areaErrorMean, &r.areaErrorMax, &r.edgeStrainMean, &r.collarStretchMean,
        &r.collarStretchMax, &r.objectiveBefore, &r.objectiveAfter, &r.nearestContact, &r.safeStep,
        &r.step, &r.largestMove, &r.damping, &r.phases.visibility, &r.phases.repulsion,
        &r.phases.collision, &r.phases.solve, &r.seconds}) {
    visit(*member);
  }
  for (auto& energy : r.energies.values) visit(energy);
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  Writer w;
  const UnfoldState& s = checkpoint.state;
  w.points(s.positions);
  w.count(s.multipliers.size());
  w.raw(s.multipliers.data(), static_cast<std::size_t>(s.multipliers.size()) * sizeof(double));
  w.number(s.damping);
  w.number(s.areaStiffness);
  w.number(s.drive);
  w.count(s.driveIteration);
  w.number(s.firmness);
  w.number(s.lift);
  w.number(s.collarWidth);
  w.count(s.ways);
  w.number(s.contactStiffness);
  w.count(s.iteration);
  w.count(s.separating);
  w.number(s.separatingEnergy);
  w.count(s.stalled);
  w.count(static_cast<std::int64_t>(s.held.size()));
  for (const HeldPair& held : s.held) w.raw(&held, sizeof held);
  w.count(checkpoint.best.iteration);
  w.number(checkpoint.best.visibility);
  w.number(checkpoint.best.strain);
  w.points(checkpoint.best.moving);
  w.count(static_cast<std::int64_t>(checkpoint.history.size()));
  for (const IterationRecord& r : checkpoint.history) {
    w.count(r.iteration);
    w.count(r.contacts);
    w.count(r.solves);
    visitNumbers(r, [&](const double& value) { w.number(value); });
  }
  w.count(static_cast<std::int64_t>(checkpoint.path.size()));
  for (const Positions& p : checkpoint.path) w.points(p);
  if (s.directions.rows() > 0) {  // of an unfolding towards viewpoints there is no more to say
    w.points(s.directions);
    w.numbers(checkpoint.notes);
  }
  const std::uint64_t sum = checkSum(w.bytes);

  WholeFile file(path);
  file.write(kMagic);
  file.write(&sum, sizeof sum);
  file.write(w.bytes);
  file.commit();
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IOError(path.string() + " cannot be read; nothing was left to resume from");
  std::string all{std::istreambuf_iterator<char>(in), {}};
  const std::size_t head = sizeof kMagic - 1;
  Reader whole(all, path.string());
  if (all.compare(0, head, kMagic) != 0 || all.size() < head + 8) whole.fail("has another format");
  std::uint64_t sum;
  std::memcpy(&sum, all.data() + head, sizeof sum);
  Reader r(all.substr(head + 8), path.string());
  if (sum != checkSum(std::string_view(all).substr(head + 8))) r.fail("is damaged");

  Checkpoint c;
  c.state.positions = r.points();
  c.state.multipliers.resize(r.count());
  r.raw(c.state.multipliers.data(),
        static_cast<std::size_t>(c.state.multipliers.size()) * sizeof(double));
  c.state.damping = r.number();
  c.state.areaStiffness = r.number();
  c.state.drive = r.number();
  c.state.driveIteration = static_cast<int>(r.count());
  c.state.firmness = r.number();
  c.state.lift = r.number();
  c.state.collarWidth = r.number();
  c.state.ways = static_cast<int>(r.count());
  c.state.contactStiffness = r.number();
  c.state.iteration = static_cast<int>(r.count());
  c.state.separating = r.count() != 0;
  c.state.separatingEnergy = r.number();
  c.state.stalled = r.count() != 0;
  c.state.held.resize(static_cast<std::size_t>(r.count()));
  for (HeldPair& held : c.state.held) r.raw(&held, sizeof held);
  c.best.iteration = static_cast<int>(r.count());
  c.best.visibility = r.number();
  c.best.strain = r.number();
  c.best.moving = r.points();
  c.history.resize(static_cast<std::size_t>(r.count()));
  for (IterationRecord& row : c.history) {
    row.iteration = static_cast<int>(r.count());
    row.contacts = static_cast<int>(r.count());
    row.solves = static_cast<int>(r.count());
    visitNumbers(row, [&](double& value) { value = r.number(); });
  }
  c.path.resize(static_cast<std::size_t>(r.count()));
  for (Positions& p : c.path) p = r.points();
  if (!r.atEnd()) {
    c.state.directions = r.points();
    c.notes = r.numbers();
  }
  return c;
}

}  // namespace explica::unfolding
