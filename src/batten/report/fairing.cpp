#include <batten/fair/fair.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace batten {

std::string FairReport::full() const {
    std::string text = fmt::format("energy {:.6g}, was {:.6g}; {} control points may move, the "
                                   "furthest by {:.6g}\n",
                                   energy_after, energy_before, moving.size(), largest_move);
    text += fmt::format("  method      {}", method);
    if (method != "direct")
        text +=
            fmt::format(", {} iterations, {}", course.iterations, to_string(course.termination));
    return text + "\n";
}

std::string FairReport::to_json() const {
    nlohmann::ordered_json json;
    json["energy_before"] = energy_before;
    json["energy_after"] = energy_after;
    json["moving"] = moving;
    json["largest_move"] = largest_move;
    json["method"] = method;
    json["settings"] = settings;
    json["termination"] = to_string(course.termination);
    json["iterations"] = course.iterations;
    json["gradient_norm"] = course.gradient_norm;
    json["first_gradient_norm"] = course.first_gradient_norm;
    return json.dump(2) + "\n";
}

} // namespace batten
