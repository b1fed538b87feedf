#include "cli/video.h"

#include "cli/parse.h"
#include "cli/temporary_file.h"

#include <tessera/error.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>
#include <vector>

namespace tessera::cli {
namespace {

using Words = std::vector<std::string>;

struct Format {
    const char* ending;
    const char* muxer;
    bool even_sides, transparency;
    const char* transparent_pixels;  // ffmpeg's name of the pixel format with alpha
};

constexpr Format kFormats[] = {
    {".mp4", "mp4", true, false, ""},           {".mov", "mov", true, false, ""}, {".mkv", "matroska", true, false, ""},
    {".webm", "webm", false, true, "yuva420p"}, {".gif", "gif", false, true, ""},
};

const Format* format_of(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    if (dot == std::string::npos) return nullptr;
    std::string ending = path.substr(dot);
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const Format* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                       [&](const Format& format) { return ending == format.ending; });
    return found == std::end(kFormats) ? nullptr : found;
}

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
    throw Error(ErrorCode::kOutput, reason, path);
}

std::string number(double value) {
    std::string text = std::to_string(value);  // six digits are enough for any rate
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text;
}

// The command line. The encoder reads sRGB and is told to convert with, and to name, the matrix of BT.709.
Words arguments(const std::string& ffmpeg, const Format& format, const Image& first, const VideoOptions& options,
                const std::string& file) {
    Words words{ffmpeg,
                "-nostdin",
                "-hide_banner",
                "-loglevel",
                "error",
                "-y",
                "-f",
                "rawvideo",
                "-pixel_format",
                "rgba",
                "-video_size",
                std::to_string(first.width()) + "x" + std::to_string(first.height()),
                "-framerate",
                number(options.fps),
                "-i",
                "pipe:0",
                "-an"};
    const auto add = [&](const Words& more) { words.insert(words.end(), more.begin(), more.end()); };
    const std::string muxer = format.muxer;
    if (muxer == "gif") {
        // One palette of 256 colours for the whole, from all frames.
        add({"-filter_complex", "[0:v]split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0"});
    } else {
        const bool alpha = format.transparency && options.transparent;
        add({"-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt",
             alpha ? format.transparent_pixels : "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709",
             "-color_trc", "iec61966-2-1", "-color_range", "tv"});
        if (muxer == "webm")
            add({"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1"});
        else
            add({"-c:v", "libx264", "-crf", "18", "-preset", "medium"});
        if (muxer == "mp4" || muxer == "mov") add({"-movflags", "+faststart"});
    }
    // The protocol is said, or a name such as a:b would be taken for an address.
    add({"-f", muxer, std::string("file:").append(file)});
    return words;
}

// In the child, between fork and exec: only what is safe there.
[[noreturn]] void become(char* const* argv, int input, int messages, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    // Ignored signals stay ignored over exec.
    ::signal(SIGPIPE, SIG_DFL);
    ::signal(SIGXFSZ, SIG_DFL);
    ::dup2(input, STDIN_FILENO);
    ::dup2(messages, STDOUT_FILENO);
    ::dup2(messages, STDERR_FILENO);
    ::execv(argv[0], argv);
    ::_exit(127);
}

}  // namespace

bool is_video(const std::string& path) { return format_of(path) != nullptr; }

std::string video_endings() {
    std::string list;
    for (const Format& format : kFormats) list += (list.empty() ? "" : ", ") + std::string(format.ending);
    return list;
}

void check_video(const std::string& path, int width, int height, bool transparent) {
    const Format* format = format_of(path);
    if (format == nullptr) refuse("--output", "'" + path + "' is no video");
    if (format->even_sides && (width % 2 != 0 || height % 2 != 0))
        refuse("--size", std::to_string(width) + "x" + std::to_string(height) + ": the sides of a " + format->ending +
                             " are even");
    if (transparent && !format->transparency)
        refuse("--background", std::string("none: a ") + format->ending + " has no transparency; .webm and .gif have");
}

std::string find_ffmpeg(const std::string& path) {
    const char* list = std::getenv("PATH");
    const std::string folders = list != nullptr ? list : "/usr/local/bin:/usr/bin:/bin";
    for (std::size_t at = 0; at <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', at), folders.size());
        const std::string folder = folders.substr(at, end - at);
        const std::string program = (folder.empty() ? "." : folder) + "/ffmpeg";
        if (::access(program.c_str(), X_OK) == 0) return program;
        at = end + 1;
    }
    fail(path,
         "a video needs ffmpeg, which is not in PATH; install it (Debian: apt install ffmpeg), or write numbered "
         "pictures (-o frame_{frame:04}.png)");
}

