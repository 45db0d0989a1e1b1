#include <utility>

#include "chronormal/analysis/signs.h"
#include "chronormal/workflow/query.h"
#include "workflow/query/parts.h"

namespace chronormal {
namespace {

// Finds the faces that collapse in a part of a segment, and the times at which they collapse.
std::vector<FaceCollapses> collapses_of(const Motion& motion, const SegmentPart& part) {
  const Segment segment = motion.segment(part.segment);
  std::vector<ControlNormals> normals(motion.topology.face_count());
  face_control_normals(segment, {0, normals.size()}, normals);
  std::vector<FaceCollapses> found = find_collapses(segment, {0, normals.size()}, normals);
  for (auto& [face, collapses] : found) {
    const auto all = collapses.at;
    const std::size_t count = std::exchange(collapses.count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (all[i].upper >= part.t0 && all[i].lower <= part.t1) collapses.at[collapses.count++] = all[i];
    }
  }
  return found;
}

// Returns the number of bytes that the rows for these collapses take in the answer.
std::uint64_t bytes_of_collapses(const std::vector<FaceCollapses>& found) {
  constexpr std::uint64_t kBytesPerCollapse = 2 * sizeof(std::int64_t) + 9 * sizeof(double) + 1;
  constexpr std::uint64_t kBytesPerAlways = 2 * sizeof(std::int64_t);
  std::uint64_t bytes = 0;
  for (const FaceCollapses& one : found)
    bytes += one.collapses.always ? kBytesPerAlways : kBytesPerCollapse * one.collapses.count;
  return bytes;
}

}  // namespace

Result<QueryAnswer> query_collapse(const Motion& motion, const QuerySpan& span, const QueryProgress& progress) {
  const Result<std::vector<SegmentPart>> parts = segment_parts(motion, span);
  if (!parts) return parts.error();
  const Result<std::vector<std::vector<FaceCollapses>>> found = for_bounded_parts<std::vector<FaceCollapses>>(
      parts.value(), span, progress, [&](const SegmentPart& part) { return collapses_of(motion, part); },
      bytes_of_collapses);
  if (!found) return found.error();

  std::vector<std::int64_t> segments, faces, always_segments, always_faces;
  std::vector<double> lower, upper, times, before, after;
  std::vector<std::uint8_t> turns_over;
  std::size_t turned = 0;
  const auto append = [](std::vector<double>& list, const Vec3d& v) { list.insert(list.end(), {v.x, v.y, v.z}); };
  for (std::size_t p = 0; p < found.value().size(); ++p) {
    const auto s = static_cast<std::int64_t>(parts.value()[p].segment);
    const Segment segment = motion.segment(parts.value()[p].segment);
    for (const auto& [face, collapses] : found.value()[p]) {
      if (collapses.always) {
        always_segments.push_back(s);
        always_faces.push_back(static_cast<std::int64_t>(face));
      }
      for (const Collapse& one : collapses.instants()) {
        segments.push_back(s);
        faces.push_back(static_cast<std::int64_t>(face));
        lower.push_back(one.lower);
        upper.push_back(one.upper);
        times.push_back(segment.start_time + one.upper * (segment.end_time - segment.start_time));
        turns_over.push_back(one.turns_over ? 1 : 0);
        turned += one.turns_over ? 1 : 0;
        append(before, one.before);
        append(after, one.after);
      }
    }
  }
  const auto count = [](std::size_t value) { return static_cast<double>(value); };
  return QueryAnswer{
      "collapse",
      {{"segments", worded(parts.value().size(), "segment examined", "segments examined"), count(parts.value().size())},
       {"faces", worded(motion.topology.face_count(), "face in each segment", "faces in each segment"),
        count(motion.topology.face_count())},
       {"collapses",
        worded(faces.size(), "time a face loses all area at an instant", "times a face loses all area at an instant"),
        count(faces.size())},
       {"turns_over",
        worded(turned, "time a face loses all area and turns over", "times a face loses all area and turns over"),
        count(turned)},
       {"always",
        worded(always_faces.size(), "time a face has no area throughout a segment",
               "times a face has no area throughout a segment"),
        count(always_faces.size())}},
      {{"",
        "instants at which a face has no area, at t in [lower, upper]",
        {{"segment", std::move(segments)},
         {"face", std::move(faces)},
         {"lower", std::move(lower)},
         {"upper", std::move(upper)},
         {"time", std::move(times)},
         {"turns_over", std::move(turns_over)},
         {"before", std::move(before), 3},
         {"after", std::move(after), 3}}},
       {"always",
        "faces without area during a whole segment",
        {{"segment", std::move(always_segments)}, {"face", std::move(always_faces)}}}}};
}

}  // namespace chronormal
