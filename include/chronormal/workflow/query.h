/// Answers queries about the normals of a motion over whole intervals of time, as arrays, for `chronormal query`.
///
/// A query takes a motion and a span of its time, processes every segment in the span, and returns tables of equally
/// long columns. The headers in analysis/ define the answer for one segment and its guarantees. Here the answers for
/// all segments become rows, which name their segment and face.
///
///     const Result<QueryAnswer> answer = query_collapse(motion);
///     write_query(answer.value(), "collapses.npz", false);
///
/// Units      a `t` is a fraction of a segment, in [0, 1]; a `time` is in seconds, or the weight of a target.
/// Threads    every query uses all threads (core/parallel.h); the answer is the same for any number of threads.
#ifndef CHRONORMAL_WORKFLOW_QUERY_H_
#define CHRONORMAL_WORKFLOW_QUERY_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "chronormal/analysis/signs.h"
#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

inline namespace internal {
class Expansion;  // limits the memory and the output that reading a file may cause
}

/// The span of time of a query, in times of the motion, or in weights for targets. The defaults are the beginning and
/// the end of the motion.
struct QuerySpan {
  std::optional<double> from = {}, to = {};
  /// The limit on the size of the answer, which the program sets; nullptr means no limit. If a query has a row for
  /// every face of every segment, the rows are counted before anything is computed. Other rows are counted as they are
  /// found.
  const Expansion* expansion = nullptr;
};

/// The part of one segment that is inside a span: t from t0 to t1, with t0 < t1.
struct SegmentPart {
  std::size_t segment = 0;
  double t0 = 0, t1 = 1;
};

/// Returns the parts of all segments that are inside a span, in ascending order. Errors: kUsage, with --from or --to as
/// the place, for an empty span or a span outside of the motion.
[[nodiscard]] Result<std::vector<SegmentPart>> segment_parts(const Motion& motion, const QuerySpan& span);

/// A column of an answer, which is an array with one entry for each row of its table.
struct QueryColumn {
  /// The numbers of a column. A boolean is one byte, which is 0 or 1.
  using Values =
      std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<float>, std::vector<std::uint8_t>>;

  std::string name;
  Values values;
  std::size_t width = 1;  ///< number of numbers in an entry: 1, or 3 for a vector

  [[nodiscard]] std::size_t rows() const noexcept;
};

struct QueryTable {
  /// The prefix of the names of the table's arrays in a file, or empty. The table "crossing" has the arrays
  /// crossing_face and so on.
  std::string name;
  std::string meaning;  ///< a description of the rows for users: "collapses of faces"
  std::vector<QueryColumn> columns = {};

  [[nodiscard]] std::size_t rows() const noexcept { return columns.empty() ? 0 : columns.front().rows(); }
};

/// A single number that belongs to the answer of a query.
struct QueryFact {
  std::string name;     ///< the key of the number in JSON: "faces"
  std::string meaning;  ///< a description of the number for users: "faces that collapse"
  double value = 0;
};

struct QueryAnswer {
  std::string question;  ///< the name of the query: "collapse"
  std::vector<QueryFact> facts;
  std::vector<QueryTable> tables;
};

/// A function that is called in the calling thread with the amount of work that is done and the total amount.
using QueryProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Finds when and where faces collapse (analysis/signs.h), exactly. Tables:
///     ""        segment, face, lower, upper (t), time, turns_over, before, after: one row for each collapse
///     always    segment, face: n is zero in the whole segment
/// Errors: those of segment_parts().
[[nodiscard]] Result<QueryAnswer> query_collapse(const Motion& motion, const QuerySpan& span = {},
                                                 const QueryProgress& progress = {});

