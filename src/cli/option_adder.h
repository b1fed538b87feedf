// Adds options whose values stay text to a subcommand, in groups.
#pragma once

#include <CLI/App.hpp>

#include <string>

namespace tessera::cli {

class OptionAdder {
  public:
    explicit OptionAdder(CLI::App& app) : app_(app) {}

    CLI::Option* operator()(const char* group, const char* names, std::string& value, const char* type,
                            const char* help) const {
        // An empty value is refused by name; it would otherwise look as if the option were absent.
        const auto not_empty = [](std::string& text) { return text.empty() ? std::string("is empty") : std::string(); };
        CLI::Option* added = app_.add_option(names, value, help)->group(group)->option_text(type);
        added->check(CLI::Validator(not_empty, "", "not empty"))->multi_option_policy(CLI::MultiOptionPolicy::Throw);
        return added;
    }

  private:
    CLI::App& app_;
};

}  // namespace tessera::cli
