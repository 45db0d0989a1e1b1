/// Errors as values, which every function that handles data from outside returns.
///
/// An Error has a code (which determines the exit code of the program), a place and a message. The place says where to
/// look ("walk_3.obj, line 17" or "frame 2, vertex 5"); the message says what is wrong and, if useful, what to do.
/// Together they read as one line:
///
///     walk_3.obj, line 17: the face names vertex 9, but the file has 8 vertices
///
/// Broken preconditions inside the program are not errors of this kind: they assert.
#ifndef CHRONORMAL_CORE_RESULT_H_
#define CHRONORMAL_CORE_RESULT_H_

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace chronormal {

/// The kind of a failure. The values are the exit codes of the program.
enum class ErrorCode {
  kFailed = 1,        ///< reading or writing failed, or the program itself failed
  kUsage = 2,         ///< the user asked for something that does not exist
  kInvalidInput = 3,  ///< the data are wrong; the place says where in the data
};

struct Error {
  ErrorCode code = ErrorCode::kFailed;
  std::string place;    ///< file and line, byte, frame or index where the error is; may be empty
  std::string message;  ///< one sentence without a full stop

  /// Returns "place: message", or only the message if there is no place.
  [[nodiscard]] std::string text() const { return place.empty() ? message : place + ": " + message; }
};

/// Builds an error of invalid input, the kind that parsers return.
[[nodiscard]] inline Error invalid_input(std::string place, std::string message) {
  return Error{ErrorCode::kInvalidInput, std::move(place), std::move(message)};
}

/// Either a value or the Error that prevented it. Call ok() to find out which, before value() or error().
template <class T>
class [[nodiscard]] Result {
 public:
  // NOLINT(google-explicit-constructor): lets a function `return value;`.
  Result(T value) : state_(std::move(value)) {}
  // NOLINT(google-explicit-constructor): lets a function `return error;`.
  Result(Error error) : state_(std::move(error)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  /// Returns the value. Precondition: ok().
  [[nodiscard]] T& value() & noexcept { return *checked(std::get_if<0>(&state_)); }
  [[nodiscard]] const T& value() const& noexcept { return *checked(std::get_if<0>(&state_)); }
  [[nodiscard]] T&& value() && noexcept { return std::move(*checked(std::get_if<0>(&state_))); }

  /// Returns the error. Precondition: not ok().
  [[nodiscard]] const Error& error() const noexcept { return *checked(std::get_if<1>(&state_)); }

 private:
  template <class P>
  static P* checked(P* pointer) noexcept {
    assert(pointer != nullptr);
    return pointer;
  }

  std::variant<T, Error> state_;
};

/// The value of a Result that can only say that all went well: `return Success{};`
struct Success {};
using Status = Result<Success>;

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_RESULT_H_