/// Finds when faces show their front or their back (analysis/signs.h). A moving eye moves from the first to the last
/// time of the motion, and its positions at the ends of segments are rounded to float32; for targets it moves with the
/// weight. Tables:
///     ""           segment, face, from, from_upper, to_lower, to: the face shows its front at every t in (from_upper,
///                  to_lower), and at none outside of [from, to]; cut off at the ends of the span
///     silhouette   segment, vertices, faces, from, from_upper, to_lower, to: the two faces of an edge show different
///                  sides
/// Silhouettes are included if requested, for faces only. The sides of vertices or corners, whose normals are sums over
/// faces, are decided exactly as well, as seen from the vertex. The column `face` is then `vertex` or `corner`, and
/// vertices in no face have no row. Errors: those of make_groups() and segment_parts(); kUsage for the direction (0, 0,
/// 0).
[[nodiscard]] Result<QueryAnswer> query_facing(const Motion& motion, const View& view, bool silhouettes,
                                               const QuerySpan& span = {}, const QueryProgress& progress = {},
                                               const ElementOptions& elements = {ElementKind::kFaces});

/// Finds the points that are inside a closed mesh at the first instant of the span, and the time, place and direction
/// of all crossings of the surface (analysis/containment.h). A point moves on a straight line at constant speed from
/// the first to the last time of the motion, independent of the span. At keyframes the positions of points are rounded
/// to float32, like those of vertices. Vertices that coincide in all keyframes are one point (normals/normal_groups.h).
/// Tables:
///     ""         inside: one row for each point
///     crossing   point, time, segment, face, inward, normal (rows, 3): ordered by point and time; for targets, by
///                point, segment and weight
/// If the weights of an animation jump, a point may get inside or outside without a crossing. Errors: those of
/// segment_parts() and Containment::make().
[[nodiscard]] Result<QueryAnswer> query_contain(const Motion& motion, const PointPaths& points,
                                                const QuerySpan& span = {}, const QueryProgress& progress = {});

/// Finds cones that contain every normal of a face during a part of a segment (analysis/cones.h). Tables:
///     ""        segment, face, axis, sine, half_angle (degrees, rounded up): one row for each segment and face
///     meshlet   segment, index, and the members of meshopt_Bounds (analysis/cones.h), which are valid for that part
///     member    meshlet, face
/// The last two tables are included if `meshlets`, the largest number of triangles in a meshlet, is given.
/// meshoptimizer builds the meshlets from the first keyframe. Errors: those of segment_parts(); kUsage, with --meshlets
/// as the place, for a number that is not a multiple of 4 up to 512, and for a mesh of polygons.
[[nodiscard]] Result<QueryAnswer> query_cones(const Motion& motion, std::optional<std::size_t> meshlets = {},
                                              const QuerySpan& span = {}, const QueryProgress& progress = {});

/// Computes the mean normals of faces while a shutter is open over the span (analysis/cones.h). Tables:
///     ""        segment, face, mean, mean_unit, error, length (of mean_unit), half_angle (of the cone, degrees), ends
///               (the direction halfway between the unit normals at both ends, which is the mean of lerp and nlerp),
///               and ends_off (degrees between ends and mean_unit): one row for each segment and face
///     span      the same columns without segment, for all parts together, weighted by their duration; not for targets
/// For vertices or corners, the column `face` is `vertex` or `corner`, and everything is computed in integers. Errors:
/// those of make_groups() and segment_parts().
[[nodiscard]] Result<QueryAnswer> query_shutter(const Motion& motion, const QuerySpan& span = {},
                                                const QueryProgress& progress = {},
                                                const ElementOptions& elements = {ElementKind::kFaces});

/// Writes the columns of an answer as a .npz file: int64, float64, float32 and bool, named TABLE_COLUMN, or COLUMN if
/// the table has no name. Errors: kUsage for another extension; those of write_output().
[[nodiscard]] Status write_query(const QueryAnswer& answer, const std::string& path, bool force);

/// Return the size of an answer in bytes. bytes_of_query() counts its arrays, which take as many bytes in memory as in
/// .npz. json_bytes_of_query() is an upper bound for its JSON.
[[nodiscard]] std::uint64_t bytes_of_query(const QueryAnswer& answer) noexcept;
[[nodiscard]] std::uint64_t json_bytes_of_query(const QueryAnswer& answer) noexcept;

/// Returns the errors that write_query() would return for a path, so that a caller can find out before a long
/// computation. Errors: kUsage for an extension other than .npz; those of check_output().
[[nodiscard]] Status check_query_output(const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_QUERY_H_
