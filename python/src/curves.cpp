// Implements curves and blends, whose functions are called for every frame.
#include <array>
#include <cstdio>
#include <mutex>

#include "arguments.h"
#include "computation.h"

namespace chronormal::python {
namespace {

// Writes the angles in degrees between two lists of vectors. Writes NaN if a vector has no direction.
void write_errors(VectorView<const float> exact, VectorView<const float> shown, float* degrees) {
  for (std::size_t i = 0; i < exact.count; ++i) {
    const Vec3d right = to_double(exact[i]), is = to_double(shown[i]);
    const bool both = right != Vec3d{} && is != Vec3d{} && is_finite(is);
    degrees[i] = both ? static_cast<float>(angle_between(right, unit(is)) * kDegreesPerRadian)
                      : std::numeric_limits<float>::quiet_NaN();
  }
}

class Curves : public ZeroedObject {
 public:
  Curves(const Array<float>& from, const Array<float>& to, const Array<std::uint32_t>& offsets,
         const Array<std::uint32_t>& corners, const std::string& elements, std::optional<double> crease,
         const std::string& weighting, double tolerance, bool weld, int threads) {
    const auto first = vectors_of(from, "p0"), last = vectors_of(to, "p1");
    MeshNormalsOptions options;
    options.elements = element_options(elements, crease, weld);
    options.weighting = value_or_raise(make_weighting(weighting));
    require(std::isfinite(tolerance) && tolerance > 0, "tolerance",
            "the tolerance must be an angle in radians, greater than 0");
    options.tolerance = tolerance;
    const ChosenThreads chosen(threads);
    options.threads = chosen.threads();
    Topology topology = topology_of(first.count, offsets, corners);
    curves_.emplace(without_gil([&]() -> Result<MeshNormals> {
      Result<MeshNormals> made = MeshNormals::make(std::move(topology), options);
      if (!made) return made;
      if (const Status status = made.value().set_segment(first, last); !status) return status.error();
      return made;
    }));
  }

  void next(const AnyArray<float>& from, const AnyArray<float>& to) {
    require_made(curves_.has_value());
    const auto first = vectors_of(from, "p0"), last = vectors_of(to, "p1");
    Turns& turns = turns_.required_of_others();
    Status status = Success{};
    {
      // A signal must not interrupt this call, because a half-written segment would be left.
      const py::gil_scoped_release released;
      const std::lock_guard turn(turns);
      status = curves_->set_segment(first, last);
    }
    value_or_raise(std::move(status));
  }

  py::array unit_normals(const py::object& t, const py::object& out, int threads) {
    Numbers times(t, "t");
    times.check_fractions("t");
    const ChosenThreads chosen(threads);
    py::array result = result_array(out, times.rows(), size());
    times.keep_from(out);
    write(times, chosen.threads(), static_cast<float*>(result.mutable_data()));
    return result;
  }

  py::array errors(const py::object& t, const AnyArray<float>& normals, int threads) {
    const Numbers times(t, "t");
    times.check_fractions("t");
    const ChosenThreads chosen(threads);
    const auto n = static_cast<py::ssize_t>(size()), rows = static_cast<py::ssize_t>(times.count());
    const bool fits = times.is_one ? normals.ndim() == 2 && normals.shape(0) == n && normals.shape(1) == 3
                                   : normals.ndim() == 3 && normals.shape(0) == rows && normals.shape(1) == n &&
                                         normals.shape(2) == 3;
    if (!(fits))
      refuse("normals", "the shape must be (" + (times.is_one ? "" : std::to_string(rows) + ", ") + std::to_string(n) +
                            ", 3), a vector for each normal, but is " + shape_text(normals));
    const std::size_t count = times.count() * size();
    std::vector<float> exact(3 * count), degrees(count);
    write(times, chosen.threads(), exact.data());
    {
      const float* const shown = normals.data();
      const Computation computing;
      for (std::size_t k = 0; k < times.count(); ++k) {
        check_interruption();
        const std::size_t first = k * size();
        write_errors(VectorView<const float>::packed(exact.data() + 3 * first, size()),
                     VectorView<const float>::packed(shown + 3 * first, size()), degrees.data() + first);
      }
    }
    return times.is_one ? array_of(std::move(degrees), {n}) : array_of(std::move(degrees), {rows, n});
  }

