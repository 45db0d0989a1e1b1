// Certificates as arrays.
#include "computation.h"

namespace chronormal::python {
namespace {

/// The velocities at the two ends, as many as there are positions: (2, V, 3), per segment.
using EndVelocities = std::optional<Array<float>>;

void require_end_velocities(const Array<float>& velocities, std::size_t vertices) {
  if (!(velocities.ndim() == 3 && velocities.shape(0) == 2 &&
        velocities.shape(1) == static_cast<py::ssize_t>(vertices) && velocities.shape(2) == 3))
    refuse("velocities", "the shape is " + shape_text(velocities) + " and must be (2, " + std::to_string(vertices) +
                             ", 3): those at p0 and at p1");
}

py::dict certify_faces(const Array<float>& from, const Array<float>& to, const Array<std::uint32_t>& offsets,
                       const Array<std::uint32_t>& corners, const std::string& scheme, int threads,
                       const EndVelocities& velocities) {
  const auto first = vectors_of(from, "p0"), last = vectors_of(to, "p1");
  if (first.count != last.count)
    refuse("p1", "there are " + std::to_string(last.count) + " positions, and p0 has " + std::to_string(first.count));
  if (velocities) require_end_velocities(*velocities, first.count);
  const ChosenThreads chosen(threads);
  Motion motion;
  motion.topology = topology_of(first.count, offsets, corners);
  motion.keyframes.resize(2);
  motion.keyframes[0].positions.assign(from.data(), from.data() + from.size());
  motion.keyframes[1].positions.assign(to.data(), to.data() + to.size());
  motion.keyframes[1].time = 1;
  for (std::size_t k = 0; velocities && k < 2; ++k) {
    const std::size_t size = 3 * first.count;
    const float* const values = velocities->data() + k * size;
    motion.keyframes[k].velocities.assign(values, values + size);
  }
  motion.connect_as_sequence();
  value_or_raise(validate(motion));
  const std::vector<ErrorBounds> all = without_gil([&] {
    const Segment segment = motion.segment(0);
    if (!velocities) return certify(scheme, segment, {}, chosen.threads());
    return certify(scheme, segment, path_segment(motion, 0, PathKind::kHermite), {}, chosen.threads());
  });
  py::dict result;
  const auto add = [&](const char* name, double ErrorBounds::*member, double unit) {
    std::vector<double> values(all.size());
    for (std::size_t f = 0; f < values.size(); ++f) values[f] = unit * (all[f].*member);
    result[name] = array_of(std::move(values), {static_cast<py::ssize_t>(all.size())});
  };
  add("lower", &ErrorBounds::lower, kDegreesPerRadian);
  add("upper", &ErrorBounds::upper, kDegreesPerRadian);
  add("at", &ErrorBounds::at, 1);
  add("from", &ErrorBounds::from, 1);
  add("to", &ErrorBounds::to, 1);
  return result;
}

}  // namespace

void add_certificates(py::module_& module) { module.def("certify", &certify_faces); }

}  // namespace chronormal::python
