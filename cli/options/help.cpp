// Breaks the text of help into lines. A line that begins with a blank, like the rows of a list, is kept. Other lines
// are joined into paragraphs, and then broken again.
#include "cli/options/help.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <variant>

#include "cli/terminal/format.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/text.h"
#include "cli/terminal/version.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kNameColumn = 2, kTextColumn = 27;

constexpr std::string_view kAbout = "Computes, checks and corrects normals of triangle meshes that deform.";

constexpr std::array<std::pair<const char*, const char*>, 3> kOptionsOfProgram = {
    {{"-h, --help", "explain the program, or a command: chronormal bake --help"},
     {"--help-all", "explain all options of a command"},
     {"-V, --version", "print the version"}}};

struct Paragraph {
  std::string text;
  std::size_t hang = 0;  ///< indentation of all lines after the first
};

// Splits a text at separators. (A std::istringstream is not used, because a lack of memory would look like the end of
// the text.)
std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// Splits a text into paragraphs, whose lines are joined, and rows, which keep their line breaks.
std::vector<Paragraph> paragraphs_of(const std::string& text) {
  std::vector<Paragraph> paragraphs;
  bool flows = false;
  for (const std::string& line : parts_of(text, '\n')) {
    if (line.empty() || line.front() == ' ') {
      const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
      const std::size_t gap = line.find("  ", first);
      const std::size_t second = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
      paragraphs.push_back({line, second == std::string::npos ? first + 2 : second});
      flows = false;
    } else if (flows) {
      paragraphs.back().text += ' ' + line;
    } else {
      paragraphs.push_back({line, 0});
      flows = true;
    }
  }
  return paragraphs;
}

// Breaks a paragraph between words. All lines except the first begin at column `indent`; the first line continues the
// text before it.
std::string broken(const Paragraph& paragraph, std::size_t indent, std::size_t columns) {
  const std::size_t first = std::min(paragraph.text.find_first_not_of(' '), paragraph.text.size());
  std::string result = paragraph.text.substr(0, first);
  std::size_t column = indent + first;
  bool begins = true;
  for (std::size_t at = first; at < paragraph.text.size();) {
    const std::size_t end = std::min(paragraph.text.find(' ', at), paragraph.text.size());
    const std::size_t next = std::min(paragraph.text.find_first_not_of(' ', end), paragraph.text.size());
    const std::string word = paragraph.text.substr(at, end - at);
    if (!begins && column + width_of(word) > columns) {
      result.erase(result.find_last_not_of(' ') + 1);
      column = indent + paragraph.hang;
      result.append("\n").append(column, ' ');
    }
    result += word + std::string(next - end, ' ');
    column += width_of(word) + next - end;
    begins = false;
    at = next;
  }
  return result;
}

std::string flowing(const std::string& text, std::size_t indent, std::size_t columns) {
  std::string result;
  for (const Paragraph& paragraph : paragraphs_of(text)) {
    if (!result.empty()) result.append("\n").append(paragraph.text.empty() ? 0 : indent, ' ');
    result += broken(paragraph, indent, columns);
  }
  return result;
}

std::string row(const std::string& name, const std::string& text, std::size_t columns) {
  const std::size_t at = std::min(kTextColumn, columns / 2);
  std::string line(kNameColumn, ' ');
  line += name;
  if (width_of(line) + 2 > at)
    line.append("\n").append(at, ' ');
  else
    line.append(at - width_of(line), ' ');
  return line + flowing(text, at, columns) + '\n';
}

bool takes_several(const Option& option) { return std::holds_alternative<std::vector<std::string>*>(option.target); }

// Returns the spelling of an option for help: "-o, --output OUT".
std::string spelled(const Option& option) {
  std::string text = option.spelling;
  if (const std::size_t comma = text.find(','); comma < text.find(' ')) text.insert(comma + 1, 1, ' ');
  return takes_several(option) && names_of(option).empty() ? text + "..." : text;
}

std::string brief(const Option& option) { return option.help.substr(0, option.help.find('\n')); }