  // Returns the control normals n0, m, n1 as an array (size, 3, 3). n(t) = (1-t)^2 n0 + 2t(1-t) m + t^2 n1 is the
  // normal before scaling to length 1.
  [[nodiscard]] py::array control_normals() const {
    const std::size_t count = size();
    require(curves().options().tolerance <= 1e-6, "control_normals",
            "compact curves keep no control normals; make the curves with tolerance=1e-6");
    std::vector<float> values(9 * count);
    value_or_raise(curves().fill_vertex_buffer(ControlFormat::kFloat32, std::as_writable_bytes(std::span(values))));
    return array_of(std::move(values), {static_cast<py::ssize_t>(count), 3, 3});
  }

  [[nodiscard]] std::size_t size() const { return curves().size(); }
  [[nodiscard]] std::size_t bytes() const { return curves().bytes(); }
  [[nodiscard]] double fit_bound() const { return curves().fit_bound(); }
  [[nodiscard]] std::string elements() const {
    return std::string(element_kind_name(curves().options().elements.kind));
  }
  [[nodiscard]] std::string text() const {
    std::array<char, 32> tolerance{};
    (void)std::snprintf(tolerance.data(), tolerance.size(), "%.3g", curves().options().tolerance);
    const ElementKind kind = curves().options().elements.kind;
    return "<chronormal.Curves: normals of " + counted(size(), kind) + ", " + std::to_string(curves().element_count()) +
           " of them different, weighting " + std::string(weighting_name(curves().options().weighting)) +
           ", tolerance " + tolerance.data() + ", " + std::to_string(bytes()) + " bytes>";
  }

 private:
  void write(const Numbers& times, Threads threads, float* result) {
    const std::size_t count = size();
    const double* const values = times.data();
    const Computation computing(turns_);
    for (std::size_t k = 0; k < times.count(); ++k) {
      check_interruption();
      curves_->unit_normals(values[k], VectorView<float>::packed(result + 3 * count * k, count), threads);
    }
  }

  [[nodiscard]] const MeshNormals& curves() const {
    require_made(curves_.has_value());
    return *curves_;
  }

  std::optional<MeshNormals> curves_;
  Turns turns_;
};

class Blend : public ZeroedObject {
 public:
  Blend(const Array<float>& base, const std::vector<std::pair<Array<std::uint32_t>, Array<float>>>& targets,
        const Array<std::uint32_t>& offsets, const Array<std::uint32_t>& corners, const std::string& elements,
        std::optional<double> crease, bool weld)
      : targets_(targets.size()) {
    const auto view = vectors_of(base, "base");
    BlendSet set{topology_of(view.count, offsets, corners), vector_of(base), {}};
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const auto& [vertices, deltas] = targets[k];
      const std::string place = "deltas[" + std::to_string(k) + "]";
      const std::size_t count = vectors_of(deltas, place).count;
      if (vertices.size() == 0 && count > 0) {
        if (!(count == view.count))
          refuse(place, "the target must have a delta for each vertex of the mesh, which has " +
                            std::to_string(view.count) + ", but the target has " + std::to_string(count));
        set.targets.push_back(BlendTarget::from_dense({deltas.data(), 3 * count}));
        continue;
      }
      set.targets.push_back({"", vector_of(vertices), vector_of(deltas)});
    }
    const ElementOptions options = element_options(elements, crease, weld);
    kind_ = options.kind;
    blend_.emplace(without_gil([&]() -> Result<MeshNormals> {
      Result<MeshNormals> made = MeshNormals::make(set.topology, {.elements = options});
      if (!made) return made;
      if (const Status status = made.value().set_targets(std::move(set)); !status) return status.error();
      return made;
    }));
  }

