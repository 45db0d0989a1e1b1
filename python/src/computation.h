// Runs computations while other threads of Python run; Ctrl-C ends them, and a fork() waits for them.
#ifndef CHRONORMAL_PYTHON_COMPUTATION_H_
#define CHRONORMAL_PYTHON_COMPUTATION_H_

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "arrays.h"

namespace chronormal::python {

// Hands out the turn to compute with an object, which has scratch for one computation. A fork waits until nobody has a
// turn, and no turn begins meanwhile: a thread that is in the middle of one does not exist in the child, where its turn
// would never end.
class Turns {
 public:
  // Refuses a signal handler that runs in the middle of a computation, since it cannot wait for the end of its own
  // thread's turn.
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

// A computation without the GIL, with an object or without. If the handler of a signal raises, as the one of Ctrl-C
// does, the computation throws Interrupted, and the exception of Python is set.
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

// Runs long work as a Computation, and raises its error with the GIL.
template <class Work>
auto without_gil(const Work& work) {
  auto result = [&] {
    const Computation computing;
    return work();
  }();
  return value_or_raise(std::move(result));
}

// Registers the functions that Python calls around a fork.
void hear_of_forks();

}  // namespace chronormal::python

#endif  // CHRONORMAL_PYTHON_COMPUTATION_H_
