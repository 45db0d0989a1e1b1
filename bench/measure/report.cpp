#include "measure/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace chronormal::bench {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return value;
  return std::stod(fmt::format("{:.3e}", value));
}

const Row* find(const std::vector<Row>& rows, const Row& like, const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.group == like.group && row.size == like.size && row.order == like.order && row.name == name;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::string nanoseconds(double ns) {
  return ns < 10 ? fmt::format("{:.3f}", ns) : ns < 100 ? fmt::format("{:.2f}", ns) : fmt::format("{:.0f}", ns);
}

std::string rows_table(const std::vector<Row>& rows) {
  std::string text;
  std::string last;
  for (const Row& row : rows) {
    const std::string title = fmt::format("{}, {} ({}), {}", row.group, row.size, row.elements, row.order);
    if (title != last) {
      text += fmt::format(
          "\n{:42} {:>9}  {:>6}  {:>9}  {:>9}  {:>9}  {}\n{:42} {:>9}  {:>6}  {:>9}  {:>9}  {:>9}  {}\n", title,
          "median", "spread", "recompute", "share of", "verified", "", "", "ns", "%", "is x", "memory, %", "rad", "");
      last = title;
    }
    const Row* const recompute = find(rows, row, "recompute");
    text += fmt::format("{:42} {:>9}  {:>6.1f}  {:>9}  {:>9}  {:>9.1e}  {}\n", row.name, nanoseconds(row.median_ns),
                        100 * row.spread,
                        recompute == nullptr ? "" : fmt::format("{:.2f}", recompute->median_ns / row.median_ns),
                        row.share_of_bandwidth > 0 ? fmt::format("{:.0f}", 100 * row.share_of_bandwidth) : "",
                        row.verified_error, row.note);
  }
  return text;
}

}  // namespace

std::string tables_of(const Report& report) {
  std::string text;
  for (const auto& [name, value] : report.machine) text += fmt::format("{:16} {}\n", name, value);
  for (const auto& [name, version] : report.rivals) text += fmt::format("{:16} {}\n", name, version);
  text += "\nnanoseconds are per element and evaluation; spread: between the quartiles, of the median\n";
  text += rows_table(report.rows);
  if (!report.bandwidths.empty()) {
    text += fmt::format("\n{:>14}  {:>10}  {:>10}  {:>10}\n{:>14}  {:>10}  {:>10}  {:>10}\n", "working set", "read",
                        "stream", "copy", "KiB", "GB/s", "GB/s", "GB/s");
    for (const Bandwidth& one : report.bandwidths)
      text += fmt::format("{:>14.0f}  {:>10.1f}  {:>10.1f}  {:>10.1f}\n", static_cast<double>(one.bytes) / 1024,
                          one.read, one.stream, one.copy);
  }
  if (!report.qualities.empty()) {
    text += fmt::format("\n{:20} {:10} {:>10}  {:>10}\n{:20} {:10} {:>10}  {:>10}\n", "scheme", "mesh", "mean", "max",
                        "", "", "degrees", "degrees");
    for (const SchemeQuality& one : report.qualities)
      text +=
          fmt::format("{:20} {:10} {:>10.2e}  {:>10.2e}\n", one.scheme, one.mesh, one.mean_degrees, one.max_degrees);
  }
  if (!report.accuracies.empty()) {
    text += fmt::format("\n{:26} {:16} {:9} {:>9}  {:>9}  {:>9}  {:>9}  {:>7}\n", "accuracy, radians", "mesh", "of",
                        "promised", "mean", "99.99 %", "max", "bytes");
    for (const Accuracy& one : report.accuracies)
      text += fmt::format("{:26} {:16} {:9} {:>9.1e}  {:>9.1e}  {:>9.1e}  {:>9.1e}  {:>7}\n", one.path, one.mesh,
                          one.elements, one.bound, one.mean, one.share_9999, one.max,
                          one.bytes > 0 ? fmt::format("{:.1f}", one.bytes) : "");
  }
  return text;
}

std::string json_of(const Report& report) {
  Json json;
  json["chronormal_bench"] = 1;
  json["quick"] = report.quick;
  for (const auto& [name, value] : report.machine) json["machine"][name] = value;
  json["rivals"] = Json::object();
  for (const auto& [name, version] : report.rivals) json["rivals"][name] = version;
  json["bandwidths"] = Json::array();
  for (const Bandwidth& one : report.bandwidths)
    json["bandwidths"].push_back({{"bytes", one.bytes},
                                  {"read_gb_s", rounded(one.read)},
                                  {"stream_gb_s", rounded(one.stream)},
                                  {"copy_gb_s", rounded(one.copy)}});
  json["rows"] = Json::array();
  for (const Row& row : report.rows) {
    Json one = {{"group", row.group},
                {"size", row.size},
                {"order", row.order},
                {"name", row.name},
                {"library", row.library},
                {"note", row.note},
                {"elements", row.elements},
                {"threads", row.threads},
                {"evaluations", row.evaluations},
                {"median_ns", rounded(row.median_ns)},
                {"least_ns", rounded(row.least_ns)},
                {"spread", rounded(row.spread)},
                {"repetitions", row.repetitions},
                {"bytes_read", rounded(row.bytes_read)},
                {"bytes_written", rounded(row.bytes_written)},
                {"share_of_bandwidth", rounded(row.share_of_bandwidth)},
                {"verified_error_rad", rounded(row.verified_error)},
                {"limit_rad", rounded(row.limit)},
                {"verified_elements", row.verified_elements}};
    json["rows"].push_back(std::move(one));
  }
  json["qualities"] = Json::array();
  for (const SchemeQuality& one : report.qualities)
    json["qualities"].push_back({{"scheme", one.scheme},
                                 {"mesh", one.mesh},
                                 {"mean_degrees", rounded(one.mean_degrees)},
                                 {"max_degrees", rounded(one.max_degrees)},
                                 {"bytes", rounded(one.bytes)}});
  json["accuracies"] = Json::array();
  for (const Accuracy& one : report.accuracies)
    json["accuracies"].push_back({{"path", one.path},
                                  {"mesh", one.mesh},
                                  {"of", one.elements},
                                  {"bound_rad", rounded(one.bound)},
                                  {"mean_rad", rounded(one.mean)},
                                  {"share_9999_rad", rounded(one.share_9999)},
                                  {"max_rad", rounded(one.max)},
                                  {"samples", one.samples},
                                  {"bytes", rounded(one.bytes)}});
  return json.dump(1) + "\n";
}

}  // namespace chronormal::bench