  py::array unit_normals(const Array<double>& weights, const py::object& out, int threads) {
    require_made(blend_.has_value());
    const auto k = static_cast<py::ssize_t>(targets_);
    const bool is_one = weights.ndim() == 1;
    if (!((is_one || weights.ndim() == 2) && weights.shape(weights.ndim() - 1) == k))
      refuse("weights", "the shape must be (" + std::to_string(k) + ",) or (T, " + std::to_string(k) +
                            "), with a weight for each target, but is " + shape_text(weights));
    const ChosenThreads chosen(threads);
    const std::size_t rows = is_one ? 1 : static_cast<std::size_t>(weights.shape(0)), count = size();
    py::array result = result_array(out, is_one ? std::nullopt : std::optional(rows), count);
    float* const data = static_cast<float*>(result.mutable_data());
    const Array<double> kept = kept_from(weights, out);
    const double* const values = kept.data();
    for (std::size_t i = 0; i < rows * targets_; ++i)
      if (!std::isfinite(values[i]))
        refuse("weights", "weight " + std::to_string(i % targets_) + " is NaN or infinite; give finite weights");
    const Computation computing(turns_);
    for (std::size_t r = 0; r < rows; ++r) {
      check_interruption();
      blend_->unit_normals(std::span(values + r * targets_, targets_),
                           VectorView<float>::packed(data + 3 * count * r, count), chosen.threads());
    }
    return result;
  }

  [[nodiscard]] std::size_t size() const { return blend().size(); }
  [[nodiscard]] std::size_t targets() const { return targets_; }
  [[nodiscard]] std::size_t bytes() const { return blend().bytes(); }
  [[nodiscard]] std::string text() const {
    return "<chronormal.Blend: normals of " + counted(size(), kind_) + ", " + std::to_string(blend().element_count()) +
           " of them different, " + std::to_string(targets_) + (targets_ == 1 ? " target, " : " targets, ") +
           std::to_string(bytes()) + " bytes>";
  }

 private:
  [[nodiscard]] const MeshNormals& blend() const {
    require_made(blend_.has_value());
    return *blend_;
  }

  std::size_t targets_;
  ElementKind kind_ = ElementKind::kVertices;
  std::optional<MeshNormals> blend_;
  Turns turns_;
};

}  // namespace

Topology topology_of(std::size_t vertices, const Array<std::uint32_t>& offsets, const Array<std::uint32_t>& corners) {
  if (offsets.size() > 0) {
    return value_or_raise(Topology::polygons(vertices, vector_of(offsets), vector_of(corners)));
  }
  return value_or_raise(Topology::triangles(vertices, vector_of(corners)));
}

py::array result_array(const py::object& out, std::optional<std::size_t> rows, std::size_t size) {
  constexpr const char* kWanted =
      "out must be a C-contiguous array of float32, such as numpy.empty(shape, numpy.float32)";
  const auto n = static_cast<py::ssize_t>(size);
  if (out.is_none()) {
    if (rows) return py::array_t<float>({static_cast<py::ssize_t>(*rows), n, py::ssize_t{3}});
    return py::array_t<float>({n, py::ssize_t{3}});
  }
  require(py::isinstance<py::array>(out), "out", kWanted);
  auto array = py::reinterpret_borrow<py::array>(out);
  const py::dtype type = array.dtype();
  constexpr int kWhole = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
  require(
      type.num() == py::detail::npy_api::NPY_FLOAT_ && type.byteorder() == '=' && (array.flags() & kWhole) == kWhole,
      "out", kWanted);
  const bool fits = rows ? array.ndim() == 3 && array.shape(0) == static_cast<py::ssize_t>(*rows) &&
                               array.shape(1) == n && array.shape(2) == 3
                         : array.ndim() == 2 && array.shape(0) == n && array.shape(1) == 3;
  if (!fits) {
    refuse("out", "the shape must be (" + (rows ? std::to_string(*rows) + ", " : "") + std::to_string(n) +
                      ", 3), a vector for each normal, but is " + shape_text(array));
  }
  require(array.writeable(), "out", "the array is read-only; give one that can be written");
  return array;
}

