/// The sections of docs/benchmarks.md for the results of one machine. Each sets what machine.md.in has places for.
#ifndef BENCHMARKS_SECTIONS_H_
#define BENCHMARKS_SECTIONS_H_

#include "benchmarks/results.h"
#include "support/numbers.h"
#include "support/page.h"

namespace chronormal::benchmarks {

using namespace pages;

void add_costs(Page& page, const Results& results);  ///< nanoseconds of everybody, cost against size
/// Ratios within the run beside what was aimed at, and why some aims are missed.
void add_aims(Page& page, const Results& results, const std::string& folder);
void add_memory(Page& page, const Results& results);    ///< bandwidths
void add_schemes(Page& page, const Results& results);   ///< quality against cost
void add_accuracy(Page& page, const Results& results);  ///< every path against double
/// The part on blend shapes; empty where no run measured them.
[[nodiscard]] std::string blend_part(const Results& results, const std::string& folder);

/// The parts on other meshes, and on the cost of a frame by the number of frames in a segment; each is empty where no
/// run measured it.
[[nodiscard]] std::string meshes_part(const Results& results, const std::string& folder);
[[nodiscard]] std::string frames_part(const Results& results, const std::string& folder);

/// The part on answers for whole intervals of time; it is empty where no run measured them.
[[nodiscard]] std::string uses_part(const Results& results, const std::string& folder);

/// The part on what commands of the program take; empty where no run measured them.
[[nodiscard]] std::string commands_part(const Results& results, const std::string& folder);

/// The same rows of all machines, a column for each.
[[nodiscard]] std::string side_by_side(const std::vector<Results>& machines);

[[nodiscard]] std::string nanoseconds(double ns);
/// The median, and the distance between the quartiles in percent of it; "-" where there is no row.
[[nodiscard]] std::string cell(const Row* row);
/// In bold where it is good.
[[nodiscard]] std::string emphasised(const std::string& text, bool good);

}  // namespace chronormal::benchmarks

#endif  // BENCHMARKS_SECTIONS_H_
