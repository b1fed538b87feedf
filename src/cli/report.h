// What the command says to people: one line per error or warning on stderr, and a progress bar when
// stderr is a terminal. Text that comes from files loses its control characters.
#pragma once

#include <tessera/render.h>

#include <string>
#include <string_view>
#include <vector>

namespace tessera::cli {

// `text` without characters that break a line or steer a terminal.
std::string printable(std::string_view text);

void report_error(const std::string& text);
// At most a screenful, then how many more there were. Each names `file`, once.
void report_warnings(const std::string& file, const std::vector<std::string>& warnings);

// The most that the shown stage has anywhere, in a line.
void report_stage(const RenderOptions& options, const RenderResult& result);

// A bar on one line of stderr; wiped when it goes. Does nothing unless `enabled` and stderr is a terminal.
class ProgressBar {
  public:
    explicit ProgressBar(bool enabled);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    bool active() const { return active_; }
    // `fraction` in [0, 1].
    void show(double fraction);
    // Takes it off its line, for other text.
    void clear();

  private:
    bool active_;
    int shown_percent_ = -1;
};

}  // namespace tessera::cli
