// Finds the numbers in the names of files. A name is divided into texts and numbers, in the same way for all names of a
// set. Names with the same texts form a group; a sequence is a group in which one number differs from name to name.
#include "io/input/numbering.h"

#include <algorithm>
#include <cctype>
#include <compare>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include "core/charconv.h"
#include "io/bytes/extension.h"
#include "io/bytes/scan.h"
#include "io/input/formats.h"
#include "io/input/input_files.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

// A number of any size. Its value is 0.D times ten to the power of `point`, where D stands for the text `digits`. A
// number without digits is 0.
struct Number {
  bool is_negative = false;
  std::string digits;  // digits without zeros at the beginning and the end
  std::int64_t point = 0;

  [[nodiscard]] bool is_integer() const {
    return static_cast<std::int64_t>(digits.size()) <= std::max<std::int64_t>(point, 0);
  }
  friend bool operator==(const Number&, const Number&) = default;
  friend std::strong_ordering operator<=>(const Number& a, const Number& b) {
    const auto sign = [](const Number& x) { return x.digits.empty() ? 0 : x.is_negative ? -1 : 1; };
    if (const auto order = sign(a) <=> sign(b); order != 0) return order;
    const Number &low = a.is_negative ? b : a, &high = a.is_negative ? a : b;
    if (sign(a) == 0) return std::strong_ordering::equal;
    if (const auto order = low.point <=> high.point; order != 0) return order;
    return low.digits.compare(high.digits) <=> 0;
  }
};

// The place of a number in a name.
struct Place {
  std::size_t begin = 0, end = 0;    // begin (at its sign) and end of the number
  std::size_t digits = 0;            // offset of its first digit
  std::size_t point = 0, power = 0;  // offsets of the decimal point and of the letter e; `end` if there is none
};

struct Cut {
  // The texts before, between and after the numbers of a name, one more than there are numbers. The last text is the
  // extension in lower case.
  std::vector<std::string> texts;
  std::vector<Place> places;

  [[nodiscard]] std::string key() const {
    std::string key;
    for (const std::string& text : texts) key.append(text).append(1, '\0');
    return key;
  }
};

// Returns the extension of a name in lower case. Returns an empty text if no format has this extension, because in a
// name such as walk_0.05 the last part belongs to a number.
std::string known_extension(std::string_view name) {
  return find_format(name) == nullptr ? std::string() : lower_extension(name);
}

struct Syntax {
  bool has_fractions = true, has_powers = true;
};

std::size_t end_of_digits(std::string_view name, std::size_t at) {
  while (at < name.size() && scan::is_digit(name[at])) ++at;
  return at;
}

Cut cut_name(std::string_view name, Syntax syntax) {
  Cut cut;
  const std::size_t stem = name.size() - known_extension(name).size();
  std::size_t text = 0, at = 0;
  while (at < stem) {
    if (!scan::is_digit(name[at])) {
      ++at;
      continue;
    }
    Place place{at, 0, at, 0, 0};
    at = end_of_digits(name, at);
    place.point = at;
    if (syntax.has_fractions && at + 1 < stem && name[at] == '.' && scan::is_digit(name[at + 1]))
      at = end_of_digits(name, at + 1);
    else
      place.point = 0;
    if (syntax.has_powers && at + 1 < stem && (name[at] == 'e' || name[at] == 'E')) {
      const std::size_t sign = name[at + 1] == '-' || name[at + 1] == '+' ? 1 : 0;
      if (at + 1 + sign < stem && scan::is_digit(name[at + 1 + sign])) {
        place.power = at;
        at = end_of_digits(name, at + 1 + sign);
      }
    }
    place.end = at;
    if (place.point == 0) place.point = place.end;
    if (place.power == 0) place.power = place.end;
    // A minus is a sign at the start of the name, or after a blank or a separator.
    if (place.begin > 0 && name[place.begin - 1] == '-' &&
        (place.begin == 1 || name[place.begin - 2] == ' ' || is_separator(name[place.begin - 2])))
      --place.begin;
    cut.texts.emplace_back(name.substr(text, place.begin - text));
    cut.places.push_back(place);
    text = place.end;
  }
  cut.texts.emplace_back(name.substr(text, stem - text));
  cut.texts.back() += '\0' + known_extension(name);
  return cut;
}

