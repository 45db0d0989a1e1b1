// A template is read line by line: a line decides by how it begins which block it belongs to, and each kind of block is
// laid out in its own way once its places are filled.
#include "support/page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "chronormal/io/output.h"

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

// The first row is the header; left: of each column, whether it is aligned to the left.
std::string aligned(const std::vector<Cells>& rows, const std::vector<bool>& left) {
  std::vector<std::size_t> widths(left.size(), 3);
  for (const Cells& row : rows) {
    for (std::size_t c = 0; c < left.size(); ++c) widths[c] = std::max(widths[c], width(row.at(c)));
  }
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < left.size(); ++c) text += fmt::format("| {} ", padded(rows[r][c], widths[c], left[c]));
    text += "|\n";
    if (r > 0) continue;
    for (std::size_t c = 0; c < left.size(); ++c)
      text += fmt::format("|{:-<{}}{}", "", widths[c] + 1, left[c] ? '-' : ':');
    text += "|\n";
  }
  return text;
}

// The cells of a row of a template: what stands between its bars.
Cells cells_of(const std::string& line) {
  Cells cells;
  for (std::size_t bar = line.find('|'), next = 0; (next = line.find('|', bar + 1)) != std::string::npos; bar = next) {
    std::istringstream words(line.substr(bar + 1, next - bar - 1));
    std::string cell;
    for (std::string word; words >> word;) cell += (cell.empty() ? "" : " ") + word;
    cells.push_back(cell);
  }
  return cells;
}

// A table that stands in a template: header, line of alignment, rows.
std::string aligned_anew(const std::vector<std::string>& lines) {
  std::vector<Cells> rows;
  for (const std::string& line : lines) rows.push_back(cells_of(line));
  std::vector<bool> left;
  for (const std::string& mark : rows.at(1)) left.push_back(!mark.ends_with(':'));
  rows.erase(rows.begin() + 1);
  return aligned(rows, left);
}

bool is_place(std::string_view line) { return line.starts_with("{{") && line.find("}}") == line.size() - 2; }

// Lines that stand as they are: headings, comments, indented code, images.
bool stands_alone(std::string_view line) {
  return line.empty() || line[0] == '#' || line.starts_with("<!--") || line.starts_with("    ") ||
         line.starts_with("![");
}

// The title of a row or a column.
bool is_called(const std::string& title, const std::string& name) {
  return title == name || title.find('`' + name + '`') != std::string::npos;
}

std::string read_template(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Page::Page(std::string_view template_file, std::string folder) : Page(std::move(folder)) {
  name_ = template_file;
  template_ = read_template(fmt::format("{}/{}", CHRONORMAL_TOOLS_DIR, template_file));
}

Page Page::of_text(std::string text, std::string folder) {
  Page page(std::move(folder));
  page.name_ = "template";
  page.template_ = std::move(text);
  return page;
}

void Page::set(std::string name, std::string text) {
  if (!values_.try_emplace(name, std::move(text)).second) throw std::runtime_error(name_ + ": set twice: " + name);
}

void Page::set(std::initializer_list<std::pair<const char*, std::string>> values) {
  for (const auto& [name, text] : values) set(name, text);
}

void Page::table(std::string name, Cells header, std::vector<Cells> rows, std::size_t text_column) {
  set(name, aligned_table(header, rows, text_column));
  tables_[std::move(name)] = {std::move(header), std::move(rows)};
}

void Page::picture(std::string name, const Figure& figure) {
  const std::string path = fmt::format("pictures/{}.svg", figure.name);
  draw(figure, fmt::format("{}/{}", folder_, path));
  set(std::move(name), path);
}

const std::string& Page::value(const std::string& name, std::set<std::string>& used) const {
  const auto found = values_.find(name);
  if (found != values_.end()) {
    used.insert(name);
    return found->second;
  }
  const std::size_t first = name.find('/'), last = name.rfind('/');
  const auto table = first == last ? tables_.end() : tables_.find(name.substr(0, first));
  if (table != tables_.end()) {
    const auto& [header, rows] = table->second;
    const std::string row_name = name.substr(first + 1, last - first - 1), column_name = name.substr(last + 1);
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Cells& r) { return is_called(r[0], row_name); });
    const auto column = std::find_if(header.begin(), header.end(),
                                     [&](const std::string& title) { return is_called(title, column_name); });
    if (row != rows.end() && column != header.end()) return (*row)[static_cast<std::size_t>(column - header.begin())];
  }
  throw std::runtime_error(fmt::format("{}: no value for {{{{{}}}}}", name_, name));
}

std::string Page::filled(std::string_view text, std::set<std::string>& used) const {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = std::min(text.find("{{", at), text.size());
    result += text.substr(at, begin - at);
    if (begin == text.size()) break;
    const std::size_t end = text.find("}}", begin);
    if (end == std::string_view::npos) throw std::runtime_error(fmt::format("{}: {{{{ without }}}}", name_));
    result += value(std::string(text.substr(begin + 2, end - begin - 2)), used);
    at = end + 2;
  }
  return result;
}

std::string Page::markdown() const {
  std::vector<std::string> lines;
  std::istringstream stream(template_);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);

  std::set<std::string> used;
  std::string result;
  for (std::size_t i = 0; i < lines.size();) {
    const std::string line = lines[i++];
    if (is_place(line)) {
      result += filled(line, used);
    } else if (stands_alone(line)) {
      result += filled(line, used) + '\n';
    } else if (line[0] == '|') {
      std::vector<std::string> table = {filled(line, used)};
      while (i < lines.size() && lines[i].starts_with('|')) table.push_back(filled(lines[i++], used));
      result += aligned_anew(table);
    } else {
      const bool item = line.starts_with("* ");
      std::string paragraph = item ? line.substr(2) : line;
      while (i < lines.size() && !stands_alone(lines[i]) && lines[i][0] != '|' && !lines[i].starts_with("* "))
        paragraph += '\n' + lines[i++];
      std::replace(paragraph.begin(), paragraph.end(), '\n', ' ');  // a name may be broken over lines
      result += item ? wrapped(filled(paragraph, used), "* ", "  ") : wrapped(filled(paragraph, used), "", "");
    }
  }
  for (const auto& [name, text] : values_) {
    if (!used.contains(name)) throw std::runtime_error(fmt::format("{}: no place for the value {}", name_, name));
  }
  return result;
}

void Page::write(std::string_view name) const {
  const Status written = write_output(fmt::format("{}/{}", folder_, name), markdown(), true);
  if (!written) throw std::runtime_error(written.error().text());
}

std::string aligned_table(const Cells& header, const std::vector<Cells>& rows, std::size_t text_column) {
  std::vector<bool> left;
  for (std::size_t c = 0; c < header.size(); ++c) left.push_back(c == 0 || c >= text_column);
  std::vector<Cells> all = {header};
  all.insert(all.end(), rows.begin(), rows.end());
  return aligned(all, left);
}

void require(bool holds, std::string_view claim) {
  if (!holds) throw std::runtime_error(fmt::format("the page would claim what does not hold: {}", claim));
}

int run(const char* program, const std::function<void()>& write_pages) {
  try {
    write_pages();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
    return 1;
  }
  return 0;
}

}  // namespace chronormal::pages
