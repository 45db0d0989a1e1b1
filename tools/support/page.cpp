#include "support/page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace chronormal::pages {
namespace {

constexpr std::size_t kWidth = 118;

// Words over lines of kWidth, each after the first with an indent.
std::string wrapped(std::string_view paragraph, std::string_view first, std::string_view indent) {
  std::istringstream words{std::string(paragraph)};
  std::string text(first), word;
  std::size_t column = first.size();
  bool empty = true;
  while (words >> word) {
    if (!empty && column + 1 + word.size() > kWidth) {
      text += '\n' + std::string(indent);
      column = indent.size();
      empty = true;
    }
    if (!empty) text += ' ', ++column;
    text += word;
    column += word.size();
    empty = false;
  }
  return text + '\n';
}

// Characters, not bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t to, bool left) {
  const std::string space(to - std::min(to, width(text)), ' ');
  return left ? text + space : space + text;
}

}  // namespace

void Page::heading(std::string_view title) { markdown_ += fmt::format("## {}\n\n", title); }
void Page::subheading(std::string_view title) { markdown_ += fmt::format("### {}\n\n", title); }
void Page::text(std::string_view paragraph) { markdown_ += wrapped(paragraph, "", "") + '\n'; }
void Page::line(std::string_view line) { markdown_ += std::string(line) + '\n'; }
void Page::bullet(std::string_view paragraph) { markdown_ += wrapped(paragraph, "* ", "  "); }

void Page::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                 std::size_t text_column) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < header.size(); ++c) {
    widths.push_back(std::max<std::size_t>(3, width(header[c])));
    for (const auto& row : rows) widths[c] = std::max(widths[c], width(row.at(c)));
  }
  const auto left = [text_column](std::size_t c) { return c == 0 || c >= text_column; };
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < header.size(); ++c)
      markdown_ += fmt::format("| {} ", padded(cells[c], widths[c], left(c)));
    markdown_ += "|\n";
  };
  add(header);
  for (std::size_t c = 0; c < header.size(); ++c)
    markdown_ += fmt::format("|{}{}", std::string(widths[c] + 1, '-'), left(c) ? '-' : ':');
  markdown_ += "|\n";
  for (const auto& row : rows) add(row);
  markdown_ += '\n';
}

void Page::picture(const Figure& figure, std::string_view alt) {
  draw(figure, fmt::format("{}/pictures/{}.svg", folder_, figure.name));
  markdown_ += fmt::format("![{}](pictures/{}.svg)\n\n", alt, figure.name);
}

void Page::statement(std::string statement, std::string found, std::string section) {
  statements_.push_back({std::move(statement), std::move(found), std::move(section)});
}

void require(bool holds, std::string_view claim) {
  if (!holds) throw std::runtime_error(fmt::format("the page would claim what does not hold: {}", claim));
}

std::string grouped(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", std::fabs(value), decimals);
  for (std::size_t i = std::min(text.find('.'), text.size()); i > 3;) {
    i -= 3;
    text.insert(i, 1, ',');
  }
  return value < 0 ? fmt::format("-{}", text) : text;
}

std::string ratio(double value) {
  if (value == 0) return "0";
  return std::fabs(value) < 1e-3 ? scientific(value) : fmt::format("{:.3f}", value);
}

std::string percent(double share, int decimals) { return fmt::format("{:.{}f} %", 100 * share, decimals); }

std::string scientific(double value, int decimals) {
  if (value == 0) return "0";
  const std::string text = fmt::format("{:.{}e}", value, decimals);
  const std::size_t e = text.find('e');
  const int exponent = std::stoi(text.substr(e + 1));
  return exponent == 0 ? text.substr(0, e) : fmt::format("{}e{}", text.substr(0, e), exponent);
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

}  // namespace chronormal::pages
