/// Stores new arrays of a glTF file, and describes them by accessors and buffer views. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLB_NEW_ARRAYS_H_
#define CHRONORMAL_IO_GLTF_GLB_NEW_ARRAYS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "io/bytes/spool.h"

namespace chronormal::inline internal::gltf {

/// Returns the number of bytes that an array of floats takes in the file. The array is stored dense or sparse,
/// whichever is shorter. `count` is the number of elements, `used` the number of elements that are not zero, and
/// `last_used` the index of the last element that is not zero. An array of zeros takes no bytes.
[[nodiscard]] std::size_t bytes_of_floats(std::size_t used, std::size_t last_used, std::size_t count,
                                          std::size_t components);

/// A store of new arrays, in which arrays of one kind share a buffer view. The kinds are vectors, scalars, and the
/// indices and values of sparse accessors. Only the view of vectors has a target, ARRAY_BUFFER (section 3.6.2.4 of the
/// specification). The view of sparse accessors must not have a target.
class NewArrays {
 public:
  /// Creates an empty store that keeps the bytes of its arrays in `spool`.
  explicit NewArrays(Spool spool = {}) : spool_(std::move(spool)) {}

  /// Stores an array of `components` numbers per element, 1 or 3, unless an equal array exists already. Returns the
  /// index of the array.
  std::size_t add(std::span<const float> values, std::size_t components, const GltfVectors& options);

  /// Stores a table of scalars row by row: fill(row, values) gets a row of zeros, and writes its numbers. At most a few
  /// rows are in memory in addition to the spool. Unlike an array of add(), a table has bytes even if all numbers are
  /// zero, has no bounds, and is not compared with other arrays.
  std::size_t add_table(std::size_t rows, std::size_t width,
                        const std::function<void(std::size_t row, std::span<float> values)>& fill);

  /// Puts the arrays into another order: the array with the index order[i] gets the index i. No array may be added
  /// after this call. `order` must contain each index once.
  void put_in_order(std::span<const std::size_t> order);

  /// Moves the spool out, so that it can be cleared and used again.
  [[nodiscard]] Spool take_spool() && { return std::move(spool_); }

  /// Returns success if all bytes could be stored. Errors: those of Spool.
  [[nodiscard]] const Status& status() const noexcept { return spool_.status(); }

  [[nodiscard]] std::size_t count() const noexcept { return arrays_.size(); }
  /// Returns the number of all bytes, a multiple of 4.
  [[nodiscard]] std::uint64_t byte_count() const noexcept;
  [[nodiscard]] std::size_t view_count() const noexcept;
  /// Passes all bytes to `take`, in the order of the buffer, and forgets them. Errors: those of Spool::give_away().
  [[nodiscard]] Status give_away(const Spool::Take& take);
  /// Returns all bytes, in the order of the buffer, as views that live as long as this object. The spool must be in
  /// memory.
  [[nodiscard]] std::vector<std::string_view> pieces() const;

  /// The JSON of buffer views and accessors, in the order of their indices. json() makes this JSON for bytes that begin
  /// at byte `offset` of a buffer, with buffer views numbered from first_view.
  struct Json {
    std::vector<std::string> views, accessors;
  };
  [[nodiscard]] Json json(std::size_t buffer, std::uint64_t offset, std::size_t first_view) const;

 private:
  struct Array {
    std::size_t components = 1, count = 0;
    std::size_t sparse_count = 0;
    std::size_t index_type = 0;
    std::string least, most;  // bounds of the components as JSON, or empty

    bool operator==(const Array&) const = default;
  };
  // The bytes of an array, in parts that are each padded to a multiple of 4 bytes.
  struct Encoded {
    Array array;
    // the values if they are stored dense; a view of `swapped` on machines that are big endian
    std::string_view dense;
    std::string indices, values;  // the parts of a sparse array, for its sparse_count elements that are not zero
    std::string swapped;
    std::size_t hash = 0;

    Encoded() = default;
    Encoded(Encoded&&) = delete;  // a move would leave views of the old object
  };
  // The place of an array in the spool. The parts follow each other from byte `at` on; `dense`, `indices` and `values`
  // are the sizes of the parts in bytes.
  struct Stored {
    Array array;
    std::uint64_t at = 0, dense = 0, indices = 0, values = 0;
  };
  struct Sizes {
    std::uint64_t vectors = 0, scalars = 0, sparse = 0;
  };

  static void encode(std::span<const float> values, std::size_t components, const GltfVectors& options,
                     Encoded& result);
  [[nodiscard]] bool is_same(const Stored& stored, const Encoded& encoded);
  [[nodiscard]] Sizes sizes() const noexcept;
  // Calls body(at, size) for each piece of the spool, in the order of the buffer, until body() returns an error.
  template <class Body>
  [[nodiscard]] Status each_place(const Body& body) const;

  Spool spool_;
  std::vector<Stored> arrays_;
  std::unordered_multimap<std::size_t, std::size_t> by_hash_;
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_GLB_NEW_ARRAYS_H_
