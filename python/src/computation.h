// Computations that run while other threads of Python do, that Ctrl-C ends, and that a fork() waits for.
#ifndef CHRONORMAL_PYTHON_COMPUTATION_H_
#define CHRONORMAL_PYTHON_COMPUTATION_H_

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "arrays.h"

namespace chronormal::python {

// Whose turn it is to compute with an object, which has scratch for one computation. A fork waits until it is nobody's
// turn, and nobody's begins meanwhile: a thread that is in the middle does not exist in the child, where its turn would
// never end.
class Turns {
 public:
  // The handler of a signal may run in the middle of a computation, and cannot wait for its end.
  Turns& required_of_others() {
    require(owner_ != std::this_thread::get_id(), "self", "a handler of signals cannot use what it interrupts");
    return *this;
  }
  void lock();
  void unlock();

 private:
  std::mutex mutex_;
  std::atomic<std::thread::id> owner_;
};

// A computation without the GIL, with an object or without. Where the handler of a signal raises, as that of Ctrl-C
// does, it throws Interrupted, with the exception of Python set.
class Computation {
 public:
  Computation() = default;
  explicit Computation(Turns& turns) : turns_(&turns.required_of_others()), turn_(*turns_) {}

 private:
  static bool has_heard_a_signal() {
    const py::gil_scoped_acquire held;
    return PyErr_CheckSignals() != 0;
  }

  Turns* turns_ = nullptr;
  py::gil_scoped_release released_;
  std::unique_lock<Turns> turn_;
  Interruption interruption_{has_heard_a_signal};
};

// Does what takes long as a Computation, and raises its error with the GIL.
template <class Work>
auto without_gil(const Work& work) {
  auto result = [&] {
    const Computation computing;
    return work();
  }();
  return value_or_raise(std::move(result));
}

// Has Python call what a fork waits for.
void hear_of_forks();

}  // namespace chronormal::python

#endif  // CHRONORMAL_PYTHON_COMPUTATION_H_
