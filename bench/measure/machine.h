/// What a run was measured on.
#ifndef BENCH_MEASURE_MACHINE_H_
#define BENCH_MEASURE_MACHINE_H_

#include <string>
#include <utility>
#include <vector>

namespace chronormal::bench {

/// Names and values, in the order in which they are shown: cpu, cores, caches, compiler, ...
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe_machine();

/// The distance at which evaluations prefetch curves (PrefetchRule), as found out in this run.
[[nodiscard]] std::string chosen_prefetch();

/// Makes every large allocation of this process come in huge pages, also those of libraries, by starting the program
/// anew with a tunable of the C library. Does nothing where that has been done.
void restart_with_huge_pages(char** argv);

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_MACHINE_H_
