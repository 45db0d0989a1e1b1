// Writes and reads the comment of a part, and adds up what was asked for.
#include "workflow/sample/array_place.h"

#include <system_error>
#include <vector>

#include "core/bits.h"
#include "core/charconv.h"
#include "io/bytes/binary.h"
#include "io/bytes/zip.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kRows = "rows from ", kOf = " of ", kSamples = ", samples ";

// Takes a word, and a number behind it.
bool take(std::string_view& text, std::string_view word, std::uint64_t& number) {
  if (!text.starts_with(word)) return false;
  const char* const last = text.data() + text.size();
  const auto [end, code] = from_chars(text.data() + word.size(), last, number);
  if (code != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

std::string ArrayPlace::text() const {
  return std::string(kRows).append(std::to_string(first)).append(kOf).append(std::to_string(total)).append(kSamples) +
         std::to_string(samples);
}

std::optional<ArrayPlace> ArrayPlace::read(std::string_view text) {
  ArrayPlace place;
  std::uint64_t samples = 0;
  if (!take(text, kRows, place.first) || !take(text, kOf, place.total) || !take(text, kSamples, samples) ||
      !text.empty() || samples > 0xFFFFFFFF)
    return std::nullopt;
  place.samples = static_cast<std::uint32_t>(samples);
  return place;
}

std::uint32_t checksum_of(const Topology& topology, const SampleOptions& options, const Moments& moments) {
  std::string bytes;
  const auto put = [&](std::uint64_t number) { binary::append(bytes, number, std::endian::little); };
  const auto put_real = [&](double number) { put(bit_cast<std::uint64_t>(number)); };
  put(static_cast<std::uint64_t>(options.elements.kind));
  put(options.elements.weld ? 1 : 0);
  put_real(options.elements.crease_angle);
  put(options.elements.group_of_face.size());
  put(options.elements.normal_of_corner.count);
  put(static_cast<std::uint64_t>(options.weighting));
  put(static_cast<std::uint64_t>(options.length));
  put(static_cast<std::uint64_t>(options.path));
  for (const double time : moments.times) put_real(time);
  for (const std::vector<double>& weights : moments.weights)
    for (const double weight : weights) put_real(weight);
  put(topology.vertex_count());
  std::uint32_t sum = zip::checksum(bytes);
  bytes.clear();
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    put(topology.face(f).size());
    for (const std::uint32_t v : topology.face(f)) put(v);
    if (bytes.size() < (std::size_t{1} << 16) && f + 1 < topology.face_count()) continue;
    sum = zip::checksum(bytes, sum);
    bytes.clear();
  }
  return sum;
}

}  // namespace chronormal::inline internal
