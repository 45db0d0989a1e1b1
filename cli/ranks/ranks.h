/// The processes of one task: the ranks that mpirun starts, where the program was built with MPI.
///
///     mpirun -n 4 chronormal compare body.obj walk.pc2 --json
///
/// Every rank runs the same command on the share of the segments or times that own_shard() names. What they find comes
/// together on the first rank, which alone prints. An error on any rank goes to the first, which says it with the
/// number of the rank and ends all of them; usage errors, which every rank has, carry no number.
///
/// A process that nobody started as a rank never starts MPI: it is the first of one, and nothing here costs it
/// anything. alone.cpp is a build without MPI, mpi.cpp a build with it.
///
/// Threads    everything here belongs to the main thread.
#ifndef CLI_RANKS_RANKS_H_
#define CLI_RANKS_RANKS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "workflow/segments/shards.h"

namespace chronormal::cli {

/// Whether the program was built with MPI.
[[nodiscard]] bool has_mpi() noexcept;

/// How many copies of this program mpirun has started that know nothing of each other: more than 1 only in a build
/// without MPI.
[[nodiscard]] std::size_t count_of_copies() noexcept;

/// Joins the other ranks, if there are any. `report` says an error, and returns its exit code. To be called once,
/// before anything else here.
void start_ranks(std::function<int(const Error&)> report);

/// The share of this rank.
[[nodiscard]] Shard own_shard() noexcept;
[[nodiscard]] inline bool has_ranks() noexcept { return !own_shard().is_all(); }

/// Returns on the first rank the texts of all, in order, once all have called this; on the others nothing, at once.
[[nodiscard]] std::vector<std::string> gather_texts(const std::string& own);

/// Returns the text of the first rank on every rank, once the first has called this.
[[nodiscard]] std::string broadcast_text(const std::string& of_first);

/// Makes each number the largest of those that all ranks have in its place, once all have called this.
void maximize_numbers(std::span<double> numbers);

/// These three, for the library; nullptr where there is one process.
[[nodiscard]] inline const Peers* ranks_as_peers() {
  static const Peers peers{gather_texts, broadcast_text, maximize_numbers};
  return has_ranks() ? &peers : nullptr;
}

/// The same progress callback, which also looks whether a rank has failed.
using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;
[[nodiscard]] ProgressCallback watching_ranks(ProgressCallback progress);

/// Ends a task: with the exit code of the first rank for all, or with the error of any. Nothing here may be called
/// afterwards. Returns the exit code.
[[nodiscard]] int end_ranks(const Result<int>& result);

}  // namespace chronormal::cli

#endif  // CLI_RANKS_RANKS_H_
