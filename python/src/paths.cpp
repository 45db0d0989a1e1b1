// Normals of sequences on curved paths: the calls that are made for every frame.
#include "arguments.h"
#include "computation.h"

namespace chronormal::python {
namespace {

class Paths : public ZeroedObject {
 public:
  Paths(const Array<float>& positions, const Array<std::uint32_t>& offsets, const Array<std::uint32_t>& corners,
        const Array<double>& times, const std::string& path, const std::optional<Array<float>>& velocities,
        const std::string& elements, std::optional<double> crease, bool weld) {
    ElementPathsOptions options;
    options.elements = element_options(elements, crease, weld);
    Result<PathKind> kind = make_path(path);
    if (!kind) refuse("path", kind.error().message);
    options.path = kind.value();
    Motion motion = motion_of(positions, offsets, corners, times);
    if (velocities) {
      const std::size_t size = 3 * motion.topology.vertex_count();
      if (!(velocities->ndim() == 3 && velocities->size() == positions.size() &&
            velocities->shape(0) == positions.shape(0) && velocities->shape(2) == 3))
        refuse("velocities", "the shape is " + shape_text(*velocities) + " and must be " + shape_text(positions));
      for (std::size_t k = 0; k < motion.keyframes.size(); ++k)
        motion.keyframes[k].velocities.assign(velocities->data() + k * size, velocities->data() + (k + 1) * size);
    }
    paths_.emplace(without_gil([&] { return ElementPaths::make(std::move(motion), options); }));
  }

  py::array unit_normals(const py::object& time, const py::object& out, int threads) {
    Numbers times(time, "time");
    const ChosenThreads chosen(threads);
    const std::size_t count = size();
    py::array result = result_array(out, times.rows(), count);
    times.keep_from(out);
    const Status status = write(times, chosen.threads(), static_cast<float*>(result.mutable_data()));
    if (!status) raise(status.error());
    return result;
  }

  [[nodiscard]] std::size_t size() const { return paths().size(); }
  [[nodiscard]] std::size_t bytes() const { return paths().bytes(); }
  [[nodiscard]] std::string path() const { return std::string(path_name(paths().options().path)); }
  [[nodiscard]] std::string elements() const { return std::string(element_kind_name(paths().options().elements.kind)); }
  [[nodiscard]] std::string text() const {
    return "<chronormal.Paths: normals of " + counted(size(), paths().options().elements.kind) + " on " + path() +
           " paths through " + std::to_string(paths().motion().keyframes.size()) + " keyframes>";
  }

 private:
  Status write(const Numbers& times, Threads threads, float* result) {
    const std::size_t count = paths_->size();
    const double* const values = times.data();
    const Computation computing(turns_);
    for (std::size_t k = 0; k < times.count(); ++k) {
      check_interruption();
      const auto row = VectorView<float>::packed(result + 3 * count * k, count);
      if (const auto written = paths_->unit_normals(values[k], row, threads); !written) return written.error();
    }
    return Success{};
  }

  [[nodiscard]] const ElementPaths& paths() const {
    require_made(paths_.has_value());
    return *paths_;
  }

  std::optional<ElementPaths> paths_;
  Turns turns_;
};

}  // namespace

void add_paths(py::module_& module) {
  py::class_<Paths> paths(module, "Paths",
                          R"(Unit normals of a sequence whose vertices move on curves through its keyframes.

Made by chronormal.paths(). len() is the number of normals n: faces, vertices or corners.)");
  refuse_to_be_pickled(paths);
  paths
      .def(py::init<const Array<float>&, const Array<std::uint32_t>&, const Array<std::uint32_t>&, const Array<double>&,
                    const std::string&, const std::optional<Array<float>>&, const std::string&, std::optional<double>,
                    bool>())
      .def("unit_normals", &Paths::unit_normals, py::arg("time"), py::arg("out") = py::none(), py::arg("threads") = 1,
           R"(Return the unit normals at a time, (0, 0, 0) where there is none; within 1e-6 rad of the exact ones.

time     a float, in the seconds of the keyframes: the result is (n, 3) float32; or T of them: (T, n, 3)
out, threads  as for Curves.unit_normals()

The curves of one segment are kept, that of the last time: times in ascending order are fast.)")
      .def_property_readonly("path", &Paths::path, "\"linear\", \"catmull-rom\" or \"hermite\".")
      .def_property_readonly("bytes", &Paths::bytes,
                             "Memory that the curves of the last segment take, in bytes; 0 before the first time.")
      .def_property_readonly("elements", &Paths::elements, "\"faces\", \"vertices\" or \"corners\".")
      .def("__len__", &Paths::size)
      .def("__repr__", &Paths::text);
}

}  // namespace chronormal::python