// Returns the meaning of an option for help: the first line of its text and, if `all` is true, the sentences that
// follow this line.
std::string meaning(const Option& option, bool all) {
  std::string text = brief(option) + (option.rules.required ? " (required)" : "");
  if (const std::size_t end = option.help.find('\n'); all && end != std::string::npos)
    text += ". " + option.help.substr(end + 1);
  return text;
}

template <class Visit>
void visit_options(const Command& command, bool named, const Visit& visit) {
  for (const std::vector<Option>& table : command.tables)
    for (const Option& option : table)
      if (names_of(option).empty() != named) visit(option);
}

std::string usage_of(const Command& command) {
  std::string arguments;
  visit_options(command, false, [&](const Option& option) { arguments += formatted(" [{}]", spelled(option)); });
  return formatted("chronormal {}{} [OPTIONS]", command.name, arguments);
}

// Escapes a text for roff. In roff, a period or an apostrophe at the start of a line would begin a command.
std::string for_manual(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\' || c == '-') result += '\\';
    if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
    result += c;
  }
  return result;
}

// Formats a text for the manual: rows keep their lines, and lines of paragraphs are joined.
std::string lines_for_manual(const std::string& text) {
  std::string result;
  for (const Paragraph& paragraph : paragraphs_of(text)) {
    if (!result.empty() && !paragraph.text.empty()) result += ".br\n";
    result += for_manual(paragraph.text.empty() ? ".PP" : paragraph.text) + '\n';
  }
  return result;
}

std::string words_of(const Command& command) {
  std::string words = "--help --help-all";
  visit_options(command, true, [&](const Option& option) { words += ' ' + names_of(option).back(); });
  return words;
}

std::string command_names(const std::vector<Command>& commands) {
  std::string names;
  for (const Command& command : commands) names.append(names.empty() ? "" : " ").append(command.name);
  return names;
}

// Puts a text into single quotes, as a shell reads them.
std::string quoted_for_shell(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + '\'';
}

std::string bash_completions(const std::vector<Command>& commands) {
  std::string cases;
  for (const Command& command : commands)
    cases += formatted("    {}) words=\"{}\" ;;\n", command.name, words_of(command));
  return formatted(
      "# Completions of chronormal for bash.\n"
      "_chronormal() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} words\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W \"{} help --help --version\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "    help) words=\"{}\" ;;\n"
      "{}"
      "  esac\n"
      "  case $word in\n"
      "    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
      "    *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
      "  esac\n"
      "}}\n"
      "complete -o filenames -F _chronormal chronormal\n",
      command_names(commands), command_names(commands), cases);
}