Number number_at(std::string_view name, const Place& place) {
  Number number;
  number.is_negative = place.digits > place.begin;
  const std::size_t mantissa_end = std::min(place.power, place.end);
  number.point = static_cast<std::int64_t>(std::min(place.point, mantissa_end) - place.digits);
  for (std::size_t i = place.digits; i < mantissa_end; ++i)
    if (name[i] != '.') number.digits += name[i];
  const std::size_t zeros = std::min(number.digits.find_first_not_of('0'), number.digits.size());
  number.digits.erase(0, zeros);
  number.point -= static_cast<std::int64_t>(zeros);
  while (number.digits.ends_with('0')) number.digits.pop_back();
  if (place.power < place.end) {
    std::int64_t power = 0;
    std::string_view text = name.substr(place.power + 1, place.end - place.power - 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    constexpr std::int64_t kLargest = std::int64_t{1} << 40;
    if (scan::parse_integer(text, power) == scan::NumberFault::kTooLarge)
      power = text.starts_with('-') ? -kLargest : kLargest;
    number.point += std::clamp(power, -kLargest, kLargest);
  }
  if (number.digits.empty()) number = {};
  return number;
}

// Returns the number as a double, or infinity if it is too large.
double value_of(const Number& number) {
  const std::string text = (number.is_negative ? "-0." : "0.") + number.digits + "e" + std::to_string(number.point);
  double value = 0;
  const auto [end, code] = from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc{} || number.point < 0 ? value : std::numeric_limits<double>::infinity();
}

// A group of files whose names have the same texts between their numbers.
struct Group {
  std::vector<std::size_t> files;
  // Indices of the numbers that differ between the files.
  std::vector<std::size_t> varying;
};

class Names {
 public:
  explicit Names(const std::vector<std::string>& files) : files_(files) {
    Syntax syntax;
    cut_all(syntax);
    syntax.has_powers = all_have_powers();
    if (!syntax.has_powers) cut_all(syntax);
    syntax.has_fractions = have_fractions();
    if (!syntax.has_fractions) cut_all(syntax);
    take_signs();
    for (std::size_t i = 0; i < files.size(); ++i)
      for (const Place& place : cuts_[i].places) numbers_[i].push_back(number_at(files[i], place));
  }

  [[nodiscard]] const Number& number(std::size_t file, std::size_t k) const { return numbers_[file][k]; }
  [[nodiscard]] const Place& place(std::size_t file, std::size_t k) const { return cuts_[file].places[k]; }
  [[nodiscard]] std::vector<Group> groups() const {
    std::map<std::string, Group> by_key;
    for (std::size_t i = 0; i < files_.size(); ++i) by_key[cuts_[i].key()].files.push_back(i);
    std::vector<Group> groups;
    for (auto& of_key : by_key) {
      Group& group = of_key.second;
      const std::size_t first = group.files.front();
      for (std::size_t k = 0; k < numbers_[first].size(); ++k) {
        const auto differs = [&](std::size_t i) { return numbers_[i][k] != numbers_[first][k]; };
        if (std::any_of(group.files.begin(), group.files.end(), differs)) group.varying.push_back(k);
      }
      const auto stands_first = [&](std::size_t a, std::size_t b) {
        for (const std::size_t k : group.varying)
          if (const auto order = numbers_[a][k] <=> numbers_[b][k]; order != 0) return order < 0;
        return files_[a] < files_[b];
      };
      std::stable_sort(group.files.begin(), group.files.end(), stands_first);
      groups.push_back(std::move(group));
    }
    return groups;
  }

 private:
  void cut_all(Syntax syntax) {
    for (std::size_t i = 0; i < files_.size(); ++i) cuts_[i] = cut_name(files_[i], syntax);
  }

  // Returns true if some number has an exponent, and if at each place either all names have an exponent or none has.
  [[nodiscard]] bool all_have_powers() const {
    bool some = false;
    for (const Cut& cut : cuts_) {
      if (cut.texts != cuts_.front().texts) return false;
      for (std::size_t k = 0; k < cut.places.size(); ++k) {
        const bool has_power = cut.places[k].power < cut.places[k].end;
        if (has_power != (cuts_.front().places[k].power < cuts_.front().places[k].end)) return false;
        some = some || has_power;
      }
    }
    return some;
  }

  // Returns true if points between digits can be decimal points. Returns false if they are separators, as in versions
  // (v2.0001) and lists (1.9, 1.10).
  [[nodiscard]] bool have_fractions() const {
    std::map<std::pair<std::string, std::size_t>, std::vector<std::pair<std::string, std::string>>> found;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      for (std::size_t k = 0; k < cuts_[i].places.size(); ++k) {
        const Place& place = cuts_[i].places[k];
        const std::size_t end = std::min(place.power, place.end);
        if (place.point >= end) continue;
        std::string text = cuts_[i].texts[k];
        found[{text, k}].emplace_back(files_[i].substr(place.digits, place.point - place.digits),
                                      files_[i].substr(place.point + 1, end - place.point - 1));
      }
    }
    for (const auto& place : found) {
      const auto& parts = place.second;
      const bool is_constant =
          std::all_of(parts.begin(), parts.end(), [&](const auto& each) { return each == parts.front(); });
      if (is_constant) continue;
      const bool one_version =
          std::all_of(parts.begin(), parts.end(), [&](const auto& each) { return each.first == parts.front().first; });
      const std::string& before = parts.front().first;
      const std::string& text = place.first.first;
      const bool is_named = text.ends_with('v') || text.ends_with('V');
      if (one_version && (is_named || (before.size() > 1 && before.front() == '0'))) return false;
      const bool same_length = std::all_of(parts.begin(), parts.end(), [&](const auto& each) {
        return each.second.size() == parts.front().second.size();
      });
      const bool has_padded = std::any_of(parts.begin(), parts.end(), [](const auto& each) {
        return each.second.size() > 1 && each.second.ends_with('0');
      });
      if (!same_length && has_padded) return false;
    }
    return true;
  }

  // Takes a minus before a number as its sign if another name has the same texts around its numbers, but no minus
  // there.
  void take_signs() {
    std::set<std::vector<std::string>> texts;
    for (const Cut& cut : cuts_) texts.insert(cut.texts);
    for (Cut& cut : cuts_) {
      for (std::size_t k = 0; k < cut.places.size(); ++k) {
        if (!cut.texts[k].ends_with('-')) continue;
        std::vector<std::string> unsigned_texts = cut.texts;
        unsigned_texts[k].pop_back();
        if (!texts.contains(unsigned_texts)) continue;
        cut.texts = std::move(unsigned_texts);
        --cut.places[k].begin;
      }
    }
  }

  const std::vector<std::string>& files_;
  std::vector<Cut> cuts_ = std::vector<Cut>(files_.size());
  std::vector<std::vector<Number>> numbers_ = std::vector<std::vector<Number>>(files_.size());
};

