#include "load/json.h"

#include <cmath>

namespace tessera {

std::string JsonPath::text() const {
    std::string text;
    for (std::size_t i = 0; i < depth_; ++i) {
        text += '/';
        if (steps_[i].key.data())
            text += steps_[i].key.substr(0, 80);
        else
            text += std::to_string(steps_[i].index);
    }
    return text;
}

void Json::wrong_type(std::string_view expected) const {
    std::string_view is = "null";
    switch (element_.type()) {
        case simdjson::dom::element_type::ARRAY:
            is = "an array";
            break;
        case simdjson::dom::element_type::OBJECT:
            is = "an object";
            break;
        case simdjson::dom::element_type::STRING:
            is = "a string";
            break;
        case simdjson::dom::element_type::BOOL:
            is = "a boolean";
            break;
        case simdjson::dom::element_type::NULL_VALUE:
            break;
        default:
            is = "a number";
    }
    fail("expected " + std::string(expected) + ", found " + std::string(is));
}

simdjson::dom::object Json::object() const {
    simdjson::dom::object object;
    if (element_.get(object) != simdjson::SUCCESS) wrong_type("an object");
    return object;
}

simdjson::dom::array Json::array() const {
    simdjson::dom::array array;
    if (element_.get(array) != simdjson::SUCCESS) wrong_type("an array");
    return array;
}

std::optional<Json> Json::find(std::string_view key) const {
    simdjson::dom::element value;
    if (object().at_key(key).get(value) != simdjson::SUCCESS) return std::nullopt;
    return Json(value, path_.child(key), *file_);
}

Json Json::at(std::string_view key) const {
    if (std::optional<Json> value = find(key)) return *value;
    fail("\"" + std::string(key) + "\" is missing");
}

std::vector<simdjson::dom::element> Json::elements() const {
    std::vector<simdjson::dom::element> elements;
    for (const simdjson::dom::element element : array()) elements.push_back(element);
    return elements;
}

std::string_view Json::string() const {
    std::string_view text;
    if (element_.get(text) != simdjson::SUCCESS) wrong_type("a string");
    return text;
}

bool Json::boolean() const {
    bool value = false;
    if (element_.get(value) != simdjson::SUCCESS) wrong_type("a boolean");
    return value;
}

double Json::real() const {
    double value = 0;
    if (element_.get(value) != simdjson::SUCCESS) wrong_type("a number");
    return value;
}

float Json::number() const {
    const double value = real();
    if (!(std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) fail("the number is too large");
    return static_cast<float>(value);
}

std::uint64_t Json::integer(std::uint64_t most) const {
    std::uint64_t value = 0;
    if (element_.get(value) != simdjson::SUCCESS) {
        // JSON has only one kind of number: 3.0 is the integer 3.
        double real = 0;
        if (element_.get(real) != simdjson::SUCCESS) wrong_type("a non-negative integer");
        if (!(real >= 0 && real <= 9007199254740992.0 && std::floor(real) == real))
            fail("expected a non-negative integer");
        value = static_cast<std::uint64_t>(real);
    }
    if (value > most) fail("the number " + std::to_string(value) + " is too large");
    return value;
}

int Json::reference(std::size_t size, std::string_view what) const {
    const std::uint64_t value = integer();
    if (value >= size)
        fail("there is no " + std::string(what) + " " + std::to_string(value) + " (the file has " +
             std::to_string(size) + ")");
    return static_cast<int>(value);
}

std::vector<float> Json::numbers() const {
    std::vector<float> values;
    each([&](const Json& value, std::size_t) { values.push_back(value.number()); });
    return values;
}

void Json::numbers(std::span<float> out) const {
    std::size_t count = 0;
    each([&](const Json& value, std::size_t i) {
        if (i < out.size()) out[i] = value.number();
        count = i + 1;
    });
    if (count != out.size())
        fail("expected " + std::to_string(out.size()) + " numbers, found " + std::to_string(count));
}

std::string Json::raw() const { return simdjson::minify(element_); }

std::string Json::string_or(std::string_view key, std::string_view fallback) const {
    const std::optional<Json> value = find(key);
    return std::string(value ? value->string() : fallback);
}

bool Json::boolean_or(std::string_view key, bool fallback) const {
    const std::optional<Json> value = find(key);
    return value ? value->boolean() : fallback;
}

float Json::number_or(std::string_view key, float fallback) const {
    const std::optional<Json> value = find(key);
    return value ? value->number() : fallback;
}

std::uint64_t Json::integer_or(std::string_view key, std::uint64_t fallback) const {
    const std::optional<Json> value = find(key);
    return value ? value->integer() : fallback;
}

int Json::reference_or_none(std::string_view key, std::size_t size, std::string_view what) const {
    const std::optional<Json> value = find(key);
    return value ? value->reference(size, what) : -1;
}

void Json::numbers_or_keep(std::string_view key, std::span<float> out) const {
    if (const std::optional<Json> value = find(key)) value->numbers(out);
}

std::string Json::raw_or_empty(std::string_view key) const {
    const std::optional<Json> value = find(key);
    return value ? value->raw() : std::string();
}

}  // namespace tessera