std::string zsh_completions(const std::vector<Command>& commands) {
  std::string summaries, cases;
  for (const Command& command : commands) {
    summaries += formatted("    {}\n", quoted_for_shell(formatted("{}:{}", command.name, command.summary)));
    cases += formatted("    {})\n      _arguments '*:file:_files'", command.name);
    visit_options(command, true, [&](const Option& option) {
      std::string text = brief(option);
      for (std::size_t at = 0; (at = text.find_first_of("[]:", at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\\');
      cases += formatted(" \\\n        {}", quoted_for_shell(formatted("*{}[{}]{}", names_of(option).back(), text,
                                                                       takes_value(option) ? ":value:_files" : "")));
    });
    cases += "\n      ;;\n";
  }
  return formatted(
      "#compdef chronormal\n"
      "# Completions of chronormal for zsh.\n"
      "_chronormal() {{\n"
      "  local -a commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  case $words[2] in\n{}"
      "  esac\n"
      "}}\n"
      "_chronormal \"$@\"\n",
      summaries, cases);
}

std::string fish_completions(const std::vector<Command>& commands) {
  std::string lines;
  for (const Command& command : commands) {
    lines += formatted("complete -c chronormal -n __fish_use_subcommand -a {} -d {}\n", command.name,
                       quoted_for_shell(command.summary));
    visit_options(command, true, [&](const Option& option) {
      lines += formatted("complete -c chronormal -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& name : names_of(option))
        lines += formatted(" {} {}", name.starts_with("--") ? "-l" : "-s", name.substr(name.find_first_not_of('-')));
      lines += formatted("{} -d {}\n", takes_value(option) ? " -r" : "", quoted_for_shell(brief(option)));
    });
  }
  return formatted("# Completions of chronormal for fish.\n{}", lines);
}

}  // namespace

std::vector<std::string> names_of(const Option& option) {
  if (option.spelling.front() != '-') return {};
  return parts_of(option.spelling.substr(0, option.spelling.find(' ')), ',');
}

bool takes_value(const Option& option) { return !std::holds_alternative<bool*>(option.target); }

std::string help_of_program(const std::vector<Command>& commands, std::size_t columns) {
  std::string text =
      flowing(std::string(kAbout), 0, columns) + "\n\nUsage: chronormal COMMAND [OPTIONS]\n\nCommands:\n";
  for (const Command& command : commands) text += row(command.name, command.summary, columns);
  text += "\nOptions:\n";
  for (const auto& [names, meaning] : kOptionsOfProgram) text += row(names, meaning, columns);
  return with_headings(text) + "\n" + flowing("chronormal COMMAND --help explains a command.", 0, columns) + "\n";
}

std::string help_of_command(const Command& command, bool all, std::size_t columns) {
  std::string text =
      flowing(command.summary, 0, columns) + "\n\n" + broken({"Usage: " + usage_of(command), 7}, 0, columns) + "\n\n";
  const auto add_row = [&](const Option& option) { text += row(spelled(option), meaning(option, all), columns); };
  // Prints a heading before the first option below it, so that a heading without options is not printed. The options of
  // the first table choose the input.
  const auto add_rows = [&](std::string heading, bool of_input, bool rare) {
    visit_options(command, true, [&](const Option& option) {
      const std::vector<Option>& input = command.tables.front();
      const bool chooses_input = &option >= input.data() && &option < input.data() + input.size();
      if (option.rules.rare != rare || (chooses_input != of_input && !rare)) return;
      text += std::exchange(heading, "");
      add_row(option);
    });
  };
  visit_options(command, false, add_row);
  add_rows("\nOptions:\n", false, false);
  text += row("-h, --help", "print this help", columns) +
          row("--help-all", "print all options with more about each of them", columns);
  add_rows("\nOptions for the input:\n", true, false);
  if (all) add_rows("\nOptions that few need:\n", false, true);
  if (!command.footer.empty()) text += formatted("\n{}\n", flowing(command.footer, 0, columns));
  return with_headings(text);
}

std::string manual_page(const std::vector<Command>& commands) {
  std::string page = formatted(".TH CHRONORMAL 1 \"\" \"chronormal {}\" \"User Commands\"\n.SH NAME\n", kVersion);
  page +=
      for_manual("chronormal - normals of triangle meshes that deform, exact at every instant") + "\n.SH SYNOPSIS\n";
  page += for_manual("chronormal COMMAND [OPTIONS]") + "\n";
  for (const Command& command : commands) {
    std::string title = command.name;
    std::transform(title.begin(), title.end(), title.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    page +=
        formatted(".SH {}\n.B {}\n.PP\n{}", title, for_manual(usage_of(command)), lines_for_manual(command.summary));
    for (const bool named : {false, true}) {
      visit_options(command, named, [&](const Option& option) {
        page += formatted(".TP\n.B {}\n{}", for_manual(spelled(option)), lines_for_manual(meaning(option, true)));
      });
    }
    if (!command.footer.empty()) page += formatted(".PP\n{}", lines_for_manual(command.footer));
  }
  page += ".SH OPTIONS\n";
  for (const auto& [names, text] : kOptionsOfProgram)
    page += formatted(".TP\n.B {}\n{}", for_manual(names), lines_for_manual(text));
  return page + ".SH EXIT STATUS\n0 done, 1 failed, 2 wrong usage, 3 invalid input, 4 a limit was exceeded\n";
}

Result<std::string> completions(const std::vector<Command>& commands, std::string_view shell) {
  if (shell == "bash") return bash_completions(commands);
  if (shell == "zsh") return zsh_completions(commands);
  if (shell == "fish") return fish_completions(commands);
  return Error{ErrorCode::kUsage, "--completions",
               formatted("there are no completions for '{}'; choose bash, zsh or fish", printable(shell))};
}

}  // namespace chronormal::cli
