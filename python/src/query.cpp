// Answers queries about whole intervals of time. A query takes keyframes, and returns a dict of arrays.
#include <cmath>
#include <type_traits>
#include <variant>

#include "arguments.h"
#include "computation.h"

namespace chronormal::python {
namespace {

using Positions = Array<float>;
using Indices = Array<std::uint32_t>;

py::array array_of_column(QueryColumn column) {
  return std::visit(
      [&](auto& values) -> py::array {
        using T = typename std::decay_t<decltype(values)>::value_type;
        std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(values.size() / column.width)};
        if (column.width != 1) shape.push_back(static_cast<py::ssize_t>(column.width));
        if constexpr (std::is_same_v<T, std::uint8_t>)
          return array_of(std::move(values), std::move(shape)).attr("view")("bool");
        else
          return array_of(std::move(values), std::move(shape));
      },
      column.values);
}

// Returns a dict of the arrays of an answer. The keys are the names that the program uses in files. Calls `ask` without
// the GIL. Errors name the arguments `start` and `end` instead of the options --from and --to.
template <class Ask>
py::dict answer_of(const Ask& ask) {
  QueryAnswer found = without_gil([&]() -> Result<QueryAnswer> {
    Result<QueryAnswer> answer = ask();
    if (answer || (answer.error().place != "--from" && answer.error().place != "--to")) return answer;
    return Error{answer.error().code, answer.error().place == "--from" ? "start" : "end", answer.error().message};
  });
  py::dict arrays;
  for (QueryTable& table : found.tables) {
    const std::string prefix = table.name.empty() ? "" : table.name + '_';
    for (QueryColumn& column : table.columns) {
      const py::str name(prefix + column.name);
      arrays[name] = array_of_column(std::move(column));
    }
  }
  return arrays;
}

py::dict ask_collapse(const Positions& positions, const Indices& offsets, const Indices& corners,
                      const Array<double>& times, std::optional<double> start, std::optional<double> end) {
  const Motion motion = motion_of(positions, offsets, corners, times);
  return answer_of([&] { return query_collapse(motion, {start, end}); });
}

py::dict ask_facing(const Positions& positions, const Indices& offsets, const Indices& corners,
                    const Array<double>& times, std::optional<double> start, std::optional<double> end, bool is_eye,
                    const Array<double>& from, const Array<double>& to, bool silhouettes, const std::string& elements,
                    std::optional<double> crease, bool weld) {
  const ElementOptions asked = element_options(elements, crease, weld);
  const Motion motion = motion_of(positions, offsets, corners, times);
  const auto vector = [](const Array<double>& a) { return Vec3d{a.at(0), a.at(1), a.at(2)}; };
  const View view{is_eye, vector(from), vector(to)};
  return answer_of([&] { return query_facing(motion, view, silhouettes, {start, end}, {}, asked); });
}

PointPaths paths_of(const Array<double>& points) {
  const bool moves = points.ndim() == 3 && points.shape(1) == 2 && points.shape(2) == 3;
  if (!moves && !(points.ndim() == 2 && points.shape(1) == 3))
    refuse("points",
           "the shape must be (P, 3) for P points, or (P, 2, 3) for the first and last place of each, but is " +
               shape_text(points));
  const auto count = static_cast<std::size_t>(points.shape(0));
  const std::size_t row = moves ? 6 : 3;
  PointPaths paths;
  for (std::size_t i = 0; i < count; ++i) {
    const double* const first = points.data() + row * i;
    for (std::size_t k = 0; k < row; ++k) {
      if (!std::isfinite(static_cast<float>(first[k])))
        refuse("points[" + std::to_string(i) + "]",
               "a coordinate is NaN, infinite or too large for float32; give finite numbers of at most 3.4e38");
    }
    paths.from.insert(paths.from.end(), first, first + 3);
    paths.to.insert(paths.to.end(), first + row - 3, first + row);
  }
  return paths;
}

py::dict ask_contain(const Positions& positions, const Indices& offsets, const Indices& corners,
                     const Array<double>& times, std::optional<double> start, std::optional<double> end,
                     const Array<double>& points) {
  const Motion motion = motion_of(positions, offsets, corners, times);
  const PointPaths paths = paths_of(points);
  return answer_of([&] { return query_contain(motion, paths, {start, end}); });
}

py::dict ask_cones(const Positions& positions, const Indices& offsets, const Indices& corners,
                   const Array<double>& times, std::optional<double> start, std::optional<double> end,
                   std::optional<std::size_t> meshlets) {
  const Motion motion = motion_of(positions, offsets, corners, times);
  return answer_of([&] { return query_cones(motion, meshlets, {start, end}); });
}

py::dict ask_shutter(const Positions& positions, const Indices& offsets, const Indices& corners,
                     const Array<double>& times, std::optional<double> start, std::optional<double> end,
                     const std::string& elements, std::optional<double> crease, bool weld) {
  const ElementOptions asked = element_options(elements, crease, weld);
  const Motion motion = motion_of(positions, offsets, corners, times);
  return answer_of([&] { return query_shutter(motion, {start, end}, {}, asked); });
}

py::tuple cut(const Positions& positions, const Indices& offsets, const Indices& corners, const Array<double>& times,
              const std::string& text, const std::optional<Positions>& velocities) {
  const Result<Path> path = make_path(text);
  if (!path) refuse("path", path.error().message);
  Motion motion = motion_of(positions, offsets, corners, times);
  if (velocities) {
    const std::size_t size = 3 * motion.topology.vertex_count();
    if (!(velocities->ndim() == 3 && velocities->size() == positions.size() &&
          velocities->shape(0) == positions.shape(0) && velocities->shape(2) == 3))
      refuse("velocities", "the shape must be " + shape_text(positions) + ", but is " + shape_text(*velocities));
    for (std::size_t k = 0; k < motion.keyframes.size(); ++k)
      motion.keyframes[k].velocities.assign(velocities->data() + k * size, velocities->data() + (k + 1) * size);
    if (const Status status = validate(motion); !status) raise(status.error());
  }
  const CutMotion pieces = without_gil([&] { return cut_into_segments(motion, path.value()); });
  std::vector<float> all;
  std::vector<double> at;
  for (const Motion::Keyframe& keyframe : pieces.motion.keyframes) {
    all.insert(all.end(), keyframe.positions.begin(), keyframe.positions.end());
    at.push_back(keyframe.time);
  }
  const auto count = static_cast<py::ssize_t>(at.size());
  return py::make_tuple(array_of(std::move(all), {count, positions.shape(1), 3}), array_of(std::move(at), {count}));
}

}  // namespace

Motion motion_of(const Array<float>& positions, const Array<std::uint32_t>& offsets,
                 const Array<std::uint32_t>& corners, const Array<double>& times) {
  const auto keyframes = static_cast<std::size_t>(positions.shape(0)),
             vertices = static_cast<std::size_t>(positions.shape(1));
  require(times.ndim() == 1 && static_cast<std::size_t>(times.size()) == keyframes, "times",
          "there must be one time for each keyframe; give as many times as keyframes");
  Motion motion;
  motion.topology = topology_of(vertices, offsets, corners);
  for (std::size_t k = 0; k < keyframes; ++k) {
    const float* const first = positions.data() + 3 * vertices * k;
    motion.keyframes.push_back({{first, first + 3 * vertices}, times.data()[k], ""});
  }
  motion.connect_as_sequence();
  if (const Status status = validate(motion); !status) raise(status.error());
  return motion;
}

void add_queries(py::module_& module) {
  module.def("cut", &cut);
  module.def("query_collapse", &ask_collapse);
  module.def("query_cones", &ask_cones);
  module.def("query_facing", &ask_facing);
  module.def("query_contain", &ask_contain);
  module.def("query_shutter", &ask_shutter);
}

}  // namespace chronormal::python
