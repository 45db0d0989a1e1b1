#include "chronormal/analysis/signs.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "chronormal/workflow/query.h"
#include "workflow/query/parts.h"

namespace chronormal {
namespace {

// An interval of t with ends that are not exactly known. The interval begins between the two numbers in `from`, and
// ends between the two numbers in `to`.
struct Interval {
  std::array<double, 2> from{}, to{};
};

struct Front {
  std::size_t element = 0;
  Interval when;
};

struct Found {
  std::vector<Front> fronts;
  std::vector<Silhouette> silhouettes;
  std::size_t always_front = 0, always_back = 0;
};

// Restricts an interval of t to a part of a segment. Returns false if nothing is left.
bool cut(Interval& when, const SegmentPart& part) {
  if (when.from[0] >= part.t1 || when.to[1] <= part.t0) return false;
  for (double& t : when.from) t = std::max(t, part.t0);
  for (double& t : when.to) t = std::min(t, part.t1);
  return true;
}

void add_fronts(const Facing& facing, std::size_t element, const SegmentPart& part, std::vector<Front>& fronts) {
  Interval when{{0, 0}, {1, 1}};
  bool is_front = facing.first() == Side::kFront;
  const auto close = [&] {
    if (cut(when, part)) fronts.push_back({element, when});
  };
  for (const FacingChange& change : facing.changes()) {
    // Ends the interval and begins the next one if a face turns edge-on and back without showing its other side.
    if (is_front) {
      when.to = {change.lower, change.upper};
      close();
    }
    is_front = change.after == Side::kFront;
    when = {{change.lower, change.upper}, {1, 1}};
  }
  if (is_front) close();
}

// Returns the view in one segment. A moving eye moves at constant speed from time `first` to time `last` of the motion.
View view_in(const Segment& segment, const View& view, double first, double last) {
  if (view.from == view.to) return view;
  return View::of_moving_eye(view.from, view.to, LocalTime::between(first, segment.start_time, last),
                             LocalTime::between(first, segment.end_time, last));
}

void add_facing(const Facing& facing, std::size_t element, const SegmentPart& part, Found& found) {
  add_fronts(facing, element, part, found.fronts);
  if (facing.count == 0) ++(facing.side == Side::kFront ? found.always_front : found.always_back);
}

// Finds when outputs face the viewer in a part of a segment. Vertices at the same point with the same normal have the
// same result, which is computed once.
Found facing_of_outputs(const Segment& segment, const View& view, const AskedOutputs& outputs,
                        const SegmentPart& part) {
  std::vector<std::optional<Facing>> facings(outputs.element_count());
  Found found;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::size_t element = outputs.element(i);
    if (outputs.faces(element).empty()) continue;
    std::optional<Facing>& facing = facings[element];
    if (!facing) facing = find_vertex_facing(segment, outputs.vertex(i), outputs.faces(element), view);
    add_facing(*facing, i, part, found);
  }
  return found;
}

Found facing_of(const Segment& segment, const View& view, bool with_silhouettes, const SegmentPart& part) {
  std::vector<ControlNormals> normals(segment.topology->face_count());
  face_control_normals(segment, {0, normals.size()}, normals);
  std::vector<Facing> facings(normals.size());
  find_facings(segment, {0, normals.size()}, normals, view, facings);
  Found found;
  for (std::size_t f = 0; f < normals.size(); ++f) add_facing(facings[f], f, part, found);
  if (!with_silhouettes) return found;
  for (Silhouette& one : find_silhouettes(segment, normals, view)) {
    Interval when{one.from, one.to};
    if (!cut(when, part)) continue;
    one.from = when.from;
    one.to = when.to;
    found.silhouettes.push_back(one);
  }
  return found;
}

// Returns the number of bytes that the rows for these intervals and silhouettes take in the answer.
std::uint64_t bytes_of_fronts(const Found& found) {
  constexpr std::uint64_t kBytesPerFront = 2 * sizeof(std::int64_t) + 4 * sizeof(double);
  constexpr std::uint64_t kBytesPerSilhouette = 5 * sizeof(std::int64_t) + 4 * sizeof(double);
  return kBytesPerFront * found.fronts.size() + kBytesPerSilhouette * found.silhouettes.size();
}

// The columns of an answer that give, for each row, the segment and the interval of t.
struct WhenColumns {
  std::vector<std::int64_t> segments;
  std::array<std::vector<double>, 4> ends;

  void add(std::size_t segment, const Interval& when) {
    segments.push_back(static_cast<std::int64_t>(segment));
    const std::array<double, 4> values{when.from[0], when.from[1], when.to[0], when.to[1]};
    for (std::size_t k = 0; k < 4; ++k) ends[k].push_back(values[k]);
  }
  void move_to(std::vector<QueryColumn>& columns) {
    columns.insert(columns.begin(), {"segment", std::move(segments)});
    constexpr std::array<const char*, 4> kNames{"from", "from_upper", "to_lower", "to"};
    for (std::size_t k = 0; k < 4; ++k) columns.push_back({kNames[k], std::move(ends[k])});
  }
};

QueryTable table_of(const char* name, const char* meaning, std::vector<QueryColumn> columns, WhenColumns when) {
  when.move_to(columns);
  return {name, meaning, std::move(columns)};
}

}  // namespace

