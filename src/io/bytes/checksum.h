/// Checksums (CRC-32, as zip files have it) of bytes, of numbers, and of texts that carry their own: journals, parts of
/// shards and zip files tell by them what was damaged or is of something else. Private to io and workflow.
#ifndef CHRONORMAL_IO_BYTES_CHECKSUM_H_
#define CHRONORMAL_IO_BYTES_CHECKSUM_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Continues a checksum: `so_far` is that of all bytes before these.
[[nodiscard]] std::uint32_t checksum_of(std::string_view bytes, std::uint32_t so_far = 0);

/// The checksum of some bytes and of others behind them, which are so many, from the checksums of both.
[[nodiscard]] std::uint32_t joined_checksum(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

/// A checksum that grows with numbers; it is the same on machines of either byte order.
class NumberChecksum {
 public:
  void add(std::uint64_t number);
  void add(double number);
  /// The count of the numbers is a part of the checksum, so that two lists are not taken for another two.
  void add(std::span<const std::uint32_t> numbers);
  void add(std::span<const float> numbers);
  void add(std::string_view text);

  [[nodiscard]] std::uint32_t value() const noexcept { return value_; }

 private:
  std::uint32_t value_ = 0;
};

/// A text in a line that says its checksum, "1a2b3c4d TEXT" and a line feed; the text itself has none.
[[nodiscard]] std::string checked_line(std::string_view text);
/// The text of such a line without its end; nothing where it is damaged.
[[nodiscard]] std::optional<std::string_view> text_of_checked(std::string_view line);

/// Adds the checksum of everything before it to the text of a JSON object, as its last member: {"a": 1} becomes
/// {"a": 1,"checksum":"1a2b3c4d"} and a line feed.
[[nodiscard]] std::string with_checksum(std::string object);
/// Returns true if a text ends with its checksum, and nothing in it was changed since.
[[nodiscard]] bool has_its_checksum(std::string_view text);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_CHECKSUM_H_