// Describes a group for messages: "walk_0.obj ... walk_9.obj (10 files)".
std::string group_words(const std::vector<std::string>& files, const Group& group) {
  const std::string first = file_name_of(files[group.files.front()]);
  if (group.files.size() == 1) return first;
  return first + " ... " + file_name_of(files[group.files.back()]) + " (" + std::to_string(group.files.size()) +
         " files)";
}

// Divides each group in which several numbers differ. Files whose numbers differ only in the last place form a part:
// take1_1 and take1_2 are one part, take2_1 and take2_2 another. If every part would be a single file, as for dates,
// the group stays whole.
std::vector<Group> divided(const Names& names, const std::vector<Group>& groups) {
  std::vector<Group> result;
  for (const Group& group : groups) {
    std::vector<Group> parts;
    for (const std::size_t file : group.files) {
      const auto goes_with = [&](const Group& part) {
        return std::all_of(group.varying.begin(), group.varying.end() - 1,
                           [&](std::size_t k) { return names.number(file, k) == names.number(part.files.front(), k); });
      };
      const bool is_next = !parts.empty() && !group.varying.empty() && goes_with(parts.back());
      if (!is_next)
        parts.push_back({{}, group.varying.empty() ? std::vector<std::size_t>{} : std::vector{group.varying.back()}});
      parts.back().files.push_back(file);
    }
    const bool has_series =
        std::any_of(parts.begin(), parts.end(), [](const Group& part) { return part.files.size() > 1; });
    if (group.varying.size() < 2 || !has_series) parts = {group};
    result.insert(result.end(), parts.begin(), parts.end());
  }
  return result;
}

void reorder(std::vector<std::string>& files, const std::vector<std::size_t>& order) {
  std::vector<std::string> sorted;
  sorted.reserve(files.size());
  for (const std::size_t i : order) sorted.push_back(std::move(files[i]));
  files = std::move(sorted);
}

// Returns true if a shell may have listed the files in this order. Shells sort names by bytes, or by the rules of a
// language, most of which compare letters and digits before all other characters.
bool stand_as_listed(const std::vector<std::string>& files) {
  const auto letters_of = [](const std::string& name) {
    std::string letters;
    for (const char c : name)
      if (std::isalnum(static_cast<unsigned char>(c)) != 0)
        letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return letters;
  };
  const auto by_letters = [&](const std::string& a, const std::string& b) { return letters_of(a) < letters_of(b); };
  return std::is_sorted(files.begin(), files.end()) || std::is_sorted(files.begin(), files.end(), by_letters);
}

}  // namespace

