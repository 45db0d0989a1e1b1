// Runs computations while other threads of Python run. Ctrl-C ends a computation, and a fork() waits until the
// computation ends.
#ifndef CHRONORMAL_PYTHON_COMPUTATION_H_
#define CHRONORMAL_PYTHON_COMPUTATION_H_

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "arrays.h"

namespace chronormal::python {

// The turns of threads to compute with an object, which has scratch memory for only one computation. One thread at a
// time has a turn. A fork waits until no other thread has a turn, and no turn begins meanwhile. Otherwise the turn of
// another thread would never end in the child, because that thread does not exist there.
class Turns {
 public:
  // Returns this object. Raises an exception if the calling thread has the turn already. This happens in a signal
  // handler that runs during a computation of the same thread, where waiting for the turn would never end.
  Turns& required_of_others() {
    require(owner_ != std::this_thread::get_id(), "self",
            "a signal handler cannot use the object whose computation it interrupts; use the object after the "
            "computation has ended");
    return *this;
  }
  void lock();
  void unlock();

 private:
  std::mutex mutex_;
  std::atomic<std::thread::id> owner_;
};

// A computation that runs without the GIL. A computation that is made with the Turns of an object has a turn of this
// object. If a signal handler raises an exception, as for Ctrl-C, the computation throws Interrupted, and the exception
// of Python is set.
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

// Runs long work as a Computation, and returns its result. If the result is an error, takes the GIL and raises the
// error.
template <class Work>
auto without_gil(const Work& work) {
  auto result = [&] {
    const Computation computing;
    return work();
  }();
  return value_or_raise(std::move(result));
}

// Registers the functions that Python calls before and after a fork.
void hear_of_forks();

}  // namespace chronormal::python

#endif  // CHRONORMAL_PYTHON_COMPUTATION_H_
