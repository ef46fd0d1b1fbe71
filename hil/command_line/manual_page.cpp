#include "hil/command_line/manual_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

namespace rigwire::hil {

namespace {

/// Escapes `text` so that no character of it is a roff command (man(7), groff_char(7)).
std::string plain(const std::string& text) {
  std::string page;
  for (const char c : text) {
    const bool begins = page.empty() || page.back() == '\n';
    if (begins && (c == '.' || c == '\'')) {
      page += "\\&";
    }
    page += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return page;
}

/// In one line, whatever the terminal's help breaks.
std::string one_line(const std::string& text) {
  std::string line = text;
  for (char& c : line) {
    c = c == '\n' ? ' ' : c;
  }
  return plain(line);
}

std::string option_text(const CLI::Option& option) {
  const bool takes = option.get_items_expected_max() > 0;
  std::string name = option.get_name(option.get_positional(), true);
  if (option.get_positional()) {
    name = option.get_name(true);
  } else if (takes) {
    name += " " + (option.get_type_name().empty() ? "VALUE" : option.get_type_name());
  }
  const std::string value = option.get_default_str();
  return fmt::format(".TP\n.B {}\n{}{}\n", one_line(name), one_line(option.get_description()),
                     value.empty() ? "" : " (" + one_line(value) + " without)");
}

/// Writes the paragraphs of a text with their lines unchanged.
std::string example_text(const std::string& footer) {
  const std::size_t first = footer.find_first_not_of('\n');
  return first == std::string::npos
             ? ""
             : fmt::format(".PP\n.nf\n{}\n.fi\n", plain(footer.substr(first)));
}

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string page = fmt::format(
      ".TH RIGWIRE 1 \"\" \"rigwire {}\" \"User Commands\"\n.SH NAME\nrigwire \\- simulated field "
      "machines on the wires of real devices\n.SH SYNOPSIS\n.B rigwire\nVERB [WORDS] [OPTIONS]\n"
      ".SH DESCRIPTION\n{}\n",
      plain(version), one_line(app.get_description()));
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : app.get_options()) {
    page += option_text(*option);
  }
  page += ".SH VERBS\n";
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    page += fmt::format(".SS rigwire {}\n{}.\n", plain(verb->get_name()),
                        one_line(verb->get_description()));
    for (const CLI::Option* option : verb->get_options()) {
      if (option->get_name() != "--help") {
        page += option_text(*option);
      }
    }
    page += example_text(verb->get_footer());
  }
  page += ".SH EXAMPLES AND EXIT CODES\n" + example_text(app.get_footer());
  return page;
}

}  // namespace rigwire::hil
