/// Connects the processes of one task, which are the ranks that mpirun starts, if the program was built with MPI.
///
///     mpirun -n 4 chronormal compare body.obj walk.pc2 --json
///
/// Every rank runs the same command on the share of the segments or times that own_shard() returns. The results come
/// together on the first rank, which alone prints. An error on any rank goes to the first rank, which prints it with
/// the number of the rank and ends all ranks. Usage errors are the same on all ranks, and are printed without a number.
///
/// A process that was not started as a rank never starts MPI. It counts as the only rank, and these functions do
/// nothing. alone.cpp is for builds without MPI, and mpi.cpp for builds with MPI.
///
/// Threads    all functions must be called from the main thread.
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

/// Returns true if the program was built with MPI.
[[nodiscard]] bool has_mpi() noexcept;

/// Returns the number of independent copies of this program that mpirun has started. The number can be above 1 only in
/// a build without MPI.
[[nodiscard]] std::size_t count_of_copies() noexcept;

/// Connects with the other ranks, if there are any. `report` prints an error and returns its exit code. Must be called
/// once, before the other functions.
void start_ranks(std::function<int(const Error&)> report);

/// Returns the share of the work of this rank.
[[nodiscard]] Shard own_shard() noexcept;
[[nodiscard]] inline bool has_ranks() noexcept { return !own_shard().is_all(); }

/// Returns the texts of all ranks, in order, on the first rank, which waits until all ranks have called this function.
/// On the other ranks, returns an empty list without waiting.
[[nodiscard]] std::vector<std::string> gather_texts(const std::string& own);

/// Returns the text of the first rank on every rank. Waits until the first rank has called this function.
[[nodiscard]] std::string broadcast_text(const std::string& of_first);

/// Replaces each number by the largest number that any rank has at the same index. Waits until all ranks have called
/// this function.
void maximize_numbers(std::span<double> numbers);

/// Returns gather_texts(), broadcast_text() and maximize_numbers() in the form that the library takes, or nullptr if
/// there is only one process.
[[nodiscard]] inline const Peers* ranks_as_peers() {
  static const Peers peers{gather_texts, broadcast_text, maximize_numbers};
  return has_ranks() ? &peers : nullptr;
}

/// Returns a callback that passes progress on to `progress`, and also looks for errors of other ranks. If another rank
/// has failed, the callback may end the process.
using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;
[[nodiscard]] ProgressCallback watching_ranks(ProgressCallback progress);

/// Ends a task on all ranks. If all ranks succeeded, the exit code is that of the first rank; otherwise the error is
/// reported. No other function of this file may be called afterwards. Returns the exit code.
[[nodiscard]] int end_ranks(const Result<int>& result);

}  // namespace chronormal::cli

#endif  // CLI_RANKS_RANKS_H_
