#include "computation.h"

#include <condition_variable>
#include <new>

namespace chronormal::python {
namespace {

// The gate between turns and forks. A turn is the permission of a thread to compute with an object (computation.h). The
// gate counts the turns of all objects in progress, and the forks that wait until no other thread has a turn.
class ForkGate {
 public:
  void begin_turn() {
    std::unique_lock lock(mutex_);
    change_.wait(lock, [&] { return forks_ == 0; });
    ++turns_;
    ++own_turns;
  }
  void end_turn() {
    const std::lock_guard lock(mutex_);
    --turns_;
    --own_turns;
    change_.notify_all();
  }
  // Waits until no other thread has a turn. The turns of this thread, which forks, continue in the child.
  void begin_fork() {
    std::unique_lock lock(mutex_);
    ++forks_;
    change_.wait(lock, [&] { return turns_ == own_turns; });
  }
  void end_fork() {
    const std::lock_guard lock(mutex_);
    --forks_;
    change_.notify_all();
  }
  // Makes a new gate in the child, because a thread that does not exist there may have locked the mutex.
  void begin_anew() {
    new (this) ForkGate;
    turns_ = own_turns;
  }

 private:
  static thread_local std::size_t own_turns;

  std::mutex mutex_;
  std::condition_variable change_;
  std::size_t turns_ = 0, forks_ = 0;
};

thread_local std::size_t ForkGate::own_turns = 0;

ForkGate gate;

}  // namespace

void Turns::lock() {
  gate.begin_turn();
  mutex_.lock();
  owner_ = std::this_thread::get_id();
}

void Turns::unlock() {
  owner_ = std::thread::id();
  mutex_.unlock();
  gate.end_turn();
}

void hear_of_forks() {
  const py::module_ system = py::module_::import("os");
  if (!py::hasattr(system, "register_at_fork")) return;  // this system has no fork()
  system.attr("register_at_fork")(
      py::arg("before") = py::cpp_function([] { gate.begin_fork(); }, py::call_guard<py::gil_scoped_release>()),
      py::arg("after_in_parent") = py::cpp_function([] { gate.end_fork(); }),
      py::arg("after_in_child") = py::cpp_function([] { gate.begin_anew(); }));
}

}  // namespace chronormal::python
