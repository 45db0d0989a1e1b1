// Computes checksums by zlib, and writes them in hexadecimal.
#include "io/bytes/checksum.h"

#include <zlib.h>

#include <algorithm>
#include <bit>

#include "core/bits.h"
#include "io/bytes/binary.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kDigits = 8;
constexpr std::string_view kMember = ",\"checksum\":\"", kEnd = "\"}\n";

std::string digits_of(std::uint32_t sum) {
  std::string digits(kDigits, '0');
  for (std::size_t i = kDigits; i-- > 0; sum >>= 4U) digits[i] = "0123456789abcdef"[sum & 0xFU];
  return digits;
}

std::string member_of(std::string_view object) {
  return std::string(kMember).append(digits_of(checksum_of(object))).append(kEnd);
}

}  // namespace

std::uint32_t checksum_of(std::string_view bytes, std::uint32_t so_far) {
  return static_cast<std::uint32_t>(::crc32_z(so_far, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t joined_checksum(std::uint32_t first, std::uint32_t second, std::uint64_t second_size) {
  return static_cast<std::uint32_t>(::crc32_combine(first, second, static_cast<z_off_t>(second_size)));
}

void NumberChecksum::add(std::uint64_t number) {
  std::string bytes;
  binary::append(bytes, number, std::endian::little);
  value_ = checksum_of(bytes, value_);
}

void NumberChecksum::add(double number) { add(bit_cast<std::uint64_t>(number)); }

void NumberChecksum::add(std::span<const std::uint32_t> numbers) {
  constexpr std::size_t kBlock = 4096;
  add(std::uint64_t{numbers.size()});
  std::string bytes;
  for (std::size_t first = 0; first < numbers.size(); first += kBlock) {
    bytes.clear();
    for (const std::uint32_t number : numbers.subspan(first, std::min(kBlock, numbers.size() - first)))
      binary::append(bytes, number, std::endian::little);
    value_ = checksum_of(bytes, value_);
  }
}

void NumberChecksum::add(std::span<const float> numbers) {
  std::string storage;
  add(std::uint64_t{numbers.size()});
  value_ = checksum_of(binary::bytes_of(numbers, std::endian::little, storage), value_);
}

void NumberChecksum::add(std::string_view text) {
  add(std::uint64_t{text.size()});
  value_ = checksum_of(text, value_);
}

std::string checked_line(std::string_view text) {
  return digits_of(checksum_of(text)).append(" ").append(text).append("\n");
}

std::optional<std::string_view> text_of_checked(std::string_view line) {
  if (line.size() <= kDigits || line[kDigits] != ' ') return std::nullopt;
  const std::string_view text = line.substr(kDigits + 1);
  return line.starts_with(digits_of(checksum_of(text))) ? std::optional(text) : std::nullopt;
}

std::string with_checksum(std::string object) {
  object.pop_back();
  return object + member_of(object);
}

bool has_its_checksum(std::string_view text) {
  constexpr std::size_t kSize = kMember.size() + kDigits + kEnd.size();
  return text.size() > kSize && text.ends_with(member_of(text.substr(0, text.size() - kSize)));
}

}  // namespace chronormal::inline internal