void add_curves(py::module_& module) {
  py::class_<Curves> curves(module, "Curves",
                            R"(Unit normals between two arrays of positions, exact for every t in [0, 1].

Made by chronormal.curves(). len() is n, the number of normals: one for each face, vertex or corner.)");
  refuse_to_be_pickled(curves);
  curves
      .def(py::init<const Array<float>&, const Array<float>&, const Array<std::uint32_t>&, const Array<std::uint32_t>&,
                    const std::string&, std::optional<double>, const std::string&, double, bool, int>())
      .def("unit_normals", &Curves::unit_normals, py::arg("t"), py::arg("out") = py::none(), py::arg("threads") = 1,
           R"(Return the unit normals at t, (0, 0, 0) where there is none.

t        one float from 0 to 1, which gives (n, 3) float32, or an array of T floats, which gives (T, n, 3)
out      where to write, a C-contiguous float32 array of that shape, which is returned
threads  1 for the calling thread, 0 for all cores if there is enough to do, k for at most k threads

The GIL is released. Raises ValueError if t is outside of [0, 1] or a shape does not fit.)")
      .def("errors", &Curves::errors, py::arg("t"), py::arg("normals"), py::arg("threads") = 1,
           R"(Return the angles between given normals and the exact ones, in degrees: (n,) or (T, n) float32.

normals  (n, 3) or (T, n, 3) float32: the normals at t that are judged; their lengths do not matter
NaN      where the exact normal or the given one has no direction)")
      .def(
          "next", &Curves::next, py::arg("p0"), py::arg("p1"),
          R"(Prepare the motion from p0 to p1 instead, in the same memory: (V, 3) float32 positions of the same mesh.)")
      .def_property_readonly(
          "control_normals", &Curves::control_normals,
          R"(The vectors n0, m and n1 of each normal, as a new (n, 3, 3) float32 array; needs a tolerance of 1e-6.

n(t) is (1 - t)**2 * n0 + 2 * t * (1 - t) * m + t**2 * n1; the unit normal is n(t) / |n(t)|.)")
      .def_property_readonly("bytes", &Curves::bytes, "Memory that the curves keep, in bytes.")
      .def_property_readonly("elements", &Curves::elements,
                             "What the normals belong to: \"faces\", \"vertices\" or \"corners\".")
      .def_property_readonly("fit_bound", &Curves::fit_bound,
                             "The largest error, in radians, of the fit for another weighting than area; 0 for area.")
      .def("__len__", &Curves::size)
      .def("__repr__", &Curves::text);
  py::class_<Blend> blend(module, "Blend", R"(Unit normals of blend shapes, exact at any weights.

Made by chronormal.blend(). len() is n, the number of normals: one for each face, vertex or corner.)");
  refuse_to_be_pickled(blend);
  blend
      .def(py::init<const Array<float>&, const std::vector<std::pair<Array<std::uint32_t>, Array<float>>>&,
                    const Array<std::uint32_t>&, const Array<std::uint32_t>&, const std::string&, std::optional<double>,
                    bool>())
      .def("unit_normals", &Blend::unit_normals, py::arg("weights"), py::arg("out") = py::none(),
           py::arg("threads") = 1,
           R"(Return the unit normals at some weights, (0, 0, 0) where there is none.

weights  (K,) weights, one for each target, which give (n, 3) float32, or (T, K), which give (T, n, 3)
out, threads  as for Curves.unit_normals())")
      .def_property_readonly("targets", &Blend::targets, "K, the number of morph targets.")
      .def_property_readonly("bytes", &Blend::bytes, "Memory that the blend keeps, in bytes.")
      .def("__len__", &Blend::size)
      .def("__repr__", &Blend::text);
}

}  // namespace chronormal::python
