// The JSON of a run, read and checked, and the lists of what every run has to have measured.
#include "benchmarks/results.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace chronormal::benchmarks {
namespace {

constexpr const char* kChosenInFloat32 = "chosen in float32";

using Json = nlohmann::ordered_json;

std::vector<std::pair<std::string, std::string>> pairs(const Json& object) {
  std::vector<std::pair<std::string, std::string>> result;
  for (const auto& [name, value] : object.items()) result.emplace_back(name, value.get<std::string>());
  return result;
}

Results parsed(const Json& json) {
  if (json.at("chronormal_bench") != 1) throw std::runtime_error("of another version");
  Results results;
  results.quick = json.at("quick");
  results.machine = pairs(json.at("machine"));
  for (auto& [key, value] : results.machine) {
    if (key == "instruction_set" && value == "AVX3") value = "AVX-512";  // which Highway calls AVX3
  }
  results.rivals = pairs(json.at("rivals"));
  for (const Json& one : json.at("bandwidths"))
    results.bandwidths.push_back({one.at("bytes"), one.at("read_gb_s"), one.at("stream_gb_s"), one.at("copy_gb_s")});
  for (const Json& one : json.at("rows")) {
    Row row{one.at("group"), one.at("size"), one.at("order"), one.at("name"), one.at("library"), one.at("note")};
    row.elements = one.at("elements"), row.ns = one.at("median_ns"), row.spread = one.at("spread");
    row.share = one.at("share_of_bandwidth"), row.threads = one.at("threads");
    row.evaluations = one.at("evaluations");
    if (!(row.ns > 0) || !(one.at("verified_error_rad").get<double>() <= one.at("limit_rad").get<double>()))
      throw std::runtime_error(fmt::format("row '{}' took no time, or was wrong", row.name));
    results.rows.push_back(std::move(row));
  }
  for (const Json& one : json.at("qualities"))
    results.qualities.push_back(
        {one.at("scheme"), one.at("mesh"), one.at("mean_degrees"), one.at("max_degrees"), one.at("bytes")});
  for (const Json& one : json.at("accuracies"))
    results.accuracies.push_back({one.at("path"), one.at("mesh"), one.at("of"), one.at("bound_rad"), one.at("mean_rad"),
                                  one.at("share_9999_rad"), one.at("max_rad"), one.at("bytes")});
  return results;
}

}  // namespace

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {{"15k", kGrid, "15 k"},
                                          {"45k", kGrid, "45 k"},
                                          {"1M", kGrid, "1 M"},
                                          {"10M", kGrid, "10 M"},
                                          {"10M", kShuffled, "10 M shuffled"}};
  return all;
}

const std::vector<std::string>& rivals_of(const std::string& group) {
  static const std::vector<std::string> faces = {"plain C++ loop", "Eigen loop", "CGAL compute_face_normals",
                                                 "OpenMesh update_face_normals", "VTK vtkPolyDataNormals"};
  static const std::vector<std::string> vertices = {"plain C++ loop",
                                                    "Eigen loop",
                                                    "CGAL compute_vertex_normals",
                                                    "OpenMesh update_vertex_normals",
                                                    "OpenMesh update_normals",
                                                    "OpenMesh calc_vertex_normal_correct",
                                                    "VTK vtkPolyDataNormals",
                                                    "VTK vtkTriangleMeshPointNormals"};
  return group == "faces" ? faces : vertices;
}

const std::vector<std::string>& ours() {
  static const std::vector<std::string> all = {"recompute in float32",
                                               "recompute",
                                               "exact to float3",
                                               "exact to planes",
                                               "exact to octahedral",
                                               "exact to rgb10a2",
                                               "compact to float3",
                                               "compact to octahedral",
                                               "exact to float3, 8 t",
                                               "exact to float3, 64 t",
                                               "compact to float3, 8 t",
                                               "compact to float3, 64 t",
                                               "bare loop as exact",
                                               "bare loop as compact",
                                               "bare loop that writes, 8 t",
                                               "bare loop that writes, 64 t",
                                               "prepare exact",
                                               "prepare compact"};
  return all;
}

