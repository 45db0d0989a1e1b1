#include "chronormal/workflow/errors.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "chronormal/io/output.h"
#include "core/text.h"
#include "io/cache/npz.h"
#include "io/mesh/ply.h"
#include "io/system/names.h"
#include "workflow/errors/error_rows.h"

namespace chronormal {
namespace {

constexpr float kNotJudged = std::numeric_limits<float>::quiet_NaN();

bool is_ply(const std::string& path) { return path_of(path).extension() == ".ply"; }

bool has_numbers(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
}

float largest(std::span<const float> degrees) {
  float worst = -1;
  for (const float value : degrees) worst = value > worst ? value : worst;
  return worst;
}

std::string npz_of(std::span<const ErrorTable> tables) {
  std::vector<std::pair<std::string, std::string>> arrays;
  for (const ErrorTable& table : tables) {
    const std::string prefix = table.name.empty() ? "" : table.name + '_';
    NpyBytes errors({table.rows(), table.columns()});
    errors.append(table.degrees);
    arrays.emplace_back(prefix + "errors", std::move(errors).bytes());
    arrays.emplace_back(prefix + "subjects", NpyBytes({table.rows()}, table.subjects).bytes());
    if (has_numbers(table.times)) arrays.emplace_back(prefix + "times", NpyBytes({table.rows()}, table.times).bytes());
    if (has_numbers(table.weights))
      arrays.emplace_back(prefix + "weights", NpyBytes({table.rows()}, table.weights).bytes());
    if (table.primitives.empty()) continue;
    arrays.emplace_back(prefix + "primitives", NpyBytes({table.columns()}, table.primitives).bytes());
    arrays.emplace_back(prefix + "vertices", NpyBytes({table.columns()}, table.vertices).bytes());
  }
  std::vector<NpzMember> members;
  members.reserve(arrays.size());
  for (const auto& [name, bytes] : arrays) members.push_back({name, bytes});
  return write_npz(members);
}

Result<std::string> ply_of(std::span<const ErrorTable> tables, const std::string& path) {
  const ErrorTable* worst = tables.data();
  for (const ErrorTable& table : tables)
    if (largest(table.degrees) > largest(worst->degrees)) worst = &table;
  if (worst->kind == ElementKind::kCorners)
    return Error{ErrorCode::kUsage, path, "PLY cannot store errors of corners; write .npz instead"};
  if (tables.size() > 1 && worst->primitives.empty())
    return Error{ErrorCode::kUsage, path,
                 "PLY can only store the errors of one scheme; choose one with --schemes, or write .npz instead"};
  std::vector<float> quality = worst->worst();
  std::replace_if(
      quality.begin(), quality.end(), [](float value) { return std::isnan(value); }, 0.0F);
  PlyProperties properties;
  (worst->kind == ElementKind::kFaces ? properties.quality_of_faces : properties.quality_of_vertices) = quality;
  const auto positions = VectorView<const float>::packed(worst->positions.data(), worst->topology.vertex_count());
  return write_ply(worst->topology, positions, properties, PlyEncoding::kBinaryLittleEndian);
}

}  // namespace

std::size_t ErrorTable::columns() const noexcept {
  if (kind == ElementKind::kFaces) return topology.face_count();
  return kind == ElementKind::kVertices ? topology.vertex_count() : topology.corner_count();
}

std::vector<float> ErrorTable::worst() const {
  std::vector<float> result(columns(), kNotJudged);
  for (std::size_t i = 0; i < degrees.size(); ++i) result[i % columns()] = std::fmax(result[i % columns()], degrees[i]);
  return result;
}

Status check_errors_output(const std::string& path, bool force) {
  const std::string extension = utf8_of(path_of(path).extension());
  if (extension != ".npz" && extension != ".ply")
    return Error{ErrorCode::kUsage, path, "the name of a file of errors must end in .npz or .ply"};
  return check_output(path, force);
}

Status write_errors(std::span<const ErrorTable> tables, const std::string& path, bool force) {
  if (const Status status = check_errors_output(path, force); !status) return status.error();
  if (tables.empty())
    return invalid_input(path,
                         "there are no errors to write, since nothing could be judged; leave the file of errors out");
  const Result<std::string> bytes = is_ply(path) ? ply_of(tables, path) : npz_of(tables);
  if (!bytes) return bytes.error();
  return write_output(path, bytes.value(), force);
}

Status internal::reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion, std::uint64_t& earlier) {
  const std::size_t columns = table.columns();
  if (columns > 0 && rows > kMostErrorBytes / sizeof(float) / columns)
    return Error{ErrorCode::kUsage, table.name,
                 "the errors of " + counted(rows, "sample", "samples") + " of " +
                     counted(columns, one_element(table.kind), element_kind_name(table.kind)) +
                     " take more than 1 GiB; ask for fewer samples, or for a part of the input"};
  // The sum cannot overflow, since the table of each mesh has at most 1 GiB.
  earlier += std::uint64_t{sizeof(float)} * rows * columns;
  if (Status status = expansion.check(earlier, "the errors of every sample"); !status) return status;
  table.degrees.reserve(rows * columns);
  return Success{};
}

std::span<float> internal::add_row(ErrorTable& table, std::size_t subject, bool is_weight, double at) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  table.subjects.push_back(static_cast<std::int64_t>(subject));
  table.times.push_back(is_weight ? kNone : at);
  table.weights.push_back(is_weight ? at : kNone);
  table.degrees.resize(table.degrees.size() + table.columns(), kNotJudged);
  return std::span(table.degrees).last(table.columns());
}

}  // namespace chronormal
