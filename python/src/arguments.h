// Reads the arguments that curves and blends have in common: times or weights, and the elements whose normals are
// requested.
#ifndef CHRONORMAL_PYTHON_ARGUMENTS_H_
#define CHRONORMAL_PYTHON_ARGUMENTS_H_

#include <optional>
#include <string>

#include "arrays.h"

namespace chronormal::python {

inline std::string counted(std::size_t count, ElementKind kind) {
  return std::to_string(count) + ' ' + std::string(count == 1 ? one_element(kind) : element_kind_name(kind));
}

// Makes the options of elements from the arguments that curves and blends have in common. Raises ValueError for invalid
// arguments.
inline ElementOptions element_options(const std::string& elements, std::optional<double> crease, bool weld) {
  ElementOptions options;
  options.kind = value_or_raise(make_element_kind(elements));
  options.weld = weld;
  if (crease) {
    require(options.kind == ElementKind::kCorners, "crease",
            "only corners can have hard edges; add elements=\"corners\"");
    options.crease_angle = *crease;
  }
  return options;
}

// The numbers that a caller gave as a Python float or as an array. `is_one` is true for a single number.
struct Numbers {
  explicit Numbers(const py::object& given, const char* place) {
    if (PyFloat_Check(given.ptr()) || PyLong_Check(given.ptr())) {
      is_one = true;
      one = PyFloat_AsDouble(given.ptr());
      if (PyErr_Occurred() == nullptr) return;
      PyErr_Clear();
      refuse(place, "the number is too large for a float; give a smaller number");
    }
    many = Array<double>::ensure(given);
    if (!*many) {
      PyErr_Clear();
      refuse(place, "the value must be a number, or a one-dimensional array of numbers");
    }
    if (many->ndim() == 0) {
      is_one = true;
      one = *many->data();
      return;
    }
    if (many->ndim() != 1)
      refuse(place, "the shape must be (T,), a number for each of T moments, but is " + shape_text(*many));
  }

  // Copies the numbers if they share memory with the array `out`, which will be written.
  void keep_from(const py::object& out) {
    if (many) *many = kept_from(std::move(*many), out);
  }

  // Raises ValueError unless every number is in [0, 1].
  void check_fractions(const char* place) const {
    for (std::size_t i = 0; i < count(); ++i) {
      if (const double t = data()[i]; t >= 0 && t <= 1) continue;
      refuse(is_one ? place : place + ("[" + std::to_string(i) + "]"),
             "the value must be from 0 to 1, but is " + py::str(py::float_(data()[i])).cast<std::string>());
    }
  }

  [[nodiscard]] std::size_t count() const { return is_one ? 1 : static_cast<std::size_t>(many->size()); }
  [[nodiscard]] const double* data() const { return is_one ? &one : many->data(); }
  [[nodiscard]] std::optional<std::size_t> rows() const {
    return is_one ? std::nullopt : std::optional<std::size_t>(count());
  }

  bool is_one = false;
  double one = 0;
  // The array, if an array was given. The member is optional, because making an empty array would cost time.
  std::optional<Array<double>> many;
};

}  // namespace chronormal::python

#endif  // CHRONORMAL_PYTHON_ARGUMENTS_H_