// The running child, and the file that it writes.
struct Video::Encoder {
    Encoder(const std::string& target, const Image& first, const VideoOptions& options);
    ~Encoder();

    void write(const std::byte* data, std::size_t size, const std::function<bool()>& cancel);
    void wait(const std::function<bool()>& cancel);
    // What the encoder said, and how it ended.
    [[noreturn]] void fail_with_messages(const std::string& how);

    TemporaryFile file;
    int width, height;
    int pipe = -1, messages = -1;
    pid_t child = -1;
};

Video::Encoder::Encoder(const std::string& target, const Image& first, const VideoOptions& options)
    : file(target), width(first.width()), height(first.height()) {
    Words words = arguments(find_ffmpeg(target), *format_of(target), first, options, file.name());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int ends[2];
    messages = ::memfd_create("ffmpeg", MFD_CLOEXEC);
    if (messages < 0 || ::pipe2(ends, O_CLOEXEC) != 0) fail(target, std::string("no pipe: ") + std::strerror(errno));
    pipe = ends[1];
    const pid_t parent = ::getpid();
    child = ::fork();
    if (child == 0) become(argv.data(), ends[0], messages, parent);
    ::close(ends[0]);
    if (child < 0) fail(target, std::string("ffmpeg cannot be started: ") + std::strerror(errno));
    ::fcntl(pipe, F_SETFL, O_NONBLOCK);
}

Video::Encoder::~Encoder() {
    if (pipe >= 0) ::close(pipe);
    if (child > 0) {
        ::kill(child, SIGKILL);
        while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    if (messages >= 0) ::close(messages);
}

void Video::Encoder::write(const std::byte* data, std::size_t size, const std::function<bool()>& cancel) {
    while (size > 0) {
        const ssize_t written = ::write(pipe, data, size);
        if (written > 0) {
            data += written, size -= static_cast<std::size_t>(written);
        } else if (errno == EPIPE) {
            wait(cancel);  // throws, with its reason, unless it ended well
            fail_with_messages("ffmpeg ended before the last frame");
        } else if (errno == EAGAIN) {
            pollfd ready{pipe, POLLOUT, 0};
            ::poll(&ready, 1, 50);
            if (cancel && cancel()) throw Error(ErrorCode::kCancelled, "cancelled", file.target());
        } else if (errno != EINTR) {
            fail_with_messages(std::string("ffmpeg cannot be fed: ") + std::strerror(errno));
        }
    }
}

void Video::Encoder::wait(const std::function<bool()>& cancel) {
    ::close(std::exchange(pipe, -1));
    int status = 0;
    for (;;) {
        const pid_t ended = ::waitpid(child, &status, WNOHANG);
        if (ended == child) break;
        if (ended < 0 && errno != EINTR) fail_with_messages("ffmpeg is lost");
        if (cancel && cancel()) throw Error(ErrorCode::kCancelled, "cancelled", file.target());
        ::poll(nullptr, 0, 2);
    }
    child = -1;
    if (WIFSIGNALED(status)) fail_with_messages("ffmpeg was ended by signal " + std::to_string(WTERMSIG(status)));
    if (WEXITSTATUS(status) != 0)
        fail_with_messages("ffmpeg failed (exit code " + std::to_string(WEXITSTATUS(status)) + ")");
}

void Video::Encoder::fail_with_messages(const std::string& how) {
    constexpr off_t kTail = 400;
    const off_t size = ::lseek(messages, 0, SEEK_END), from = std::max<off_t>(0, size - kTail);
    std::string tail(static_cast<std::size_t>(std::max<off_t>(0, size - from)), '\0');
    const ssize_t got = ::pread(messages, tail.data(), tail.size(), from);
    tail.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    while (!tail.empty() && std::isspace(static_cast<unsigned char>(tail.back()))) tail.pop_back();
    fail(file.target(), tail.empty() ? how : how + ": " + tail);
}

Video::Video(std::string path, VideoOptions options, std::function<bool()> cancel)
    : path_(std::move(path)), options_(options), cancel_(std::move(cancel)) {
    find_ffmpeg(path_);
}

Video::~Video() = default;

void Video::add(const Image& frame) {
    if (!encoder_) encoder_ = std::make_unique<Encoder>(path_, frame, options_);
    if (frame.width() != encoder_->width || frame.height() != encoder_->height)
        throw Error(ErrorCode::kInternal, "the frames of a video have one size");
    encoder_->write(frame.bytes().data(), frame.bytes().size(), cancel_);
}

void Video::finish() {
    if (!encoder_) return;
    encoder_->wait(cancel_);
    encoder_->file.publish();
    encoder_.reset();
}

}  // namespace tessera::cli