const std::vector<std::string>& threaded() {
  static const std::vector<std::string> all = {"recompute in float32", "recompute",          "exact to float3",
                                               "compact to float3",    "bare loop as exact", "bare loop as compact",
                                               "prepare exact",        "prepare compact"};
  return all;
}

const std::vector<std::string>& schemes() {
  static const std::vector<std::string> all = {"linear",        "quadratic",         "cubic",
                                               "lagrange:4",    "linear:scaled",     "slerp",
                                               "decasteljau:4", "quaternion:matrix", "quaternion:optimal",
                                               "circle",        "circle:timed",      "rational",
                                               "polynomial",    "recompute"};
  return all;
}

const std::vector<std::string>& blend_actives() {
  static const std::vector<std::string> all = {"1", "2", "4", "8", "16", "52", "100"};
  return all;
}

const std::vector<std::string>& dense_actives() {
  static const std::vector<std::string> all = {"1", "2", "5"};
  return all;
}

const std::vector<std::string>& other_meshes() {
  static const std::vector<std::string> all = {"thin", "varied", "eversion", "dance", "face"};
  return all;
}

const std::vector<std::string>& paths_on_meshes() {
  static const std::vector<std::string> all = {"plain C++ loop",  "recompute in float32", "recompute",
                                               "exact to float3", "compact to float3",    "prepare exact",
                                               "prepare compact"};
  return all;
}

const std::vector<std::string>& blend_ways() {
  static const std::vector<std::string> all = {
      "chosen",    "terms",          "touched part", kChosenInFloat32, "recompute in float32",
      "recompute", "plain C++ loop", "linear sum"};
  return all;
}

std::string blend_row(const std::string& active, const std::string& way, const std::string& targets) {
  return fmt::format("{} of {}: {}", active, targets, way);
}

std::vector<std::string> blend_sizes(const Results& results) {
  std::vector<std::string> sizes;
  for (const Column& column : columns()) {
    if (column.order != kGrid) continue;
    if (std::any_of(results.rows.begin(), results.rows.end(), [&](const Row& row) {
          return row.group == "blend" && row.size == column.size && row.order == kGrid;
        }))
      sizes.push_back(column.size);
  }
  return sizes;
}

std::string spelt(const std::string& size) {
  for (const Column& column : columns()) {
    if (column.size == size && column.order == kGrid) return column.title;
  }
  return size;
}

const std::vector<std::string>& accuracy_paths() {
  static const std::vector<std::string> all = {"exact to float3",
                                               "compact 0.0001 to float3",
                                               "compact 0.001 to float3",
                                               "compact 0.01 to float3",
                                               "compact 0.001 to octahedral",
                                               "exact to octahedral",
                                               "exact to rgb10a2",
                                               "recompute"};
  return all;
}

const std::vector<std::string>& accuracy_meshes() {
  static const std::vector<std::string> all = {"grid", "grid, far away", "cloth", "bend", "twist", "eversion", "soup"};
  return all;
}

bool may_be_missing(const std::string& group, const Column& column, const std::string& name) {
  // Three gigabytes of results, and minutes.
  if (column.size == "10M" && name.ends_with(", 64 t")) return true;
  return group == "vertices" && column.order == kShuffled && name == "CGAL compute_vertex_normals";
}

const Row* Results::find(const std::string& group, const std::string& size, const std::string& order,
                         const std::string& path, bool many_threads) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.group == group && row.size == size && row.order == order &&
           (many_threads ? row.threads > 1 && row.name.starts_with(fmt::format("{}, ", path))
                         : row.threads == 1 && row.name == path);
  });
  return found == rows.end() ? nullptr : &*found;
}

bool Results::knows(const std::string& group, const std::string& path) const {
  return std::any_of(rows.begin(), rows.end(),
                     [&](const Row& row) { return row.group == group && (path.empty() || row.name == path); });
}

const std::string& Results::machine_value(const std::string& key) const {
  for (const auto& [entry, value] : machine) {
    if (entry == key) return value;
  }
  throw std::runtime_error(fmt::format("{}: nothing is said about the machine's {}", name, key));
}

