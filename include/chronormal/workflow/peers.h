/// Processes that do one task together, each its own shard (workflow/shard.h), as far as the library needs to know of
/// them: it can send texts and numbers between them, by whatever the program that runs it has for that, such as MPI.
///
/// Every process makes the same calls in the same order. One that fails makes none any more, and its program must end
/// the others.
#ifndef CHRONORMAL_WORKFLOW_PEERS_H_
#define CHRONORMAL_WORKFLOW_PEERS_H_

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace chronormal {

struct Peers {
  /// Returns in the process of the first shard the texts of all, in the order of the shards, once all have called this;
  /// in the others nothing.
  std::function<std::vector<std::string>(const std::string& own)> gather;
  /// Returns in every process the text of the first.
  std::function<std::string(const std::string& of_first)> broadcast;
  /// Makes each number the largest of those that all processes have in its place; all have as many.
  std::function<void(std::span<double> numbers)> maximize = {};
};

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_PEERS_H_
