#include "cli/terminal/table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "cli/terminal/format.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kGap = 2;  // number of blanks between columns
// A name that is longer than 1 / kLongestShare of a line gets a line of its own.
constexpr std::size_t kLongestShare = 2;

// Breaks a text between words. The first line starts at column `from`, and a line takes at least one word.
std::string broken(const std::string& text, std::size_t from, std::size_t columns) {
  std::string result;
  std::size_t column = from;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at + 1), text.size());
    const std::string word = text.substr(at, end - at);
    if (column > from && column + width_of(word) > columns) {
      result.append("\n").append(from, ' ').append(word, 1, word.size());
      column = from + width_of(word) - 1;
    } else {
      result += word;
      column += width_of(word);
    }
    at = end;
  }
  return result;
}

}  // namespace

void Table::add_column(std::string title, std::string unit, Align align) {
  assert(rows_.empty());
  columns_.push_back({std::move(title), std::move(unit), align});
}

void Table::add_row(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::text_of(const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& widths,
                           std::size_t columns) const {
  const auto line = [&](const auto& cell_of) {
    std::string text;
    std::size_t column = 0;
    for (const std::size_t c : chosen) {
      const std::string cell = cell_of(c);
      const std::size_t gap = c == chosen.front() ? 0 : kGap, width = width_of(cell);
      column += gap;
      text.append(gap, ' ');
      const std::string blanks(widths[c] - std::min(width, widths[c]), ' ');
      if (width > widths[c])  // a name that is wider than its column
        text.append(cell).append("\n").append(column + widths[c], ' ');
      else if (c == chosen.back() && columns_[c].align == Align::kLeft)
        text.append(broken(cell, column, columns));
      else
        text += columns_[c].align == Align::kLeft ? cell + blanks : blanks + cell;
      column += widths[c];
    }
    return text.erase(text.find_last_not_of(' ') + 1);
  };
  const auto title = [&](std::size_t c) { return columns_[c].title; };
  const auto unit = [&](std::size_t c) { return columns_[c].unit; };
  std::string text = heading(line(title)).append("\n");
  if (const std::string units = line(unit); !units.empty()) text.append(heading(units)).append("\n");
  for (const std::vector<std::string>& row : rows_)
    text.append(line([&](std::size_t c) { return row[c]; })).append("\n");
  return text;
}

std::size_t Table::width_of_column(std::size_t column, std::size_t most) const {
  std::size_t width = std::max(width_of(columns_[column].title), width_of(columns_[column].unit));
  for (const std::vector<std::string>& row : rows_)
    if (const std::size_t own = width_of(row[column]); own <= most) width = std::max(width, own);
  return width;
}

std::string Table::text(std::size_t columns) const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c)
    widths.push_back(width_of_column(c, std::numeric_limits<std::size_t>::max()));
  std::size_t width_of_all = kGap * (columns_.size() - 1);
  for (const std::size_t width : widths) width_of_all += width;

  // When a table is split, every part repeats the columns that identify a row.
  std::vector<std::size_t> about;
  std::size_t next = 0, width_about = 0;
  for (bool is_name = false; next < columns_.size() && !is_name; ++next) {
    is_name = columns_[next].align == Align::kLeft;
    if (is_name && width_of_all > columns) widths[next] = width_of_column(next, columns / kLongestShare);
    about.push_back(next);
    width_about += widths[next] + (next > 0 ? kGap : 0);
  }
  std::string text;
  while (next < columns_.size() || text.empty()) {
    std::vector<std::size_t> part = about;
    std::size_t width = width_about;
    while (next < columns_.size()) {
      std::size_t end = next + 1, more = kGap + widths[next];
      for (; end < columns_.size() && columns_[end].title.empty(); ++end) more += kGap + widths[end];
      if (width + more > columns && part.size() > about.size()) break;
      for (; next < end; ++next) part.push_back(next);
      width += more;
    }
    text.append(text.empty() ? "" : "\n").append(text_of(part, widths, columns));
  }
  return text;
}

std::vector<std::size_t> indices_of_largest(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() <= most) return order;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] > values[b]; });
  order.resize(most);
  std::sort(order.begin(), order.end());
  return order;
}

std::string four_decimals(double value) {
  if (value == 0) return "0";
  return value < 5e-4 ? formatted("{:.1e}", value) : formatted("{:.4f}", value);
}

std::string grouped_sum(double value) {
  if (value == 0) return "0";
  if (value < 0.1) return formatted("{:.1e}", value);
  const double tenths = std::round(value * 10);
  if (!(tenths < 9e15)) return formatted("{:.4e}", value);
  const auto whole = static_cast<std::size_t>(tenths);
  return formatted("{}.{}", grouped(whole / 10), whole % 10);
}

}  // namespace chronormal::cli
