// Containment: which points are inside a closed mesh, and when they cross its surface.
#include <cmath>

#include "arrays.h"

namespace chronormal::python {
namespace {

Motion motion_of(const Array<float>& positions, const Array<std::uint32_t>& offsets,
                 const Array<std::uint32_t>& corners, const Array<double>& times) {
  if (positions.ndim() != 3 || positions.shape(2) != 3)
    refuse("positions", "the shape is " + shape_text(positions) + " and must be (T, V, 3)");
  const auto keyframes = static_cast<std::size_t>(positions.shape(0)),
             vertices = static_cast<std::size_t>(positions.shape(1));
  if (times.ndim() != 1 || static_cast<std::size_t>(times.size()) != keyframes)
    refuse("times", "the shape is " + shape_text(times) + " and must be (T,)");
  Motion motion;
  motion.topology = topology_of(vertices, offsets, corners);
  for (std::size_t k = 0; k < keyframes; ++k) {
    const float* const first = positions.data() + 3 * vertices * k;
    motion.keyframes.push_back({{first, first + 3 * vertices}, times.data()[k], {}});
  }
  motion.connect_as_sequence();
  value_or_raise(validate(motion));
  return motion;
}

PointPaths paths_of(const Array<double>& points) {
  const bool moves = points.ndim() == 3 && points.shape(1) == 2 && points.shape(2) == 3;
  if (!moves && !(points.ndim() == 2 && points.shape(1) == 3))
    refuse("points", "the shape is " + shape_text(points) + " and must be (P, 3) or (P, 2, 3)");
  const auto count = static_cast<std::size_t>(points.shape(0)), row = static_cast<std::size_t>(moves ? 6 : 3);
  PointPaths paths;
  for (std::size_t i = 0; i < count; ++i) {
    const double* const first = points.data() + row * i;
    for (std::size_t k = 0; k < row; ++k) {
      if (!std::isfinite(static_cast<float>(first[k])))
        refuse("points[" + std::to_string(i) + "]", "a coordinate is not finite, or too large for float32");
    }
    paths.from.insert(paths.from.end(), first, first + 3);
    paths.to.insert(paths.to.end(), first + (row - 3), first + row);
  }
  return paths;
}

py::object array_of_column(QueryColumn column) {
  const auto rows = static_cast<py::ssize_t>(column.rows()), width = static_cast<py::ssize_t>(column.width);
  return std::visit(
      [&](auto& values) -> py::object {
        const bool are_truths = std::is_same_v<decltype(values), std::vector<std::uint8_t>&>;
        std::vector<py::ssize_t> shape{rows};
        if (width != 1) shape.push_back(width);
        const py::object array = array_of(std::move(values), std::move(shape));
        return are_truths ? py::object(array.attr("view")("bool")) : array;
      },
      column.values);
}

// The arrays that `chronormal query -o OUT.npz` writes.
py::dict dict_of(QueryAnswer answer) {
  py::dict dict;
  for (QueryTable& table : answer.tables) {
    const std::string prefix = table.name.empty() ? "" : table.name + '_';
    for (QueryColumn& column : table.columns) dict[py::str(prefix + column.name)] = array_of_column(std::move(column));
  }
  return dict;
}

py::dict contain(const Array<float>& positions, const Array<std::uint32_t>& offsets,
                 const Array<std::uint32_t>& corners, const Array<double>& times, const Array<double>& points) {
  const Motion motion = motion_of(positions, offsets, corners, times);
  const PointPaths paths = paths_of(points);
  Result<QueryAnswer> answer = [&] {
    const py::gil_scoped_release released;
    return query_contain(motion, paths);
  }();
  return dict_of(value_or_raise(std::move(answer)));
}

}  // namespace

void add_containment(py::module_& module) { module.def("contain", contain); }

}  // namespace chronormal::python
