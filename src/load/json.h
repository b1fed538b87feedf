// Checked access to a parsed JSON document: every getter verifies type and range and throws kInput
// with the JSON path ("/nodes/3/mesh"). A Json is a small view; it must not outlive the document that
// it came from nor the file name that it was made with.
#pragma once

#include <tessera/error.h>

#include <simdjson.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// A place in a document. Cheap to extend; becomes text only for an error. Beyond kMaxDepth levels the
// path stays at its last level.
class JsonPath {
  public:
    JsonPath child(std::string_view key) const { return extended({key, 0}); }
    JsonPath child(std::size_t index) const { return extended({{}, index}); }
    std::string text() const;

  private:
    static constexpr std::size_t kMaxDepth = 12;
    struct Step {
        std::string_view key;  // null data: an index
        std::size_t index = 0;
    };
    JsonPath extended(const Step& step) const {
        JsonPath path = *this;
        if (path.depth_ < kMaxDepth) path.steps_[path.depth_++] = step;
        return path;
    }
    std::array<Step, kMaxDepth> steps_;
    std::size_t depth_ = 0;
};

class Json {
  public:
    Json(simdjson::dom::element element, const JsonPath& path, const std::string& file)
        : element_(element), path_(path), file_(&file) {}

    std::string place() const { return path_.text(); }
    [[noreturn]] void fail(const std::string& message, ErrorCode code = ErrorCode::kInput) const {
        throw Error(code, message, *file_, place());
    }

    // Members of an object. `find` gives nothing when the member is absent; `at` throws.
    bool is_object() const { return element_.is_object(); }
    std::optional<Json> find(std::string_view key) const;
    Json at(std::string_view key) const;
    template <class F>
    void each_member(F&& f) const {  // f(std::string_view key, Json value)
        for (const simdjson::dom::key_value_pair member : object())
            f(member.key, Json(member.value, path_.child(member.key), *file_));
    }

    // Elements of an array.
    std::vector<simdjson::dom::element> elements() const;
    template <class F>
    void each(F&& f) const {  // f(Json element, std::size_t index)
        std::size_t i = 0;
        for (const simdjson::dom::element element : array()) {
            f(Json(element, path_.child(i), *file_), i);
            ++i;
        }
    }

    // Values.
    std::string_view string() const;
    bool boolean() const;
    float number() const;  // finite as a 32-bit float
    double real() const;   // any number
    std::uint64_t integer(std::uint64_t most = std::numeric_limits<std::int64_t>::max()) const;
    // A reference to one of `size` things called `what`.
    int reference(std::size_t size, std::string_view what) const;
    std::vector<float> numbers() const;
    void numbers(std::span<float> out) const;  // exactly out.size()
    std::string raw() const;                   // the value as JSON text without white space

    // Optional members of an object.
    std::string string_or(std::string_view key, std::string_view fallback = {}) const;
    bool boolean_or(std::string_view key, bool fallback) const;
    float number_or(std::string_view key, float fallback) const;
    std::uint64_t integer_or(std::string_view key, std::uint64_t fallback) const;
    int reference_or_none(std::string_view key, std::size_t size, std::string_view what) const;
    void numbers_or_keep(std::string_view key, std::span<float> out) const;
    std::string raw_or_empty(std::string_view key) const;

  private:
    simdjson::dom::object object() const;
    simdjson::dom::array array() const;
    [[noreturn]] void wrong_type(std::string_view expected) const;

    simdjson::dom::element element_;
    JsonPath path_;
    const std::string* file_;
};

}  // namespace tessera