Status sort_as_sequence(const std::string& input, std::vector<std::string>& files) {
  const Names names(files);
  std::vector<Group> groups = names.groups();
  for (const Group& group : groups) {
    for (std::size_t i = 1; i < group.files.size(); ++i) {
      const std::size_t a = group.files[i - 1], b = group.files[i];
      const bool same = std::all_of(group.varying.begin(), group.varying.end(),
                                    [&](std::size_t k) { return names.number(a, k) == names.number(b, k); });
      if (same)
        return invalid_input(
            input, file_name_of(files[a]) + " and " + file_name_of(files[b]) +
                       " have the same number, so one of them is not a keyframe; choose files with a pattern");
    }
  }
  groups = divided(names, groups);
  if (groups.size() > 1) {
    const Group* series = nullptr;
    for (const Group& group : groups)
      if (group.files.size() > 1 && (series == nullptr || group.files.size() > series->files.size())) series = &group;
    if (series != nullptr) {
      constexpr std::size_t kMostListed = 5;
      std::size_t sequences = 0;
      std::string list;
      std::stable_sort(groups.begin(), groups.end(),
                       [](const Group& a, const Group& b) { return a.files.size() > b.files.size(); });
      for (std::size_t i = 0; i < groups.size(); ++i) {
        if (groups[i].files.size() > 1) ++sequences;
        if (i < kMostListed) list += (i == 0 ? "" : ", ") + group_words(files, groups[i]);
      }
      if (groups.size() > kMostListed) list += ", ...";
      const std::size_t file = groups.front().files.front();
      const Place& place = names.place(file, groups.front().varying.back());
      std::string pattern = files[file];
      pattern.replace(place.begin, place.end - place.begin, "*");
      return invalid_input(input, (sequences > 1 ? "the files are " + std::to_string(sequences) + " sequences"
                                                 : std::string("the files are a sequence and other files")) +
                                      ": " + list + "; choose one sequence with a pattern such as '" + pattern + "'");
    }
    std::sort(files.begin(), files.end(), stands_before);
    return Success{};
  }
  if (!groups.empty()) reorder(files, groups.front().files);
  return Success{};
}

bool sort_listed(std::vector<std::string>& files) {
  if (files.size() < 3 || !stand_as_listed(files)) return false;
  const Names names(files);
  const std::vector<Group> groups = names.groups();
  if (groups.size() != 1 || groups.front().varying.size() != 1) return false;
  const std::vector<std::size_t>& order = groups.front().files;
  const std::size_t k = groups.front().varying.front();
  for (std::size_t i = 1; i < order.size(); ++i)
    if (names.number(order[i - 1], k) == names.number(order[i], k)) return false;
  if (std::is_sorted(order.begin(), order.end())) return false;
  reorder(files, std::vector<std::size_t>(order));
  return true;
}

FileTimes times_of_files(const std::vector<std::string>& files) {
  FileTimes result;
  result.times.resize(files.size());
  std::iota(result.times.begin(), result.times.end(), 0.0);
  if (files.size() < 2) return result;
  const Names names(files);
  const std::vector<Group> groups = names.groups();
  if (groups.size() != 1 || groups.front().varying.size() != 1) return result;
  const std::size_t k = groups.front().varying.front();
  std::vector<double> values;
  bool are_seconds = false;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Number& number = names.number(i, k);
    are_seconds = are_seconds || !number.is_integer();
    values.push_back(value_of(number));
    if (i > 0 && !(values[i] > values[i - 1] && values[i] < std::numeric_limits<double>::infinity())) return result;
  }
  FileSeries series{files.size(),          values.front(),        values.back(),
                    values[1] - values[0], values[1] - values[0], are_seconds};
  for (std::size_t i = 1; i < values.size(); ++i) {
    series.least_step = std::min(series.least_step, values[i] - values[i - 1]);
    series.most_step = std::max(series.most_step, values[i] - values[i - 1]);
  }
  result.series = series;
  if (are_seconds)
    result.times = std::move(values);
  else if (series.least_step != series.most_step)
    for (std::size_t i = 0; i < values.size(); ++i) result.times[i] = values[i] - values.front();
  return result;
}

}  // namespace chronormal::inline internal
