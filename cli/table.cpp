#include "cli/table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "cli/format.h"
#include "cli/text.h"

namespace chronormal::cli {

void Table::add_column(std::string title, std::string unit, Align align) {
  assert(rows_.empty());
  columns_.push_back({std::move(title), std::move(unit), align});
}

void Table::add_row(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::text() const {
  std::vector<std::vector<std::string>> lines(2);
  for (const Column& column : columns_) {
    lines[0].push_back(column.title);
    lines[1].push_back(column.unit);
  }
  const bool has_units = std::any_of(lines[1].begin(), lines[1].end(), [](const auto& unit) { return !unit.empty(); });
  if (!has_units) lines.pop_back();
  lines.insert(lines.end(), rows_.begin(), rows_.end());

  std::vector<std::size_t> widths(columns_.size(), 0);
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], width_of(line[c]));
  }
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t c = 0; c < line.size(); ++c) {
      if (c > 0) row += "  ";
      const std::string blanks(widths[c] - width_of(line[c]), ' ');
      row += columns_[c].align == Align::kLeft ? line[c] + blanks : blanks + line[c];
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
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
