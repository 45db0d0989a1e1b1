/// The sections of docs/benchmarks.md, for the results of one machine.
#ifndef BENCHMARKS_SECTIONS_H_
#define BENCHMARKS_SECTIONS_H_

#include "benchmarks/results.h"
#include "support/page.h"
#include "support/statistics.h"

namespace chronormal::benchmarks {

using namespace pages;

void write_costs(Page& page, const Results& results);     ///< nanoseconds of everybody, cost against size
void write_aims(Page& page, const Results& results);      ///< ratios within the run beside what was aimed at
void write_memory(Page& page, const Results& results);    ///< bandwidths
void write_schemes(Page& page, const Results& results);   ///< quality against cost
void write_blend(Page& page, const Results& results);     ///< of blend shapes; nothing where no run measured them
void write_accuracy(Page& page, const Results& results);  ///< every path against double

[[nodiscard]] std::string nanoseconds(double ns);

}  // namespace chronormal::benchmarks

#endif  // BENCHMARKS_SECTIONS_H_
