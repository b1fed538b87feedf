// Reports back from JSON, for merging.
#include "cli/batch_report.h"

#include <tessera/error.h>

#include <simdjson.h>

#include <algorithm>
#include <limits>

namespace tessera::cli {
namespace {

using simdjson::dom::element;

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
    throw Error(ErrorCode::kInput, reason, file);
}

// One report's members; a fault names the file and the member.
class Reader {
  public:
    explicit Reader(const std::string& file) : file_(file) {}

    template <class T>
    T get(const element& object, const char* key) const {
        T value{};
        if (object[key].get(value) != simdjson::SUCCESS)
            fail(file_, std::string(key) + ": missing, or not what a report has there");
        return value;
    }
    std::string text(const element& object, const char* key) const {
        return std::string(get<std::string_view>(object, key));
    }
    template <class T>
    T get_or(const element& object, const char* key, T otherwise) const {
        return object[key].error() == simdjson::NO_SUCH_FIELD ? otherwise : get<T>(object, key);
    }
    std::string text_or(const element& object, const char* key) const {
        return std::string(get_or<std::string_view>(object, key, {}));
    }
    template <class T>
    T in_range(const element& object, const char* key, std::int64_t low, std::int64_t high) const {
        const auto value = get<std::int64_t>(object, key);
        if (value < low || value > high)
            fail(file_, std::string(key) + ": " + std::to_string(value) + " is out of range");
        return static_cast<T>(value);
    }

    // JSON has no infinity: it is written as null.
    double error(const element& object, const char* key) const {
        return object[key].is_null() ? std::numeric_limits<double>::infinity() : get<double>(object, key);
    }

    Comparison comparison(const element& e) const {
        Comparison c;
        const std::string verdict = text(e, "verdict");
        constexpr int kVerdicts = static_cast<int>(Verdict::kMissing) + 1;
        int i = 0;
        while (i < kVerdicts && verdict != name(static_cast<Verdict>(i))) ++i;
        if (i == kVerdicts) fail(file_, "verdict: there is no '" + verdict + "'");
        c.verdict = static_cast<Verdict>(i);
        c.reference = text(e, "reference");
        c.difference = text_or(e, "difference");
        if (c.verdict > Verdict::kDifferent) return c;
        c.pixels = get<std::uint64_t>(e, "pixels");
        c.differing_pixels = get<std::uint64_t>(e, "differing_pixels");
        c.floating = text(e, "unit") == "1";
        c.max_error = error(e, "max_error");
        c.mean_error = error(e, "mean_error");
        if (!e["psnr_db"].is_null()) c.psnr = get<double>(e, "psnr_db");
        return c;
    }

    PictureReport picture(const element& e) const {
        PictureReport p;
        p.file = text(e, "file"), p.aov = text(e, "aov");
        p.camera = text_or(e, "camera"), p.hash = text_or(e, "hash");
        p.skipped = get_or(e, "skipped", false);
        if (!e["frame"].error()) p.frame = static_cast<long>(get<std::int64_t>(e, "frame"));
        if (!e["width"].error()) {
            p.width = in_range<int>(e, "width", 1, 1 << 20);
            p.height = in_range<int>(e, "height", 1, 1 << 20);
        }
        if (!e["comparison"].error()) p.comparison = comparison(e["comparison"].value());
        return p;
    }

    SceneReport scene(const element& e) const {
        SceneReport s;
        s.file = text(e, "scene");
        s.number = get<std::uint64_t>(e, "number");
        const std::string status = text(e, "status");
        if (status != "done" && status != "skipped" && status != "failed")
            fail(file_, "status: there is no '" + status + "'");
        if (status == "skipped") s.status = SceneStatus::kSkipped;
        if (status == "failed") {
            s.status = SceneStatus::kFailed;
            s.exit_code = in_range<int>(e, "exit_code", kInternalFault, kLimitReached);
            s.error = text(e, "error");
        }
        s.load_ms = get<double>(e, "load_ms"), s.render_ms = get<double>(e, "render_ms");
        s.encode_ms = get<double>(e, "encode_ms");
        for (const element picture_element : get<simdjson::dom::array>(e, "pictures"))
            s.pictures.push_back(picture(picture_element));
        for (const element warning : get<simdjson::dom::array>(e, "warnings"))
            if (warning.is_string()) s.warnings.emplace_back(std::string_view(warning));
        return s;
    }

    BatchReport report(const element& e) const {
        if (!e.is_object() || e["tessera_batch"].error()) fail(file_, "is no report of tessera batch");
        if (get<std::int64_t>(e, "tessera_batch") != 1) fail(file_, "is a report of another version of tessera batch");
        BatchReport r;
        for (const auto& [key, value] : get<simdjson::dom::object>(e, "options"))
            if (value.is_string()) r.options.emplace(key, std::string_view(value));
        const auto list = get<element>(e, "list"), shards = get<element>(e, "shards");
        r.list_scenes = get<std::uint64_t>(list, "scenes");
        r.list_hash = text(list, "hash");
        r.shard_count = in_range<long>(shards, "count", 1, 1000000);
        r.shard_by = text(shards, "by");
        r.shards.clear();
        for (const element shard : get<simdjson::dom::array>(shards, "here")) {
            std::int64_t number = 0;
            if (shard.get(number) != simdjson::SUCCESS || number < 1 || number > r.shard_count)
                fail(file_, "here: no such shard");
            r.shards.push_back(static_cast<long>(number));
        }
        r.threads = in_range<int>(e, "threads", 0, 1 << 20);
        r.in_flight = in_range<int>(e, "in_flight", 0, 1 << 20);
        r.wall_ms = get<double>(e, "wall_ms");
        r.peak_rss_mb = get<double>(e, "peak_rss_mb");
        for (const element scene_element : get<simdjson::dom::array>(e, "scenes"))
            r.scenes.push_back(scene(scene_element));
        return r;
    }

  private:
    const std::string& file_;
};

}  // namespace

BatchReport read_report(const std::string& file) {
    simdjson::dom::parser parser;
    element root;
    if (const auto error = parser.load(file).get(root); error != simdjson::SUCCESS)
        fail(file, error == simdjson::IO_ERROR ? std::string("cannot be read")
                                               : std::string("is no JSON: ") + simdjson::error_message(error));
    return Reader(file).report(root);
}

}  // namespace tessera::cli
