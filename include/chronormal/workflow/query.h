/// Answers questions about the normals of a motion over whole intervals of time with arrays, for `chronormal query`.
///
/// A question takes a motion and a span of its time, looks at every segment that the span touches, and answers with
/// tables of equally long columns. The header of the same name in analysis/ says what one segment's answer is made of,
/// and what is guaranteed; here it becomes rows that name their segment and face.
///
///     const Result<QueryAnswer> answer = query_collapse(motion);
///     write_query(answer.value(), "collapses.npz", false);
///
/// Units      a `t` is the fraction of a segment, in [0, 1]; a `time` is that of the motion: seconds, or the weight of
///            a target.
/// Threads    every question uses all (core/parallel.h); the answer is the same on any number of them.
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
class Expansion;  // how much a file may make us hold or write
}

/// The span that a question is about, in the time of the motion, or in weights for targets. Nothing: from its
/// beginning, or to its end.
struct QuerySpan {
  std::optional<double> from = {}, to = {};
  /// The limit of what the answer may take, which the program sets; nullptr: anything. Rows for every face of every
  /// segment are counted before anything is computed, and rows that have to be found are counted as they are.
  const Expansion* expansion = nullptr;
};

/// The part of one segment in a span: [t0, t1], with t0 < t1.
struct SegmentPart {
  std::size_t segment = 0;
  double t0 = 0, t1 = 1;
};

/// Returns the parts of all segments that lie in a span, ascending. Errors: kUsage, with --from or --to as the place,
/// for a span that is empty or in which there is no motion.
[[nodiscard]] Result<std::vector<SegmentPart>> segment_parts(const Motion& motion, const QuerySpan& span);

/// A column of an answer: an array whose first length is the number of rows of its table.
struct QueryColumn {
  /// The numbers of a column; truths are one byte each, 0 or 1.
  using Values =
      std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<float>, std::vector<std::uint8_t>>;

  std::string name;
  Values values;
  std::size_t width = 1;  ///< 3: an array (rows, 3)

  [[nodiscard]] std::size_t rows() const noexcept;
};

struct QueryTable {
  std::string name;     ///< prefix of its arrays in a file: "crossing" has crossing_face; may be empty
  std::string meaning;  ///< a row, in words for people: "collapses of faces"
  std::vector<QueryColumn> columns = {};

  [[nodiscard]] std::size_t rows() const noexcept { return columns.empty() ? 0 : columns.front().rows(); }
};

/// A number that sums up the answer.
struct QueryFact {
  std::string name;     ///< its key in JSON: "faces"
  std::string meaning;  ///< for people, behind the number: "faces that collapse"
  double value = 0;
};

struct QueryAnswer {
  std::string question;  ///< "collapse"
  std::vector<QueryFact> facts;
  std::vector<QueryTable> tables;
};

/// Is called with (done, total) from the calling thread.
using QueryProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Finds when and where faces collapse (analysis/signs.h), decided exactly. Tables:
///     ""        segment, face, lower, upper (t), time, turns_over, before, after: one row for each collapse
///     always    segment, face: n is zero in the whole segment
/// Errors: of segment_parts().
[[nodiscard]] Result<QueryAnswer> query_collapse(const Motion& motion, const QuerySpan& span = {},
                                                 const QueryProgress& progress = {});

/// Finds when faces show their front or their back (analysis/signs.h). The view is that of the whole motion: an eye
/// that moves does so from the first to the last time of the motion, and its places at the ends of segments are rounded
/// to float32; over targets it moves with the weight. Tables:
///     ""           segment, face, from, from_upper, to_lower, to: the face shows its front at every t in (from_upper,
///                  to_lower), and at none outside of [from, to]; cut off at the ends of the span
///     silhouette   segment, vertices, faces, from, from_upper, to_lower, to: the two faces of an edge show different sides
/// Silhouettes are there where they are asked for, of faces. The normals of vertices or corners, which are sums of those of
/// faces, are decided as exactly, each seen from its vertex: the column is `vertex` or `corner` then, and without a row
/// for those of no face. Errors: of make_groups(); of segment_parts(); kUsage for
/// the direction (0, 0, 0).
[[nodiscard]] Result<QueryAnswer> query_facing(const Motion& motion, const View& view, bool silhouettes,
                                               const QuerySpan& span = {}, const QueryProgress& progress = {},
                                               const ElementOptions& elements = {});

/// Finds the points that are inside a closed mesh at the first instant of the span, and when, where and which way each
/// crosses the surface (analysis/containment.h). A point moves on a straight line, at a constant speed, from the first
/// time of the motion to the last, whatever the span; at keyframes it is rounded to float32, as vertices are, and
/// between them it moves straight. Vertices at one point in all keyframes are one (normals/normal_groups.h). Tables:
///     ""         inside: one row for each point
///     crossing   point, time, segment, face, inward, normal (rows, 3): ordered by point and time; for targets, by
///                point, segment and weight
/// Where the weights of an animation jump, a point may be elsewhere without a crossing.
/// Errors: of segment_parts() and of Containment::make().
[[nodiscard]] Result<QueryAnswer> query_contain(const Motion& motion, const PointPaths& points,
                                                const QuerySpan& span = {}, const QueryProgress& progress = {});

/// Finds cones that contain every normal of a face while a part of a segment lasts (analysis/cones.h). Tables:
///     ""        segment, face, axis, sine, half_angle (degrees, rounded up): one row for each segment and face
///     meshlet   segment, index, and the members of meshopt_Bounds (analysis/cones.h), which hold for that part
///     member    meshlet, face
/// The last two tables are there if `meshlets` says how many triangles one may have: meshoptimizer builds meshlets from
/// the first keyframe. Errors: of segment_parts(); kUsage, with --meshlets as the place, for a number that is no
/// multiple of 4 up to 512, and for a mesh of larger faces.
[[nodiscard]] Result<QueryAnswer> query_cones(const Motion& motion, std::optional<std::size_t> meshlets = {},
                                              const QuerySpan& span = {}, const QueryProgress& progress = {});

/// Computes the mean normals of faces while a shutter is open over the span (analysis/cones.h). Tables:
///     ""        segment, face, mean, mean_unit, error, length (of mean_unit), half_angle (of the cone, degrees), ends
///               (the direction half way between the unit normals at both ends, which lerp and nlerp have as their
///               mean), and ends_off (degrees from mean_unit to it): one row for each segment and face
///     span      the same without segment, over all parts together, weighed by their duration; not for targets
/// For vertices or corners the column is `vertex` or `corner`, and integers decide all. Errors: of make_groups();
/// of segment_parts().
[[nodiscard]] Result<QueryAnswer> query_shutter(const Motion& motion, const QuerySpan& span = {},
                                                const QueryProgress& progress = {},
                                                const ElementOptions& elements = {});

/// Writes the columns of an answer as a .npz file: int64, float64, float32 and bool, named TABLE_COLUMN, or COLUMN
/// where the table has no name. Errors: kUsage for another extension; those of write_output().
[[nodiscard]] Status write_query(const QueryAnswer& answer, const std::string& path, bool force);

/// Returns the bytes that the arrays of an answer have in memory and as .npz, and at most as JSON.
[[nodiscard]] std::uint64_t bytes_of_query(const QueryAnswer& answer) noexcept;
[[nodiscard]] std::uint64_t json_bytes_of_query(const QueryAnswer& answer) noexcept;

/// Refuses before a long computation what write_query() would refuse.
[[nodiscard]] Status check_query_output(const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_QUERY_H_
