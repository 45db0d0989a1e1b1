/// Describes the machine on which a run is measured, and gives the process huge pages.
#ifndef BENCH_MEASURE_MACHINE_H_
#define BENCH_MEASURE_MACHINE_H_

#include <string>
#include <utility>
#include <vector>

namespace chronormal::bench {

/// Returns names and values in the order in which tables show them: cpu, cores, caches, compiler, ...
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe_machine();

/// Describes how far ahead of the evaluation the curves are prefetched (PrefetchRule): for each size of data, the
/// distance in KiB that this run has measured to be the fastest.
[[nodiscard]] std::string chosen_prefetch();

/// Restarts the program with a tunable of the C library, so that every large allocation of this process uses huge
/// pages, including allocations of libraries. Does nothing after the restart.
void restart_with_huge_pages(char** argv);

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_MACHINE_H_
