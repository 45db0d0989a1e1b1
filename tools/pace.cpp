// What ./test compiles to see the pace of a machine (tools/parts.sh). It is never run, and stays as it is: whoever
// changes it measures the machine of the budgets anew.
#include <algorithm>
#include <iostream>
#include <map>
#include <regex>
#include <string>

int main(int count, char** texts) {
  const std::regex word("[a-z]+");
  std::map<std::string, int> lengths;
  std::for_each(texts, texts + count, [&](const std::string& text) {
    const std::string changed = std::regex_replace(text, word, "_");
    lengths[changed] += static_cast<int>(changed.size());
  });
  for (const auto& [text, length] : lengths) std::cout << text << ' ' << length << '\n';
}
