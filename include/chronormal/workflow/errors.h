/// Every single error of an audit or a comparison: one for each vertex at each sample, for plots and heat maps.
///
///     AuditOptions options;
///     options.keep_errors = true;
///     const ErrorTable& table = audit(document, options).value().errors[0];
///     table.degrees[row * table.columns() + vertex];      // at table.times[row], or table.weights[row]
///
/// Shapes     degrees is (rows, columns): a row for each sample, a column for each face, vertex or corner. NaN where
///            nothing was judged: the vertex does not move, or there is no right normal. A vertex that shows several
///            normals has the worst of them.
/// Units      degrees, seconds, weights.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/topology.h"
#include "chronormal/normals/elements.h"

namespace chronormal {

struct ErrorTable {
  std::string name;  ///< "mesh0" of a glTF file, or the scheme; empty where one table has all
  ElementKind kind = ElementKind::kVertices;
  Topology topology;             ///< the mesh
  std::vector<float> positions;  ///< (V, 3), at the first keyframe, or of the base
  /// (V) of a glTF mesh: the primitive of each vertex, and which of its vertices it is; else empty.
  std::vector<std::int64_t> primitives = {}, vertices = {};

  /// Of each row: the subject of the audit (Audit::subjects), or the segment of the motion; and when it is. One of time
  /// and weight is NaN.
  std::vector<std::int64_t> subjects = {};
  std::vector<double> times = {}, weights = {};
  std::vector<float> degrees = {};  ///< (rows, columns)

  [[nodiscard]] std::size_t rows() const noexcept { return subjects.size(); }
  [[nodiscard]] std::size_t columns() const noexcept;
  /// The worst error of each column; NaN where nothing was judged.
  [[nodiscard]] std::vector<float> worst() const;
};

/// The most bytes that the errors of one table may have.
inline constexpr std::size_t kMostErrorBytes = std::size_t{1} << 30;

/// Refuses before a long computation what write_errors() would refuse. Errors: kUsage for another extension than .npz
/// and .ply; those of check_output().
[[nodiscard]] Status check_errors_output(const std::string& path, bool force);

/// Writes tables as a file, all or nothing:
///
///     .npz    errors (rows, columns) float32, subjects (rows) int64, times and weights (rows) float64 as far as there are
///             any, and of glTF primitives and vertices (columns) int64. Where tables have names, so do their arrays:
///             mesh0_errors, linear_times
///     .ply    the mesh with the worst error, as it is at the first keyframe, with a property float quality for each vertex
///             or face: the worst error of all samples, 0 where nothing was judged. MeshLab and Blender show it
///
/// Errors: those of check_errors_output() and write_output(); kInvalidInput where there is no table; kUsage in PLY for
/// corners, and for tables of several schemes, of which only one can be shown.
[[nodiscard]] Status write_errors(std::span<const ErrorTable> tables, const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_H_
