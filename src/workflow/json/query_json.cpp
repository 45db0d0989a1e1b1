#include <cmath>
#include <type_traits>

#include "workflow/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {
namespace {

template <class T>
Json value_json(T value) {
  if constexpr (std::is_same_v<T, std::uint8_t>) return value != 0;
  return value;
}

// Returns a column of an answer as an array with one value for each row. If the column has several numbers in each row,
// each value is an array.
Json column_json(const QueryColumn& column) {
  Json rows = Json::array();
  std::visit(
      [&](const auto& values) {
        for (std::size_t row = 0; row < column.rows(); ++row) {
          Json cells = Json::array();
          for (std::size_t k = 0; k < column.width; ++k) cells.push_back(value_json(values[row * column.width + k]));
          rows.push_back(column.width == 1 ? cells[0] : std::move(cells));
        }
      },
      column.values);
  return rows;
}

// Returns a fact as a JSON number. Writes whole numbers without a decimal point, since most facts are counts.
Json fact_json(double value) {
  constexpr double kEveryInteger = 0x1p53;
  if (value == std::floor(value) && std::fabs(value) < kEveryInteger) return static_cast<std::int64_t>(value);
  return value;
}

}  // namespace

std::string query_json(const std::string& input, const QueryAnswer& answer) {
  Json json = json_of_command("query");
  json["question"] = answer.question;
  json["input"] = input;
  for (const QueryFact& fact : answer.facts) json["summary"][fact.name] = fact_json(fact.value);
  for (const QueryTable& table : answer.tables) {
    const std::string prefix = table.name.empty() ? "" : table.name + '_';
    for (const QueryColumn& column : table.columns) json["arrays"][prefix + column.name] = column_json(column);
  }
  return json_text(json);
}

}  // namespace chronormal::inline internal
