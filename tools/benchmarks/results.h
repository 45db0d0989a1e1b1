/// What ./run bench wrote on one machine: bench/results/NAME.json.
#ifndef BENCHMARKS_RESULTS_H_
#define BENCHMARKS_RESULTS_H_

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chronormal::benchmarks {

struct Row {
  std::string group, size, order, name, library, note;
  double elements = 0, ns = 0, spread = 0, share = 0;  // ns: median; share: of what the memory allows, 0: not known
  int threads = 1, evaluations = 1;
};

struct Bandwidth {
  double bytes = 0, read = 0, stream = 0, copy = 0;  // GB/s
};

struct SchemeQuality {
  std::string scheme, mesh;
  double mean_degrees = 0, max_degrees = 0, bytes = 0;
};

struct Accuracy {
  std::string path, mesh, of;
  double bound = 0, mean = 0, share_9999 = 0, max = 0, bytes = 0;  // radians
};

/// What ./run bench --commands wrote on one machine: bench/results/commands/NAME.json.
struct CommandRow {
  std::string name;
  double wall = 0, cpu = 0;  // seconds
};
struct CommandInput {
  std::string title;
  double bytes = 0;
  std::vector<CommandRow> rows;  ///< cat, memcpy, reading, then commands
};
struct ObjReader {
  std::string name;
  double cpu_ms = 0;
};
struct Commands {
  double vertices = 0, faces = 0, keyframes = 0;
  std::vector<CommandInput> inputs;
  double obj_bytes = 0;
  std::vector<ObjReader> readers;  ///< the first one is the loop that checks nothing
};

struct Results {
  std::string name;  ///< of the file
  bool quick = false;
  std::vector<std::pair<std::string, std::string>> machine, rivals;
  std::vector<Bandwidth> bandwidths;
  std::vector<Row> rows;
  std::vector<SchemeQuality> qualities;
  std::vector<Accuracy> accuracies;
  std::optional<Commands> commands;

  /// The row of a path or a rival; nullptr where there is none. On many threads: of the same path, however many.
  [[nodiscard]] const Row* find(const std::string& group, const std::string& size, const std::string& order,
                                const std::string& path, bool many_threads = false) const;
  /// Whether there is any row of this group, or of this path in it. Older results may have no such rows.
  [[nodiscard]] bool knows(const std::string& group, const std::string& path = "") const;
  [[nodiscard]] const std::string& machine_value(const std::string& key) const;
};

/// A column of the tables: a size and an order.
struct Column {
  std::string size, order, title;
};
[[nodiscard]] const std::vector<Column>& columns();
inline const std::string kGrid = "grid", kShuffled = "shuffled";

/// Throws std::runtime_error, with the path, where the file is no such result.
[[nodiscard]] Results read_results(const std::filesystem::path& path);
[[nodiscard]] Commands read_commands(const std::filesystem::path& path);

/// What the page needs and the results lack, a line each: every rival, path, scheme and size.
[[nodiscard]] std::vector<std::string> missing_rows(const Results& results);

/// The rows of the tables, in their order.
[[nodiscard]] const std::vector<std::string>& rivals_of(const std::string& group);
[[nodiscard]] const std::vector<std::string>& ours();
[[nodiscard]] const std::vector<std::string>& threaded();  ///< those of ours that also run on many threads
[[nodiscard]] const std::vector<std::string>& schemes();
[[nodiscard]] const std::vector<std::string>& blend_actives();  ///< numbers of active targets, as rows name them
[[nodiscard]] const std::vector<std::string>& blend_ways();
/// The same for few targets that move everything.
[[nodiscard]] const std::vector<std::string>& dense_actives();
/// Meshes other than the torus, and the rows of their tables.
[[nodiscard]] const std::vector<std::string>& other_meshes();
[[nodiscard]] const std::vector<std::string>& paths_on_meshes();
/// The name of the row of one way.
[[nodiscard]] std::string blend_row(const std::string& active, const std::string& way,
                                    const std::string& targets = "100");
/// The sizes of the columns for which there are rows of blend shapes: at each of them all are needed. Results from
/// before there were such rows have none.
[[nodiscard]] std::vector<std::string> blend_sizes(const Results& results);
/// 15k as "15 k".
[[nodiscard]] std::string spelt(const std::string& size);
[[nodiscard]] const std::vector<std::string>& accuracy_paths();
[[nodiscard]] const std::vector<std::string>& accuracy_meshes();
/// Rows that are not measured at that size, and need not be there.
[[nodiscard]] bool may_be_missing(const std::string& group, const Column& column, const std::string& name);

}  // namespace chronormal::benchmarks

#endif  // BENCHMARKS_RESULTS_H_
