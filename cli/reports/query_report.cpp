#include "cli/reports/query_report.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "cli/terminal/format.h"
#include "cli/terminal/rows.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {
namespace {

template <class T>
std::string cell_of(T value) {
  if constexpr (std::is_same_v<T, std::uint8_t>)
    return value != 0 ? "yes" : "no";
  else if constexpr (std::is_floating_point_v<T>)
    return formatted("{:.6g}", value);
  else
    return formatted("{}", value);
}

std::string cell_of(const QueryColumn& column, std::size_t row) {
  return std::visit(
      [&](const auto& values) {
        std::string text;
        for (std::size_t k = 0; k < column.width; ++k)
          text.append(k == 0 ? "" : " ").append(cell_of(values[row * column.width + k]));
        return text;
      },
      column.values);
}

std::string text_of(const QueryTable& table) {
  Table shown;
  for (const QueryColumn& column : table.columns) {
    std::string title = column.name;
    std::replace(title.begin(), title.end(), '_', ' ');
    shown.add_column(title, "", Table::Align::kRight);
  }
  const std::size_t rows = std::min(table.rows(), kMostRows);
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<std::string> cells;
    for (const QueryColumn& column : table.columns) cells.push_back(cell_of(column, row));
    shown.add_row(std::move(cells));
  }
  std::string text = "\n";
  text += heading(formatted("{}:", table.meaning)) + '\n' + shown.text();
  if (table.rows() > rows)
    text += formatted("... and {} (-o OUT.npz and --json have all)\n",
                      counted(table.rows() - rows, "more row", "more rows"));
  return text;
}

// Formats a whole number with its digits in groups of three, and any other value with six digits.
std::string text_of(double value) {
  return value >= 0 && value < 1e15 && value == std::floor(value) ? grouped(static_cast<std::size_t>(value))
                                                                  : formatted("{:.6g}", value);
}

}  // namespace

std::string query_text(const std::string& input, const QueryAnswer& answer) {
  std::string text = heading(printable(input)) + '\n';
  std::size_t width = 0;
  for (const QueryFact& fact : answer.facts) width = std::max(width, text_of(fact.value).size());
  for (const QueryFact& fact : answer.facts)
    text += formatted("  {:>{}}  {}\n", text_of(fact.value), width, fact.meaning);
  for (const QueryTable& table : answer.tables)
    if (table.rows() > 0) text += text_of(table);
  return text;
}

}  // namespace chronormal::cli
