// Answers the query `shutter`: the normal that a renderer should use while the shutter is open. Also returns the error
// of the usual way, which interpolates between the normals at both ends.

#include "chronormal/analysis/cones.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "chronormal/workflow/query.h"
#include "normals/control/exact_curve.h"
#include "normals/control/local_time.h"
#include "workflow/query/parts.h"

namespace chronormal {
namespace {

// The mean normals of all faces, vertices or corners. The mean is over a part of a segment, or over several consecutive
// parts.
struct Means {
  std::vector<ShutterNormal> normals;
  std::vector<Vec3d> from, to;  // unit normals at the beginning and the end of the parts
  std::vector<NormalCone> cones;
};

Means means_of(const Motion& motion, const SegmentPart& part) {
  const std::size_t count = motion.topology.face_count();
  const Segment segment = motion.segment(part.segment);
  Means means{std::vector<ShutterNormal>(count), {}, {}, std::vector<NormalCone>(count)};
  face_shutter_normals(segment, {0, count}, part.t0, part.t1, means.normals);
  face_normal_cones(segment, {0, count}, part.t0, part.t1, means.cones);
  std::vector<ControlNormals> control(count);
  face_control_normals(segment, {0, count}, control);
  for (const ControlNormals& c : control) {
    means.from.push_back(unit_normal_at(c, part.t0).vector);
    means.to.push_back(unit_normal_at(c, part.t1).vector);
  }
  return means;
}

// Computes the mean normals of vertices or corners over a part of a segment. The mean of an element is computed once,
// because vertices at one point can share it.
Means means_of_outputs(const Motion& motion, const AskedOutputs& outputs, const SegmentPart& part) {
  const Segment segment = motion.segment(part.segment);
  struct One {
    ShutterNormal normal;
    NormalCone cone;
    Vec3d from, to;
  };
  std::vector<One> of_elements(outputs.element_count());
  for (std::size_t e = 0; e < of_elements.size(); ++e) {
    const std::span<const std::uint32_t> faces = outputs.faces(e);
    if (faces.empty()) continue;
    const ExactCurve curve = ExactCurve::of_faces(segment, faces);
    of_elements[e] = {shutter_normal_of_faces(segment, faces, part.t0, part.t1),
                      normal_cone_of_faces(segment, faces, part.t0, part.t1),
                      curve.unit_normal_at(local_time(part.t0)).vector,
                      curve.unit_normal_at(local_time(part.t1)).vector};
  }
  Means means;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const One& one = of_elements[outputs.element(i)];
    means.normals.push_back(one.normal);
    means.cones.push_back(one.cone);
    means.from.push_back(one.from);
    means.to.push_back(one.to);
  }
  return means;
}

// Averages the mean normals of all parts, weighted by the durations of the parts.
Means whole_of(const Motion& motion, std::span<const SegmentPart> parts, std::span<const Means> found) {
  Means whole = found.front();
  whole.to = found.back().to;
  double total = 0;
  std::vector<double> durations;
  for (const SegmentPart& part : parts) {
    const Segment segment = motion.segment(part.segment);
    durations.push_back((part.t1 - part.t0) * (segment.end_time - segment.start_time));
    total += durations.back();
  }
  for (std::size_t f = 0; f < whole.normals.size(); ++f) {
    ShutterNormal sum;
    std::vector<NormalCone> cones;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const ShutterNormal& one = found[p].normals[f];
      const double share = durations[p] / total;
      sum = {sum.mean + share * one.mean, sum.mean_unit + share * one.mean_unit,
             sum.error + share * one.error + 0x1p-48};
      cones.push_back(found[p].cones[f]);
    }
    whole.normals[f] = sum;
    whole.cones[f] = enclosing_cone(cones);
  }
  return whole;
}

// The rows of a table of mean normals, column by column.
struct Rows {
  std::vector<std::int64_t> segments, numbers;
  std::vector<double> mean, mean_unit, error, spread, half_angle, ends, ends_off;
  double sum_off = 0, largest_off = 0;
  std::size_t judged = 0;

