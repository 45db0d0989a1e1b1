#include "io/gltf/model/gltf_uri.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/text.h"
#include "io/gltf/model/unicode_forms.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kNoDigit = 255;

constexpr std::array<std::uint8_t, 256> base64_digits() {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::uint8_t, 256> digits{};
  for (std::uint8_t& digit : digits) digit = kNoDigit;
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  return digits;
}

// Decodes base64. Returns nothing if the text is not base64. Accepts text without padding, which is common.
std::optional<std::string> decode_base64(std::string_view text) {
  static constexpr std::array<std::uint8_t, 256> kDigits = base64_digits();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const std::uint8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit == kNoDigit) return std::nullopt;
    bits = (bits << 6) | digit;
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes += static_cast<char>((bits >> bit_count) & 0xFF);
    }
  }
  return bytes;
}

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> decode_percent(std::string_view uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    // Some exporters do not encode names. A percent sign that is not followed by two hexadecimal digits therefore
    // stands for itself.
    const bool is_code =
        uri[i] == '%' && uri.size() - i >= 3 && hexadecimal(uri[i + 1]) >= 0 && hexadecimal(uri[i + 2]) >= 0;
    if (!is_code) {
      path += uri[i];
      continue;
    }
    const int high = hexadecimal(uri[i + 1]), low = hexadecimal(uri[i + 2]);
    path += static_cast<char>(16 * high + low);
    i += 2;
  }
  if (path.find('\0') != std::string::npos) return std::nullopt;
  return path;
}

// Returns true if the URI begins with a scheme or a drive, such as "http:", "file:" or "C:".
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon < uri.find('/') && colon > 0;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  const auto [in_folder, in_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return in_folder == folder.end() && in_path != path.end();
}

Result<fs::path> decode_file_uri(std::string_view uri, const std::string& place) {
  const std::optional<std::string> relative = decode_percent(uri);
  if (!relative || relative->empty())
    return invalid_input(place, "the uri is empty or has a broken % code, so it names no file; export the file again");
  if (has_scheme(uri))
    return invalid_input(
        place,
        "the uri is a web address, not the name of a file; copy the file beside the glTF file and refer to it by name");
  return path_of(*relative);
}

// Returns `path` if a file exists there. Otherwise returns the file that was probably meant: `literal`, which is the
// URI without decoding, or a file in the same folder whose name is equal in another Unicode form.
fs::path existing(const fs::path& path, const fs::path& literal) {
  std::error_code code;
  if (fs::exists(path, code)) return path;
  if (fs::exists(literal, code)) return literal;
  for (fs::directory_iterator entry(path.parent_path(), code), end; !code && entry != end; entry.increment(code))
    if (are_same_text(utf8_of(entry->path().filename()), utf8_of(path.filename()))) return entry->path();
  return path;
}

}  // namespace

bool is_data_uri(std::string_view uri) noexcept { return uri.starts_with("data:"); }

Result<std::string> decode_data_uri(std::string_view uri, std::size_t least, const std::string& place) {
  constexpr std::string_view kPrefixes[] = {"data:application/octet-stream;base64,",
                                            "data:application/gltf-buffer;base64,"};
  for (const std::string_view prefix : kPrefixes) {
    if (!uri.starts_with(prefix)) continue;
    const std::string_view text = uri.substr(prefix.size());
    if (text.size() / 4 * 3 + 3 < least)
      return invalid_input(place, "the data URI has fewer than the " + counted(least, "byte", "bytes") +
                                      " of byteLength; export the file again");
    std::optional<std::string> bytes = decode_base64(text);
    if (!bytes) return invalid_input(place, "the data URI is not valid base64; export the file again");
    if (bytes->size() < least)
      return invalid_input(place, "the data URI has " + counted(bytes->size(), "byte", "bytes") +
                                      ", but byteLength is " + grouped(least) + "; export the file again");
    return std::move(*bytes);
  }
  return invalid_input(place,
                       "the data URI of a buffer has another type than glTF allows; export it with "
                       "data:application/octet-stream;base64, or "
                       "data:application/gltf-buffer;base64,");
}

Result<std::string> resolve_file_uri(std::string_view uri, const std::optional<std::string>& folder,
                                     bool allow_external, const std::string& place) {
  const Result<fs::path> relative = decode_file_uri(uri, place);
  if (!relative) return relative.error();
  const fs::path& path_in_uri = relative.value();
  if (!allow_external && !folder)
    return invalid_input(place,
                         "the glTF file came from standard input, so the folder of its other files is unknown; add "
                         "--allow-external to look in the current folder");
  if (!allow_external && path_in_uri.has_root_path())
    return invalid_input(
        place, "the uri is an absolute path, which is refused for safety; if you trust the file, add --allow-external");

  const fs::path base = folder && !folder->empty() ? path_of(*folder) : ".";
  const fs::path path = existing(base / path_in_uri, base / path_of(uri));
  std::error_code code;
  const fs::path real_base = fs::canonical(base, code);
  const fs::path real = code ? fs::path() : fs::weakly_canonical(path, code);
  if (!allow_external && (code || !is_inside(real, real_base)))
    return invalid_input(place,
                         "the uri leads out of the folder of the glTF file, which is refused for safety; if you trust "
                         "the file, add --allow-external");
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status)) return invalid_input(place, std::string("this file is missing: ").append(utf8_of(path)));
  if (!fs::is_regular_file(status))
    return invalid_input(place, utf8_of(path).append(" is not a regular file; put the file itself there"));
  return utf8_of(path);
}

Result<std::string> name_file_uri(std::string_view uri, const std::optional<std::string>& folder,
                                  const std::string& place) {
  const Result<fs::path> relative = decode_file_uri(uri, place);
  if (!relative) return relative.error();
  const fs::path path = relative.value().lexically_normal();
  if (path.has_root_path() || *path.begin() == "..")
    return invalid_input(place, "the uri leads out of the folder of the glTF file; give a name inside that folder");
  return utf8_of(path_of(folder.value_or("")) / path);
}

}  // namespace chronormal::inline internal
