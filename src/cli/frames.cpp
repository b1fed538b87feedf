#include "cli/frames.h"

#include "cli/parse.h"

namespace tessera::cli {
namespace {

constexpr std::int64_t kMostFrames = 9999999;

}  // namespace

Moment Frames::moment(Moment start, long frame) const {
    if (plays) start.time = static_cast<double>(frame) / fps;
    return start;
}

View Frames::view(View first_view, long frame) const {
    constexpr double kFullTurn = 6.283185307179586;
    if (turning) first_view.turn = kFullTurn * static_cast<double>(frame % *turning) / static_cast<double>(*turning);
    return first_view;
}

std::optional<Frames> parse_frames(const std::string& frames, const std::string& fps, const std::string& turntable) {
    Frames f;
    f.fps = parse_number("--fps", fps, 1e-3, 1e6);
    f.plays = !frames.empty();
    if (!turntable.empty()) {
        f.turning = static_cast<long>(parse_integer("--turntable", turntable, 1, kMostFrames));
        f.last = *f.turning - 1;
    }
    if (frames.empty()) return turntable.empty() ? std::nullopt : std::optional(f);
    const std::size_t dash = frames.find('-');
    f.first = static_cast<long>(parse_integer("--frames", frames.substr(0, dash), 0, kMostFrames));
    f.last = dash == std::string::npos
                 ? f.first
                 : static_cast<long>(parse_integer("--frames", frames.substr(dash + 1), 0, kMostFrames));
    if (f.last < f.first) refuse("--frames", "ends before it begins");
    return f;
}

}  // namespace tessera::cli
