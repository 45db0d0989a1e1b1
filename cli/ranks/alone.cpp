// Implements ranks in a build without MPI: this process is the only rank.
#include <cstdlib>
#include <utility>

#include "cli/ranks/ranks.h"

namespace chronormal::cli {
namespace {

std::function<int(const Error&)> say_error;

}  // namespace

bool has_mpi() noexcept { return false; }

std::size_t count_of_copies() noexcept {
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* const size = std::getenv(name); size != nullptr) return std::strtoul(size, nullptr, 10);
  return 1;
}

void start_ranks(std::function<int(const Error&)> report) { say_error = std::move(report); }
Shard own_shard() noexcept { return {}; }
std::vector<std::string> gather_texts(const std::string& own) { return {own}; }
std::string broadcast_text(const std::string& of_first) { return of_first; }
void maximize_numbers(std::span<double> /*numbers*/) {}
ProgressCallback watching_ranks(ProgressCallback progress) { return progress; }
int end_ranks(const Result<int>& result) { return result ? result.value() : say_error(result.error()); }

}  // namespace chronormal::cli