  void add(const Means& means, std::size_t segment) {
    const auto append = [](std::vector<double>& list, const Vec3d& v) { list.insert(list.end(), {v.x, v.y, v.z}); };
    for (std::size_t f = 0; f < means.normals.size(); ++f) {
      const ShutterNormal& s = means.normals[f];
      const Vec3d between = unit(means.from[f] + means.to[f]);
      const double off = angle_between(s.mean_unit, between) * kDegreesPerRadian;
      segments.push_back(static_cast<std::int64_t>(segment));
      numbers.push_back(static_cast<std::int64_t>(f));
      append(mean, s.mean);
      append(mean_unit, s.mean_unit);
      error.push_back(s.error);
      spread.push_back(length(s.mean_unit));
      half_angle.push_back(chronormal::half_angle(means.cones[f]) * kDegreesPerRadian * (1 + 0x1p-48));
      append(ends, between);
      ends_off.push_back(off);
      if (s.mean_unit == Vec3d{} || between == Vec3d{}) continue;
      ++judged;
      sum_off += off;
      largest_off = std::max(largest_off, off);
    }
  }

  [[nodiscard]] QueryTable table(std::string name, std::string meaning, ElementKind kind, bool has_segments) && {
    QueryTable table{std::move(name), std::move(meaning), {}};
    if (has_segments) table.columns.push_back({"segment", std::move(segments)});
    table.columns.push_back({std::string(one_element(kind)), std::move(numbers)});
    table.columns.push_back({"mean", std::move(mean), 3});
    table.columns.push_back({"mean_unit", std::move(mean_unit), 3});
    table.columns.push_back({"error", std::move(error)});
    table.columns.push_back({"length", std::move(spread)});
    table.columns.push_back({"half_angle", std::move(half_angle)});
    table.columns.push_back({"ends", std::move(ends), 3});
    table.columns.push_back({"ends_off", std::move(ends_off)});
    return table;
  }
};

}  // namespace

Result<QueryAnswer> query_shutter(const Motion& motion, const QuerySpan& span, const QueryProgress& progress,
                                  const ElementOptions& elements) {
  std::optional<AskedOutputs> outputs;
  if (elements.kind != ElementKind::kFaces) {
    Result<AskedOutputs> made = AskedOutputs::make(motion, elements);
    if (!made) return made.error();
    outputs = std::move(made).value();
  }
  const std::size_t asked = outputs ? outputs->size() : motion.topology.face_count();
  const Result<std::vector<SegmentPart>> parts = segment_parts(motion, span);
  if (!parts) return parts.error();
  constexpr std::uint64_t kBytesPerRow = 2 * sizeof(std::int64_t) + 13 * sizeof(double);
  if (const Status status = check_rows(asked, one_element(elements.kind), parts.value(), kBytesPerRow, span); !status)
    return status.error();
  const std::vector<Means> found = for_parts<Means>(parts.value(), progress, [&](const SegmentPart& part) {
    return outputs ? means_of_outputs(motion, *outputs, part) : means_of(motion, part);
  });
  Rows rows;
  for (std::size_t p = 0; p < found.size(); ++p) rows.add(found[p], parts.value()[p].segment);
  const auto number = [](std::size_t value) { return static_cast<double>(value); };
  const auto mean_off = [](const Rows& of) { return of.judged == 0 ? 0 : of.sum_off / static_cast<double>(of.judged); };
  const std::string all(element_kind_name(elements.kind));
  QueryAnswer answer{
      "shutter",
      {{"segments", worded(parts.value().size(), "segment examined", "segments examined"),
        number(parts.value().size())},
       {all, worded(asked, one_element(elements.kind), all) + " in each segment", number(asked)},
       {"largest_error", "largest possible error of an average normal, as the length of the difference",
        *std::max_element(rows.error.begin(), rows.error.end())},
       {"mean_ends_off",
        "average angle in degrees between the average normal and the bisector of the normals at both ends",
        mean_off(rows)},
       {"largest_ends_off",
        "largest angle in degrees between the average normal and the bisector of the normals at both ends",
        rows.largest_off}},
      {}};
  answer.tables.push_back(std::move(rows).table(
      "", "average normals while the shutter is open, and normals half way between the ends", elements.kind, true));
  if (parts.value().size() > 1 && motion.kind != MotionKind::kTargets) {
    Rows whole;
    whole.add(whole_of(motion, parts.value(), found), 0);
    answer.facts.push_back(
        {"span_mean_ends_off",
         "average angle in degrees between the average normal over the whole time and the bisector of "
         "the normals at its ends",
         mean_off(whole)});
    answer.facts.push_back(
        {"span_largest_ends_off",
         "largest angle in degrees between the average normal over the whole time and the bisector of "
         "the normals at its ends",
         whole.largest_off});
    answer.tables.push_back(
        std::move(whole).table("span", "average normals over the whole time", elements.kind, false));
  }
  return answer;
}

}  // namespace chronormal