namespace {

// Returns what `parse` makes of a file; an exception of it gets the path.
template <class Parse>
auto read(const std::filesystem::path& path, const Parse& parse) {
  try {
    std::ifstream file(path, std::ios::binary);
    return parse(Json::parse(file));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace

Results read_results(const std::filesystem::path& path) {
  Results results = read(path, parsed);
  results.name = path.stem().string();
  return results;
}

Commands read_commands(const std::filesystem::path& path) {
  return read(path, [](const Json& json) {
    if (json.at("chronormal_bench_commands") != 1) throw std::runtime_error("of another version");
    Commands commands{json.at("vertices"), json.at("faces"), json.at("keyframes"), {}, json.at("obj").at("bytes"), {}};
    for (const Json& input : json.at("inputs")) {
      commands.inputs.push_back({input.at("title"), input.at("bytes"), {}});
      for (const Json& row : input.at("rows"))
        commands.inputs.back().rows.push_back({row.at("name"), row.at("wall_s"), row.at("cpu_s")});
    }
    for (const Json& reader : json.at("obj").at("readers"))
      commands.readers.push_back({reader.at("name"), reader.at("cpu_ms")});
    if (commands.inputs.empty() || commands.readers.empty()) throw std::runtime_error("nothing was measured");
    return commands;
  });
}

std::vector<std::string> missing_rows(const Results& results) {
  std::vector<std::string> missing;
  const auto need = [&](const std::string& group, const Column& column, const std::string& name, bool many_threads) {
    if (may_be_missing(group, column, name)) return;
    // Earlier runs need not have what only later ones measure.
    if (name == "recompute in float32" && !results.knows(group, name)) return;
    if (results.find(group, column.size, column.order, name, many_threads) == nullptr)
      missing.push_back(fmt::format("{}, {}, {}: {}{}", group, column.size, column.order, name,
                                    many_threads ? " on many threads" : ""));
  };
  const bool many_threads = results.machine_value("cores") != "1";
  for (const std::string group : {"faces", "vertices"}) {
    for (const Column& column : columns()) {
      need(group, column, "interpolate positions", false);
      for (const std::string& name : rivals_of(group)) need(group, column, name, false);
      for (const std::string& name : ours()) need(group, column, name, false);
      for (const std::string& name : threaded()) {
        if (many_threads) need(group, column, name, true);
      }
    }
  }
  for (const std::string& scheme : schemes()) {
    for (const char* size : {"15k", "1M"}) need("schemes", {size, kGrid, ""}, scheme, false);
    if (std::none_of(results.qualities.begin(), results.qualities.end(),
                     [&](const SchemeQuality& one) { return one.scheme == scheme && one.mesh == "twist"; }))
      missing.push_back(fmt::format("quality of {}", scheme));
  }
  for (const std::string& size : blend_sizes(results)) {
    for (const std::string& active : blend_actives()) {
      for (const std::string& way : blend_ways()) {
        const std::string row = blend_row(active, way);
        if (way == kChosenInFloat32) continue;  // earlier runs have none
        const bool is_later = way == "recompute in float32" || active == "52";
        if (!is_later || results.knows("dense blend")) need("blend", {size, kGrid, ""}, row, false);
      }
    }
    for (const std::string& active : dense_actives()) {
      if (!results.knows("dense blend")) break;
      for (const std::string& way : blend_ways()) {
        if (way != kChosenInFloat32)
          need("dense blend", {size, kGrid, ""}, blend_row(active, way, dense_actives().back()), false);
      }
    }
  }
  for (const std::string of : {"faces", "vertices"}) {
    for (const std::string& mesh : accuracy_meshes()) {
      for (const std::string& path : accuracy_paths()) {
        if (std::none_of(results.accuracies.begin(), results.accuracies.end(),
                         [&](const Accuracy& one) { return one.of == of && one.mesh == mesh && one.path == path; }))
          missing.push_back(fmt::format("accuracy, {}, {}: {}", mesh, of, path));
      }
    }
  }
  for (const std::string library : {"CGAL", "Eigen", "OpenMesh", "VTK"}) {
    if (std::none_of(results.rivals.begin(), results.rivals.end(),
                     [&](const auto& one) { return one.first == library; }))
      missing.push_back(fmt::format("the version of {}", library));
  }
  return missing;
}

}  // namespace chronormal::benchmarks
