// What was aimed at, beside what is: ratios of rows of one run, and why some aims are missed.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

// Aims by column: 15k, 45k, 1M, 10M, 10M shuffled; 0: none.
struct Aim {
  std::string group, what;
  std::vector<std::string> against;  // the fastest of them counts
  std::array<double, 5> at;
  enum class Kind { kTimesFaster, kShare, kShareOfBare, kThreads, kTimesRecompute } kind = Kind::kTimesFaster;
};

using Kind = Aim::Kind;

// Why an aim of this kind may be missed: what stands in the way, on any machine.
std::string reason_of(const Aim& aim) {
  switch (aim.kind) {
    case Kind::kShare:
      return "no loop gets there that reads and writes the same bytes in the same order, so that the share of the bare "
             "loop is the one to look at";
    case Kind::kThreads:
      if (aim.what.starts_with("exact") || aim.what.starts_with("compact"))
        return "two cores of a virtual machine share their way to memory, and the bare loop gains no more from the "
               "second";
      return "waking the other thread takes a part of calls that last less than a millisecond, and both threads share "
             "one way to memory in those that last longer";
    case Kind::kTimesRecompute:
      return "these aims are times the recomputing of before there were lanes, which has become faster since then, as "
             "preparing has, and by more";
    case Kind::kShareOfBare:
    case Kind::kTimesFaster:
      break;
  }
  if (aim.what.ends_with(" t"))
    return "the results of all t have to be written in any case, and a loop that does nothing else takes most of the "
           "time";
  return "the rival shares the cache and the clock of this machine, on which curves wait for the arithmetic of "
         "unpacking "
         "and normalising, and not for memory; the aim was made on a machine where both waited for memory";
}

const std::vector<Aim>& aims() {
  static const std::vector<std::string> libraries = {"OpenMesh update_vertex_normals", "OpenMesh update_normals",
                                                     "OpenMesh calc_vertex_normal_correct", "VTK vtkPolyDataNormals",
                                                     "VTK vtkTriangleMeshPointNormals"};
  static const std::vector<Aim> all = {
      {"faces", "compact to float3", {"recompute"}, {4, 0, 1.9, 1.8, 15}},
      {"faces", "compact to float3", {"recompute in float32"}, {}},
      {"faces", "exact to float3", {"recompute in float32"}, {}},
      {"faces", "compact to float3", {"CGAL compute_face_normals"}, {24, 0, 12, 12, 0}},
      {"faces", "compact to float3", {"OpenMesh update_face_normals"}, {24, 0, 12, 12, 0}},
      {"vertices", "compact to float3", {"recompute"}, {15, 0, 6, 8, 30}},
      {"vertices", "exact to float3", {"recompute"}, {14, 0, 4, 5, 0}},
      {"vertices", "compact to float3", {"recompute in float32"}, {}},
      {"vertices", "exact to float3", {"recompute in float32"}, {}},
      {"vertices", "compact to float3", {"VTK vtkTriangleMeshPointNormals"}, {60, 0, 25, 20, 0}},
      {"vertices", "exact to float3", {"VTK vtkTriangleMeshPointNormals"}, {55, 0, 17, 13, 0}},
      {"vertices", "compact to float3", libraries, {0, 0, 0, 0, 100}},
      {"faces", "exact to float3", {}, {0, 0, 0.95, 0.88, 0}, Kind::kShare},
      {"faces", "compact to float3", {}, {0, 0, 0.95, 0.88, 0}, Kind::kShare},
      {"vertices", "exact to float3", {}, {0, 0, 0.95, 0.88, 0}, Kind::kShare},
      {"vertices", "compact to float3", {}, {0, 0, 0.95, 0.88, 0}, Kind::kShare},
      {"faces", "exact to float3", {"bare loop as exact"}, {}, Kind::kShareOfBare},
      {"faces", "compact to float3", {"bare loop as compact"}, {}, Kind::kShareOfBare},
      {"vertices", "exact to float3", {"bare loop as exact"}, {}, Kind::kShareOfBare},
      {"vertices", "compact to float3", {"bare loop as compact"}, {}, Kind::kShareOfBare},
      {"faces", "exact to float3", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "compact to float3", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "bare loop as exact", {}, {}, Kind::kThreads},
      {"faces", "bare loop as compact", {}, {}, Kind::kThreads},
      {"vertices", "recompute", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"vertices", "prepare compact", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "exact to float3, 64 t", {"exact to float3"}, {0, 0, 2, 0, 0}},
      {"faces", "compact to float3, 64 t", {"compact to float3"}, {}},
      {"faces", "exact to float3, 8 t", {"exact to float3"}, {0, 0, 2, 2, 0}},
      {"faces", "exact to float3, 64 t", {"bare loop that writes, 64 t"}, {}, Kind::kShareOfBare},
      {"faces", "compact to float3, 64 t", {"bare loop that writes, 64 t"}, {}, Kind::kShareOfBare},
      {"faces", "exact to float3, 8 t", {"bare loop that writes, 8 t"}, {}, Kind::kShareOfBare},
      {"faces", "prepare exact", {"recompute"}, {2.5, 2.5, 2.5, 2.5, 2.5}, Kind::kTimesRecompute},
      {"faces", "prepare compact", {"recompute"}, {2.5, 2.5, 2.5, 2.5, 2.5}, Kind::kTimesRecompute},
      {"vertices", "prepare exact", {"recompute"}, {3, 3, 3, 3, 3}, Kind::kTimesRecompute},
      {"vertices", "prepare compact", {"recompute"}, {3, 3, 3, 3, 3}, Kind::kTimesRecompute},
  };
  return all;
}

