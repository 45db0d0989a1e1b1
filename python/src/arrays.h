// Converts NumPy arrays to views for the library, and results of the library to arrays. python/chronormal has already
// checked the type of an array; the functions here check its shape.
#ifndef CHRONORMAL_PYTHON_ARRAYS_H_
#define CHRONORMAL_PYTHON_ARRAYS_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace chronormal::python {

namespace py = pybind11;

// A C-contiguous array. Pass only arrays that python/chronormal has converted, because pybind11 would silently copy an
// array of another layout or of a narrower type.
template <class T>
using Array = py::array_t<T, py::array::c_style>;
// A C-contiguous array of T, into which pybind11 converts numbers of any type.
template <class T>
using AnyArray = py::array_t<T, py::array::c_style | py::array::forcecast>;

// Converts a text from outside, which may have any bytes, to a Python string, as os.fsdecode() does for the name of a
// file.
inline py::str string_of(std::string_view text) {
  PyObject* const made = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

// Raises the exception for an error: OSError for files, ValueError for wrong arguments. The caller may or may not hold
// the GIL.
[[noreturn]] inline void raise(const Error& error) {
  const py::gil_scoped_acquire held;
  PyObject* const kind = error.code == ErrorCode::kFailed ? PyExc_OSError : PyExc_ValueError;
  PyErr_SetObject(kind, string_of(error.text()).ptr());
  throw py::error_already_set();
}

template <class T>
T value_or_raise(Result<T> result) {
  if (!result) raise(result.error());
  return std::move(result).value();
}

[[noreturn]] inline void refuse(const std::string& place, const std::string& message) {
  raise(Error{ErrorCode::kUsage, place, message});
}

// Raises an error if a condition does not hold. If the condition holds, no string is made, since the whole call may
// take less than a microsecond.
inline void require(bool condition, const char* place, const char* message) {
  if (!condition) refuse(place, message);
}

inline std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

// Makes a view of an array of float32. Raises ValueError unless the shape is (n, 3).
template <int kFlags>
VectorView<const float> vectors_of(const py::array_t<float, kFlags>& array, const std::string& place) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    refuse(place, "the shape must be (n, 3), a vector in each of n rows, but is " + shape_text(array));
  return VectorView<const float>::packed(array.data(), static_cast<std::size_t>(array.shape(0)));
}

template <class T>
std::vector<T> vector_of(const Array<T>& array) {
  return {array.data(), array.data() + array.size()};
}

// Makes an array that takes over the memory of a vector.
template <class T>
py::array_t<T> array_of(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const py::capsule owner(kept.release(), [](void* memory) { delete static_cast<std::vector<T>*>(memory); });
  return py::array_t<T>(std::move(shape), data, owner);
}

// Makes the topology of a mesh from the offsets and the corners of its faces.
Topology topology_of(std::size_t vertices, const Array<std::uint32_t>& offsets, const Array<std::uint32_t>& corners);

// Makes a motion from keyframes (T, V, 3) at `times`, in seconds.
Motion motion_of(const Array<float>& positions, const Array<std::uint32_t>& offsets,
                 const Array<std::uint32_t>& corners, const Array<double>& times);

// Returns the array into which normals (rows, size, 3) are written, or (size, 3) if `rows` has no value. The array is
// `out` itself if `out` has this shape, or a new array if `out` is None. Raises an error for other values of `out`.
py::array result_array(const py::object& out, std::optional<std::size_t> rows, std::size_t size);

// Returns the array `numbers` itself, or a copy if `numbers` shares memory with the array `out`, which is written while
// `numbers` is read.
inline Array<double> kept_from(Array<double> numbers, const py::object& out) {
  if (!py::isinstance<py::array>(out) || numbers.size() == 0) return numbers;
  const auto other = py::reinterpret_borrow<py::array>(out);
  const auto begin = [](const py::array& array) { return reinterpret_cast<std::uintptr_t>(array.data()); };
  const auto end = [&](const py::array& array) { return begin(array) + static_cast<std::uintptr_t>(array.nbytes()); };
  if (end(numbers) <= begin(other) || end(other) <= begin(numbers)) return numbers;
  return Array<double>(numbers.size(), numbers.data());
}

// Makes pickle and copy refuse objects of a class, since they cannot copy the memory of such an object. Otherwise the
// protocols 0 and 1 of pickle would make an object of the base class, and pybind11 would end the process.
template <class Class>
void refuse_to_be_pickled(Class& made) {
  const auto refuse = [](const py::object& self, const py::args&) -> py::object {
    throw py::type_error("cannot pickle '" + py::type::of(self).attr("__qualname__").cast<std::string>() +
                         "' object; make the object again from its inputs");
  };
  made.def("__reduce__", refuse).def("__reduce_ex__", refuse);
}

// Sets the number of threads of calls while the object lives: 1 stands for the calling thread, 0 for all cores, and a
// larger number for at most as many threads.
class ChosenThreads {
 public:
  explicit ChosenThreads(int count) : threads_(count == 1 ? Threads::kOne : Threads::kAll) {
    require(count >= 0, "threads", "the number of threads must be at least 0 (0 for all cores)");
    if (count > 1) limit_.emplace(static_cast<std::size_t>(count));
  }
  [[nodiscard]] Threads threads() const noexcept { return threads_; }

 private:
  Threads threads_;
  std::optional<ThreadLimit> limit_;
};

// The base of classes whose new objects have memory filled with zeros. `Curves.__new__(Curves)` makes an object without
// calling its constructor, and pybind11 then passes this memory to a method. From the zero members, the method
// recognises that the constructor did not run.
struct ZeroedObject {
  static void* operator new(std::size_t size) {
    void* const memory = ::operator new(size);
    std::memset(memory, 0, size);
    return memory;
  }
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void* memory) noexcept { ::operator delete(memory); }
};

inline void require_made(bool is_made) {
  require(is_made, "self", "the object is not ready, since its __init__() has not run; call __init__() first");
}

void add_certificates(py::module_& module);
void add_curves(py::module_& module);
void add_files(py::module_& module);
void add_queries(py::module_& module);

}  // namespace chronormal::python

#endif  // CHRONORMAL_PYTHON_ARRAYS_H_
