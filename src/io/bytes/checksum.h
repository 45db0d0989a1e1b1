/// Checksums (CRC-32, as in zip files) of bytes, of numbers, and of texts that end or begin with their own checksum.
/// Journals, parts of shards and zip files use these checksums to detect data that are damaged or belong to another
/// run. Private to io and workflow.
#ifndef CHRONORMAL_IO_BYTES_CHECKSUM_H_
#define CHRONORMAL_IO_BYTES_CHECKSUM_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns the checksum of a text that ends with `bytes`. `so_far` is the checksum of the text before `bytes`, or 0 if
/// no text comes before.
[[nodiscard]] std::uint32_t checksum_of(std::string_view bytes, std::uint32_t so_far = 0);

/// Returns the checksum of two blocks of bytes in a row from the checksum of each block. `second_size` is the size of
/// the second block in bytes.
[[nodiscard]] std::uint32_t joined_checksum(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

/// A checksum of numbers and texts that are added one after the other. The checksum is the same on machines of either
/// byte order.
class NumberChecksum {
 public:
  void add(std::uint64_t number);
  void add(double number);
  /// Adds the numbers and their count. The count makes the lists [1], [2, 3] differ from [1, 2], [3].
  void add(std::span<const std::uint32_t> numbers);
  void add(std::span<const float> numbers);
  void add(std::string_view text);

  [[nodiscard]] std::uint32_t value() const noexcept { return value_; }

 private:
  std::uint32_t value_ = 0;
};

/// Returns a line that consists of the checksum of a text, a blank, the text and a line feed: "1a2b3c4d TEXT". The text
/// must not contain a line feed.
[[nodiscard]] std::string checked_line(std::string_view text);
/// Returns the text in a line that checked_line() made, or nothing if the line is damaged. Pass the line without its
/// line feed.
[[nodiscard]] std::optional<std::string_view> text_of_checked(std::string_view line);

/// Appends a last member, "checksum", to the text of a JSON object. The value of this member is the checksum of all
/// bytes before it: {"a": 1} becomes {"a": 1,"checksum":"1a2b3c4d"} and a line feed.
[[nodiscard]] std::string with_checksum(std::string object);
/// Returns true if a text ends with a checksum, as with_checksum() appends it, that matches the text before it.
[[nodiscard]] bool has_its_checksum(std::string_view text);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_CHECKSUM_H_
