// What was aimed at, beside what is: ratios of rows of one run, and why some aims are missed.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

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

// Why an aim may be missed: what stands in the way, on any machine.
struct Reason {
  std::string title, text;

  friend bool operator==(const Reason&, const Reason&) = default;
};

Reason reason_of(const Aim& aim) {
  switch (aim.kind) {
    case Kind::kShare:
      return {
          "Shares of memory",
          "a loop that reads and writes the same bytes in the same order does not get there either. The share of the "
          "bare loop tells more."};
    case Kind::kThreads:
      if (aim.what.starts_with("exact") || aim.what.starts_with("compact"))
        return {"Many threads that evaluate",
                "two cores of a virtual machine share their way to memory, and the bare loop gains no more from the "
                "second one."};
      return {
          "Many threads that compute",
          "waking the other thread takes a part of a call that lasts less than a millisecond, and both threads share "
          "one way to memory in a call that lasts longer."};
    case Kind::kTimesRecompute:
      return {"Preparing",
              "these aims were set against a way to recompute normals that has become faster since then, as preparing "
              "has."};
    case Kind::kShareOfBare:
      return {
          "Shares of the bare loop",
          "where lanes are 256 bits wide, or memory answers at once, the arithmetic of a block takes about as long as "
          "its bytes, and not all of it is done while they come."};
    case Kind::kTimesFaster:
      break;
  }
  if (aim.what.ends_with(" t"))
    return {"Many t",
            "the results of all t are written in any case, and a loop that does nothing else takes most of that time."};
  return {
      "Times others",
      "in a cache, curves take the time of their own arithmetic, unpacking integers and normalising, which the aims "
      "left out."};
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
      {"faces", "exact to float3", {"bare loop as exact"}, {0, 0, 0.95, 0.95, 0}, Kind::kShareOfBare},
      {"faces", "compact to float3", {"bare loop as compact"}, {0, 0, 0.95, 0.95, 0}, Kind::kShareOfBare},
      {"vertices", "exact to float3", {"bare loop as exact"}, {0, 0, 0.95, 0.95, 0}, Kind::kShareOfBare},
      {"vertices", "compact to float3", {"bare loop as compact"}, {0, 0, 0.95, 0.95, 0}, Kind::kShareOfBare},
      {"faces", "exact to float3", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "compact to float3", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "bare loop as exact", {}, {}, Kind::kThreads},
      {"faces", "bare loop as compact", {}, {}, Kind::kThreads},
      {"vertices", "recompute", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
      {"faces", "prepare compact", {}, {0, 1.8, 1.8, 1.8, 0}, Kind::kThreads},
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

void add_aims(Page& page, const Results& results, const std::string& folder) {
  Cells header = {"what"};
  for (const Column& column : columns()) header.push_back(column.title);
  std::vector<Cells> rows;
  std::size_t reached = 0, aimed = 0;
  std::vector<Reason> missed;
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
    const Reason reason = reason_of(aim);
    if (std::find(missed.begin(), missed.end(), reason) == missed.end()) missed.push_back(reason);
  }
  std::string reasons;
  for (const Reason& reason : missed) {
    Page part("benchmarks/missed.md.in", folder);
    part.set({{"title", reason.title}, {"text", reason.text}});
    reasons += part.markdown();
  }
  page.table("aims", header, rows);
  page.set({{"reached", fmt::format("{}", reached)}, {"aimed", fmt::format("{}", aimed)}, {"missed", reasons}});
}

}  // namespace chronormal::benchmarks
