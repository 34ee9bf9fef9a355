// Options are read from CLI11 and printed as completion scripts or troff.
#include "describe.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <vector>

#include "tool.h"
#include "version.h"

namespace tool {
namespace {

struct Option {
  std::vector<std::string> names;    // with dashes, long ones last
  std::string value;                 // placeholder of its value; empty for a flag
  std::vector<std::string> choices;  // allowed values, if listed
  std::string help;
};

// CLI11 writes choices into the type's name: TEXT:{one,two}.
std::vector<std::string> choices_of(const std::string& type) {
  const auto open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

std::vector<Option> options_of(const CLI::App& app) {
  std::vector<Option> out;
  for (const CLI::Option* o : app.get_options()) {
    if (!o->nonpositional()) continue;
    Option option;
    for (const std::string& s : o->get_snames()) option.names.push_back("-" + s);
    for (const std::string& l : o->get_lnames()) option.names.push_back("--" + l);
    const std::string type = o->get_type_name();
    if (o->get_expected_max() > 0 && o->get_type_size_max() > 0)
      option.value = type.empty() ? "FILE" : type.substr(0, type.find(':'));
    option.choices = choices_of(type);
    option.help = o->get_description();
    out.push_back(std::move(option));
  }
  return out;
}

bool is_number(const Option& o) { return o.value == "INT" || o.value == "UINT" || o.value == "FLOAT"; }

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : between) + w;
  return out;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string bash(const CLI::App& app) {
  const std::string name = app.get_name(), function = "_" + replaced(name, "-", "_");
  std::vector<std::string> names;
  std::string cases;
  for (const Option& o : options_of(app)) {
    names.insert(names.end(), o.names.begin(), o.names.end());
    if (o.value.empty()) continue;
    const std::string words = o.choices.empty() ? "-f" : "-W '" + joined(o.choices, " ") + "'";
    cases += "    " + joined(o.names, "|") + ") " +
             (is_number(o) ? "" : "COMPREPLY=($(compgen " + words + " -- \"$word\")); ") + "return ;;\n";
  }
  return "# Completion of " + name + " for bash.\n" + function +
         "() {\n  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n  case $before in\n" +
         cases + "  esac\n  case $word in\n    -*) COMPREPLY=($(compgen -W '" + joined(names, " ") +
         "' -- \"$word\")) ;;\n    *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n  esac\n}\n" +
         "complete -o filenames -F " + function + " " + name + "\n";
}

std::string zsh(const CLI::App& app) {
  const auto escaped = [](const std::string& text) {
    return replaced(replaced(replaced(replaced(text, "'", "'\\''"), "[", "\\["), "]", "\\]"), ":", "\\:");
  };
  std::string out = "#compdef " + app.get_name() + "\n# Completion of " + app.get_name() + " for zsh.\n_arguments -s";
  for (const Option& o : options_of(app)) {
    out += o.names.size() == 1 ? " \\\n  '" + o.names[0] : " \\\n  {" + joined(o.names, ",") + "}'";
    out += "[" + escaped(o.help) + "]";
    if (!o.value.empty())
      out += ":" + o.value + ":" +
             (is_number(o)        ? ""
              : o.choices.empty() ? "_files"
                                  : "(" + joined(o.choices, " ") + ")");
    out += "'";
  }
  return out + " \\\n  '*:file:_files'\n";
}

// Text for roff: dashes as ASCII, and no line that begins like a request.
std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  std::string lines;
  for (const std::string& line : CLI::detail::split(out, '\n'))
    lines += (!line.empty() && (line[0] == '.' || line[0] == '\'') ? "\\&" : "") + line + "\n";
  if (!lines.empty()) lines.pop_back();
  return lines;
}

std::string man(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string upper = name, positionals, list;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const CLI::Option* o : app.get_options())
    if (!o->nonpositional() && o->get_positional()) {
      const std::string word = o->get_name(true) + (o->get_expected_max() > 1 ? "..." : "");
      positionals += " " + (o->get_required() ? word : "[" + word + "]");
      list += ".TP\n\\fB" + roff(o->get_name(true)) + "\\fR\n" + roff(o->get_description()) + "\n";
    }
  for (const Option& o : options_of(app))
    list += ".TP\n\\fB" + roff(joined(o.names, ", ")) + "\\fR" +
            (o.value.empty() ? "" : " \\fI" + roff(o.choices.empty() ? o.value : joined(o.choices, "|")) + "\\fR") +
            "\n" + roff(o.help) + "\n";
  // The footer is "Examples:", lines, an empty line, "Exit codes: ...".
  const std::string footer = app.get_footer();
  const auto examples = footer.find('\n'), exits = footer.find("\n\nExit codes: ");
  return ".TH " + upper + " 1 \"\" \"kerf " KERF_VERSION "\" \"Kerf\"\n.SH NAME\n" + roff(name) + " \\- " +
         roff(app.get_description()) + "\n.SH SYNOPSIS\n.B " + roff(name) + "\n[\\fIoptions\\fR]" + roff(positionals) +
         "\n.SH DESCRIPTION\n@DESCRIPTION@\n.SH OPTIONS\n" + list + ".SH EXAMPLES\n.nf\n" +
         roff(footer.substr(examples + 1, exits - examples - 1)) + "\n.fi\n.SH EXIT STATUS\n" +
         roff(footer.substr(exits + std::string_view("\n\nExit codes: ").size())) + "\n";
}

}  // namespace

std::string describe(const CLI::App& app, const std::string& what) {
  if (what == "bash") return bash(app);
  if (what == "zsh") return zsh(app);
  if (what == "man") return man(app);
  throw UsageError("--describe takes bash, zsh or man");
}

}  // namespace tool
