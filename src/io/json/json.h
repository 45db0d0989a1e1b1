/// Reads JSON from files, and reports the place of every fault. Private to io.
///
/// A JsonView is a value of a document with its JSON pointer (RFC 6901). Its getters check type and range. The first
/// complaint about a document is kept in a JsonComplaint; from then on every getter returns its fallback. A parser can
/// therefore read an object without checks in between, and test once at the end for a complaint.
#ifndef CHRONORMAL_IO_JSON_JSON_H_
#define CHRONORMAL_IO_JSON_JSON_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// The deepest allowed nesting of arrays and objects. glTF itself needs about ten levels.
inline constexpr std::size_t kDeepestJson = 256;

/// A long list whose objects parse_json() passes on one by one, so that they are never all in memory. Every object in
/// the array `key` of the root is passed to `take` with its index, and then dropped. Items that are not objects stay in
/// the array.
struct JsonItems {
  std::string_view key;
  std::function<void(std::size_t index, const nlohmann::json& item)> take;
};

/// Parses UTF-8 text, which begins at byte `offset` of the file `name` and may have a byte order mark. Numbers that are
/// too large for double become infinity, and a JsonView complains about them when they are read. Objects that `items`
/// takes are not in the result. Errors: kInvalidInput with the place "NAME, byte N" for text that is not JSON or is
/// nested deeper than kDeepestJson (checked before a tree is built).
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, const std::string& name, std::size_t offset,
                                                const JsonItems& items);

/// The first fault that was found in a document.
class JsonComplaint {
 public:
  explicit JsonComplaint(std::string name) : name_(std::move(name)) {}

  void add(const std::string& pointer, std::string message) {
    if (!first_) first_ = invalid_input(place(pointer), std::move(message));
  }
  /// Adds an error that was found without a JsonView, unless an earlier complaint is kept.
  void add(Error error) {
    if (!first_) first_ = std::move(error);
  }
  [[nodiscard]] std::string place(const std::string& pointer) const;
  [[nodiscard]] const std::optional<Error>& first() const noexcept { return first_; }
  /// Returns the first complaint, and forgets it.
  [[nodiscard]] std::optional<Error> take() noexcept { return std::exchange(first_, std::nullopt); }

 private:
  std::string name_;
  std::optional<Error> first_;
};

class JsonView {
 public:
  JsonView(const nlohmann::json& value, std::string pointer, JsonComplaint& complaint)
      : value_(&value), pointer_(std::move(pointer)), complaint_(&complaint) {}

  /// Returns true if the value is an object that has the member `key`.
  [[nodiscard]] bool has(const char* key) const { return find(key) != nullptr; }

  /// Return a member that is an object, or a non-empty array, as a view. Return nothing if the member is missing.
  /// Complain and return nothing if the member is of another kind, or if the array is empty.
  [[nodiscard]] std::optional<JsonView> object(const char* key) const;
  [[nodiscard]] std::optional<JsonView> array(const char* key) const;

  /// Returns the number of items of an array, or of members of an object.
  [[nodiscard]] std::size_t size() const noexcept { return value_->size(); }
  [[nodiscard]] JsonView item(std::size_t i) const { return {(*value_)[i], pointer(i), *complaint_}; }
  /// Returns true if the value of this view is an object. Otherwise complains and returns false.
  [[nodiscard]] bool is_object() const;
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Return the member `key` as an integer from 0 to `most`; 4.0 counts as an integer, as glTF demands. Complain about
  /// any other value. Without a usable value, find_count() returns nothing, count() returns the fallback, and
  /// required_count() returns 0. Only required_count() complains about a missing member.
  [[nodiscard]] std::optional<std::size_t> find_count(const char* key, std::size_t most) const;
  [[nodiscard]] std::size_t count(const char* key, std::size_t most, std::size_t fallback) const;
  [[nodiscard]] std::size_t required_count(const char* key, std::size_t most) const;
  /// Return the member `key` as an index below `count`. Complain about a larger index: "the index is 7, but the number
  /// of WHAT is only 5". If the member is missing, return nothing; required_index() then also complains.
  [[nodiscard]] std::optional<std::size_t> find_index(const char* key, std::size_t count, const char* what) const;
  [[nodiscard]] std::optional<std::size_t> required_index(const char* key, std::size_t count, const char* what) const;
  /// Returns the value of this view as an index below `count`, or nothing after a complaint.
  [[nodiscard]] std::optional<std::size_t> as_index(std::size_t count, const char* what) const;
  [[nodiscard]] bool flag(const char* key) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] std::string required_text(const char* key) const;
  /// Return the value of this view as text or as a number. Complain about a value of another kind, and about a number
  /// that is too large for double.
  [[nodiscard]] std::string as_text() const;
  [[nodiscard]] double as_number() const;

  void complain(std::string message) const { complaint_->add(pointer_, std::move(message)); }
  void complain(const char* key, std::string message) const { complaint_->add(pointer(key), std::move(message)); }
  [[nodiscard]] const std::string& pointer() const noexcept { return pointer_; }
  [[nodiscard]] std::string pointer(std::string_view key) const;
  [[nodiscard]] std::string pointer(std::size_t index) const;
  [[nodiscard]] std::string place() const { return complaint_->place(pointer_); }

 private:
  [[nodiscard]] const nlohmann::json* find(const char* key) const;
  [[nodiscard]] JsonView member(const char* key, const nlohmann::json& value) const {
    return {value, pointer(key), *complaint_};
  }
  [[nodiscard]] std::optional<std::size_t> as_count(std::size_t most) const;

  const nlohmann::json* value_;
  std::string pointer_;
  JsonComplaint* complaint_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_JSON_JSON_H_
