// Options are declared to the library of command lines, and kept as entries for the reference page. Their
// values are checked as parameters are, so that messages read alike. No other file includes that library.
#include "args.h"

#include <CLI/CLI.hpp>

#include "tafoni/core/error.h"

namespace tafoni::cli {
namespace {

/// The longest name, as errors show it: "--voxel".
std::string long_name(const std::string& flags) {
  const auto comma = flags.rfind(',');
  return comma == std::string::npos ? flags : flags.substr(comma + 1);
}

class Help : public CLI::Formatter {
 public:
  Help() { column_width(36); }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_type_name().empty() ? "" : " " + option->get_type_name();
  }
};

}  // namespace

Args::Args(const std::string& name, const std::string& doc) : app_(std::make_shared<CLI::App>(doc, name)) {
  app_->formatter(std::make_shared<Help>());
  app_->set_help_flag("-h,--help", "Print this help and exit");
}
Args::~Args() = default;

void Args::footer(const std::string& text) {
  app_->footer(text);
}

void Args::positional(const std::string& name, std::string& target, const std::string& doc, bool required) {
  entries_.push_back({name, "", doc, "Arguments"});
  auto* option = app_->add_option(name, target, doc)->type_name("");
  if (required) option->required();
}

void Args::flag(const std::string& flags, bool& target, const std::string& doc) {
  entries_.push_back({flags, "", doc, group_});
  app_->add_flag(flags, target, doc)->group(group_);
}

void Args::add(const std::string& flags, const std::string& value, const std::string& doc,
               std::function<void(const std::string&)> store) {
  entries_.push_back({flags, value, doc, group_});
  auto* option = app_->add_option(flags, doc)->group(group_)->type_name(value)->type_size(1);
  after_.push_back([option, store = std::move(store)] {
    if (option->count() > 0) store(option->results().back());
  });
}

void Args::add_value(const std::string& flags, const std::string& value, const std::string& doc,
                     ParamInfo info, std::function<void(const Value&)> store) {
  info.name = long_name(flags);
  add(flags, value, doc, [info, store = std::move(store)](const std::string& text) {
    store(parse_value(info, text, "command line"));
  });
}

void Args::text(const std::string& flags, const std::string& value, std::string& target,
                const std::string& doc) {
  add(flags, value, doc, [&target](const std::string& text) { target = text; });
}

