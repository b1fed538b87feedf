#include "cli/batch_report.h"

#include "cli/json_writer.h"

#include <tessera/version.h>

#include <cstdio>

namespace tessera::cli {
namespace {

const char* name(SceneStatus status) {
    switch (status) {
        case SceneStatus::kDone:
            return "done";
        case SceneStatus::kSkipped:
            return "skipped";
        case SceneStatus::kFailed:
            return "failed";
    }
    return "";
}

void write(JsonWriter& json, const Comparison& c) {
    json.key("comparison").begin_object().member("verdict", name(c.verdict)).member("reference", c.reference);
    if (c.verdict <= Verdict::kDifferent) {
        json.member("pixels", c.pixels).member("differing_pixels", c.differing_pixels);
        json.member("unit", c.floating ? "1" : "1/255")
            .member("max_error", c.max_error)
            .member("mean_error", c.mean_error);
        json.key("psnr_db");
        c.psnr ? json.value(*c.psnr) : json.null();
    }
    if (!c.difference.empty()) json.member("difference", c.difference);
    json.end_object();
}

void write(JsonWriter& json, const PictureReport& p) {
    json.begin_object().member("file", p.file);
    if (!p.camera.empty()) json.member("camera", p.camera);
    if (p.frame) json.member("frame", *p.frame);
    json.member("aov", p.aov);
    if (p.skipped) json.member("skipped", true);
    if (!p.hash.empty()) json.member("hash", p.hash);
    if (p.width > 0) json.member("width", p.width).member("height", p.height);
    if (p.comparison) write(json, *p.comparison);
    json.end_object();
}

void write(JsonWriter& json, const SceneReport& s) {
    json.begin_object().member("number", s.number).member("scene", s.file).member("status", name(s.status));
    if (s.status == SceneStatus::kFailed) json.member("exit_code", s.exit_code).member("error", s.error);
    json.member("load_ms", s.load_ms).member("render_ms", s.render_ms).member("encode_ms", s.encode_ms);
    json.key("pictures").begin_array();
    for (const PictureReport& picture : s.pictures) write(json, picture);
    json.end_array();
    json.key("warnings").begin_array();
    for (const std::string& warning : s.warnings) json.value(warning);
    json.end_array().end_object();
}

std::string counted(std::uint64_t count, const char* one, const char* many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

const char* name(Verdict verdict) {
    switch (verdict) {
        case Verdict::kEqual:
            return "equal";
        case Verdict::kWithin:
            return "within";
        case Verdict::kDifferent:
            return "different";
        case Verdict::kOtherSize:
            return "other-size";
        case Verdict::kUnreadable:
            return "unreadable";
        case Verdict::kMissing:
            return "missing";
    }
    return "";
}

BatchTotals totals(const BatchReport& report) {
    BatchTotals t;
    for (const SceneReport& scene : report.scenes) {
        t.done += scene.status == SceneStatus::kDone;
        t.skipped += scene.status == SceneStatus::kSkipped;
        t.failed += scene.status == SceneStatus::kFailed;
        for (const PictureReport& picture : scene.pictures) {
            ++(picture.skipped ? t.already_there : t.written);
            t.compared += picture.comparison.has_value();
            t.differ += picture.comparison && picture.comparison->failed();
        }
    }
    return t;
}

int exit_code(const BatchReport& report) {
    for (const SceneReport& scene : report.scenes)
        if (scene.status == SceneStatus::kFailed) return scene.exit_code;
    return totals(report).differ > 0 ? kComparisonFailed : kFine;
}

std::string summary(const BatchReport& report) {
    const BatchTotals t = totals(report);
    std::string text = counted(report.scenes.size(), "scene", "scenes");
    if (report.shard_count > 1 && report.shards.size() == 1)
        text += " of shard " + std::to_string(report.shards.front()) + "/" + std::to_string(report.shard_count);
    text += ": " + counted(t.written, "picture", "pictures") + " written";
    if (t.already_there > 0) text += ", " + std::to_string(t.already_there) + " there already";
    if (t.failed > 0) text += ", " + counted(t.failed, "scene", "scenes") + " failed";
    if (t.compared > 0)
        text += ", " + std::to_string(t.differ) + " of " + std::to_string(t.compared) + " differ from the reference";
    char time[32];
    std::snprintf(time, sizeof time, ", %.2f s", report.wall_ms / 1000);
    return text + time;
}

std::string report_json(const BatchReport& report) {
    const BatchTotals t = totals(report);
    JsonWriter json;
    json.begin_object().member("tessera_batch", 1).member("version", TESSERA_VERSION);
    json.key("options").begin_object();
    for (const auto& [option, value] : report.options) json.member(option, value);
    json.end_object();
    json.key("list").begin_object().member("scenes", report.list_scenes).member("hash", report.list_hash).end_object();
    json.key("shards").begin_object().member("count", report.shard_count).member("by", report.shard_by);
    json.key("here").begin_array();
    for (const long shard : report.shards) json.value(shard);
    json.end_array().end_object();
    json.member("threads", report.threads).member("in_flight", report.in_flight);
    json.key("totals").begin_object();
    json.member("scenes", report.scenes.size()).member("done", t.done).member("skipped", t.skipped);
    json.member("failed", t.failed).member("pictures_written", t.written).member("pictures_skipped", t.already_there);
    json.member("compared", t.compared).member("differ", t.differ).member("exit_code", exit_code(report));
    json.end_object();
    json.member("wall_ms", report.wall_ms).member("peak_rss_mb", report.peak_rss_mb);
    json.key("scenes").begin_array();
    for (const SceneReport& scene : report.scenes) write(json, scene);
    json.end_array();
    return json.end_object().text();
}

}  // namespace tessera::cli
