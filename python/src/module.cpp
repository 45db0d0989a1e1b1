// Defines the extension module behind python/chronormal, the package that users import.
#include "computation.h"

namespace py = pybind11;

PYBIND11_MODULE(_chronormal, module) {
  module.doc() = "The compiled part of the package chronormal; import chronormal instead.";
  module.attr("__version__") = CHRONORMAL_VERSION;
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const chronormal::Interrupted&) {  // a signal handler has already set the exception
    }
  });
  chronormal::python::hear_of_forks();
  chronormal::python::add_certificates(module);
  chronormal::python::add_curves(module);
  chronormal::python::add_files(module);
  chronormal::python::add_queries(module);
}
