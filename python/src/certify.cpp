// Returns certificates, which bound the largest error of a scheme, to Python as arrays.
#include "computation.h"

namespace chronormal::python {
namespace {

py::dict certify_faces(const Array<float>& from, const Array<float>& to, const Array<std::uint32_t>& offsets,
                       const Array<std::uint32_t>& corners, const std::string& scheme, int threads) {
  const auto first = vectors_of(from, "p0"), last = vectors_of(to, "p1");
  if (first.count != last.count)
    refuse("p1", "p1 must have as many positions as p0, which has " + std::to_string(first.count) + ", but p1 has " +
                     std::to_string(last.count));
  const ChosenThreads chosen(threads);
  Motion motion;
  motion.topology = topology_of(first.count, offsets, corners);
  motion.keyframes.resize(2);
  motion.keyframes[0].positions.assign(from.data(), from.data() + from.size());
  motion.keyframes[1].positions.assign(to.data(), to.data() + to.size());
  motion.keyframes[1].time = 1;
  motion.connect_as_sequence();
  value_or_raise(validate(motion));
  const std::vector<ErrorBounds> all =
      without_gil([&] { return certify(scheme, motion.segment(0), {}, chosen.threads()); });
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
