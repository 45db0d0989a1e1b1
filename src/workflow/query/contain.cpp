#include <algorithm>
#include <cmath>
#include <utility>

#include "chronormal/analysis/containment.h"
#include "chronormal/workflow/query.h"
#include "io/bytes/expansion.h"
#include "workflow/query/parts.h"

namespace chronormal {
namespace {

struct Passed {
  std::size_t segment = 0;
  double time = 0;
  Crossing crossing;
};

// Returns the positions of points at a time of the motion. `share` is the part of the motion that has passed, from 0 to
// 1. The positions are relative to the origin of the motion and in float32, like the positions of the motion's
// vertices.
std::vector<float> places_at(const PointPaths& points, const std::array<double, 3>& origin, double share) {
  std::vector<float> places(points.from.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double from = points.from[i] - origin[i % 3], to = points.to[i] - origin[i % 3];
    places[i] = static_cast<float>(points.from[i] == points.to[i] ? from : (1 - share) * from + share * to);
  }
  return places;
}

// Returns true if the faces of a closed mesh face inwards, because its signed volume is negative by much more than
// rounding errors.
bool is_inside_out(const Topology& topology, const std::vector<float>& positions) {
  const auto place = [&](std::uint32_t vertex) {
    const auto coordinate = [&](std::size_t axis) {
      return double{positions[3 * std::size_t{vertex} + axis]} - double{positions[axis]};
    };
    return Vec3d{coordinate(0), coordinate(1), coordinate(2)};
  };
  double volume = 0, size = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 2; c < face.size(); ++c) {
      const double part = dot(place(face[0]), cross(place(face[c - 1]), place(face[c])));
      volume += part;
      size += std::fabs(part);
    }
  }
  return volume < -1e-6 * size;
}

QueryAnswer answer_of(std::size_t segments, const std::vector<std::int32_t>& windings, const std::vector<Passed>& all) {
  std::vector<std::uint8_t> inside;
  inside.reserve(windings.size());
  for (const std::int32_t winding : windings) inside.push_back(winding != 0 ? 1 : 0);
  std::vector<std::int64_t> points, of_segments, faces;
  std::vector<double> times, normals;
  std::vector<std::uint8_t> inward;
  for (const auto& [segment, time, crossing] : all) {
    points.push_back(crossing.point);
    of_segments.push_back(static_cast<std::int64_t>(segment));
    faces.push_back(crossing.face);
    times.push_back(time);
    inward.push_back(crossing.inward ? 1 : 0);
    normals.insert(normals.end(), {crossing.normal.x, crossing.normal.y, crossing.normal.z});
  }
  const auto count = [](auto value) { return static_cast<double>(value); };
  return {"contain",
          {{"segments", worded(segments, "segment examined", "segments examined"), count(segments)},
           {"points", worded(inside.size(), "point", "points"), count(inside.size())},
           {"inside",
            worded(std::count(inside.begin(), inside.end(), 1), "point that is inside at the first instant",
                   "points that are inside at the first instant"),
            count(std::count(inside.begin(), inside.end(), 1))},
           {"crossings", worded(all.size(), "time a point crosses the surface", "times a point crosses the surface"),
            count(all.size())},
           {"inward",
            worded(std::count(inward.begin(), inward.end(), 1), "time a point crosses the surface inward",
                   "times a point crosses the surface inward"),
            count(std::count(inward.begin(), inward.end(), 1))}},
          {{"crossing",
            "crossings, by point and time",
            {{"point", std::move(points)},
             {"time", std::move(times)},
             {"segment", std::move(of_segments)},
             {"face", std::move(faces)},
             {"inward", std::move(inward)},
             {"normal", std::move(normals), 3}}},
           {"", "which points are inside at the first instant", {{"inside", std::move(inside)}}}}};
}

}  // namespace

Result<QueryAnswer> query_contain(const Motion& motion, const PointPaths& points, const QuerySpan& span,
                                  const QueryProgress& progress) {
  const Result<std::vector<SegmentPart>> parts = segment_parts(motion, span);
  if (!parts) return parts.error();
  const Result<Containment> containment =
      Containment::make(motion.topology, weld_coincident(motion),
                        VectorView<const float>::packed(motion.keyframes[motion.keyframes.size() / 2].positions));
  if (!containment) return containment.error();

  double first = motion.segment(0).start_time, last = first;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    first = std::min(first, motion.segment(s).start_time);
    last = std::max(last, motion.segment(s).end_time);
  }
  constexpr std::uint64_t kBytesPerCrossing = 3 * sizeof(std::int64_t) + 4 * sizeof(double) + 1;
  std::vector<std::int32_t> windings;
  std::vector<Passed> all;
  const Expansion expansion = expansion_of(span);
  RowsInBounds rows(expansion);
  SegmentRun run;
  run.progress = progress;
  run.begin(parts.value().size());
  const Status answered = run.over(run.share(), 1, [&](IndexRange one) {
    const std::size_t i = one.first;
    const SegmentPart& part = parts.value()[i];
    const Segment segment = motion.segment(part.segment);
    const auto places = [&](double time) { return places_at(points, motion.origin, (time - first) / (last - first)); };
    const std::vector<float> start = places(segment.start_time), end = places(segment.end_time);
    const auto from = VectorView<const float>::packed(start), to = VectorView<const float>::packed(end);
    if (i == 0) windings = containment.value().winding_numbers(segment, part.t0, from, to);
    const std::size_t before = all.size();
    for (const Crossing& crossing : containment.value().crossings(segment, from, to)) {
      if (part.t0 <= crossing.t && crossing.t <= part.t1)
        all.push_back(
            {part.segment, segment.start_time + crossing.t * (segment.end_time - segment.start_time), crossing});
    }
    return rows.add(kBytesPerCrossing * (all.size() - before), i + 1, parts.value().size());
  });
  if (!answered) return answered.error();
  std::stable_sort(all.begin(), all.end(),
                   [](const Passed& a, const Passed& b) { return a.crossing.point < b.crossing.point; });
  QueryAnswer answer = answer_of(parts.value().size(), windings, all);
  const std::size_t at_start = motion.segments[parts.value().empty() ? 0 : parts.value().front().segment].from;
  if (is_inside_out(motion.topology, motion.keyframes[at_start].positions))
    answer.facts.push_back(
        {"inside_out",
         "mesh that is inside out: its normals point inward, and the crossings that are called inward go outward", 1});
  return answer;
}

}  // namespace chronormal