double fastest(const Results& results, const Aim& aim, const Column& column) {
  double ns = 0;
  for (const std::string& name : aim.against) {
    const Row* const row = results.find(aim.group, column.size, column.order, name);
    if (row != nullptr) ns = ns == 0 ? row->ns : std::min(ns, row->ns);
  }
  return ns;
}

std::optional<double> measured(const Results& results, const Aim& aim, const Column& column) {
  const Row* const row = results.find(aim.group, column.size, column.order, aim.what);
  if (row == nullptr) return std::nullopt;
  if (aim.kind == Kind::kShare) return row->share > 0 ? std::optional(row->share) : std::nullopt;
  if (aim.kind == Kind::kThreads) {
    const Row* const many = results.find(aim.group, column.size, column.order, aim.what, true);
    return many == nullptr ? std::nullopt : std::optional(row->ns / many->ns);
  }
  const double other = fastest(results, aim, column);
  if (other == 0) return std::nullopt;
  return aim.kind == Kind::kTimesRecompute ? row->ns / other : other / row->ns;
}

std::string number(const Aim& aim, double value) {
  if (aim.kind == Kind::kShare || aim.kind == Kind::kShareOfBare) return fmt::format("{:.0f} %", 100 * value);
  return value < 10 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::string sentence(const Aim& aim) {
  switch (aim.kind) {
    case Kind::kShare:
      return fmt::format("{}, {}: share of memory", aim.group, aim.what);
    case Kind::kShareOfBare:
      return fmt::format("{}, {}: share of the {}", aim.group, aim.what, aim.against.front());
    case Kind::kThreads:
      return fmt::format("{}, {}: many threads are times one", aim.group, aim.what);
    case Kind::kTimesRecompute:
      return fmt::format("{}, {}: takes times recompute (at most)", aim.group, aim.what);
    case Kind::kTimesFaster:
      break;
  }
  return fmt::format("{}, {}: times {}", aim.group, aim.what,
                     aim.against.size() > 1 ? "the fastest library" : aim.against.front());
}

}  // namespace

void add_aims(Page& page, const Results& results) {
  Cells header = {"what"};
  for (const Column& column : columns()) header.push_back(column.title);
  std::vector<Cells> rows;
  std::size_t reached = 0, aimed = 0;
  std::vector<std::pair<std::string, std::vector<std::string>>> missed;  // aims by their reasons
  for (const Aim& aim : aims()) {
    if (!aim.against.empty() && aim.against.front() == "recompute in float32" &&
        !results.knows(aim.group, aim.against.front()))
      continue;
    Cells cells = {sentence(aim)};
    bool all_reached = true;
    for (std::size_t c = 0; c < columns().size(); ++c) {
      const std::optional<double> value = measured(results, aim, columns()[c]);
      std::string text = value ? number(aim, *value) : "";
      if (value && aim.at[c] != 0) {
        const bool good = aim.kind == Kind::kTimesRecompute ? *value <= aim.at[c] : *value >= aim.at[c];
        text = emphasised(fmt::format("{} / {}", text, number(aim, aim.at[c])), good);
        reached += good ? 1 : 0;
        all_reached &= good;
        ++aimed;
      }
      cells.push_back(std::move(text));
    }
    rows.push_back(std::move(cells));
    if (all_reached) continue;
    const auto same = std::find_if(missed.begin(), missed.end(),
                                   [&aim](const auto& reason) { return reason.first == reason_of(aim); });
    if (same == missed.end())
      missed.push_back({reason_of(aim), {sentence(aim)}});
    else
      same->second.push_back(sentence(aim));
  }
  std::string reasons = missed.empty() ? "" : "Where the others are missed, this is why:\n";
  for (const auto& [reason, sentences] : missed) {
    reasons += "\n* ";
    for (std::size_t i = 0; i < sentences.size(); ++i) reasons += (i == 0 ? "" : "; ") + sentences[i];
    reasons += ". Here " + reason + ".";
  }
  page.table("aims", header, rows);
  page.set({{"reached", fmt::format("{}", reached)}, {"aimed", fmt::format("{}", aimed)}, {"missed", reasons}});
}

}  // namespace chronormal::benchmarks