void Args::texts(const std::string& flags, const std::string& value, std::vector<std::string>& target,
                 const std::string& doc) {
  entries_.push_back({flags, value, doc, group_});
  app_->add_option(flags, target, doc)
      ->group(group_)
      ->type_name(value)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void Args::choice(const std::string& flags, std::string& target, std::vector<std::string> choices,
                  const std::string& doc) {
  ParamInfo info;
  info.kind = ValueKind::choice;
  info.choices = std::move(choices);
  const std::string value = allowed(info);
  add_value(flags, value, doc, info, [&target](const Value& v) { target = std::get<std::string>(v); });
}

void Args::number(const std::string& flags, const std::string& value, std::optional<double>& target,
                  double min, double max, const std::string& unit, const std::string& doc) {
  ParamInfo info;
  info.kind = ValueKind::real;
  info.min = min;
  info.max = max;
  info.unit = unit;
  add_value(flags, value, doc, info, [&target](const Value& v) { target = std::get<double>(v); });
}

void Args::integer(const std::string& flags, const std::string& value, std::optional<std::int64_t>& target,
                   std::int64_t min, std::int64_t max, const std::string& doc) {
  ParamInfo info;
  info.kind = ValueKind::integer;
  info.min = static_cast<double>(min);
  info.max = static_cast<double>(max);
  add_value(flags, value, doc, info, [&target](const Value& v) { target = std::get<std::int64_t>(v); });
}

namespace {

ParamInfo numbers_info(std::size_t count) {
  ParamInfo info;
  info.kind = ValueKind::numbers;
  info.count = count;
  info.min = -1e9;
  info.max = 1e9;
  return info;
}

}  // namespace

void Args::numbers(const std::string& flags, const std::string& value, std::vector<double>& target,
                   std::size_t count, const std::string& doc) {
  add_value(flags, value, doc, numbers_info(count),
            [&target](const Value& v) { target = std::get<std::vector<double>>(v); });
}

void Args::optional_numbers(const std::string& flags, const std::string& value, bool& given,
                            std::vector<double>& target, std::size_t count, const std::string& doc) {
  add_value(flags, "[" + value + "]", doc, numbers_info(count),
            [&target](const Value& v) { target = std::get<std::vector<double>>(v); });
  CLI::Option* option = app_->get_option(long_name(flags));
  option->expected(0, 1);
  after_.back() = [option, store = after_.back(), &given] {
    given = option->count() > 0;
    if (given && !option->results().empty() && !option->results().back().empty() &&
        option->results().back() != "{}")
      store();
  };
}

void Args::apply() const {
  for (const auto& store : after_) store();
}

namespace {

std::string help_of(const CLI::App& app) {
  return app.get_name() == "tafoni" ? "tafoni --help" : "tafoni " + app.get_name() + " --help";
}

[[noreturn]] void unexpected(const CLI::App& app, const std::string& word) {
  const std::string help = help_of(app);
  if (!word.starts_with('-')) fail(ErrorKind::usage, "unexpected argument \"{}\"; see {}", word, help);
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const std::string name = word.substr(0, word.find('='));
  const std::string near = nearest(name, names);
  fail(ErrorKind::usage, "unknown option {}; {}", name,
       near.empty() ? "see " + help : fmt::format("did you mean {}?", near));
}

void check_command_name(int argc, const char* const* argv, const std::vector<Args*>& commands) {
  if (argc < 2) return;
  std::vector<std::string> names;
  for (const Args* args : commands) names.push_back(args->app()->get_name());
  const auto is_name = [&](const char* word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  if (argv[1][0] == '-') {
    const std::vector<std::string> own = {"-h", "--help", "--version"};
    if (std::find(own.begin(), own.end(), argv[1]) != own.end()) return;
    const bool is_long = std::string_view(argv[1]).starts_with("--");
    if (const std::string near = is_long ? nearest(argv[1], own) : std::string(); !near.empty())
      fail(ErrorKind::usage, "unknown option {}; did you mean {}?", argv[1], near);
    const auto name = std::find_if(argv + 2, argv + argc, is_name);
    if (name != argv + argc)
      fail(ErrorKind::usage, "options stand after the command: tafoni {} {} …", *name, argv[1]);
    fail(ErrorKind::usage, "{} needs a command before it; see tafoni --help", argv[1]);
  }
  if (is_name(argv[1])) return;
  const std::string near = nearest(argv[1], names);
  fail(ErrorKind::usage, "unknown command \"{}\"; {}", argv[1],
       near.empty() ? "see tafoni --help" : fmt::format("did you mean {}?", near));
}

/// Throws a parse error in the program's own words.
[[noreturn]] void explain(const CLI::ParseError& error, const CLI::App& app) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    for (const std::string& word : app.remaining()) unexpected(app, word);
  std::string text = error.what();
  for (char& c : text)
    if (c == '\n') c = ' ';
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string option = text.substr(0, text.find(':'));
    if (text.ends_with(" missing")) text = option + " needs a value; see " + help_of(app);
    if (text.find("At Most") != text.npos) text = option + " is given more than once; leave one";
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) text += "; see " + help_of(app);
  fail(ErrorKind::usage, "{}", text);
}

}  // namespace

Parsed parse(int argc, const char* const* argv, const std::vector<Args*>& commands, const std::string& doc,
             const std::string& footer, const std::string& version) {
  // "help" and "help COMMAND" are what other programs take, too.
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    const char* const asked[] = {argv[0], argc > 2 ? argv[2] : "--help", "--help"};
    return parse(3, asked, commands, doc, footer, version);
  }
  check_command_name(argc, argv, commands);
  CLI::App app(doc, "tafoni");
  app.formatter(std::make_shared<Help>());
  app.footer(footer);
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", version, "Print the version and exit");
  app.require_subcommand(1);
  for (Args* args : commands) app.add_subcommand(args->app());
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion&) {
    return {-1, version + "\n"};
  } catch (const CLI::Success&) {
    const auto chosen = app.get_subcommands();
    return {-1, chosen.empty() ? app.help() : chosen.front()->help("tafoni")};
  } catch (const CLI::ParseError& error) {
    if (argc < 2) return {-1, app.help()};
    const auto chosen = app.get_subcommands();
    explain(error, chosen.empty() ? app : *chosen.front());
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (!commands[i]->app()->parsed()) continue;
    commands[i]->apply();
    return {static_cast<int>(i), {}};
  }
  return {-1, app.help()};
}

}  // namespace tafoni::cli
