// The extension module behind python/chronormal, which is what users import.
#include "arrays.h"

PYBIND11_MODULE(_chronormal, module) {
  module.doc() = "The library behind the package chronormal.";
  module.attr("__version__") = CHRONORMAL_VERSION;
  chronormal::python::add_certificates(module);
  chronormal::python::add_curves(module);
  chronormal::python::add_files(module);
  chronormal::python::add_paths(module);
  chronormal::python::add_queries(module);
}