Result<QueryAnswer> query_facing(const Motion& motion, const View& placed, bool silhouettes, const QuerySpan& span,
                                 const QueryProgress& progress, const ElementOptions& elements) {
  const bool are_faces = elements.kind == ElementKind::kFaces;
  if (silhouettes && !are_faces)
    return Error{ErrorCode::kUsage, "--silhouettes", "silhouettes can only be listed for faces; leave --elements out"};
  // Makes the position of the eye relative to the origin of the motion, as the positions of vertices are.
  View view = placed;
  const Vec3d origin = {motion.origin[0], motion.origin[1], motion.origin[2]};
  if (view.is_eye) {
    view.from = view.from - origin;
    view.to = view.to - origin;
  }
  const std::string option = view.is_eye ? "--eye" : "--direction";
  for (const Vec3d& v : {view.from, view.to}) {
    if (!is_finite(v) || max_abs(v) > std::numeric_limits<float>::max())
      return Error{ErrorCode::kUsage, option,
                   "a coordinate is NaN, infinite or too large for float32; give finite numbers of at most 3.4e38"};
  }
  if (!view.is_eye && view.from == Vec3d{})
    return Error{ErrorCode::kUsage, option, "the direction must not be 0,0,0; give at least one number that is not 0"};
  const Result<std::vector<SegmentPart>> parts = segment_parts(motion, span);
  if (!parts) return parts.error();
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    first = std::min(first, motion.segment(s).start_time);
    last = std::max(last, motion.segment(s).end_time);
  }
  std::optional<AskedOutputs> outputs;
  if (!are_faces) {
    Result<AskedOutputs> made = AskedOutputs::make(motion, elements);
    if (!made) return made.error();
    outputs = std::move(made).value();
  }
  const Result<std::vector<Found>> found = for_bounded_parts<Found>(
      parts.value(), span, progress,
      [&](const SegmentPart& part) {
        const Segment segment = motion.segment(part.segment);
        const View seen = view_in(segment, view, first, last);
        return outputs ? facing_of_outputs(segment, seen, *outputs, part) : facing_of(segment, seen, silhouettes, part);
      },
      bytes_of_fronts);
  if (!found) return found.error();

  WhenColumns when, silhouette_when;
  std::vector<std::int64_t> numbers, edge_vertices, edge_faces;
  std::size_t always_front = 0, always_back = 0;
  for (std::size_t p = 0; p < found.value().size(); ++p) {
    const std::size_t s = parts.value()[p].segment;
    for (const Front& front : found.value()[p].fronts) {
      when.add(s, front.when);
      numbers.push_back(static_cast<std::int64_t>(front.element));
    }
    for (const Silhouette& one : found.value()[p].silhouettes) {
      silhouette_when.add(s, {one.from, one.to});
      edge_vertices.insert(edge_vertices.end(), one.vertices.begin(), one.vertices.end());
      edge_faces.insert(edge_faces.end(), one.faces.begin(), one.faces.end());
    }
    always_front += found.value()[p].always_front;
    always_back += found.value()[p].always_back;
  }
  const auto count = [](std::size_t value) { return static_cast<double>(value); };
  std::size_t asked = motion.topology.face_count();
  if (outputs) {
    asked = 0;
    for (std::size_t i = 0; i < outputs->size(); ++i) asked += outputs->faces(outputs->element(i)).empty() ? 0U : 1U;
  }
  const std::size_t pairs = asked * parts.value().size();
  const std::string one(one_element(elements.kind)), all(element_kind_name(elements.kind));
  QueryAnswer answer{
      "facing",
      {{"segments", worded(parts.value().size(), "segment examined", "segments examined"), count(parts.value().size())},
       {all, worded(asked, one, all) + " in each segment", count(asked)},
       {"always_front", worded(always_front, "time a ", "times a ") + one + " shows its front during a whole segment",
        count(always_front)},
       {"always_back", worded(always_back, "time a ", "times a ") + one + " shows its back during a whole segment",
        count(always_back)},
       {"changing",
        worded(pairs - always_front - always_back, "time a ", "times a ") + one +
            " changes sides, or is seen edge-on at an instant",
        count(pairs - always_front - always_back)}},
      {}};
  answer.tables.push_back(
      table_of("", "intervals of time in which the front shows", {{one, std::move(numbers)}}, std::move(when)));
  if (!silhouettes) return answer;
  answer.facts.push_back(
      {"silhouettes", worded(edge_faces.size() / 2, "time an edge is a silhouette", "times an edge is a silhouette"),
       count(edge_faces.size() / 2)});
  answer.tables.push_back(table_of("silhouette", "silhouette edges",
                                   {{"vertices", std::move(edge_vertices), 2}, {"faces", std::move(edge_faces), 2}},
                                   std::move(silhouette_when)));
  return answer;
}

}  // namespace chronormal
